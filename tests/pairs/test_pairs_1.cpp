#include "lists.hpp"

TEST_CASE("pairs: list 1") { tests::pairs::check_list<tests::pairs::list_1>(); }
TEST_CASE("pairs: list 2") { tests::pairs::check_list<tests::pairs::list_2>(); }
TEST_CASE("pairs: list 3") { tests::pairs::check_list<tests::pairs::list_3>(); }
TEST_CASE("pairs: list 4") { tests::pairs::check_list<tests::pairs::list_4>(); }
