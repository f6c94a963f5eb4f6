/// Made by make_lists.py: the lists with karabassi and float.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

// clang-format off
TEST_CASE("pairs: list 2") { check_list<list_2>(); }
static bool const list_2_is_hunted = hunt<list_2>("2", "gravity sphere_contact bounce adhesion reaction mesh_forces pair_forces");
TEST_CASE("pairs: list 3") { check_list<list_3>(); }
static bool const list_3_is_hunted = hunt<list_3>("3", "bounce gravity sphere_contact polydisperse friction sleep spin reaction");
TEST_CASE("pairs: list 6") { check_list<list_6>(); }
static bool const list_6_is_hunted = hunt<list_6>("6", "bounce gravity friction sleep adhesion spin reaction mesh_forces");
TEST_CASE("pairs: list 14") { check_list<list_14>(); }
static bool const list_14_is_hunted = hunt<list_14>("14", "lost_motion polydisperse lost external_forces bounce friction spin adhesion mesh_forces emit absorbing_box box_walls");
TEST_CASE("pairs: list 22") { check_list<list_22>(); }
static bool const list_22_is_hunted = hunt<list_22>("22", "sleep granular_contact mesh_forces periodic_box pair_forces reaction polydisperse lost wind drag emit mass_flow");
