/// \file
/// A narrow phase of one's own: one-sided triangles, which only spheres in front of them can touch. All that a narrow
/// phase needs is a static function `intersects`; `contact_of` only for the sinks that ask for contacts.

#include <cstdio>

#include <Eigen/Geometry>

#include <collide/bucket.cuh>

/// Karabassi's test for spheres whose centre is not behind the triangle, as seen against its normal.
struct front_only {
  template <class S>
  static COLLIDE_HD bool intersects(collide::triangle<S> const& t, collide::sphere<S> const& s) {
    collide::vec3<S> const normal = (t.b - t.a).cross(t.c - t.a);
    return normal.dot(s.centre - t.a) >= 0 && collide::karabassi<>::intersects(t, s);
  }
};

int main() {
  float const vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  unsigned const corners[] = {0, 1, 2};
  float const centres[] = {0.2f, 0.2f, 0.1f, 0.2f, 0.2f, -0.1f};  // one in front of the triangle, one behind it
  auto const mesh = collide::indexed_mesh(vertices, 3, corners, 1);
  auto const spheres = collide::spheres_xyz(centres, 2, 0.5f);

  collide::detector<collide::bucket> both_sides;
  collide::detector<collide::bucket, front_only> one_side;
  std::printf("%d touch the triangle\n", static_cast<int>(both_sides.detect(mesh, spheres, collide::count()).total()));
  std::printf("%d from the front\n", static_cast<int>(one_side.detect(mesh, spheres, collide::count()).total()));
}
