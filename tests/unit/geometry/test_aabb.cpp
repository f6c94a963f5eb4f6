/// Boxes of triangles, and balls that come near them.
#include <limits>

#include <doctest/doctest.h>

#include <collide/detail/geometry/aabb.hpp>

namespace {

template <class S>
collide::triangle<S> sample() {
  return {{1, 5, -2}, {3, 2, 0}, {-1, 4, 4}};
}

}  // namespace

TEST_CASE_TEMPLATE("aabb: the box of a triangle, and of what is not finite", S, float, double) {
  using namespace collide::detail;
  box<S> const b = box_of(sample<S>());
  CHECK((b.lower[0] == -1 && b.lower[1] == 2 && b.lower[2] == -2));
  CHECK((b.upper[0] == 3 && b.upper[1] == 5 && b.upper[2] == 4));
  CHECK(b.extent() == 6);
  CHECK(!b.is_empty());
  for (int corner = 0; corner < 3; ++corner) {
    for (S const bad : {std::numeric_limits<S>::quiet_NaN(), std::numeric_limits<S>::infinity()}) {
      collide::triangle<S> t = sample<S>();
      (corner == 0 ? t.a : corner == 1 ? t.b : t.c)[corner] = bad;
      CHECK(box_of(t).is_empty());
    }
  }
}

TEST_CASE_TEMPLATE("aabb: the union with nothing changes nothing", S, float, double) {
  using namespace collide::detail;
  box<S> const b = box_of(sample<S>()), nothing = box<S>::empty();
  CHECK(nothing.is_empty());
  typename box<S>::unite const unite;
  for (box<S> const& u : {unite(b, nothing), unite(nothing, b)}) {
    for (int k = 0; k < 3; ++k) {
      CHECK(u.lower[k] == b.lower[k]);
      CHECK(u.upper[k] == b.upper[k]);
    }
  }
  CHECK(unite(nothing, nothing).is_empty());
}

TEST_CASE_TEMPLATE("aabb: balls that touch the box come near it, others that are far from it do not", S, float,
                   double) {
  using namespace collide::detail;
  triangle_box<S> const b = triangle_box_of(sample<S>());
  CHECK(b.reached({0, 3, 0}, S(0)));      // inside
  CHECK(b.reached({5, 3, 0}, S(2)));      // touches a face
  CHECK(b.reached({6, 9, 0}, S(5)));      // touches an edge
  CHECK(!b.reached({5, 3, 0}, S(1.99)));  // in front of a face
  CHECK(!b.reached({6, 9, 0}, S(4.99)));  // near the boxes on all axes, but not the edge
}
