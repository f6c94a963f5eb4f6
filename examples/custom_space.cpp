/// \file
/// An execution space of one's own: a pool of threads. It finds what the host finds.

#include "custom_space.hpp"

#include <cstdio>

#include <collide/bucket.cuh>

int main() {
  float const vertices[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  unsigned const corners[] = {0, 1, 2, 0, 2, 3};
  float const centres[] = {0.9f, 0.1f, 0, 0.5f, 0.5f, 0, 5, 5, 5};
  auto const mesh = collide::indexed_mesh(vertices, 4, corners, 2);
  auto const spheres = collide::spheres_xyz(centres, 3, 0.2f);

  thread_pool threads(4);
  collide::detector<collide::bucket, collide::karabassi<>, pool_space> detector{pool_space(threads)};
  for (auto [sphere, triangle] : detector.detect(mesh, spheres, collide::pairs(collide::order::canonical)).to_host()) {
    std::printf("%u %u\n", sphere, triangle);
  }
}
