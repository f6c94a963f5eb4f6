/// Made by make_lists.py: the lists with karabassi_swept and double.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

// clang-format off
TEST_CASE("pairs: list 1") { check_list<list_1>(); }
static bool const list_1_is_hunted = hunt<list_1>("1", "bounce spin velocity_verlet sphere_contact friction gravity reaction");
TEST_CASE("pairs: list 4") { check_list<list_4>(); }
static bool const list_4_is_hunted = hunt<list_4>("4", "velocity_verlet gravity lost bounce adhesion reaction");
TEST_CASE("pairs: list 5") { check_list<list_5>(); }
static bool const list_5_is_hunted = hunt<list_5>("5", "polydisperse gravity sphere_contact bounce velocity_verlet reaction");
TEST_CASE("pairs: list 20") { check_list<list_20>(); }
static bool const list_20_is_hunted = hunt<list_20>("20", "sphere_contact bounce friction box_walls adhesion wind absorb spin pair_forces mesh_forces reaction polydisperse");
TEST_CASE("pairs: list 21") { check_list<list_21>(); }
static bool const list_21_is_hunted = hunt<list_21>("21", "external_forces mass_flow gravity periodic_box warms absorbing_box drag velocity_verlet bounce spin friction mesh_forces");
TEST_CASE("pairs: list 23") { check_list<list_23>(); }
static bool const list_23_is_hunted = hunt<list_23>("23", "lost sleep bounce emit lost_motion adhesion spin warms friction absorb pair_forces absorbing_box");
TEST_CASE("pairs: list 29") { check_list<list_29>(); }
static bool const list_29_is_hunted = hunt<list_29>("29", "bounce adhesion periodic_box drag");
