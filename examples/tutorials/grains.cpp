/// \file
/// Tutorial 3: grains of two sizes settle in a box, and a wall that moves pushes them to one side. Lengths in metres,
/// times in seconds.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/bounds.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/simulation.cuh>

namespace {

constexpr float small = 0.01f, large = 0.014f;                 // radii
constexpr double density = 2500, collision_time = 2e-3;        // of glass; how long two grains touch
constexpr float dt = static_cast<float>(collision_time / 20);  // no longer than this
constexpr float half_width = 0.1f;                             // of the box

using grains = collide::simulation<collide::detector<collide::bucket>, collide::polydisperse, collide::gravity,
                                   collide::sphere_contact, collide::bounce, collide::box_walls>;

/// A floor and a wall across the box, four triangles.
class floor_and_wall {
 public:
  collide::mesh_view<float> with_wall_at(float x) {
    for (std::size_t i = 4; i < 8; ++i) vertices_[3 * i] = x;
    return collide::indexed_mesh(static_cast<float const*>(vertices_), 8, triangles_, 4);
  }

 private:
  float vertices_[24] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0, 0, -1, 0, 0, 1, 0, 0, 1, 1, 0, -1, 1};
  unsigned triangles_[12] = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
};

/// Kinetic and potential energy of all grains, J.
double energy_of(grains const& simulation) {
  auto const x = simulation.to_host<collide::position>(), v = simulation.to_host<collide::velocity>();
  auto const r = simulation.to_host<collide::radius>();
  double sum = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    double const mass = density * 4.18879 * std::pow(double{r[i]}, 3), height = x[3 * i + 2];
    double const square =
        std::pow(double{v[3 * i]}, 2) + std::pow(double{v[3 * i + 1]}, 2) + std::pow(double{v[3 * i + 2]}, 2);
    sum += mass * (square / 2 + 9.81 * height);
  }
  return sum;
}

}  // namespace

int main() {
  std::vector<float> centres, radii;
  for (int i = 0; i < 200; ++i) {
    float const column = static_cast<float>(i % 5), row = static_cast<float>(i / 5 % 5),
                layer = static_cast<float>(i / 25);
    centres.insert(centres.end(), {0.032f * column - 0.064f, 0.032f * row - 0.064f, 0.02f + 0.03f * layer});
    radii.push_back(i % 3 == 0 ? large : small);
  }

  collide::box_walls walls;
  for (int k = 0; k < 2; ++k) walls.lower[k] = -half_width, walls.upper[k] = half_width;
  grains simulation(collide::host(1), collide::polydisperse(), collide::gravity(),
                    collide::sphere_contact::from_restitution(0.5, collision_time, small, density, 0.3),
                    collide::bounce{0.3}, walls);
  floor_and_wall mesh;
  float wall = -half_width - large;
  simulation.set_mesh(mesh.with_wall_at(wall));
  simulation.set(collide::spheres_xyz(static_cast<float const*>(centres.data()), radii.size(),
                                      static_cast<float const*>(radii.data())));

  double energy = energy_of(simulation), most_gained = 0;
  for (int part = 0; part < 50; ++part) {  // half a second
    simulation.steps(100, dt);
    double const now = energy_of(simulation);
    most_gained = std::max(most_gained, now / energy - 1);
    energy = now;
  }
  std::printf("settled, energy grew by less than 5 %%: %s\n", most_gained < 0.05 ? "yes" : "no");

  while (wall < 0) {  // 0.2 m a second, far less than a radius in a step
    wall += 0.2f * dt;
    simulation.set_mesh(mesh.with_wall_at(wall));
    simulation.step(dt);
  }
  auto const x = simulation.to_host<collide::position>();
  std::size_t behind = 0;
  for (std::size_t i = 0; i < radii.size(); ++i) behind += x[3 * i] < wall;
  std::printf("%zu of %zu grains are behind the wall\n", behind, radii.size());
  std::printf("%zu bytes a grain\n", simulation.bytes() / radii.size());
}
