/// Made by make_lists.py: the lists with karabassi_swept and float.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

TEST_CASE("pairs: list 7") { check_list<list_7>(); }
static bool const list_7_is_hunted = hunt<list_7>("7");
TEST_CASE("pairs: list 9") { check_list<list_9>(); }
static bool const list_9_is_hunted = hunt<list_9>("9");
TEST_CASE("pairs: list 11") { check_list<list_11>(); }
static bool const list_11_is_hunted = hunt<list_11>("11");
TEST_CASE("pairs: list 14") { check_list<list_14>(); }
static bool const list_14_is_hunted = hunt<list_14>("14");
TEST_CASE("pairs: list 18") { check_list<list_18>(); }
static bool const list_18_is_hunted = hunt<list_18>("18");
TEST_CASE("pairs: list 22") { check_list<list_22>(); }
static bool const list_22_is_hunted = hunt<list_22>("22");
TEST_CASE("pairs: list 26") { check_list<list_26>(); }
static bool const list_26_is_hunted = hunt<list_26>("26");
TEST_CASE("pairs: list 30") { check_list<list_30>(); }
static bool const list_30_is_hunted = hunt<list_30>("30");
TEST_CASE("pairs: list 34") { check_list<list_34>(); }
static bool const list_34_is_hunted = hunt<list_34>("34");
TEST_CASE("pairs: list 39") { check_list<list_39>(); }
static bool const list_39_is_hunted = hunt<list_39>("39");
TEST_CASE("pairs: list 42") { check_list<list_42>(); }
static bool const list_42_is_hunted = hunt<list_42>("42");
