/// \file
/// An effect of one's own: a spring that pulls each particle to the origin. A particle that starts at 1 is at -1 after
/// half a period, and back after a whole one.

#include <cmath>
#include <cstdio>

#include <collide/bucket.cuh>
#include <collide/simulation.cuh>

/// The parameters of the effect, and what it does. Other columns than those that are named here are not there.
struct spring {
  using reads = collide::columns<collide::position>;
  using writes = collide::columns<collide::velocity>;

  double stiffness = 1;  ///< acceleration at a distance of 1

  template <class Particle, class S>
  COLLIDE_HD void accelerate(Particle& p, S dt) const {
    p[collide::velocity{}] -= p[collide::position{}] * (S(stiffness) * dt);
  }
};

int main() {
  float const centre[] = {1, 0, 0};
  double const period = 6.283185307179586, stiffness = 4;  // of a period of pi
  collide::simulation<collide::detector<collide::bucket>, spring> simulation(collide::host(1), spring{stiffness});
  simulation.set(collide::spheres_xyz(centre, 1, 0.1f));

  bool is_right = true;
  for (int half = 1; half <= 4; ++half) {
    simulation.steps(500, static_cast<float>(period / std::sqrt(stiffness) / 1000));
    float const x = simulation.to_host<collide::position>()[0];
    std::printf("%.2f\n", x);
    is_right = is_right && std::abs(x - (half % 2 == 0 ? 1.0f : -1.0f)) < 0.01f;
  }
  return is_right ? 0 : 1;
}
