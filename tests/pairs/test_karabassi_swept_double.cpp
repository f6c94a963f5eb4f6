/// Made by make_lists.py: the lists with karabassi_swept and double.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

TEST_CASE("pairs: list 1") { check_list<list_1>(); }
static bool const list_1_is_hunted = hunt<list_1>("1");
TEST_CASE("pairs: list 4") { check_list<list_4>(); }
static bool const list_4_is_hunted = hunt<list_4>("4");
TEST_CASE("pairs: list 5") { check_list<list_5>(); }
static bool const list_5_is_hunted = hunt<list_5>("5");
TEST_CASE("pairs: list 15") { check_list<list_15>(); }
static bool const list_15_is_hunted = hunt<list_15>("15");
TEST_CASE("pairs: list 19") { check_list<list_19>(); }
static bool const list_19_is_hunted = hunt<list_19>("19");
TEST_CASE("pairs: list 23") { check_list<list_23>(); }
static bool const list_23_is_hunted = hunt<list_23>("23");
TEST_CASE("pairs: list 29") { check_list<list_29>(); }
static bool const list_29_is_hunted = hunt<list_29>("29");
TEST_CASE("pairs: list 32") { check_list<list_32>(); }
static bool const list_32_is_hunted = hunt<list_32>("32");
TEST_CASE("pairs: list 35") { check_list<list_35>(); }
static bool const list_35_is_hunted = hunt<list_35>("35");
TEST_CASE("pairs: list 40") { check_list<list_40>(); }
static bool const list_40_is_hunted = hunt<list_40>("40");
TEST_CASE("pairs: list 43") { check_list<list_43>(); }
static bool const list_43_is_hunted = hunt<list_43>("43");
