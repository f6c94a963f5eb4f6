/// \file
/// Times steps of simulations on the host. Prints a line for each scene: its name, seconds, hash of the positions.
#include <array>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/simulation.cuh>

#include "../../bench/scene.hpp"
#include "io/scenes.hpp"
#include "timings.hpp"

namespace {

using namespace collide;

/// Grains in a box, packed: those of a cubic lattice, a little compressed and shaken.
template <class S, class... Effect>
void packed(std::string const& name, bool are_mixed, S dt, Effect... effects) {
  int const n = 22;
  S const r = S(0.001), cell = 2 * r * S(0.99), half = n * cell / 2;
  std::vector<S> centres, radii;
  for (int i = 0; i < n * n * n; ++i) {
    int const at[] = {i % n, i / n % n, i / n / n};
    for (int k = 0; k < 3; ++k)
      centres.push_back((at[k] + S(0.5)) * cell - half + S(0.02) * r * S((i * 7 + k * 3) % 11 - 5) / 5);
    radii.push_back(are_mixed ? r * (i % 3 == 0 ? S(1) : S(0.7)) : r);
  }
  std::vector<S> box;
  std::vector<std::uint32_t> corners;
  for (int c = 0; c < 8; ++c)
    for (int k = 0; k < 3; ++k) box.push_back(c >> k & 1 ? half : -half);
  for (auto const& q :
       {std::array<std::uint32_t, 4>{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}})
    corners.insert(corners.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
  simulation<detector<bucket, karabassi<>, host, S>, Effect...> made(host(1), effects...);
  made.set_mesh(indexed_mesh(box.data(), 8, corners.data(), 12));
  auto const run = [&] {
    made.set(are_mixed ? spheres_xyz(centres.data(), radii.size(), radii.data())
                       : spheres_xyz(centres.data(), radii.size(), r));
    made.steps(40, dt);
  };
  timed(name, run, [&] { return made.template to_host<position>(); });
}

}  // namespace

int main() {
  packed<double>("packed/granular", false, 5e-7, gravity{0, 0, -9.81}, granular_contact<hertz, mindlin>{},
                 velocity_verlet{});
  packed<double>("mixed/granular", true, 5e-7, polydisperse{}, gravity{0, 0, -9.81}, granular_contact<hertz, mindlin>{},
                 velocity_verlet{});
  packed<float>("packed/sphere_contact", false, 5e-7f, gravity{0, 0, -9.81f}, sphere_contact{}, bounce{});
  {
    bench::scene<float> const study(io::find_scene("study")->make(200000, io::study_triangles, 0));
    simulation<detector<bucket>, gravity, bounce> made(host(1), gravity{0, 0, -10}, bounce{0.5f});
    made.set_mesh(study.mesh());
    auto const run = [&] {
      made.set(study.spheres());
      made.steps(15, 0.01f);
    };
    timed("study/bounce", run, [&] { return made.to_host<position>(); });
  }
}
