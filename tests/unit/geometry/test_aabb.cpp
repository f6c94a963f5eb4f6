/// Boxes of triangles, and balls that come near them.
#include <limits>

#include <doctest/doctest.h>

#include <collide/exact/detail/geometry/aabb.hpp>

namespace {

template <class S>
collide::triangle<S> sample() {
  return {{1, 5, -2}, {3, 2, 0}, {-1, 4, 4}};
}

}  // namespace

TEST_CASE_TEMPLATE("aabb: the box of a triangle, and of what is not finite", S, float, double) {
  using namespace collide::detail;
  aabb<S> const b = aabb_of(sample<S>());
  CHECK((b.lower[0] == -1 && b.lower[1] == 2 && b.lower[2] == -2));
  CHECK((b.upper[0] == 3 && b.upper[1] == 5 && b.upper[2] == 4));
  CHECK(b.max_extent() == 6);
  CHECK(!b.is_empty());
  for (int corner = 0; corner < 3; ++corner) {
    for (S const bad : {std::numeric_limits<S>::quiet_NaN(), std::numeric_limits<S>::infinity()}) {
      collide::triangle<S> t = sample<S>();
      (corner == 0 ? t.a : corner == 1 ? t.b : t.c)[corner] = bad;
      CHECK(aabb_of(t).is_empty());
    }
  }
}

TEST_CASE_TEMPLATE("aabb: the union with nothing changes nothing", S, float, double) {
  using namespace collide::detail;
  aabb<S> const b = aabb_of(sample<S>()), nothing = aabb<S>::empty();
  CHECK(nothing.is_empty());
  typename aabb<S>::merge const merge;
  for (aabb<S> const& u : {merge(b, nothing), merge(nothing, b)}) {
    for (int k = 0; k < 3; ++k) {
      CHECK(u.lower[k] == b.lower[k]);
      CHECK(u.upper[k] == b.upper[k]);
    }
  }
  CHECK(merge(nothing, nothing).is_empty());
}

TEST_CASE_TEMPLATE("aabb: balls that touch the box come near it, others that are far from it do not", S, float,
                   double) {
  using namespace collide::detail;
  triangle_aabb<S> const b = triangle_aabb_of(sample<S>());
  CHECK(b.overlaps({0, 3, 0}, S(0)));      // inside
  CHECK(b.overlaps({5, 3, 0}, S(2)));      // touches a face
  CHECK(b.overlaps({6, 9, 0}, S(5)));      // touches an edge
  CHECK(!b.overlaps({5, 3, 0}, S(1.99)));  // in front of a face
  CHECK(!b.overlaps({6, 9, 0}, S(4.99)));  // near the boxes on all axes, but not the edge
}
