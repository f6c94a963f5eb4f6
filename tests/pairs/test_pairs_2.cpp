#include "lists.hpp"

TEST_CASE("pairs: list 5") { tests::pairs::check_list<tests::pairs::list_5>(); }
TEST_CASE("pairs: list 6") { tests::pairs::check_list<tests::pairs::list_6>(); }
TEST_CASE("pairs: list 7") { tests::pairs::check_list<tests::pairs::list_7>(); }
TEST_CASE("pairs: list 8") { tests::pairs::check_list<tests::pairs::list_8>(); }
