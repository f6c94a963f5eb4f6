/// \file
/// The programs of docs/guide.md in one: views, a detector, sinks, spheres that move, invalid input.

#include <cstdio>
#include <limits>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/bvh.cuh>
#include <collide/checks/validate.hpp>
#include <collide/checks/validate_closed.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/sinks/contains.hpp>
#include <collide/sinks/csr.hpp>
#include <collide/sinks/earliest.hpp>
#include <collide/sinks/nearest.hpp>
#include <collide/sinks/signed_distance.hpp>

namespace {

/// A unit square in the plane z = 0, of two triangles.
float const vertices[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
unsigned const triangles[] = {0, 1, 2, 0, 2, 3};
auto const mesh = collide::indexed_mesh(vertices, 4, triangles, 2);

void use_layouts() {
  struct particle {
    float x, y, z, mass;
  };
  std::vector<particle> const particles{{0.75f, 0.25f, 0.1f, 1}, {3, 3, 3, 1}};
  std::vector<float> const x{0.75f, 3}, y{0.25f, 3}, z{0.1f, 3}, radii{0.2f, 0.3f};
  auto const of_structs = collide::spheres_at(collide::points(particles.data(), particles.size()), 0.2f);
  auto const of_arrays = collide::spheres_soa(x.data(), y.data(), z.data(), x.size(), radii.data());

  collide::detector<collide::bucket> detector;
  detector.build(mesh, 0.3f);  // 0.3: the largest radius of the queries
  auto const a = detector.query(of_structs, collide::count()).total();
  auto const b = detector.query(of_arrays, collide::count()).total();
  std::printf("%d and %d pairs\n", static_cast<int>(a), static_cast<int>(b));
}

void use_sinks() {
  float const centres[] = {0.75f, 0.25f, 0.1f, 0.5f, 0.5f, 0, 3, 3, 3};
  auto const spheres = collide::spheres_xyz(centres, 3, 0.2f);
  collide::detector<collide::bucket> detector;
  detector.build(mesh, 0.2f);

  collide::contacts<float> contacts(collide::order::canonical);  // keeps its memory from query to query
  for (auto const& c : detector.query(spheres, contacts).to_host())
    std::printf("sphere %u is %.2f deep in triangle %u\n", c.sphere, c.depth, c.triangle);

  auto const [offsets, hit] = detector.query(spheres, collide::csr(collide::order::canonical)).to_host();
  for (std::size_t i = 0; i < 3; ++i)
    std::printf("sphere %d touches %d triangles\n", static_cast<int>(i), static_cast<int>(offsets[i + 1] - offsets[i]));

  collide::pair room[2];
  collide::pairs pairs(room, 2);  // your buffer, which may be too small
  detector.query(spheres, pairs);
  if (!pairs.complete())
    std::printf("room for %d of %d\n", static_cast<int>(pairs.size()), static_cast<int>(pairs.total()));
}

void use_nearest() {
  float const places[] = {0.2f, 0.2f, 7, -3, 0, 0};
  collide::detector<collide::bvh> tree;
  tree.build(mesh);
  for (auto const& found : tree.query(collide::points(places, 2), collide::nearest()).to_host())
    std::printf("triangle %u, %g away\n", found.triangle, static_cast<double>(found.distance));
}

void use_inside() {
  float const corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  unsigned const faces[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  auto const solid = collide::indexed_mesh(corners, 4, faces, 4);
  if (!collide::validate_closed(solid).closed()) std::printf("there is a hole\n");
  float const places[] = {0.1f, 0.2f, 0.3f, 0, 0, 1, 1, 1, 1};
  collide::detector<collide::bvh> tree;
  tree.build(solid);
  auto const is_inside = tree.query(collide::points(places, 3), collide::contains()).to_host();  // 1, 1, 0
  auto const surface = tree.query(collide::points(places, 3), collide::signed_distance()).to_host();
  for (std::size_t i = 0; i < surface.size(); ++i)
    std::printf("%s: %g\n", is_inside[i] ? "inside" : "outside", static_cast<double>(surface[i].distance));
}

void use_moving_spheres() {
  float const centres[] = {0.5f, 0.25f, 5, 3, 3, 5}, displacements[] = {0, 0, -10, 0, 0, -10};
  auto const falling = collide::with_displacements(collide::spheres_xyz(centres, 2, 0.5f), displacements);
  collide::detector<collide::bucket, collide::karabassi_swept<>> detector;
  detector.build(mesh);
  auto const first = detector.query(falling, collide::earliest<float>()).to_host();
  std::printf("sphere 0 hits triangle %u after %.2f of the step\n", first[0].triangle, first[0].time);
  std::printf("sphere 1 hits %s\n", first[1].triangle == collide::no_id ? "nothing" : "something");
}

void check_input() {
  float const centres[] = {0, 0, 0, std::numeric_limits<float>::quiet_NaN(), 0, 0};
  auto const found = collide::validate(collide::spheres_xyz(centres, 2, 0.2f));
  std::printf("%s\n", found.message().c_str());
}

}  // namespace

int main() {
  use_layouts();
  use_sinks();
  use_nearest();
  use_inside();
  use_moving_spheres();
  check_input();
}
