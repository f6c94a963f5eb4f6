/// \file
/// The scenes of a common benchmark of granular codes, M. Dosta et al., Computer Physics Communications 296, 2024: a
/// ball falls into a bed of grains, a drum turns grains of two kinds, grains flow out of a silo. Beds are made here, to
/// the published dimensions, or read from a file. Writes a curve as CSV, and what it cost to the standard error.
///
/// Usage: granular_benchmark penetration|drum|silo [OPTION VALUE]...
///   spheres N    grains: 25000, 38000 and 100000
///   centres FILE reads the bed, at rest: radius, x, y, z of each grain, one a line; a first line of words is skipped
///   steps N      how far: those of 0.1 s, 5 s and 5 s
///   start T      penetration: the ball has fallen for this time through the air, and the bed has not moved
///   law NAME     liggghts, lammps or mercury: variants of Hertz' and Mindlin's contact
///   soft 1       drum: grains a 500th as stiff, with steps of 1e-4 s
///   threads N    of the host: 1
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <collide/bodies.hpp>
#include <collide/bucket.cuh>
#include <collide/effects/absorb.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/integrators.hpp>
#include <collide/simulation.cuh>

namespace {

using namespace collide;
using law = granular_contact<hertz, mindlin, none, none, materials<3>>;
using detector_type = detector<bucket, karabassi<>, host, double>;
constexpr double pi = 3.14159265358979323846, g = 9.81;
enum solids : std::uint8_t { m1, m2, steel };

struct wishes {
  std::string scene, centres, variant = "liggghts";
  std::size_t spheres = 0, steps = 0;
  double start = 0;
  int threads = 1;
  bool is_soft = false;
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
    } else if (option == "start") {
      w.start = std::stod(value);
    } else if (option == "centres") {
      w.centres = value;
    } else if (option == "law") {
      w.variant = value;
    } else if (option == "soft") {
      w.is_soft = value == "1";
    } else if (option == "threads") {
      w.threads = std::stoi(value);
    } else {
      throw std::runtime_error("there is no option " + option);
    }
  }
  return w;
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
};

/// Grains of a file, those that are smaller than a ball; the material follows from the radius.
void read_bed(grains& of, std::string const& path, bool two_kinds) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream numbers(line);
    double r, x, y, z;
    if (numbers >> r >> x >> y >> z && r < 0.005) of.add(r, x, y, z, two_kinds && r > 0.0015 ? m2 : m1);
  }
  if (of.radii.empty()) throw std::runtime_error("there are no grains in " + path);
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
  made.set(spheres_xyz(of.centres.data(), of.radii.size(), of.radii.data()), of.velocities.data());
  made.template assign<material>(of.made_of);
}

/// Lets grains that were laid loosely come to rest: soft ones, which lose their speed soon, with longer steps.
template <class Simulation>
void settle(Simulation& made, grains& of, double time) {
  auto& by = made.template effect<law>();
  law const stiff = by;
  for (int i = 0; i < 3; ++i) by.made_of.set(i, {2e7, 0.2, 2500});
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k <= i; ++k) by.made_of.set_pair(k, i, {0.2, 0.3});
  place(made, of);
  double const dt = largest_time_step(made);
  made.steps(static_cast<std::size_t>(time / dt), dt);
  of.centres = made.template to_host<position>();
  made.template effect<law>() = stiff;
}

/// Steps, with a line of the curve after every so many. Returns the processor's time.
template <class Simulation, class Line>
double play(Simulation& made, std::size_t steps, std::size_t every, double dt, double start, Line const& line) {
  double spent = 0;
  for (std::size_t k = 0;; k += every) {
    std::printf("%.6g,", start + static_cast<double>(std::min(k, steps)) * dt);
    line();
    std::fflush(stdout);
    if (k >= steps) return spent;
    std::clock_t const before = std::clock();
    made.steps(std::min(every, steps - k), dt);
    made.space().synchronize();
    spent += static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  }
}

void say_cost(std::size_t spheres, std::size_t steps, double spent) {
  std::fprintf(stderr, "%zu spheres, %zu steps, %.2f s of processors, %.3g sphere-steps a second\n", spheres, steps,
               spent, static_cast<double>(spheres) * static_cast<double>(steps) / spent);
}

