/// \file
/// A body that is free: a plate on a spring sinks under the grains that fall on it. We integrate it ourselves, of the
/// forces that `reaction` sums up. Lengths in metres, times in seconds, masses in kilograms.
#include <cstdio>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/simulation.cuh>

using namespace collide;

int main() {
  float const plate[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, -1, 0, 1, 1, 0, -1, 1, 0};
  std::vector<float> centres;
  constexpr float radius = 0.03f, dt = 1e-3f;
  for (float x : {-0.4f, -0.2f, 0.0f, 0.2f, 0.4f}) {
    for (float y : {-0.4f, -0.2f, 0.0f, 0.2f, 0.4f}) centres.insert(centres.end(), {x, y, 0.2f});
  }
  constexpr double density = 2500, mass = 20, stiffness = 1000, damping = 150;  // of the grains; of plate and spring

  host const cpu(1);
  reaction_sums sums(cpu, 1, 1e-12);
  simulation<detector<bucket>, gravity, bounce, reaction, moving_bodies<driven>> scene(
      cpu, gravity{}, bounce{0.2}, sums.effect(density), moving_bodies<driven>{});
  scene.set_mesh(triangle_soup(plate, 2), {body{0, 2, {}}});
  scene.set(spheres_xyz(static_cast<float const*>(centres.data()), 25, radius));

  double height = 0, speed = 0;  // of the plate; its own weight is borne where it begins
  for (int step = 0; step < 5000; ++step) {
    sums.clear(cpu);
    scene.step(dt);
    double const force = sums.read(cpu)[0].linear[2] / double{dt};
    speed += double{dt} * (force - stiffness * height - damping * speed) / mass;
    height += double{dt} * speed;
    body_state& state = scene.bodies().states()[0];  // what it is to be at the end of the next step
    state.at.position[2] = height;
    state.moving.linear[2] = speed;
  }
  double const r = radius, weight = 25 * density * 4.18879 * r * r * r * 9.81;
  std::printf("the plate has sunk by %.1f mm; weight over stiffness is %.1f mm\n", -1000 * height,
              1000 * weight / stiffness);
}
