/// Made by make_lists.py: the lists with karabassi and double.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

TEST_CASE("pairs: list 8") { check_list<list_8>(); }
static bool const list_8_is_hunted = hunt<list_8>("8");
TEST_CASE("pairs: list 10") { check_list<list_10>(); }
static bool const list_10_is_hunted = hunt<list_10>("10");
TEST_CASE("pairs: list 12") { check_list<list_12>(); }
static bool const list_12_is_hunted = hunt<list_12>("12");
TEST_CASE("pairs: list 13") { check_list<list_13>(); }
static bool const list_13_is_hunted = hunt<list_13>("13");
TEST_CASE("pairs: list 17") { check_list<list_17>(); }
static bool const list_17_is_hunted = hunt<list_17>("17");
TEST_CASE("pairs: list 21") { check_list<list_21>(); }
static bool const list_21_is_hunted = hunt<list_21>("21");
TEST_CASE("pairs: list 27") { check_list<list_27>(); }
static bool const list_27_is_hunted = hunt<list_27>("27");
TEST_CASE("pairs: list 31") { check_list<list_31>(); }
static bool const list_31_is_hunted = hunt<list_31>("31");
TEST_CASE("pairs: list 36") { check_list<list_36>(); }
static bool const list_36_is_hunted = hunt<list_36>("36");
TEST_CASE("pairs: list 38") { check_list<list_38>(); }
static bool const list_38_is_hunted = hunt<list_38>("38");
TEST_CASE("pairs: list 41") { check_list<list_41>(); }
static bool const list_41_is_hunted = hunt<list_41>("41");
