/// Functions called for each hit, on the host.
#include "visit.hpp"

TEST_CASE("visit: sums of many threads are whole and do not depend on the order on the host") {
  for (int const threads : {1, 2, 7}) tests::check_sums(collide::host(threads));
}

TEST_CASE("visit: a lambda, and one that names the type of a hit") {
  tests::crowded_scene<collide::host> scene(collide::host(3));
  auto const expected = scene.end(tests::add_up{scene.begin()}).hits;
  tests::sums* to = scene.begin();
  CHECK(scene.end([to](auto const&) { collide::atomic_add(&to->hits, 1); }).hits == expected);
  to = scene.begin();
  using hit_type = collide::hit<collide::karabassi<>, float>;
  CHECK(scene.end([to](hit_type const&) { collide::atomic_add(&to->hits, 1); }).hits == expected);
}
