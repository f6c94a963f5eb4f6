#include "lists.hpp"

TEST_CASE("pairs: list 17") { tests::pairs::check_list<tests::pairs::list_17>(); }
TEST_CASE("pairs: list 18") { tests::pairs::check_list<tests::pairs::list_18>(); }
TEST_CASE("pairs: list 19") { tests::pairs::check_list<tests::pairs::list_19>(); }
TEST_CASE("pairs: list 20") { tests::pairs::check_list<tests::pairs::list_20>(); }
