/// \file
/// A wall that a controller holds at a force: a lid presses on grains in a box, then harder, then less. We move it
/// ourselves, by the forces that `reaction` sums up; free_body.cpp has a body that moves by its mass. Lengths in
/// metres, times in seconds, masses in kilograms.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/simulation.cuh>

using namespace collide;

/// Holds a wall at a force: it gives way with a speed that is proportional to how much the force is off. So the force
/// is right once the wall stands still. `damping` is above stiffness times dt, that of all grains together.
struct servo {
  double damping;     ///< force per speed
  double most_speed;  ///< the wall is never faster
  double at = 0;      ///< where it is, along the force on it
  double speed = 0;

  /// Goes on for the time `dt`: `force` is that of the grains on the wall, `wanted` what it is to be.
  void step(double force, double wanted, double dt) {
    speed = std::clamp((force - wanted) / damping, -most_speed, most_speed);
    at += speed * dt;
  }
};

int main() {
  constexpr double half = 0.0403, high = 0.2, radius = 0.01, density = 2500;
  double const inner = half - 1e-4, lid = 0.08, corners[] = {-inner, -inner, lid,   inner, -inner, lid,   inner, inner,
                                                             lid,    -inner, inner, lid,  // the lid, then the box
                                                             -half,  -half,  0,     half,  -half,  0,     half,  half,
                                                             0,      -half,  half,  0,     -half,  -half, high,  half,
                                                             -half,  high,   half,  half,  high,   -half, half,  high};
  unsigned const triangles[] = {0, 1, 2,  0, 2,  3, 4, 5, 6,  4, 6,  7,  4, 5, 9, 4, 9, 8,
                                5, 6, 10, 5, 10, 9, 6, 7, 11, 6, 11, 10, 7, 4, 8, 7, 8, 11};
  std::vector<double> centres;
  for (int layer = 0; layer < 5; ++layer) {  // of 4 by 4 and 3 by 3 grains, each in the gaps of the one below
    int const n = 4 - layer % 2;
    for (int k = 0; k < n * n; ++k) {
      double const middle = (n - 1) / 2.0;
      for (double x : {(k % n - middle) * 0.0201, (k / n - middle) * 0.0201, 0.0101 + layer * 0.01425})
        centres.push_back(x);
    }
  }

  host const cpu(1);
  reaction_sums sums(cpu, 1, 1e-15);
  using law = granular_contact<hertz, mindlin>;
  simulation<detector<bucket, karabassi<>, host, double>, gravity, law, reaction, moving_bodies<driven>,
             velocity_verlet>
      grains(cpu, gravity{}, law{one_material({1e7, 0.2, density}, {0.3, 0.4})}, sums.effect(density),
             moving_bodies<driven>{}, velocity_verlet{});
  grains.set_mesh(indexed_mesh(corners, 12, triangles, 12), {body{0, 2, {}}});
  grains.set(spheres_xyz(static_cast<double const*>(centres.data()), centres.size() / 3, radius));

  double const dt = largest_time_step(grains) / 4;  // grains that are pressed in a dense bed shake with longer steps
  servo hand{500, 0.1};
  bool holds = true;
  for (double const wanted : {20.0, 50.0, 5.0}) {
    double sum = 0, largest_error = 0;
    int const steps = static_cast<int>(0.5 / dt), last = static_cast<int>(0.05 / dt);
    for (int k = 0; k < steps; ++k) {
      sums.clear(cpu);
      grains.step(dt);
      double const force = sums.read(cpu)[0].linear[2] / dt;
      hand.step(force, wanted, dt);
      body_state& state = grains.bodies().states()[0];  // what it is to be at the end of the next step
      state.at.position[2] = hand.at;
      state.moving.linear[2] = hand.speed;
      if (k < steps - last) continue;
      sum += force;
      largest_error = std::max(largest_error, std::abs(force - wanted));
    }
    holds = holds && std::abs(sum / last - wanted) < 1e-3 * wanted && largest_error < 0.02 * wanted;
    std::printf("wanted %4.1f N: %6.3f N, never off by more than %.3f N; the lid is at %.2f mm\n", wanted, sum / last,
                largest_error, 1000 * (lid + hand.at));
  }
  return holds ? 0 : 1;
}
