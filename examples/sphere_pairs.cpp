/// \file
/// Which spheres touch each other: as pairs, and as a list of neighbours for each.
#include <cstdio>

#include <collide/detectors/sphere_pairs.cuh>

int main() {
  float const xyzr[] = {0, 0,    0, 1,    2, 0, 0, 1,
                        2, 2.5f, 0, 1.5f, 9, 9, 9, 1};  // metres: the first two touch in a point
  auto const spheres = collide::spheres_xyzr(xyzr, 4);
  collide::sphere_pairs<> finder;
  for (auto [i, j] : finder.query(spheres, collide::pairs(collide::order::canonical)).to_host())
    std::printf("spheres %u and %u touch\n", i, j);
  auto const neighbours = finder.neighbours(spheres, collide::csr()).to_host();
  for (unsigned i = 0; i < 4; ++i)
    std::printf("sphere %u has %u neighbours\n", i, unsigned(neighbours.offsets[i + 1] - neighbours.offsets[i]));
}
