/// Made by make_lists.py: the lists with karabassi_swept and float.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

// clang-format off
TEST_CASE("pairs: list 8") { check_list<list_8>(); }
static bool const list_8_is_hunted = hunt<list_8>("8", "gravity sleep velocity_verlet granular_contact reaction mesh_forces");
TEST_CASE("pairs: list 12") { check_list<list_12>(); }
static bool const list_12_is_hunted = hunt<list_12>("12", "drag wind pair_forces periodic_box bounce absorb emit absorbing_box spin");
TEST_CASE("pairs: list 14") { check_list<list_14>(); }
static bool const list_14_is_hunted = hunt<list_14>("14", "velocity_verlet absorb gravity sleep sphere_contact box_walls periodic_box warms wind");
TEST_CASE("pairs: list 16") { check_list<list_16>(); }
static bool const list_16_is_hunted = hunt<list_16>("16", "drag box_walls lost lost_motion sphere_contact warms spin pair_forces polydisperse");
TEST_CASE("pairs: list 18") { check_list<list_18>(); }
static bool const list_18_is_hunted = hunt<list_18>("18", "periodic_box polydisperse wind absorb bounce lost friction adhesion mesh_forces");
TEST_CASE("pairs: list 21") { check_list<list_21>(); }
static bool const list_21_is_hunted = hunt<list_21>("21", "bounce velocity_verlet adhesion sleep lost_motion friction drag pair_forces gravity");
TEST_CASE("pairs: list 26") { check_list<list_26>(); }
static bool const list_26_is_hunted = hunt<list_26>("26", "emit sleep polydisperse absorbing_box bounce velocity_verlet spin reaction gravity");
TEST_CASE("pairs: list 29") { check_list<list_29>(); }
static bool const list_29_is_hunted = hunt<list_29>("29", "drag mesh_forces pair_forces absorb lost_motion reaction");
TEST_CASE("pairs: list 34") { check_list<list_34>(); }
static bool const list_34_is_hunted = hunt<list_34>("34", "absorbing_box granular_contact box_walls pair_forces drag sleep polydisperse periodic_box lost");
TEST_CASE("pairs: list 37") { check_list<list_37>(); }
static bool const list_37_is_hunted = hunt<list_37>("37", "polydisperse external_forces sleep mass_flow emit bounce friction adhesion reaction");
TEST_CASE("pairs: list 41") { check_list<list_41>(); }
static bool const list_41_is_hunted = hunt<list_41>("41", "mass_flow sphere_contact warms gravity box_walls lost lost_motion absorb external_forces");
