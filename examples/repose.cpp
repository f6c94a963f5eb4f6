/// \file
/// The angle of repose: a bin of grains is opened at one side, and what does not fall out lies in a slope. Grains of
/// one, two and four spheres of the same volume, or of so many alone: repose [SPHERES] (docs/granular.md).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/bounds.hpp>
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
using bin = simulation<detector<bucket, karabassi<>, host, double>, polydisperse, gravity, law, periodic_box, clumps,
                       velocity_verlet>;
using spheres = std::vector<sphere<double>>;

constexpr double length = 0.06, width = 0.02, height = 0.3;  // metres

/// A plate across the bin, from one point of its x, z plane to another.
void add_plate(std::vector<double>& to, double x, double z, double to_x, double to_z) {
  to.insert(to.end(), {x, -1, z, to_x, -1, to_z, to_x, 1, to_z, x, -1, z, to_x, 1, to_z, x, 1, z});
}

/// The slope of the heap, in degrees: a line through the highest spheres of eight parts of its length.
double slope_of(bin const& scene) {
  constexpr int parts = 10;
  double top[parts] = {}, sums[4] = {};
  auto const centres = scene.to_host<position>();
  for (std::size_t i = 0; i < centres.size(); i += 3) {
    auto const part = static_cast<int>(std::floor(centres[i] / length * parts));
    if (part >= 0 && part < parts) top[part] = std::max(top[part], centres[i + 2]);
  }
  for (int k = 1; k < parts - 1; ++k) {
    double const x = (k + 0.5) * length / parts;
    sums[0] += x, sums[1] += top[k], sums[2] += x * x, sums[3] += x * top[k];
  }
  double const n = parts - 2;
  return -std::atan((n * sums[3] - sums[0] * sums[1]) / (n * sums[2] - sums[0] * sums[0])) * 57.29577951308232;
}

int main(int argc, char** argv) {
  std::vector<double> open;
  add_plate(open, 0, 0, length, 0);
  add_plate(open, 0, 0, 0, height);
  std::vector<double> shut = open;
  add_plate(shut, length, 0, length, height);
  double const volume = 4.18879 * std::pow(0.003, 3);  // of a sphere of 3 mm
  for (spheres of : {spheres{{{0, 0, 0}, 1}}, spheres{{{-0.6, 0, 0}, 1}, {{0.6, 0, 0}, 1}},
                     spheres{{{1, 0, -0.7}, 1.2}, {{-1, 0, -0.7}, 1.2}, {{0, 1, 0.7}, 1.2}, {{0, -1, 0.7}, 1.2}}}) {
    if (argc > 1 && std::strtoul(argv[1], nullptr, 10) != of.size()) continue;
    double const scale = std::cbrt(volume / shape_of_clump(of).volume);
    for (auto& s : of) s.centre *= scale, s.radius *= scale;
    clump_shape const shape = shape_of_clump(of);
    law const contact{one_material({3e5, 0.25, 2500}, {0.3, 0.5})};
    bin scene(host(1), polydisperse{}, gravity{}, contact, periodic_box{{-9, 0, -9}, {9, width, 9}}, clumps{},
              velocity_verlet{});
    scene.set_mesh(triangle_soup(shut.data(), shut.size() / 9));
    auto const places =
        fill_number(box_region{{0, 0, 0.001}, {length, width, height}}, size_distribution::one(shape.reach()), 330, 3);
    set_clumps(scene, {shape}, clumps_within(places.centres, places.radii, shape));
    double const dt = largest_time_step(scene);
    scene.steps(static_cast<std::size_t>(0.4 / dt), dt);
    scene.set_mesh(triangle_soup(open.data(), open.size() / 9));
    scene.steps(static_cast<std::size_t>(0.8 / dt), dt);
    std::printf("grains of %zu spheres: a slope of %.0f degrees\n", of.size(), slope_of(scene));
  }
}
