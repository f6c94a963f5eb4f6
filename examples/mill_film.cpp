/// \file
/// The film of the README: a mill of 1 m with twelve lifters, as many grains as wanted. Compiled by nvcc (-x cu) it
/// runs on a GPU. The grains begin as a tilted bed that turns with the mill.
///
/// Usage: mill_film FOLDER [GRAINS [TURNS [FRAMES [SECONDS]]]]: torque.csv has torque and power of the motor, mill.json
/// the costs, walls.vtp the mill as it begins, and film.pvd as many frames of the last twelfth of a turn, which
/// repeats. It stops sooner if all steps would take longer than so many seconds. All files are whole after each frame.
/// scripts/render-mill draws them.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <future>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/io/vtk.hpp>
#include <collide/simulation.cuh>
#include <collide/simulation/fill.hpp>
#include <collide/spaces/upload.hpp>

#include "io/device.hpp"
#include "io/scenes/surfaces.hpp"

namespace {

using namespace collide;
#if defined(__CUDACC__)
using space_type = cuda_shared;
#else
using space_type = host;
#endif
using law = granular_contact<hertz, mindlin, epsd>;
using mill = simulation<detector<bucket, karabassi<>, space_type, double>, polydisperse, gravity, law, reaction,
                        moving_bodies<>, velocity_verlet>;

constexpr double outer = 0.5, deep = 0.2, lifter = 0.035;  // of the mill, in metres; its axis is y
constexpr int lifters = 12, sides = 16 * lifters;
constexpr double tilt = 0.65, surface = -0.13;  // of the bed: its slope, how far from the axis

/// The shell, and beyond its ends squares, so that no triangles meet on the axis.
io::scene walls() {
  io::scene s;
  io::add_tube(s, sides, 2, [](std::size_t k, double angle) {
    long const side = std::lround(angle / (2 * io::pi) * sides);
    double const r = side % (sides / lifters) < 2 ? outer - lifter : outer;
    return io::point{r * std::cos(angle), k == 0 ? -deep : deep, r * std::sin(angle)};
  });
  for (double const end : {-deep, deep})
    io::add_plate(s, {-outer, end, -outer}, {2 * outer, 0, 0}, {0, 0, 2 * outer}, 1, 1);
  return s;
}

/// The part of the mill below a level, from y to y, as `fill` takes it.
struct bed_region : cylinder_region {
  bed_region(double begin, double end) : cylinder_region({0, begin, 0}, {0, end, 0}, outer - lifter) {
    upper[2] = surface;
  }
  double volume() const {
    double const part = std::acos(-surface / radius);  // of the angle of a segment, a half
    return (radius * radius * part + surface * std::sqrt(radius * radius - surface * surface)) * length();
  }
  std::vector<double> depths(std::vector<double> const& xyz) const {
    auto found = cylinder_region::depths(xyz);
    for (std::size_t i = 0; i < found.size(); ++i) found[i] = std::min(found[i], surface - xyz[3 * i + 2]);
    return found;
  }
};

/// A bed of so many grains with a mean radius: slices beside each other, each laid by a thread.
filling laid(std::size_t wanted, double usual) {
  auto const slices = static_cast<std::size_t>(std::max(1.0, 2 * deep / (40 * usual)));
  std::vector<std::future<filling>> parts;
  for (std::size_t k = 0; k < slices; ++k)
    parts.push_back(std::async(std::launch::async, [=] {
      auto const side = [&](std::size_t i) {
        return deep * (2 * static_cast<double>(i) / static_cast<double>(slices) - 1);
      };
      return fill_number(bed_region(side(k), side(k + 1)), size_distribution::uniform(0.8 * usual, 1.18 * usual),
                         wanted * (k + 1) / slices - wanted * k / slices, k);
    }));
  filling all;
  for (auto& part : parts) {
    filling const found = part.get();
    all.centres.insert(all.centres.end(), found.centres.begin(), found.centres.end());
    all.radii.insert(all.radii.end(), found.radii.begin(), found.radii.end());
  }
  return all;
}

/// Writes what the renderer needs of all grains.
void write_frame(std::string const& path, mill const& of) {
  auto const x = of.to_host<position>(), v = of.to_host<velocity>(), r = of.to_host<radius>();
  std::vector<float> speeds(r.size());
  for (std::size_t i = 0; i < r.size(); ++i)
    speeds[i] = static_cast<float>(std::hypot(v[3 * i], v[3 * i + 1], v[3 * i + 2]));
  std::ofstream out(path, std::ios::binary);
  write_vtp(out, std::vector<float>(x.begin(), x.end()),
            {{"radius", std::vector<float>(r.begin(), r.end())}, {"speed", speeds}}, vtk_cells::dots, {});
}

/// Seconds since the first call.
double seconds() {
  using clock = std::chrono::steady_clock;
  static auto const begin = clock::now();
  return std::chrono::duration<double>(clock::now() - begin).count();
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) return 2;
  seconds();
  std::string const folder = std::string(argv[1]) + "/";
  auto const wanted = static_cast<std::size_t>(argc > 2 ? std::atoll(argv[2]) : 5'000);
  double const turns = argc > 3 ? std::atof(argv[3]) : 1;
  int const frames = argc > 4 ? std::atoi(argv[4]) : 48;
  double const most_seconds = argc > 5 ? std::atof(argv[5]) : 1e9;
  constexpr double rate = 3.2, density = 2700;  // 0.72 of the critical speed

  double const usual =
      std::cbrt(0.48 * bed_region(-deep, deep).volume() / static_cast<double>(wanted) * 3 / (4 * io::pi));
  auto grains = laid(wanted, usual);
  std::fprintf(stderr, "%zu grains laid after %.1f s\n", wanted, seconds());
  std::vector<double> moving;
  for (std::size_t i = 0; i < grains.centres.size(); i += 3) {
    double &x = grains.centres[i], &z = grains.centres[i + 2];
    std::tie(x, z) = std::make_pair(x * std::cos(tilt) + z * std::sin(tilt), z * std::cos(tilt) - x * std::sin(tilt));
    moving.insert(moving.end(), {rate * z, 0, -rate * x});
  }

  space_type const space;
  using device = io::device_of<space_type>;
  reaction_sums forces(space, 1, 1e-13);
  law const contact{one_material({1e6, 0.25, density}, {0.4, 0.5, 0.05})};
  mill made(space, polydisperse{}, gravity{}, contact, forces.effect(density), moving_bodies<>{}, velocity_verlet{});
  auto const s = walls();
  auto const mesh = indexed_mesh(s.vertices.data(), s.vertices.size() / 3, s.corners.data(), s.triangle_count());
  auto const there = upload(space, mesh);
  body turning{0, s.triangle_count(), {}};
  turning.motion.axis[1] = 1, turning.motion.axis[2] = 0;
  turning.motion.rate = rate;
  made.set_mesh(there.view(), {turning});
  auto const spheres = upload(space, spheres_xyz(grains.centres.data(), wanted, grains.radii.data()));
  buffer<double> velocities;
  space.copy_from_host(velocities.reserve(space.resource(), moving.size()), moving.data(), moving.size());
  made.reserve(2 * wanted);  // for lists of neighbours
  made.set(spheres.view(), velocities.data());
  write_vtk_mesh(folder + "walls.vtp", mesh);
  double const ready = seconds();
  write_frame(folder + "begin.vtp", made);
  double const per_frame = seconds() - ready;
  std::fprintf(stderr, "ready after %.1f s, a frame takes %.2f s\n", ready, per_frame);

  // a row of the curve, and of the last twelfth of a turn a frame, after so many steps
  int const rows = lifters * frames;
  double const row = 2 * io::pi / rate / rows;
  auto const every = static_cast<std::size_t>(std::ceil(row / largest_time_step(made)));
  double const dt = row / static_cast<double>(every);
  auto last = static_cast<int>(std::ceil(turns * rows));
  std::ofstream curve(folder + "torque.csv");
  curve << "time,turns,torque,power\n";
  std::vector<vtk_frame> film;
  char line[512] = "";
  double spent = 0;
  for (int k = 1; k <= last; ++k) {
    forces.clear(space);
    double const start = seconds();
    made.steps(every, dt);
    space.synchronize();
    double const took = seconds() - start;
    spent += took;
    if (seconds() + frames * (took + per_frame) > most_seconds) last = std::min(last, k + frames);
    std::size_t const steps = every * static_cast<std::size_t>(k);
    if (k % frames == 1 || k == last)
      std::fprintf(stderr, "%d of %d rows after %.1f s, %.1f steps a second\n", k, last, seconds(),
                   static_cast<double>(every) / took);
    double const torque = -forces.read(space)[0].angular[1] / row;
    curve << made.time() << "," << static_cast<double>(k) / rows << "," << torque << "," << torque * rate << std::endl;
    if (k <= last - frames) continue;
    film.push_back({"grains-" + std::to_string(1000 + film.size()) + ".vtp", made.time()});
    write_frame(folder + film.back().file, made);
    write_vtk_film(folder + "film.pvd", film);
    std::snprintf(line, sizeof line,
                  "{\"particles\": %zu, \"triangles\": %zu, \"steps\": %zu, \"dt\": %.6g, \"ms_per_step\": %.6g, "
                  "\"rate\": %g, \"mean_radius\": %.6g, \"device\": \"%s\"}\n",
                  made.size(), s.triangle_count(), steps, dt, 1e3 * spent / static_cast<double>(steps), rate, usual,
                  device::name().c_str());
    std::ofstream(folder + "mill.json") << line;
  }
  std::fputs(line, stdout);
} catch (std::exception const& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
