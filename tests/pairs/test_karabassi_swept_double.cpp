/// Made by make_lists.py: the lists with karabassi_swept and double.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

// clang-format off
TEST_CASE("pairs: list 1") { check_list<list_1>(); }
static bool const list_1_is_hunted = hunt<list_1>("1", "bounce friction velocity_verlet sphere_contact spin reaction gravity");
TEST_CASE("pairs: list 4") { check_list<list_4>(); }
static bool const list_4_is_hunted = hunt<list_4>("4", "gravity lost bounce velocity_verlet adhesion reaction");
TEST_CASE("pairs: list 5") { check_list<list_5>(); }
static bool const list_5_is_hunted = hunt<list_5>("5", "polydisperse bounce velocity_verlet sphere_contact gravity reaction");
TEST_CASE("pairs: list 10") { check_list<list_10>(); }
static bool const list_10_is_hunted = hunt<list_10>("10", "sphere_contact sleep granular_contact mesh_forces lost absorbing_box lost_motion emit reaction");
TEST_CASE("pairs: list 19") { check_list<list_19>(); }
static bool const list_19_is_hunted = hunt<list_19>("19", "polydisperse box_walls warms bounce adhesion external_forces emit friction pair_forces spin mesh_forces lost");
TEST_CASE("pairs: list 23") { check_list<list_23>(); }
static bool const list_23_is_hunted = hunt<list_23>("23", "lost_motion gravity sphere_contact bounce drag periodic_box absorbing_box adhesion spin polydisperse friction reaction");
TEST_CASE("pairs: list 26") { check_list<list_26>(); }
static bool const list_26_is_hunted = hunt<list_26>("26", "granular_contact drag periodic_box wind");
