/// \file
/// A function for each hit: how many spheres touch a triangle and how deep they are in it, as a sum that does not
/// depend on the order in which threads add to it.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/spaces/atomic_add.hpp>

int main() {
  float const vertices[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  unsigned const corners[] = {0, 1, 2, 0, 2, 3};
  std::vector<float> centres;
  for (int i = 0; i < 1000; ++i) {
    float const t = static_cast<float>(i) / 1000;
    centres.insert(centres.end(), {t, 0.9f - 0.8f * t, 0.2f * t});
  }
  collide::detector<collide::bucket> detector;
  detector.build(collide::indexed_mesh(vertices, 4, corners, 2));

  std::vector<unsigned> counts(2);
  std::vector<std::int64_t> depths(2);  // in units of 2^-32
  detector.query(collide::spheres_xyz(centres.data(), 1000, 0.1f), collide::visit([&](auto const& hit) {
                   collide::atomic_add(&counts[hit.triangle], 1);
                   collide::atomic_add(&depths[hit.triangle], std::llround(std::ldexp(hit.contact().depth, 32)));
                 }));
  for (std::size_t i = 0; i < 2; ++i)
    std::printf("%u spheres, depth %.6f\n", counts[i], std::ldexp(static_cast<double>(depths[i]), -32));
}
