/// Steps of simulations, with what collide::compiled has of them or without. Prints a hash of where the particles end:
/// the same either way.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <vector>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/simulation.cuh>

namespace {

/// A wavy floor, and particles above it.
template <class S>
struct scene {
  std::vector<S> corners, centres, velocities;

  scene() {
    for (int i = 0; i < 12; ++i) {
      for (int j = 0; j < 12; ++j) {
        for (int half = 0; half < 2; ++half) {
          for (int k = 0; k < 3; ++k) {
            int const x = i + (k == 1 || (half == 1 && k == 0)), y = j + (k == 2 || (half == 1 && k == 0));
            corners.insert(corners.end(), {S(x), S(y), S((x * 5 + y * 3) % 4) / 8});
          }
        }
      }
    }
    for (int i = 0; i < 200; ++i) {
      centres.insert(centres.end(), {S(i % 20) / 2 + 1, S(i / 20) + 1, S(i % 7) / 4 + 1});
      velocities.insert(velocities.end(), {S(i % 3) - 1, S(i % 5) / 4, S(-1)});
    }
  }
};

template <class Detector, class... Effect>
void run(char const* name, Effect... effects) {
  using S = typename Detector::scalar;
  scene<S> const made;
  collide::simulation<Detector, Effect...> simulation(collide::host(), effects...);
  simulation.set_mesh(collide::triangle_soup(made.corners.data(), made.corners.size() / 9));
  simulation.set(collide::spheres_xyz(made.centres.data(), made.centres.size() / 3, S(0.125)), made.velocities.data());
  simulation.steps(100, S(0.01));
  std::uint64_t hash = 14695981039346656037u;
  int above = 0;
  for (S const x : simulation.template to_host<collide::position>()) {
    unsigned char bytes[sizeof x];
    std::memcpy(bytes, &x, sizeof x);
    for (unsigned char const b : bytes) hash = (hash ^ b) * 1099511628211u;
    above += std::isfinite(x) && x > -1;
  }
  std::printf("%s %016llx, %d of 600 coordinates are above -1\n", name, static_cast<unsigned long long>(hash), above);
}

template <class Broad, class S>
void run_all() {
  using namespace collide;
  using at_rest = detector<Broad, karabassi<>, host, S>;
  using in_motion = detector<Broad, karabassi_swept<>, host, S>;
  gravity const down{0, 0, -9.81};
  run<at_rest>("exact", down, bounce{0.5});
  run<detector<Broad, karabassi<single_precision>, host, S>>("single precision", down, bounce{0.5});
  run<in_motion>("swept", down, bounce{0.5});
  run<at_rest>("bodies", moving_bodies<>{}, down, bounce{0.5});
  run<in_motion>("swept bodies", moving_bodies<>{}, down, bounce{0.5});
}

}  // namespace

int main() {
  run_all<collide::bucket, float>();
  run_all<collide::bucket, double>();
  run_all<collide::all_pairs, float>();
}
