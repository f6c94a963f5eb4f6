#include "lists.hpp"

TEST_CASE("pairs: list 9") { tests::pairs::check_list<tests::pairs::list_9>(); }
TEST_CASE("pairs: list 10") { tests::pairs::check_list<tests::pairs::list_10>(); }
TEST_CASE("pairs: list 11") { tests::pairs::check_list<tests::pairs::list_11>(); }
TEST_CASE("pairs: list 12") { tests::pairs::check_list<tests::pairs::list_12>(); }
