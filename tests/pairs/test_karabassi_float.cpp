/// Made by make_lists.py: the lists with karabassi and float.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

// clang-format off
TEST_CASE("pairs: list 2") { check_list<list_2>(); }
static bool const list_2_is_hunted = hunt<list_2>("2", "gravity sphere_contact bounce adhesion reaction pair_forces mesh_forces");
TEST_CASE("pairs: list 3") { check_list<list_3>(); }
static bool const list_3_is_hunted = hunt<list_3>("3", "bounce gravity sleep friction sphere_contact polydisperse spin reaction");
TEST_CASE("pairs: list 6") { check_list<list_6>(); }
static bool const list_6_is_hunted = hunt<list_6>("6", "bounce spin adhesion friction mesh_forces gravity sleep reaction");
TEST_CASE("pairs: list 8") { check_list<list_8>(); }
static bool const list_8_is_hunted = hunt<list_8>("8", "gravity sleep granular_contact mesh_forces reaction velocity_verlet");
TEST_CASE("pairs: list 18") { check_list<list_18>(); }
static bool const list_18_is_hunted = hunt<list_18>("18", "lost_motion velocity_verlet lost emit warms pair_forces wind absorb bounce adhesion spin friction");
TEST_CASE("pairs: list 22") { check_list<list_22>(); }
static bool const list_22_is_hunted = hunt<list_22>("22", "absorbing_box mass_flow box_walls sphere_contact external_forces periodic_box wind polydisperse drag granular_contact pair_forces mesh_forces");
TEST_CASE("pairs: list 24") { check_list<list_24>(); }
static bool const list_24_is_hunted = hunt<list_24>("24", "box_walls mass_flow velocity_verlet periodic_box drag external_forces gravity bounce absorbing_box friction spin adhesion");
TEST_CASE("pairs: list 26") { check_list<list_26>(); }
static bool const list_26_is_hunted = hunt<list_26>("26", "granular_contact emit mesh_forces lost_motion absorbing_box lost");
TEST_CASE("pairs: list 32") { check_list<list_32>(); }
static bool const list_32_is_hunted = hunt<list_32>("32", "velocity_verlet gravity wind external_forces granular_contact wear clumps mass_flow absorbing_box polydisperse lost_motion mesh_forces");
TEST_CASE("pairs: list 33") { check_list<list_33>(); }
static bool const list_33_is_hunted = hunt<list_33>("33", "sleep gravity emit granular_contact wear contact_work lost reaction periodic_box");
TEST_CASE("pairs: list 34") { check_list<list_34>(); }
static bool const list_34_is_hunted = hunt<list_34>("34", "gravity sphere_contact contact_work polydisperse periodic_box lost");
TEST_CASE("pairs: list 36") { check_list<list_36>(); }
static bool const list_36_is_hunted = hunt<list_36>("36", "velocity_verlet gravity granular_contact sleep clumps pair_forces external_forces contact_work mass_flow absorbing_box periodic_box");
