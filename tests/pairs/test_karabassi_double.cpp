/// Made by make_lists.py: the lists with karabassi and double.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

// clang-format off
TEST_CASE("pairs: list 7") { check_list<list_7>(); }
static bool const list_7_is_hunted = hunt<list_7>("7", "gravity sphere_contact velocity_verlet sleep bounce friction adhesion spin reaction");
TEST_CASE("pairs: list 9") { check_list<list_9>(); }
static bool const list_9_is_hunted = hunt<list_9>("9", "lost granular_contact velocity_verlet gravity pair_forces reaction polydisperse");
TEST_CASE("pairs: list 10") { check_list<list_10>(); }
static bool const list_10_is_hunted = hunt<list_10>("10", "sphere_contact sleep granular_contact mesh_forces lost absorbing_box lost_motion emit reaction");
TEST_CASE("pairs: list 12") { check_list<list_12>(); }
static bool const list_12_is_hunted = hunt<list_12>("12", "drag mass_flow external_forces absorb box_walls bounce warms adhesion absorbing_box mesh_forces periodic_box polydisperse");
TEST_CASE("pairs: list 14") { check_list<list_14>(); }
static bool const list_14_is_hunted = hunt<list_14>("14", "mass_flow wind periodic_box drag sphere_contact box_walls external_forces sleep lost granular_contact reaction pair_forces");
TEST_CASE("pairs: list 17") { check_list<list_17>(); }
static bool const list_17_is_hunted = hunt<list_17>("17", "granular_contact mass_flow emit external_forces polydisperse wind periodic_box gravity velocity_verlet lost_motion box_walls drag");
TEST_CASE("pairs: list 25") { check_list<list_25>(); }
static bool const list_25_is_hunted = hunt<list_25>("25", "sphere_contact sleep polydisperse reaction wind gravity absorb warms velocity_verlet absorbing_box");
TEST_CASE("pairs: list 30") { check_list<list_30>(); }
static bool const list_30_is_hunted = hunt<list_30>("30", "velocity_verlet gravity granular_contact wear contact_work mesh_forces reaction polydisperse lost");
TEST_CASE("pairs: list 31") { check_list<list_31>(); }
static bool const list_31_is_hunted = hunt<list_31>("31", "velocity_verlet gravity granular_contact clumps contact_work mesh_forces reaction pair_forces lost periodic_box");
TEST_CASE("pairs: list 35") { check_list<list_35>(); }
static bool const list_35_is_hunted = hunt<list_35>("35", "velocity_verlet gravity granular_contact wear sleep clumps contact_work mesh_forces reaction polydisperse lost");
