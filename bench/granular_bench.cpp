/// \file
/// Sphere-steps a second of granular contact: granular_bench [host|device] [LARGEST] [SMALLEST] [STEPS]
///
/// Spheres of one size in a box of twelve triangles, in double: from SMALLEST (1,000) to LARGEST (10,000,000, on the
/// host 100,000) of them: `packed`, a cubic lattice shaken by a little, in which most touch five others; `loose`, where
/// few are near others; and `clumps`, a lattice of clumps of three spheres, in which all touch. Laws with and without
/// memory, with rolling, with cohesion. Prints a line of JSON for each: microseconds a step (the least of five times as
/// many steps as asked for, 100), sphere-steps a second, bytes a sphere, and how many others a sphere touches in the
/// mean, -1 of more than 100,000. On the host, time is that of one processor; on a device, between events. Built by
/// hand: nvcc -x cu -std=c++17 -O3 -arch=sm_90 -fmad=false --expt-relaxed-constexpr -Iinclude -Iexamples -Ibench, or
/// with g++ for the host.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/clumps.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/simulation.cuh>
#include <collide/simulation/energy.hpp>
#include <collide/simulation/place_clumps.hpp>
#include <collide/spaces/upload.hpp>

#include "stopwatch.hpp"

namespace {

using namespace collide;
constexpr double radius_of_all = 0.001;

struct bed {
  std::vector<double> centres, velocities, corners;

