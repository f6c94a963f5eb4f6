/// \file
/// The scenes of a common benchmark of granular codes, M. Dosta et al., Computer Physics Communications 296, 2024: a
/// ball falls into a bed of grains, a drum turns grains of two kinds, grains flow out of a silo. Beds are made here, to
/// the published dimensions, or read from a file. Writes a curve as CSV, and what it cost to the standard error.
/// Compiled by nvcc (-x cu) it runs on a GPU.
///
/// Usage: granular_benchmark penetration|drum|silo [OPTION VALUE]...
///   spheres N    grains: 25000, 38000 and 100000
///   centres FILE reads the bed, at rest: radius, x, y, z of each grain, one a line; a first line of words is skipped
///   rest T       for how long grains that are laid here come to rest: 0.2, 0.3 and 1 s
///   bed FILE     writes the bed, once it is at rest
///   steps N      how far: those of 0.1 s, 5 s and 5 s
///   every N      steps between two lines of the curve
///   start T      penetration: the ball has fallen for this time through the air, and the bed has not moved
///   law NAME     liggghts, lammps or mercury: variants of Hertz' and Mindlin's contact
///   soft 1       drum: grains a 500th as stiff, with steps of 1e-4 s
///   wide 1       silo: the large orifice
///   second 1     silo: grains of the second material, with steps of 2e-6 s
///   threads N    of the host: 1
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/absorb.hpp>
#include <collide/effects/bodies.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/lost_motion.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/simulation.cuh>
#include <collide/simulation/energy.hpp>
#include <collide/spaces/upload.hpp>

#if defined(__CUDACC__)
#include <thrust/device_vector.h>

#include <collide/cuda.cuh>
#endif

namespace {

using namespace collide;
using law = granular_contact<hertz, mindlin, none, none, materials<3>>;
#if defined(__CUDACC__)
using space_type = cuda_shared;
template <class T>
using array = thrust::device_vector<T>;
#else
using space_type = host;
template <class T>
using array = std::vector<T>;
#endif
template <class... Effect>
using scene_of = simulation<detector<bucket, karabassi<>, space_type, double>, polydisperse, gravity, lost_motion, law,
                            velocity_verlet, Effect...>;
constexpr double pi = 3.14159265358979323846, g = 9.81;
enum solids : std::uint8_t { m1, m2, steel };

struct wishes {
  std::string scene, centres, bed, variant = "liggghts";
  std::size_t spheres = 0, steps = 0, every = 0;
  double start = 0, rest = 0;
  int threads = 1;
  bool is_soft = false, is_wide = false, is_second = false;
};

wishes read(int argc, char** argv) {
  wishes w;
  if (argc < 2 || argc % 2 != 0)
    throw std::runtime_error("usage: granular_benchmark penetration|drum|silo [OPTION VALUE]...");
  w.scene = argv[1];
  for (int k = 2; k < argc; k += 2) {
    std::string const option = argv[k], value = argv[k + 1];
    if (option == "spheres") {
      w.spheres = std::stoul(value);
    } else if (option == "steps") {
      w.steps = std::stoul(value);
    } else if (option == "every") {
      w.every = std::stoul(value);
    } else if (option == "start") {
      w.start = std::stod(value);
    } else if (option == "centres") {
      w.centres = value;
    } else if (option == "rest") {
      w.rest = std::stod(value);
    } else if (option == "bed") {
      w.bed = value;
    } else if (option == "law") {
      w.variant = value;
    } else if (option == "soft") {
      w.is_soft = value == "1";
    } else if (option == "wide") {
      w.is_wide = value == "1";
    } else if (option == "second") {
      w.is_second = value == "1";
    } else if (option == "threads") {
      w.threads = std::stoi(value);
    } else {
      throw std::runtime_error("there is no option " + option);
    }
  }
  return w;
}

space_type space_of(wishes const& w) {
#if defined(__CUDACC__)
  return static_cast<void>(w), space_type();
#else
  return space_type(w.threads);
#endif
}

law contact(std::string const& variant, bool is_soft = false) {
  law by;
  by.made_of.set(m1, {is_soft ? 2e6 : 1e9, 0.2, 2500});
  by.made_of.set(m2, {is_soft ? 1e6 : 0.5e9, 0.2, 2000});
  by.made_of.set(steel, {210e9, 0.2, 7200});
  by.made_of.set_pair(m1, m1, {0.5, 0.3});
  by.made_of.set_pair(m2, m2, {0.4, 0.4});
  by.made_of.set_pair(m1, m2, {0.45, 0.2});
  by.made_of.set_pair(m1, steel, {0.4, 0.2});
  by.made_of.set_pair(m2, steel, {0.4, 0.2});
  by.made_of.set_pair(steel, steel, {0.6, 0.5});
  by.made_of.wall_material = steel;
  if (variant == "lammps") {
    by.tangential.damping = tangential_damping::of_normal;
    by.tangential.test = slip_test::spring_and_dashpot;
    by.tangential.keeps_length = true;
    by.slip_shortening = 0;
  } else if (variant == "mercury") {
    by.tangential.damping = tangential_damping::none;
    by.tangential.stiffness_factor = 2.0 / 3;
  } else if (variant != "liggghts") {
    throw std::runtime_error("there is no law " + variant);
  }
  return by;
}

/// Grains and walls.
struct grains {
  std::vector<double> centres, velocities, radii, corners;
  std::vector<std::uint8_t> made_of;

