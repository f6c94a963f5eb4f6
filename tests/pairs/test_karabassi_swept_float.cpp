/// Made by make_lists.py: the lists with karabassi_swept and float.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

// clang-format off
TEST_CASE("pairs: list 8") { check_list<list_8>(); }
static bool const list_8_is_hunted = hunt<list_8>("8", "velocity_verlet granular_contact reaction sleep mesh_forces gravity");
TEST_CASE("pairs: list 12") { check_list<list_12>(); }
static bool const list_12_is_hunted = hunt<list_12>("12", "wind absorb warms polydisperse mass_flow emit lost bounce drag friction spin periodic_box");
TEST_CASE("pairs: list 13") { check_list<list_13>(); }
static bool const list_13_is_hunted = hunt<list_13>("13", "sphere_contact gravity absorbing_box drag box_walls granular_contact periodic_box mesh_forces wind external_forces mass_flow velocity_verlet");
TEST_CASE("pairs: list 16") { check_list<list_16>(); }
static bool const list_16_is_hunted = hunt<list_16>("16", "external_forces sleep lost_motion bounce adhesion warms box_walls pair_forces absorb reaction mass_flow wind");
TEST_CASE("pairs: list 18") { check_list<list_18>(); }
static bool const list_18_is_hunted = hunt<list_18>("18", "pair_forces bounce polydisperse velocity_verlet lost_motion adhesion spin drag sleep absorbing_box friction periodic_box");
TEST_CASE("pairs: list 21") { check_list<list_21>(); }
static bool const list_21_is_hunted = hunt<list_21>("21", "lost absorbing_box gravity emit absorb sphere_contact lost_motion mesh_forces reaction velocity_verlet warms pair_forces");
TEST_CASE("pairs: list 25") { check_list<list_25>(); }
static bool const list_25_is_hunted = hunt<list_25>("25", "lost_motion granular_contact polydisperse pair_forces");
