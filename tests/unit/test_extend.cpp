/// Policies of a user, in the spaces of the host.
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
