/// \file
/// Grains that fall onto a plate and form a heap: Hertz' contact, friction with memory, rolling resistance.
#include <algorithm>
#include <cstdio>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/simulation.cuh>

int main() {
  using law = collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>;
  using scene = collide::simulation<collide::detector<collide::bucket, collide::karabassi<>, collide::host, double>,
                                    collide::gravity, law, collide::velocity_verlet>;
  collide::solid const glass{1e7, 0.2, 2500};              // Young's modulus, Poisson's ratio, density
  collide::surface_pair const surfaces{0.5, 0.5, 0.1, 0};  // restitution, friction, rolling friction, cohesion
  scene grains(collide::host(), collide::gravity{0, 0, -9.81}, law{collide::one_material(glass, surfaces)},
               collide::velocity_verlet{});

  double const plate[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0}, radius = 0.005;
  unsigned const triangles[] = {0, 1, 2, 0, 2, 3};
  grains.set_mesh(collide::indexed_mesh(plate, 4, triangles, 2));
  std::vector<double> centres;  // a column, 4 by 4 grains wide
  for (int k = 0; k < 160; ++k) {
    double const shift = 1e-4 * (k % 7);
    for (double const x : {(k % 4 - 1.5) * 0.0101 + shift, (k / 4 % 4 - 1.5) * 0.0101 - shift, 0.006 + k / 16 * 0.0101})
      centres.push_back(x);
  }
  grains.set(collide::spheres_xyz(centres.data(), centres.size() / 3, radius));
  double const dt = largest_time_step(grains);
  grains.steps(static_cast<std::size_t>(1.0 / dt), dt);

  auto const x = grains.to_host<collide::position>();
  double top = 0;
  for (std::size_t i = 0; i < x.size(); i += 3) top = std::max(top, x[i + 2] + radius);
  std::printf("after %.2f s the heap is %.1f cm high\n", grains.time(), 100 * top);
}
