#include "lists.hpp"

TEST_CASE("pairs: list 13") { tests::pairs::check_list<tests::pairs::list_13>(); }
TEST_CASE("pairs: list 14") { tests::pairs::check_list<tests::pairs::list_14>(); }
TEST_CASE("pairs: list 15") { tests::pairs::check_list<tests::pairs::list_15>(); }
TEST_CASE("pairs: list 16") { tests::pairs::check_list<tests::pairs::list_16>(); }
