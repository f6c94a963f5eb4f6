/// Policies of a user, in the spaces of the host.
#include <cmath>
#include <limits>
#include <random>

#include <collide/broad/extend.hpp>
#include <collide/bucket.cuh>

#include "custom_policies.hpp"
#include "custom_space.hpp"
#include "execution/lockstep.hpp"

using users = collide::per_sphere<bounding_spheres>;

TEST_CASE_TEMPLATE("extending: a broad phase that enumerates candidates, on the host", S, float, double) {
  tests::check_custom_broad_phase<users, S>(collide::host(2));
  tests::check_custom_broad_phase<collide::bvh, S>(collide::host(2));
}

TEST_CASE_TEMPLATE("extending: a broad phase that enumerates candidates, in lockstep", S, float, double) {
  tests::check_custom_broad_phase<users, S>(tests::lockstep<64, false>(1));
  tests::check_custom_broad_phase<collide::bvh, S>(tests::lockstep<64, false>(1));
  tests::check_custom_broad_phase<users, S>(tests::lockstep<64, true>(1));
  tests::check_custom_broad_phase<collide::bvh, S>(tests::lockstep<64, true>(1));
}

TEST_CASE_TEMPLATE("extending: a pool of threads finds what the host finds", S, float, double) {
  using collide::karabassi;
  using collide::karabassi_swept;
  thread_pool threads(3);
  pool_space const pool(threads);
  tests::check_custom_broad_phase<users, S>(pool);
  tests::check_custom_broad_phase<collide::bvh, S>(pool);
  tests::crowd<S> const made(3000, 20000);
  auto const mesh = collide::triangle_soup(made.triangles.data(), 3000);
  auto const spheres = collide::spheres_xyz(made.centres.data(), 20000, made.radii.data());
  auto const moving =
      collide::with_displacements(collide::spheres_xyz(made.centres.data(), 20000, S(0.05)), made.motions.data());
  using collide::bucket;
  using collide::host;
  using tests::pairs_of;
  CHECK((pairs_of<bucket, karabassi<>>(pool, mesh, spheres) == pairs_of<bucket, karabassi<>>(host(2), mesh, spheres)));
  CHECK((pairs_of<bucket, karabassi_swept<>>(pool, mesh, moving) ==
         pairs_of<bucket, karabassi_swept<>>(host(2), mesh, moving)));
}

namespace {

/// Spheres that touch a triangle of any size, anywhere, by so many units in the last place more or less: how many of
/// those pairs are hits, and how many hits have boxes that do not overlap.
template <class S, class NarrowPhase>
void check_conservative_boxes() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1), power(-8, 8);
  auto const vector = [&](double size) {
    return collide::vec3<S>(S(size * unit(random)), S(size * unit(random)), S(size * unit(random)));
  };
  int hits = 0, apart = 0, far = 0;
  for (int i = 0; i < 200000; ++i) {
    collide::vec3<S> const at = vector(std::exp2(power(random)));
    double const size = std::exp2(power(random)), radius = std::exp2(power(random));
    collide::triangle<S> const t{at + vector(size), at + vector(size), at + vector(size)};
    // beyond the highest corner on an axis, where boxes have no room but that for rounding
    int const axis = i % 3;
    collide::vec3<S> c = t.a[axis] >= t.b[axis] && t.a[axis] >= t.c[axis] ? t.a : (t.b[axis] >= t.c[axis] ? t.b : t.c);
    S const r = S(radius * (1 + double(i % 7 - 3) * std::numeric_limits<S>::epsilon()));
    c[axis] += S(radius);
    collide::sphere<S> const s{c, r};
    bool const overlap = collide::conservative(s).overlaps(collide::conservative(t));
    far += overlap ? 0 : 1;
    if (!NarrowPhase::intersects(t, s)) continue;
    ++hits;
    apart += overlap ? 0 : 1;
  }
  CHECK(hits > 20000);
  CHECK(apart == 0);
  CHECK(far == 0);  // they nearly touch
}

}  // namespace

TEST_CASE_TEMPLATE("extending: boxes with room for rounding overlap where a narrow phase accepts", S, float, double) {
  using collide::karabassi;
  check_conservative_boxes<S, karabassi<>>();
  check_conservative_boxes<S, karabassi<collide::single_precision>>();
  check_conservative_boxes<S, karabassi<collide::double_precision>>();
  S const inf = std::numeric_limits<S>::infinity(), nan = std::numeric_limits<S>::quiet_NaN();
  collide::triangle<S> const t{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, broken{{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  auto const overlaps = [](collide::triangle<S> const& a, collide::sphere<S> const& s) {
    return collide::conservative(s).overlaps(collide::conservative(a));
  };
  CHECK(overlaps(t, {{0, 0, 5}, inf}));
  CHECK(!overlaps(t, {{0, 0, 5}, S(4.9)}));
  CHECK(!overlaps(t, {{0, 0, 0}, nan}));
  CHECK(!overlaps(t, {{0, 0, 0}, S(-1)}));
  CHECK(!overlaps(t, {{nan, 0, 0}, S(1)}));
  CHECK(!overlaps(broken, {{0, 0, 0}, S(1)}));
}
