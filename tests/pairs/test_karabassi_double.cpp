/// Made by make_lists.py: the lists with karabassi and double.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

// clang-format off
TEST_CASE("pairs: list 7") { check_list<list_7>(); }
static bool const list_7_is_hunted = hunt<list_7>("7", "bounce friction spin adhesion reaction sleep velocity_verlet sphere_contact gravity");
TEST_CASE("pairs: list 9") { check_list<list_9>(); }
static bool const list_9_is_hunted = hunt<list_9>("9", "gravity granular_contact reaction polydisperse velocity_verlet lost pair_forces");
TEST_CASE("pairs: list 11") { check_list<list_11>(); }
static bool const list_11_is_hunted = hunt<list_11>("11", "mass_flow box_walls external_forces lost_motion wind warms bounce absorb drag pair_forces absorbing_box periodic_box");
TEST_CASE("pairs: list 15") { check_list<list_15>(); }
static bool const list_15_is_hunted = hunt<list_15>("15", "drag periodic_box wind absorb warms velocity_verlet gravity reaction emit mesh_forces sleep sphere_contact");
TEST_CASE("pairs: list 17") { check_list<list_17>(); }
static bool const list_17_is_hunted = hunt<list_17>("17", "external_forces gravity lost_motion mass_flow velocity_verlet lost sleep box_walls absorbing_box sphere_contact granular_contact reaction");
TEST_CASE("pairs: list 20") { check_list<list_20>(); }
static bool const list_20_is_hunted = hunt<list_20>("20", "warms bounce spin adhesion lost mass_flow periodic_box absorb wind polydisperse drag friction");
TEST_CASE("pairs: list 24") { check_list<list_24>(); }
static bool const list_24_is_hunted = hunt<list_24>("24", "sphere_contact polydisperse bounce sleep spin friction adhesion pair_forces");
TEST_CASE("pairs: list 27") { check_list<list_27>(); }
static bool const list_27_is_hunted = hunt<list_27>("27", "mass_flow emit mesh_forces");
