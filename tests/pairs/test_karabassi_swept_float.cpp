/// Made by make_lists.py: the lists with karabassi_swept and float.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

// clang-format off
TEST_CASE("pairs: list 11") { check_list<list_11>(); }
static bool const list_11_is_hunted = hunt<list_11>("11", "drag emit warms wind box_walls absorb periodic_box mass_flow velocity_verlet pair_forces lost_motion external_forces");
TEST_CASE("pairs: list 13") { check_list<list_13>(); }
static bool const list_13_is_hunted = hunt<list_13>("13", "wind lost absorb bounce friction gravity absorbing_box spin periodic_box box_walls drag sleep");
TEST_CASE("pairs: list 15") { check_list<list_15>(); }
static bool const list_15_is_hunted = hunt<list_15>("15", "lost_motion warms external_forces polydisperse mass_flow bounce emit gravity spin adhesion friction mesh_forces");
TEST_CASE("pairs: list 16") { check_list<list_16>(); }
static bool const list_16_is_hunted = hunt<list_16>("16", "emit lost mesh_forces sphere_contact absorb warms wind reaction sleep pair_forces lost_motion absorbing_box");
TEST_CASE("pairs: list 19") { check_list<list_19>(); }
static bool const list_19_is_hunted = hunt<list_19>("19", "external_forces drag polydisperse velocity_verlet reaction periodic_box lost mass_flow absorbing_box sphere_contact pair_forces sleep");
TEST_CASE("pairs: list 27") { check_list<list_27>(); }
static bool const list_27_is_hunted = hunt<list_27>("27", "box_walls bounce friction spin reaction");
TEST_CASE("pairs: list 28") { check_list<list_28>(); }
static bool const list_28_is_hunted = hunt<list_28>("28", "gravity absorb pair_forces polydisperse");
TEST_CASE("pairs: list 37") { check_list<list_37>(); }
static bool const list_37_is_hunted = hunt<list_37>("37", "velocity_verlet sphere_contact gravity absorb clumps mass_flow sleep polydisperse");