  void add(double radius, double x, double y, double z, std::uint8_t solid, double w = 0) {
    for (double c : {x, y, z}) centres.push_back(c);
    for (double c : {0.0, 0.0, w}) velocities.push_back(c);
    radii.push_back(radius);
    made_of.push_back(solid);
  }
  using point = std::array<double, 3>;
  void triangle(point const& a, point const& b, point const& c) {
    for (auto const* p : {&a, &b, &c}) corners.insert(corners.end(), p->begin(), p->end());
  }
  void quad(point const& a, point const& b, point const& c, point const& d) {
    triangle(a, b, c);
    triangle(a, c, d);
  }
  /// Around z: a ring between two circles.
  void ring(double r, double z, double other_r, double other_z, int n = 64) {
    for (int k = 0; k < n; ++k) {
      double const s = 2 * pi * k / n, t = 2 * pi * ((k + 1) % n) / n;
      quad({r * std::cos(s), r * std::sin(s), z}, {r * std::cos(t), r * std::sin(t), z},
           {other_r * std::cos(t), other_r * std::sin(t), other_z},
           {other_r * std::cos(s), other_r * std::sin(s), other_z});
    }
  }
  std::size_t triangles() const { return corners.size() / 9; }
  mesh_view<double> walls(std::size_t n) const { return triangle_soup(corners.data(), n); }
};

/// Grains of a file, those that are smaller than a ball; the material follows from the radius.
void read_bed(grains& of, std::string const& path, std::uint8_t small_of, std::uint8_t large_of) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream numbers(line);
    double r, x, y, z;
    if (numbers >> r >> x >> y >> z && r < 0.005) of.add(r, x, y, z, r > 0.0015 ? large_of : small_of);
  }
  if (of.radii.empty()) throw std::runtime_error("there are no grains in " + path);
}

/// A bed, as `read_bed` reads it.
void write_bed(grains const& of, std::string const& path) {
  std::ofstream file(path);
  file.precision(17);
  for (std::size_t i = 0; i < of.radii.size(); ++i)
    file << of.radii[i] << ' ' << of.centres[3 * i] << ' ' << of.centres[3 * i + 1] << ' ' << of.centres[3 * i + 2]
         << '\n';
  if (!file) throw std::runtime_error("cannot write " + path);
}

/// Loose layers of grains from the height z on, where `is_inside(x, y, z)`; radius and material of grain k are
/// `kind(k)`, cells fit `largest`.
template <class Inside, class Kind>
void fill(grains& of, std::size_t n, double largest, double x, double y, double z, Inside const& is_inside,
          Kind const& kind) {
  double const cell = 2.04 * largest;
  std::uint64_t state = 1;
  auto const uniform = [&] {  // Lehmer's generator
    state = state * 48271 % 2147483647;
    return static_cast<double>(state) / 2147483647 - 0.5;
  };
  for (int layer = 0; of.radii.size() < n; ++layer)
    for (double px = -x + largest; px <= x - largest; px += cell)
      for (double py = -y + largest; py <= y - largest && of.radii.size() < n; py += cell) {
        double const pz = z + 1.02 * largest + layer * cell, shake = 0.03 * largest;
        if (!is_inside(px, py, pz)) continue;
        auto const [radius, solid] = kind(of.radii.size());
        of.add(radius, px + shake * uniform(), py + shake * uniform(), pz, solid);
      }
}

template <class Simulation>
void place(Simulation& made, grains const& of) {
  if constexpr (!space_type::host_accessible) made.reserve(4 * of.radii.size());  // for what contacts remember
  auto const there = upload(made.space(), spheres_xyz(of.centres.data(), of.radii.size(), of.radii.data()));
  made.set(there.view());
  made.template assign<velocity>(array<double>(of.velocities.begin(), of.velocities.end()));
  made.template assign<material>(array<std::uint8_t>(of.made_of.begin(), of.made_of.end()));
}

