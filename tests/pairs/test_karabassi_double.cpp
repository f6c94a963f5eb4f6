/// Made by make_lists.py: the lists with karabassi and double.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

// clang-format off
TEST_CASE("pairs: list 7") { check_list<list_7>(); }
static bool const list_7_is_hunted = hunt<list_7>("7", "sphere_contact sleep gravity bounce adhesion friction spin reaction velocity_verlet");
TEST_CASE("pairs: list 9") { check_list<list_9>(); }
static bool const list_9_is_hunted = hunt<list_9>("9", "lost polydisperse gravity granular_contact velocity_verlet reaction pair_forces");
TEST_CASE("pairs: list 11") { check_list<list_11>(); }
static bool const list_11_is_hunted = hunt<list_11>("11", "warms mesh_forces lost_motion periodic_box wind box_walls polydisperse drag absorb");
TEST_CASE("pairs: list 15") { check_list<list_15>(); }
static bool const list_15_is_hunted = hunt<list_15>("15", "absorbing_box emit absorb drag wind velocity_verlet gravity periodic_box reaction");
TEST_CASE("pairs: list 17") { check_list<list_17>(); }
static bool const list_17_is_hunted = hunt<list_17>("17", "sleep bounce pair_forces wind friction drag absorb adhesion periodic_box");
TEST_CASE("pairs: list 20") { check_list<list_20>(); }
static bool const list_20_is_hunted = hunt<list_20>("20", "velocity_verlet sphere_contact spin lost_motion warms box_walls pair_forces mesh_forces gravity");
TEST_CASE("pairs: list 25") { check_list<list_25>(); }
static bool const list_25_is_hunted = hunt<list_25>("25", "emit wind sphere_contact periodic_box polydisperse pair_forces sleep absorbing_box spin");
TEST_CASE("pairs: list 28") { check_list<list_28>(); }
static bool const list_28_is_hunted = hunt<list_28>("28", "drag bounce sphere_contact lost_motion friction adhesion absorb mesh_forces polydisperse");
TEST_CASE("pairs: list 32") { check_list<list_32>(); }
static bool const list_32_is_hunted = hunt<list_32>("32", "granular_contact lost periodic_box box_walls sleep pair_forces polydisperse drag absorbing_box");
TEST_CASE("pairs: list 36") { check_list<list_36>(); }
static bool const list_36_is_hunted = hunt<list_36>("36", "mass_flow gravity box_walls external_forces sphere_contact lost_motion warms absorb lost");
TEST_CASE("pairs: list 40") { check_list<list_40>(); }
static bool const list_40_is_hunted = hunt<list_40>("40", "polydisperse bounce friction adhesion emit external_forces sleep mass_flow reaction");
