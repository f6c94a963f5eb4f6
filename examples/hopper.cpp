/// \file
/// A hopper empties: grains of one, two and four spheres, of the same volume, turned at random. It prints when half of
/// them have left (docs/granular.md).
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/clumps.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/simulation.cuh>
#include <collide/simulation/fill.hpp>
#include <collide/simulation/place_clumps.hpp>

using namespace collide;

using law = granular_contact<hertz, mindlin>;
using hopper =
    simulation<detector<bucket, karabassi<>, host, double>, polydisperse, gravity, law, clumps, velocity_verlet>;

constexpr double orifice = 0.02, rim = 0.06, foot = 0.05, shoulder = 0.11, top = 0.4;  // metres: radii, heights

/// A cone from the orifice up, and a tube.
std::vector<double> walls() {
  std::vector<double> corners;
  auto const add_ring = [&](double r, double z, double to_r, double to_z) {
    constexpr int parts = 48;
    for (int i = 0; i < parts; ++i) {
      double const a = 6.283185307179586 * i / parts, b = 6.283185307179586 * (i + 1) / parts;
      for (auto const& [radius, angle, height] :
           {std::array{r, a, z}, {r, b, z}, {to_r, b, to_z}, {r, a, z}, {to_r, b, to_z}, {to_r, a, to_z}})
        corners.insert(corners.end(), {radius * std::cos(angle), radius * std::sin(angle), height});
    }
  };
  add_ring(orifice, foot, rim, shoulder);
  add_ring(rim, shoulder, rim, top);
  return corners;
}

/// A grain of a volume, of spheres that are given for any size.
clump_shape grain(std::vector<sphere<double>> spheres, double volume) {
  double const scale = std::cbrt(volume / shape_of_clump(spheres).volume);
  for (auto& s : spheres) s.centre *= scale, s.radius *= scale;
  return shape_of_clump(spheres);
}

int main() {
  double const volume = 4.18879 * std::pow(0.003, 3);  // of a sphere of 3 mm
  auto const corners = walls();
  for (auto const& spheres : std::vector<std::vector<sphere<double>>>{
           {{{0, 0, 0}, 1}},
           {{{-0.6, 0, 0}, 1}, {{0.6, 0, 0}, 1}},
           {{{1, 0, -0.7}, 1.2}, {{-1, 0, -0.7}, 1.2}, {{0, 1, 0.7}, 1.2}, {{0, -1, 0.7}, 1.2}}}) {
    clump_shape const shape = grain(spheres, volume);
    law const contact{one_material({1e6, 0.25, 2500}, {0.5, 0.5})};
    hopper scene(host(), polydisperse{}, gravity{}, contact, clumps{}, velocity_verlet{});
    scene.set_mesh(triangle_soup(corners.data(), corners.size() / 9));
    auto const places =
        fill_number(cylinder_region({0, 0, shoulder}, {0, 0, top}, rim), size_distribution::one(shape.reach()), 300);
    set_clumps(scene, {shape}, clumps_within(places.centres, places.radii, shape));
    double const dt = largest_time_step(scene);
    std::size_t const many = spheres.size(), half = places.radii.size() / 2;
    for (std::size_t out = 0; out < half && scene.time() < 2;) {
      scene.steps(50, dt);
      auto const x = scene.to_host<position>();
      out = 0;
      for (std::size_t i = 0; i < x.size() / 3; i += many) out += x[3 * i + 2] < foot;
    }
    std::printf("%zu grains of %zu spheres: half have left after %.2f s\n", 2 * half, many, scene.time());
  }
}
