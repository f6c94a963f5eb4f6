/// Made by make_lists.py: the lists with karabassi_swept and double.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

// clang-format off
TEST_CASE("pairs: list 1") { check_list<list_1>(); }
static bool const list_1_is_hunted = hunt<list_1>("1", "gravity velocity_verlet reaction sphere_contact spin bounce friction");
TEST_CASE("pairs: list 4") { check_list<list_4>(); }
static bool const list_4_is_hunted = hunt<list_4>("4", "bounce gravity adhesion reaction lost velocity_verlet");
TEST_CASE("pairs: list 5") { check_list<list_5>(); }
static bool const list_5_is_hunted = hunt<list_5>("5", "reaction velocity_verlet sphere_contact polydisperse gravity bounce");
TEST_CASE("pairs: list 14") { check_list<list_14>(); }
static bool const list_14_is_hunted = hunt<list_14>("14", "bounce emit periodic_box external_forces lost absorb absorbing_box friction sleep pair_forces spin gravity");
TEST_CASE("pairs: list 19") { check_list<list_19>(); }
static bool const list_19_is_hunted = hunt<list_19>("19", "warms absorbing_box mesh_forces polydisperse lost bounce lost_motion emit adhesion velocity_verlet sphere_contact pair_forces");
TEST_CASE("pairs: list 24") { check_list<list_24>(); }
static bool const list_24_is_hunted = hunt<list_24>("24", "sleep mesh_forces bounce spin box_walls friction emit lost_motion absorbing_box reaction gravity polydisperse");
TEST_CASE("pairs: list 27") { check_list<list_27>(); }
static bool const list_27_is_hunted = hunt<list_27>("27", "sphere_contact drag wind mass_flow box_walls");
