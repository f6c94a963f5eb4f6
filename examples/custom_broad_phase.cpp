/// \file
/// A broad phase of one's own: a list of bounding spheres. It says which triangles one sphere could touch, and
/// `per_sphere` makes of that a broad phase for every execution space, for spheres at rest and moving ones, and for
/// simulations.

#include "custom_broad_phase.hpp"

#include <cstdio>

#include <collide/broad/extend.hpp>
#include <collide/detector.hpp>

int main() {
  float const vertices[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  unsigned const corners[] = {0, 1, 2, 0, 2, 3};
  float const centres[] = {0.9f, 0.1f, 0, 0.5f, 0.5f, 0.1f, 0.5f, 0.5f, 0.3f, 5, 5, 5};
  auto const mesh = collide::indexed_mesh(vertices, 4, corners, 2);
  auto const spheres = collide::spheres_xyz(centres, 4, 0.2f);

  collide::detector<collide::per_sphere<bounding_spheres>> detector;
  for (auto [sphere, triangle] : detector.detect(mesh, spheres, collide::pairs(collide::order::canonical)).to_host()) {
    std::printf("%u %u\n", sphere, triangle);
  }
}
