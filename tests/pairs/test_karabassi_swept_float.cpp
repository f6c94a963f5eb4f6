/// Made by make_lists.py: the lists with karabassi_swept and float.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

// clang-format off
TEST_CASE("pairs: list 11") { check_list<list_11>(); }
static bool const list_11_is_hunted = hunt<list_11>("11", "drag emit wind absorbing_box mass_flow periodic_box external_forces absorb warms pair_forces velocity_verlet box_walls");
TEST_CASE("pairs: list 13") { check_list<list_13>(); }
static bool const list_13_is_hunted = hunt<list_13>("13", "lost lost_motion gravity spin sleep drag bounce friction box_walls warms mass_flow wind");
TEST_CASE("pairs: list 15") { check_list<list_15>(); }
static bool const list_15_is_hunted = hunt<list_15>("15", "reaction polydisperse absorb mesh_forces sphere_contact bounce external_forces adhesion periodic_box lost_motion warms emit");
TEST_CASE("pairs: list 18") { check_list<list_18>(); }
static bool const list_18_is_hunted = hunt<list_18>("18", "reaction box_walls polydisperse bounce adhesion mass_flow wind mesh_forces drag friction absorbing_box spin");
TEST_CASE("pairs: list 23") { check_list<list_23>(); }
static bool const list_23_is_hunted = hunt<list_23>("23", "lost sleep spin lost_motion reaction sphere_contact pair_forces velocity_verlet bounce friction polydisperse adhesion");
TEST_CASE("pairs: list 36") { check_list<list_36>(); }
static bool const list_36_is_hunted = hunt<list_36>("36", "velocity_verlet sphere_contact gravity absorb clumps mass_flow sleep polydisperse");
