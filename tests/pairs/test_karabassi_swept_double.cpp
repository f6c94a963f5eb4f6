/// Made by make_lists.py: the lists with karabassi_swept and double.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

// clang-format off
TEST_CASE("pairs: list 1") { check_list<list_1>(); }
static bool const list_1_is_hunted = hunt<list_1>("1", "sphere_contact gravity bounce spin friction velocity_verlet reaction");
TEST_CASE("pairs: list 4") { check_list<list_4>(); }
static bool const list_4_is_hunted = hunt<list_4>("4", "bounce adhesion reaction gravity lost velocity_verlet");
TEST_CASE("pairs: list 5") { check_list<list_5>(); }
static bool const list_5_is_hunted = hunt<list_5>("5", "polydisperse gravity velocity_verlet sphere_contact bounce reaction");
TEST_CASE("pairs: list 10") { check_list<list_10>(); }
static bool const list_10_is_hunted = hunt<list_10>("10", "sphere_contact sleep granular_contact mesh_forces lost absorbing_box lost_motion emit reaction");
TEST_CASE("pairs: list 19") { check_list<list_19>(); }
static bool const list_19_is_hunted = hunt<list_19>("19", "polydisperse absorbing_box bounce warms box_walls emit friction adhesion reaction");
TEST_CASE("pairs: list 24") { check_list<list_24>(); }
static bool const list_24_is_hunted = hunt<list_24>("24", "bounce wind drag periodic_box lost absorb spin reaction lost_motion");
TEST_CASE("pairs: list 27") { check_list<list_27>(); }
static bool const list_27_is_hunted = hunt<list_27>("27", "sleep bounce friction spin adhesion mesh_forces warms box_walls lost");
TEST_CASE("pairs: list 31") { check_list<list_31>(); }
static bool const list_31_is_hunted = hunt<list_31>("31", "sphere_contact bounce adhesion friction");
TEST_CASE("pairs: list 35") { check_list<list_35>(); }
static bool const list_35_is_hunted = hunt<list_35>("35", "granular_contact sphere_contact reaction mesh_forces emit wind gravity lost_motion velocity_verlet");
TEST_CASE("pairs: list 39") { check_list<list_39>(); }
static bool const list_39_is_hunted = hunt<list_39>("39", "wind bounce external_forces velocity_verlet absorbing_box mass_flow drag spin mesh_forces");
TEST_CASE("pairs: list 42") { check_list<list_42>(); }
static bool const list_42_is_hunted = hunt<list_42>("42", "mass_flow external_forces granular_contact periodic_box pair_forces");