  /// About n places, `spacing` radii from each other along each axis, shaken by up to `shake` radii, in a box that ends
  /// `wide` radii around the last ones, a little less.
  bed(std::size_t n, vec3<double> const& spacing, double shake, double speed, vec3<double> const& wide) {
    auto const side = static_cast<std::size_t>(std::cbrt(static_cast<double>(n)) + 0.5);
    double const r = radius_of_all;
    std::uint64_t state = 1;
    auto const uniform = [&] {  // Lehmer's generator, from -1 to 1
      state = state * 48271 % 2147483647;
      return static_cast<double>(state) / 2147483647 * 2 - 1;
    };
    for (std::size_t i = 0; i < side * side * side; ++i) {
      std::size_t const at[] = {i % side, i / side % side, i / side / side};
      for (int k = 0; k < 3; ++k) {
        centres.push_back(r * (0.999 * wide[k] + static_cast<double>(at[k]) * spacing[k] + shake * uniform()));
        velocities.push_back(speed * uniform());
      }
    }
    vec3<double> const end = r * (2 * 0.999 * wide + static_cast<double>(side - 1) * spacing);
    for (int axis = 0; axis < 3; ++axis)
      for (double const at : {0.0, end[axis]}) {
        int const one = (axis + 1) % 3, two = (axis + 2) % 3;
        double const square[4][2] = {{0, 0}, {end[one], 0}, {end[one], end[two]}, {0, end[two]}};
        for (int const k : {0, 1, 2, 0, 2, 3}) {
          double corner[3];
          corner[axis] = at, corner[one] = square[k][0], corner[two] = square[k][1];
          corners.insert(corners.end(), corner, corner + 3);
        }
      }
  }
  /// Spheres.
  bed(std::size_t n, double spacing, double shake, double speed)
      : bed(n, vec3<double>(spacing, spacing, spacing), shake, speed, vec3<double>(1, 1, 1)) {}
};

template <class Space, class Law, class... Effect>
using granular = simulation<detector<bucket, karabassi<>, Space, double>, gravity, Law, velocity_verlet, Effect...>;

template <class Law>
Law law() {
  Law by;
  by.made_of = one_material({1e7, 0.3, 2500}, {0.5, 0.5});
  return by;
}

template <class Space, class Scene>
void time_steps(Space const& space, Scene& made, char const* where, char const* law, char const* scene, int steps) {
  double const dt = largest_time_step(made) / 4;
  made.steps(20, dt);
  std::vector<double> seconds;
  for (int k = 0; k < 5; ++k) {
    if constexpr (Space::host_accessible) {
      seconds.push_back(bench::processor_stopwatch()([&] { made.steps(static_cast<std::size_t>(steps), dt); }));
    } else {
      seconds.push_back(bench::stopwatch<Space>(space)([&] { made.steps(static_cast<std::size_t>(steps), dt); }));
    }
  }
  double const each = *std::min_element(seconds.begin(), seconds.end()) / steps;
  std::size_t const n = made.size();
  double const touching = n > 100000 ? -1 : contact_report(made).coordination;  // slow of many
  std::printf(
      "{\"space\": \"%s\", \"scene\": \"%s\", \"law\": \"%s\", \"spheres\": %zu, \"step_us\": %.2f, "
      "\"sphere_steps_per_s\": %.4g, \"bytes_per_sphere\": %.0f, \"touching\": %.2f}\n",
      where, scene, law, n, 1e6 * each, static_cast<double>(n) / each,
      static_cast<double>(made.bytes()) / static_cast<double>(n), touching);
  std::fflush(stdout);
}

template <class Space, class Law>
void measure(Space const& space, char const* where, char const* name, char const* scene, bed const& of, int steps) {
  granular<Space, Law> made(space, gravity{0, 0, -9.81}, law<Law>(), velocity_verlet{});
  std::size_t const n = of.centres.size() / 3;
  auto const walls = upload(space, triangle_soup(of.corners.data(), of.corners.size() / 9));
  auto const spheres = upload(space, spheres_xyz(of.centres.data(), n, radius_of_all));
  made.set_mesh(walls.view());
  buffer<double> velocities;
  velocities.reserve(space.resource(), 3 * n);
  space.copy_from_host(velocities.data(), of.velocities.data(), 3 * n);
  made.set(spheres.view(), velocities.data());
  time_steps(space, made, where, name, scene, steps);
}

/// Triangles of three spheres, in a lattice of places of which each has the middle of the box of one.
template <class Space>
void measure_clumps(Space const& space, char const* where, std::size_t spheres, int steps) {
  using law_type = granular_contact<hertz, mindlin>;
  double const r = radius_of_all;
  bed const of(spheres / 3, {3.1985, 3.0385, 1.9985}, 0.002, 0.001, {1.6, 1.52, 1});
  granular<Space, law_type, clumps> made(space, gravity{0, 0, -9.81}, law<law_type>(), velocity_verlet{}, clumps{});
  auto const walls = upload(space, triangle_soup(of.corners.data(), of.corners.size() / 9));
  made.set_mesh(walls.view());
  auto const shape =
      shape_of_clump({{{-0.6 * r, -0.52 * r, 0}, r}, {{0.6 * r, -0.52 * r, 0}, r}, {{0, 0.52 * r, 0}, r}});
  std::vector<placed_clump> placed(of.centres.size() / 3);
  for (std::size_t i = 0; i < placed.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      placed[i].at.position[k] = of.centres[3 * i + k];
      placed[i].moving.linear[k] = of.velocities[3 * i + k];
    }
  set_clumps(made, {shape}, placed);
  time_steps(space, made, where, "hertz, mindlin", "clumps", steps);
}

template <class Space>
void run(Space const& space, char const* where, std::size_t smallest, std::size_t largest, int steps) {
  for (std::size_t n = smallest; n <= largest; n *= 10) {
    bed const packed(n, 1.9985, 0.002, 0.001), loose(n, 2.6, 0.2, 0.01);
    measure<Space, granular_contact<hertz, dashpot>>(space, where, "hertz, dashpot", "packed", packed, steps);
    measure<Space, granular_contact<hertz, mindlin>>(space, where, "hertz, mindlin", "packed", packed, steps);
    measure<Space, granular_contact<hertz, mindlin>>(space, where, "hertz, mindlin", "loose", loose, steps);
    measure<Space, granular_contact<hertz, mindlin, epsd>>(space, where, "hertz, mindlin, epsd", "packed", packed,
                                                           steps);
    measure<Space, granular_contact<hertz, mindlin, none, sjkr>>(space, where, "hertz, mindlin, sjkr", "packed", packed,
                                                                 steps);
    measure_clumps(space, where, n, steps);
  }
}

}  // namespace

int main(int argc, char** argv) {
  bool const on_host = argc < 2 || std::strcmp(argv[1], "host") == 0;
  std::size_t const largest = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : on_host ? 100000 : 10000000;
  std::size_t const smallest = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1000;
  int const steps = argc > 4 ? std::atoi(argv[4]) : 100;
#if defined(__CUDACC__)
  if (!on_host) run(cuda_shared(), "cuda_shared", smallest, largest, steps);
#endif
  if (on_host) run(host(1), "host", smallest, largest, steps);
}
