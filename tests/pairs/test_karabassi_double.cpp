/// Made by make_lists.py: the lists with karabassi and double.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

// clang-format off
TEST_CASE("pairs: list 7") { check_list<list_7>(); }
static bool const list_7_is_hunted = hunt<list_7>("7", "sleep gravity sphere_contact velocity_verlet spin reaction bounce friction adhesion");
TEST_CASE("pairs: list 9") { check_list<list_9>(); }
static bool const list_9_is_hunted = hunt<list_9>("9", "velocity_verlet granular_contact pair_forces lost reaction polydisperse gravity");
TEST_CASE("pairs: list 10") { check_list<list_10>(); }
static bool const list_10_is_hunted = hunt<list_10>("10", "sphere_contact sleep granular_contact mesh_forces lost absorbing_box lost_motion emit reaction");
TEST_CASE("pairs: list 12") { check_list<list_12>(); }
static bool const list_12_is_hunted = hunt<list_12>("12", "box_walls lost_motion mass_flow drag mesh_forces external_forces absorb bounce periodic_box wind polydisperse adhesion");
TEST_CASE("pairs: list 17") { check_list<list_17>(); }
static bool const list_17_is_hunted = hunt<list_17>("17", "wind drag lost_motion warms bounce friction sleep gravity box_walls spin mass_flow pair_forces");
TEST_CASE("pairs: list 21") { check_list<list_21>(); }
static bool const list_21_is_hunted = hunt<list_21>("21", "emit mass_flow absorb drag wind warms periodic_box sphere_contact external_forces velocity_verlet reaction absorbing_box");
TEST_CASE("pairs: list 22") { check_list<list_22>(); }
static bool const list_22_is_hunted = hunt<list_22>("22", "external_forces velocity_verlet wind mass_flow drag granular_contact polydisperse sleep sphere_contact box_walls lost periodic_box");
TEST_CASE("pairs: list 29") { check_list<list_29>(); }
static bool const list_29_is_hunted = hunt<list_29>("29", "velocity_verlet gravity granular_contact wear contact_work mesh_forces reaction polydisperse lost");
TEST_CASE("pairs: list 30") { check_list<list_30>(); }
static bool const list_30_is_hunted = hunt<list_30>("30", "velocity_verlet gravity granular_contact clumps contact_work mesh_forces reaction pair_forces lost periodic_box");
TEST_CASE("pairs: list 34") { check_list<list_34>(); }
static bool const list_34_is_hunted = hunt<list_34>("34", "velocity_verlet gravity granular_contact wear sleep clumps contact_work mesh_forces reaction polydisperse lost");
