/// Functions called for each hit, on the host.
#include "visit.hpp"

TEST_CASE("visit: sums of many threads are whole and do not depend on the order on the host") {
  for (int const threads : {1, 2, 7}) tests::check_sums(collide::host(threads));
}

TEST_CASE("visit: a lambda, and one that names the type of a hit") {
  tests::crowded_scene<collide::host> scene(collide::host(3));
  auto const expected = scene.visit([](tests::sums* to) { return tests::add_up{to}; }).hits;
  auto const generic = [](tests::sums* to) { return [to](auto const&) { collide::atomic_add(&to->hits, 1); }; };
  auto const plain = [](tests::sums* to) {
    return [to](collide::hit<collide::karabassi<>, float> const&) { collide::atomic_add(&to->hits, 1); };
  };
  CHECK(scene.visit(generic).hits == expected);
  CHECK(scene.visit(plain).hits == expected);
}
