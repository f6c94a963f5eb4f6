/// Made by make_lists.py: the lists with karabassi and float.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

// clang-format off
TEST_CASE("pairs: list 2") { check_list<list_2>(); }
static bool const list_2_is_hunted = hunt<list_2>("2", "reaction mesh_forces sphere_contact bounce adhesion pair_forces gravity");
TEST_CASE("pairs: list 3") { check_list<list_3>(); }
static bool const list_3_is_hunted = hunt<list_3>("3", "reaction spin gravity polydisperse sphere_contact bounce sleep friction");
TEST_CASE("pairs: list 6") { check_list<list_6>(); }
static bool const list_6_is_hunted = hunt<list_6>("6", "spin sleep reaction bounce gravity adhesion friction mesh_forces");
TEST_CASE("pairs: list 8") { check_list<list_8>(); }
static bool const list_8_is_hunted = hunt<list_8>("8", "sleep velocity_verlet reaction mesh_forces granular_contact gravity");
TEST_CASE("pairs: list 16") { check_list<list_16>(); }
static bool const list_16_is_hunted = hunt<list_16>("16", "external_forces sphere_contact granular_contact lost box_walls emit mass_flow wind reaction absorbing_box drag velocity_verlet");
TEST_CASE("pairs: list 20") { check_list<list_20>(); }
static bool const list_20_is_hunted = hunt<list_20>("20", "periodic_box bounce pair_forces external_forces spin friction emit gravity lost sleep absorbing_box absorb");
TEST_CASE("pairs: list 25") { check_list<list_25>(); }
static bool const list_25_is_hunted = hunt<list_25>("25", "polydisperse mesh_forces gravity emit absorbing_box lost_motion bounce warms lost adhesion velocity_verlet");
TEST_CASE("pairs: list 26") { check_list<list_26>(); }
static bool const list_26_is_hunted = hunt<list_26>("26", "polydisperse mesh_forces granular_contact periodic_box lost_motion sleep pair_forces");
TEST_CASE("pairs: list 28") { check_list<list_28>(); }
static bool const list_28_is_hunted = hunt<list_28>("28", "granular_contact pair_forces");
TEST_CASE("pairs: list 31") { check_list<list_31>(); }
static bool const list_31_is_hunted = hunt<list_31>("31", "velocity_verlet gravity wind external_forces granular_contact wear clumps mass_flow absorbing_box polydisperse lost_motion mesh_forces");
TEST_CASE("pairs: list 32") { check_list<list_32>(); }
static bool const list_32_is_hunted = hunt<list_32>("32", "sleep gravity emit granular_contact wear contact_work lost reaction periodic_box");
TEST_CASE("pairs: list 33") { check_list<list_33>(); }
static bool const list_33_is_hunted = hunt<list_33>("33", "gravity sphere_contact contact_work polydisperse periodic_box lost");
TEST_CASE("pairs: list 35") { check_list<list_35>(); }
static bool const list_35_is_hunted = hunt<list_35>("35", "velocity_verlet gravity granular_contact sleep clumps pair_forces external_forces contact_work mass_flow absorbing_box periodic_box");
