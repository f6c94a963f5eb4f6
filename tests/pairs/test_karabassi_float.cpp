/// Made by make_lists.py: the lists with karabassi and float.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

// clang-format off
TEST_CASE("pairs: list 2") { check_list<list_2>(); }
static bool const list_2_is_hunted = hunt<list_2>("2", "gravity bounce adhesion sphere_contact mesh_forces pair_forces reaction");
TEST_CASE("pairs: list 3") { check_list<list_3>(); }
static bool const list_3_is_hunted = hunt<list_3>("3", "bounce gravity friction spin reaction polydisperse sphere_contact sleep");
TEST_CASE("pairs: list 6") { check_list<list_6>(); }
static bool const list_6_is_hunted = hunt<list_6>("6", "bounce gravity friction spin adhesion sleep mesh_forces reaction");
TEST_CASE("pairs: list 13") { check_list<list_13>(); }
static bool const list_13_is_hunted = hunt<list_13>("13", "emit lost lost_motion box_walls bounce warms absorbing_box friction adhesion");
TEST_CASE("pairs: list 22") { check_list<list_22>(); }
static bool const list_22_is_hunted = hunt<list_22>("22", "absorbing_box absorb emit lost sphere_contact spin sleep drag mesh_forces");
TEST_CASE("pairs: list 23") { check_list<list_23>(); }
static bool const list_23_is_hunted = hunt<list_23>("23", "lost reaction sleep mesh_forces lost_motion periodic_box warms wind box_walls");
TEST_CASE("pairs: list 30") { check_list<list_30>(); }
static bool const list_30_is_hunted = hunt<list_30>("30", "lost velocity_verlet gravity");
TEST_CASE("pairs: list 33") { check_list<list_33>(); }
static bool const list_33_is_hunted = hunt<list_33>("33", "wind lost_motion emit sphere_contact granular_contact gravity velocity_verlet reaction mesh_forces");
TEST_CASE("pairs: list 38") { check_list<list_38>(); }
static bool const list_38_is_hunted = hunt<list_38>("38", "mass_flow granular_contact absorbing_box external_forces periodic_box drag pair_forces velocity_verlet mesh_forces");
TEST_CASE("pairs: list 43") { check_list<list_43>(); }
static bool const list_43_is_hunted = hunt<list_43>("43", "spin external_forces mass_flow wind sphere_contact");
