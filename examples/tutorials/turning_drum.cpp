/// \file
/// Tutorial 7: a drum turns and takes grains along; we ask it for the torque that it needs. Lengths in metres, times in
/// seconds, masses in kilograms.

#include <cmath>
#include <cstdio>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/effects/bounds.hpp>
#include <collide/effects/friction.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/effects/spin.hpp>
#include <collide/simulation.cuh>

namespace {

constexpr float grain = 0.015f, half_length = 0.1f;  // radius of a grain; the drum is between y = -0.1 and 0.1
constexpr double radius = 0.3, density = 2500, collision_time = 6e-3;
constexpr float dt = static_cast<float>(collision_time / 20);

using drum = collide::simulation<collide::detector<collide::bucket>, collide::gravity, collide::sphere_contact,
                                 collide::bounce, collide::friction, collide::spin, collide::box_walls,
                                 collide::reaction, collide::moving_bodies<>>;

/// A tube around the y axis as a soup of triangles, as it lies at time 0.
std::vector<float> tube(int sides) {
  std::vector<float> corners;
  for (int i = 0; i < sides; ++i) {
    double const turn = 2 * 3.14159265358979 / sides;
    auto const corner = [&](int k, float y) {
      double const angle = turn * (i + k);
      corners.insert(corners.end(),
                     {static_cast<float>(radius * std::cos(angle)), y, static_cast<float>(radius * std::sin(angle))});
    };
    corner(0, -half_length), corner(1, -half_length), corner(1, half_length);
    corner(0, -half_length), corner(1, half_length), corner(0, half_length);
  }
  return corners;
}

/// How far the grains' centre of mass is from the axis, to the side.
double offset_of(drum const& simulation) {
  auto const x = simulation.to_host<collide::position>();
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); i += 3) sum += x[i];
  return 3 * sum / static_cast<double>(x.size());
}

}  // namespace

int main() {
  std::vector<float> centres;
  for (int i = 0; i < 600; ++i) {
    auto const column = static_cast<float>(i % 12), row = static_cast<float>(i / 12 % 5),
               layer = static_cast<float>(i / 60);
    centres.insert(centres.end(), {0.032f * column - 0.176f, 0.032f * row - 0.064f, 0.032f * layer - 0.2f});
  }
  collide::box_walls ends;
  ends.lower[1] = -half_length, ends.upper[1] = half_length;
  collide::host const cpu(1);
  collide::reaction_sums sums(cpu, 1, 1e-12);  // of one body, in units of 1e-12 kg m/s
  drum simulation(cpu, collide::gravity{},
                  collide::sphere_contact::from_restitution(0.4, collision_time, grain, density, 0.4),
                  collide::bounce{0.3}, collide::friction{0.6, 0.5}, collide::spin{}, ends, sums.effect(density),
                  collide::moving_bodies<>{});

  std::vector<float> const corners = tube(72);
  collide::body turning{0, corners.size() / 9, {}};  // all triangles
  turning.motion.axis[1] = 1, turning.motion.axis[2] = 0;
  turning.motion.rate = 1.2;  // radians a second
  simulation.set_mesh(collide::triangle_soup(corners.data(), corners.size() / 9), {turning});
  simulation.set(collide::spheres_xyz(static_cast<float const*>(centres.data()), centres.size() / 3, grain));

  simulation.steps(5000, dt);  // 1.5 seconds, until the grains flow evenly
  sums.clear(simulation.space());
  double offset = 0;
  for (int k = 0; k < 100; ++k) {
    simulation.steps(100, dt);
    offset += offset_of(simulation) / 100;
  }
  double const r = grain, weight = static_cast<double>(centres.size() / 3) * density * 4.18879 * r * r * r * 9.81;
  double const torque = -sums.read(simulation.space())[0].angular[1] / (10'000 * double{dt});
  std::printf("torque of the motor %.1f N m, of the grains' weight %.1f N m\n", torque, weight * -offset);

  auto const where = simulation.bodies().to_host(simulation.space())[0];
  auto const mark = where.at({radius, 0, 0});  // a point of the mesh, where it is now
  std::printf("the mark is at (%.2f, %.2f)\n", mark.x(), mark.z());
  std::printf("%u steps were too long\n", simulation.bodies().report(simulation.space()).fast_steps);
}
