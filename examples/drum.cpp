/// \file
/// Grains of two colours are poured into a drum with lifters, which turns on two rollers and mixes them.

#include <collide/bodies.hpp>
#include <collide/bounce.hpp>
#include <collide/bounds.hpp>
#include <collide/friction.hpp>
#include <collide/gravity.hpp>
#include <collide/sphere_contact.hpp>

#include "io/film.hpp"

namespace {

using namespace collide;

/// Grains fall from a slot inside the drum.
struct slot {
  double half_length, half_width, height;

  template <class S>
  COLLIDE_HD void operator()(std::uint64_t number, vec3<S>& x, vec3<S>& v) const {
    io::spot const at(number);
    x = {S(half_length * at.evenly[0]), S(half_width * at.evenly[1]), S(height)};
    v = {S(0.1 * at.anyhow[0]), S(0.1 * at.anyhow[1]), S(-1)};
  }
};

template <class Space>
using drum = simulation<detector<bucket, karabassi<>, Space>, emit_from<slot>, gravity, sphere_contact, bounce,
                        friction, box_walls, moving_bodies<>>;

constexpr double size = 0.008, duration = 0.008, pi = 3.14159265358979;
constexpr double radius = 0.3, half = 0.1, rate = 1.6;  // of the drum; it ends at two walls
constexpr double roller = 0.06, apart = 0.22;           // of the rollers: radius, and where they are
constexpr int lifters = 8;

constexpr auto make = [](auto space, io::film const& film) {
  double const wall = half, none = box_walls::none;
  return drum<decltype(space)>(space, emit_from<slot>{film.rate(), {0.12, half - 2 * size, 0.12}}, gravity{},
                               sphere_contact::from_restitution(0.4, duration, size, 2500, 0.4), bounce{0.3},
                               friction{0.6, 0.5}, box_walls{{-none, -wall, -none}, {none, wall, none}, 0.3},
                               moving_bodies<>{});
};

/// The height of the rollers' axes, on which the drum lies.
double height() { return -std::sqrt((radius + roller) * (radius + roller) - apart * apart); }

/// Adds a tube around an axis along y through (x, z), of so many sides.
void add_tube(io::scene& s, double x, double z, double r, double longer, std::size_t sides) {
  io::add_surface(s, sides, 4, false, [&](double across, double along) {
    double const u = 2 * pi * across;
    return io::point{x + r * std::cos(u), (half + longer) * (2 * along - 1), z + r * std::sin(u)};
  });
}

/// The drum, two rollers, and the floor. Each body is what has been added since the one before.
io::film scene() {
  io::scene s;
  s.radius = size;
  std::vector<body> bodies;
  auto const add_body = [&](double x, double z, double turning) {
    body b;
    b.first = bodies.empty() ? 0 : bodies.back().first + bodies.back().size;
    b.size = s.triangle_count() - b.first;
    b.motion.pivot[0] = x, b.motion.pivot[2] = z;
    b.motion.axis[1] = 1, b.motion.axis[2] = 0;
    b.motion.rate = turning;
    bodies.push_back(b);
  };
  add_tube(s, 0, 0, radius, 0, 144);
  for (int i = 0; i < lifters; ++i) {
    double const u = 2 * pi * i / lifters;
    io::add_surface(s, 4, 4, false, [&](double across, double along) {
      double const r = radius - 0.04 * across;
      return io::point{r * std::cos(u), half * (2 * along - 1), r * std::sin(u)};
    });
  }
  add_body(0, 0, rate);
  for (double const side : {-apart, apart}) {
    add_tube(s, side, height(), roller, 0.03, 12);  // as many sides that one sees it turn
    add_body(side, height(), -rate * radius / roller);
  }
  double const floor = height() - roller;
  io::add_surface(s, 8, 8, false, [&](double across, double along) {
    return io::point{2.4 * across - 1.2, 1.6 * along - 0.8, floor};
  });
  io::film film{"drum", "A drum turns, and mixes the grains in it.", s, duration / 20, 5'000, 9, 0.2};
  film.bodies = bodies;
  return film;
}

}  // namespace

int main(int argc, char** argv) { return io::film_program(argc, argv, scene(), make); }