/// Lets grains that were laid loosely come to rest: soft ones, which lose their speed soon, with longer steps, then as
/// stiff as they are.
template <class Simulation>
void settle(Simulation& made, grains& of, wishes const& w, double time) {
  law const given = made.template effect<law>();
  for (bool const is_soft : {true, false}) {
    law by = given;
    for (int i = 0; i < 3; ++i) {
      if (is_soft) by.made_of.set(i, {2e7, 0.2, 2500});
      for (int k = 0; k <= i; ++k) by.made_of.set_pair(k, i, {0.2, 0.3});
    }
    made.template effect<law>() = by;
    place(made, of);
    double const dt = largest_time_step(made), wanted = w.rest != 0 ? w.rest : time;
    made.steps(static_cast<std::size_t>((is_soft ? wanted : 0.1 * wanted) / dt), dt);
    of.centres = made.template to_host<position>();
  }
  made.template effect<law>() = given;
  if (!w.bed.empty()) write_bed(of, w.bed);
}

/// Seconds: of the processors, or with a GPU on the clock.
double seconds() {
#if defined(__CUDACC__)
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
#else
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
#endif
}

/// Steps, with a line of the curve after every so many; then says what they cost, and of how many grains rounding has
/// swallowed a motion.
template <class Simulation, class Line>
void play(Simulation& made, wishes const& w, char const* columns, std::size_t steps, std::size_t every, double dt,
          Line const& line) {
  if (w.steps != 0) steps = w.steps;
  if (w.every != 0) every = w.every;
  std::fprintf(stderr, "largest overlap to begin with: %.3g radii\n", contact_report(made).largest_overlap);
  std::printf("%s\n", columns);
  double spent = 0;
  for (std::size_t k = 0;; k += every) {
    std::printf("%.6g,", w.start + static_cast<double>(std::min(k, steps)) * dt);
    line();
    std::fflush(stdout);
    if (k >= steps) break;
    double const before = seconds();
    made.steps(std::min(every, steps - k), dt);
    made.space().synchronize();
    spent += seconds() - before;
  }
  std::fprintf(stderr, "%zu spheres, %zu steps, %.2f s, %.3g sphere-steps a second, %zu with lost motion\n",
               made.size(), steps, spent, static_cast<double>(made.size()) * static_cast<double>(steps) / spent,
               lost_particles(made));
}

/// A steel ball of 1 cm radius falls into grains of 1 mm in a box: its height.
void penetrate(wishes const& w) {
  double const x = 0.05, y = 0.03, floor = -0.0902431, top = 0.107757, dt = 5e-7;
  grains all;
  all.quad({-x, -y, floor}, {x, -y, floor}, {x, y, floor}, {-x, y, floor});
  all.quad({-x, -y, floor}, {x, -y, floor}, {x, -y, top}, {-x, -y, top});
  all.quad({-x, y, floor}, {x, y, floor}, {x, y, top}, {-x, y, top});
  all.quad({-x, -y, floor}, {-x, y, floor}, {-x, y, top}, {-x, -y, top});
  all.quad({x, -y, floor}, {x, y, floor}, {x, y, top}, {x, -y, top});
  scene_of<> made(space_of(w), polydisperse{}, gravity{0, 0, -g}, lost_motion{}, contact(w.variant), velocity_verlet{});
  auto const walls = upload(made.space(), all.walls(all.triangles()));
  made.set_mesh(walls.view());
  if (!w.centres.empty()) {
    read_bed(all, w.centres, m1, m1);
  } else {
    fill(
        all, w.spheres != 0 ? w.spheres : 25000, 0.001, x, y, floor, [](double, double, double) { return true; },
        [](std::size_t) { return std::make_pair(0.001, std::uint8_t(m1)); });
    settle(made, all, w, 0.2);
  }
  all.add(0.01, 0, 0, 0.06 - 5 * w.start - 0.5 * g * w.start * w.start, steel, -5 - g * w.start);
  place(made, all);
  play(made, w, "time,height,speed", 200000, 100, dt, [&] {
    std::size_t const at = 3 * (all.radii.size() - 1) + 2;
    std::printf("%.10g,%.10g\n", made.to_host<position>()[at], made.to_host<velocity>()[at]);
  });
}