/// A steel ball of 1 cm radius falls into grains of 1 mm in a box: its height.
void penetrate(wishes const& w) {
  using scene = simulation<detector_type, polydisperse, gravity, law, velocity_verlet>;
  double const x = 0.05, y = 0.03, floor = -0.0902431, top = 0.107757, dt = 5e-7;
  grains all;
  all.quad({-x, -y, floor}, {x, -y, floor}, {x, y, floor}, {-x, y, floor});
  all.quad({-x, -y, floor}, {x, -y, floor}, {x, -y, top}, {-x, -y, top});
  all.quad({-x, y, floor}, {x, y, floor}, {x, y, top}, {-x, y, top});
  all.quad({-x, -y, floor}, {-x, y, floor}, {-x, y, top}, {-x, -y, top});
  all.quad({x, -y, floor}, {x, y, floor}, {x, y, top}, {x, -y, top});
  scene made(host(w.threads), polydisperse{}, gravity{0, 0, -g}, contact(w.variant), velocity_verlet{});
  made.set_mesh(triangle_soup(all.corners.data(), all.triangles()));
  if (!w.centres.empty()) {
    read_bed(all, w.centres, false);
  } else {
    fill(
        all, w.spheres != 0 ? w.spheres : 25000, 0.001, x, y, floor, [](double, double, double) { return true; },
        [](std::size_t) { return std::make_pair(0.001, std::uint8_t(m1)); });
    settle(made, all, 0.2);
  }
  all.add(0.01, 0, 0, 0.06 - 5 * w.start - 0.5 * g * w.start * w.start, steel, -5 - g * w.start);
  place(made, all);
  std::size_t const steps = w.steps != 0 ? w.steps : 200000;
  std::printf("time,height,speed\n");
  double const spent = play(made, steps, 100, dt, w.start, [&] {
    std::size_t const at = 3 * (all.radii.size() - 1) + 2;
    std::printf("%.10g,%.10g\n", made.to_host<position>()[at], made.to_host<velocity>()[at]);
  });
  say_cost(all.radii.size(), steps, spent);
}

/// A drum with 8000 large and 30000 small grains turns at 2 rad/s: how many of each are in two opposite quarters.
void turn_drum(wishes const& w) {
  using scene = simulation<detector_type, polydisperse, gravity, law, velocity_verlet, moving_bodies<>>;
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
  scene made(host(w.threads), polydisperse{}, gravity{0, 0, -g}, contact(w.variant, w.is_soft), velocity_verlet{},
             moving_bodies<>{});
  auto const set_mesh = [&] {
    made.set_mesh(triangle_soup(all.corners.data(), all.triangles()), {body{0, all.triangles(), turning}});
  };
  set_mesh();
  if (!w.centres.empty()) {
    read_bed(all, w.centres, true);
  } else {
    fill(
        all, w.spheres != 0 ? w.spheres : 38000, 0.002, r, half, -r,
        [&](double x, double, double z) { return std::hypot(x, z) < r - 0.0022; },
        [](std::size_t k) {
          bool const is_large = k % 19 < 4;
          return std::make_pair(is_large ? 0.002 : 0.001, std::uint8_t(is_large ? m2 : m1));
        });
    settle(made, all, 0.3);
  }
  turning.axis[1] = 1, turning.axis[2] = 0;
  turning.rate = 2;
  place(made, all);
  set_mesh();
  std::size_t const steps = w.steps != 0 ? w.steps : w.is_soft ? 50000 : 6250000;
  std::printf("time,small_lower_left,large_lower_left,small_upper_right,large_upper_right\n");
  double const spent = play(made, steps, w.is_soft ? 100 : 12500, dt, 0, [&] {
    auto const x = made.to_host<position>();
    std::array<int, 4> in{};
    for (std::size_t i = 0; i < all.radii.size(); ++i) {
      bool const left = x[3 * i] < 0, low = x[3 * i + 2] < 0;
      if (left == low) ++in[std::size_t(all.made_of[i] == m2) + (low ? 0 : 2)];
    }
    std::printf("%d,%d,%d,%d\n", in[0], in[1], in[2], in[3]);
  });
  say_cost(all.radii.size(), steps, spent);
}

/// Grains of 2 mm flow out of a silo with a cone of 45 degrees and an orifice of 2 cm radius: how many are above it.
void empty_silo(wishes const& w) {
  using scene = simulation<detector_type, polydisperse, gravity, law, absorbing_box, velocity_verlet>;
  double const r = 0.1, orifice = 0.02, foot = 0.020699, top = 0.320699, low = foot - (r - orifice), dt = 1.5e-6;
  grains all;
  all.ring(r, foot, r, top + 0.6);  // higher: the bed is loose to begin with
  all.ring(r, foot, orifice, low);
  std::size_t const open = all.triangles();
  all.ring(orifice, low, 0, low);  // the lid
  absorbing_box const below{{-1, -1, -2}, {1, 1, low - 0.02}};
  scene made(host(w.threads), polydisperse{}, gravity{0, 0, -g}, contact(w.variant), below, velocity_verlet{});
  made.set_mesh(triangle_soup(all.corners.data(), all.triangles()));
  if (!w.centres.empty()) {
    read_bed(all, w.centres, false);
  } else {
    fill(
        all, w.spheres != 0 ? w.spheres : 100000, 0.002, r, r, low,
        [&](double x, double y, double z) { return std::hypot(x, y) < std::min(r, orifice + z - low) - 0.003; },
        [](std::size_t) { return std::make_pair(0.002, std::uint8_t(m1)); });
    settle(made, all, 1);
  }
  place(made, all);
  made.set_mesh(triangle_soup(all.corners.data(), open));
  std::size_t const steps = w.steps != 0 ? w.steps : 3333333;
  std::printf("time,above\n");
  double const spent = play(made, steps, 6667, dt, 0, [&] {
    auto const x = made.to_host<position>();
    auto const is_there = made.to_host<alive>();
    int above = 0;
    for (std::size_t i = 0; i < is_there.size(); ++i) above += is_there[i] != 0 && x[3 * i + 2] > low;
    std::printf("%d\n", above);
  });
  say_cost(all.radii.size(), steps, spent);
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
