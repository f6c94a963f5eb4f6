/// \file
/// Grains of two colours are poured into a drum with lifters, which turns on two rollers and mixes them.

#include <collide/effects/bodies.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/effects/bounds.hpp>
#include <collide/effects/friction.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/sphere_contact.hpp>

#include "io/film_program.hpp"
#include "io/scenes/solids.hpp"

namespace {

using namespace collide;
using io::operator+, io::operator*;

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

constexpr double size = 0.008, duration = 0.008;
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

/// The drum, two rollers, and the floor.
io::film scene() {
  io::film film{"drum", "A drum turns, and mixes the grains in it.", {}, duration / 20, 5'000, 9, 0.2};
  auto& s = film.stage;
  s.radius = size;
  io::add_tube(s, {0, -half, 0}, {0, half, 0}, radius, 144);
  for (int i = 0; i < lifters; ++i) {
    double const u = 2 * io::pi * i / lifters;
    io::point const outwards{std::cos(u), 0, std::sin(u)};
    io::add_plate(s, (radius - 0.04) * outwards + io::point{0, -half, 0}, 0.04 * outwards, {0, 2 * half, 0});
  }
  io::add_body(film, io::turning({0, 0, 0}, {0, 1, 0}, rate));
  for (double const side : {-apart, apart}) {  // of so few sides that one sees them turn
    io::add_tube(s, {side, -half - 0.03, height()}, {side, half + 0.03, height()}, roller, 12);
    io::add_body(film, io::turning({side, 0, height()}, {0, 1, 0}, -rate * radius / roller));
  }
  io::add_plate(s, {-1.2, -0.8, height() - roller}, {2.4, 0, 0}, {0, 1.6, 0});
  return film;
}

}  // namespace

int main(int argc, char** argv) { return io::film_program(argc, argv, scene(), make); }