/// A drum with 8000 large and 30000 small grains turns at 2 rad/s: how many of each are in two opposite quarters.
void turn_drum(wishes const& w) {
  double const r = 0.1, half = 0.03, dt = w.is_soft ? 1e-4 : 8e-7;
  grains all;
  constexpr int sides = 314;  // of 2 mm
  all.ring(r, -half, r, half, sides);
  // squares beyond the drum's ends: of triangles that meet in the middle, grains there would ask all
  for (double const end : {-half, half}) all.quad({-r, -r, end}, {r, -r, end}, {r, r, end}, {-r, r, end});
  for (std::size_t k = 0; k < all.corners.size(); k += 3) {  // from around z to around y
    double const old = all.corners[k + 1];
    all.corners[k + 1] = -all.corners[k + 2], all.corners[k + 2] = old;
  }
  body_motion turning;
  scene_of<moving_bodies<>> made(space_of(w), polydisperse{}, gravity{0, 0, -g}, lost_motion{},
                                 contact(w.variant, w.is_soft), velocity_verlet{}, moving_bodies<>{});
  auto const walls = upload(made.space(), all.walls(all.triangles()));
  auto const set_mesh = [&] { made.set_mesh(walls.view(), {body{0, all.triangles(), turning}}); };
  set_mesh();
  if (!w.centres.empty()) {
    read_bed(all, w.centres, m1, m2);
  } else {
    fill(
        all, w.spheres != 0 ? w.spheres : 38000, 0.002, r, half, -r,
        [&](double x, double, double z) { return std::hypot(x, z) < r - 0.0022; },
        [](std::size_t k) {
          bool const is_large = k % 19 < 4;
          return std::make_pair(is_large ? 0.002 : 0.001, std::uint8_t(is_large ? m2 : m1));
        });
    settle(made, all, w, 0.3);
  }
  turning.axis[1] = 1, turning.axis[2] = 0;
  turning.rate = 2;
  place(made, all);
  set_mesh();
  play(made, w, "time,small_lower_left,large_lower_left,small_upper_right,large_upper_right",
       w.is_soft ? 50000 : 6250000, w.is_soft ? 100 : 12500, dt, [&] {
         auto const x = made.to_host<position>();
         std::array<int, 4> in{};
         for (std::size_t i = 0; i < all.radii.size(); ++i) {
           bool const left = x[3 * i] < 0, low = x[3 * i + 2] < 0;
           if (left == low) ++in[std::size_t(all.made_of[i] == m2) + (low ? 0 : 2)];
         }
         std::printf("%d,%d,%d,%d\n", in[0], in[1], in[2], in[3]);
       });
}

/// Grains of 2 mm flow out of a silo with a cone of 45 degrees and an orifice of 2 or 3 cm radius: how many are above
/// it.
void empty_silo(wishes const& w) {
  double const size = 0.002, r = 0.1, orifice = w.is_wide ? 0.03 : 0.02, foot = w.is_wide ? 0.014578 : 0.020699;
  double const top = foot + 0.3, low = foot - (r - orifice), dt = w.is_second ? 2e-6 : 1.5e-6;
  std::uint8_t const solid = w.is_second ? m2 : m1;
  grains all;
  all.ring(r, foot, r, top + 0.6);  // higher: the bed is loose to begin with
  all.ring(r, foot, orifice, low);
  std::size_t const open = all.triangles();
  all.quad({-orifice, -orifice, low}, {orifice, -orifice, low}, {orifice, orifice, low}, {-orifice, orifice, low});
  absorbing_box const below{{-1, -1, -2}, {1, 1, low - 0.02}};
  scene_of<absorbing_box> made(space_of(w), polydisperse{}, gravity{0, 0, -g}, lost_motion{}, contact(w.variant),
                               velocity_verlet{}, below);
  auto const closed = upload(made.space(), all.walls(all.triangles())), walls = upload(made.space(), all.walls(open));
  made.set_mesh(closed.view());
  if (!w.centres.empty()) {
    read_bed(all, w.centres, solid, solid);
  } else {
    fill(
        all, w.spheres != 0 ? w.spheres : 100000, size, r, r, low,
        [&](double x, double y, double z) { return std::hypot(x, y) < std::min(r, orifice + z - low) - 1.5 * size; },
        [&](std::size_t) { return std::make_pair(size, solid); });
    settle(made, all, w, 1);
  }
  place(made, all);
  made.set_mesh(walls.view());
  play(made, w, "time,above", w.is_second ? 2500000 : 3333333, w.is_second ? 5000 : 6667, dt, [&] {
    auto const x = made.to_host<position>();
    auto const is_there = made.to_host<alive>();
    int above = 0;
    for (std::size_t i = 0; i < is_there.size(); ++i) above += is_there[i] != 0 && x[3 * i + 2] > low;
    std::printf("%d\n", above);
  });
}

}  // namespace

int main(int argc, char** argv) {
  try {
    wishes const w = read(argc, argv);
    if (w.scene == "penetration") {
      penetrate(w);
    } else if (w.scene == "drum") {
      turn_drum(w);
    } else if (w.scene == "silo") {
      empty_silo(w);
    } else {
      throw std::runtime_error("there is no scene " + w.scene);
    }
  } catch (std::exception const& e) {
    std::fprintf(stderr, "granular_benchmark: %s\n", e.what());
    return 1;
  }
}
