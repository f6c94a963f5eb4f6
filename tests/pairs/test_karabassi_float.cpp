/// Made by make_lists.py: the lists with karabassi and float.
#include "hunt.hpp"
#include "lists.hpp"

using namespace tests::pairs;

TEST_CASE("pairs: list 2") { check_list<list_2>(); }
static bool const list_2_is_hunted = hunt<list_2>("2");
TEST_CASE("pairs: list 3") { check_list<list_3>(); }
static bool const list_3_is_hunted = hunt<list_3>("3");
TEST_CASE("pairs: list 6") { check_list<list_6>(); }
static bool const list_6_is_hunted = hunt<list_6>("6");
TEST_CASE("pairs: list 16") { check_list<list_16>(); }
static bool const list_16_is_hunted = hunt<list_16>("16");
TEST_CASE("pairs: list 20") { check_list<list_20>(); }
static bool const list_20_is_hunted = hunt<list_20>("20");
TEST_CASE("pairs: list 24") { check_list<list_24>(); }
static bool const list_24_is_hunted = hunt<list_24>("24");
TEST_CASE("pairs: list 25") { check_list<list_25>(); }
static bool const list_25_is_hunted = hunt<list_25>("25");
TEST_CASE("pairs: list 28") { check_list<list_28>(); }
static bool const list_28_is_hunted = hunt<list_28>("28");
TEST_CASE("pairs: list 33") { check_list<list_33>(); }
static bool const list_33_is_hunted = hunt<list_33>("33");
TEST_CASE("pairs: list 37") { check_list<list_37>(); }
static bool const list_37_is_hunted = hunt<list_37>("37");
TEST_CASE("pairs: list 44") { check_list<list_44>(); }
static bool const list_44_is_hunted = hunt<list_44>("44");
