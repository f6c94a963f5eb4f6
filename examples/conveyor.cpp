/// \file
/// A belt lifts grains, throws them onto another one, and that heaps them up on a table that turns.

#include <collide/effects/bodies.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/effects/friction.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/sphere_contact.hpp>

#include "io/film_program.hpp"
#include "io/scenes/solids.hpp"
#include "io/scenes/surfaces.hpp"

namespace {

using namespace collide;
using io::operator+, io::operator-, io::operator*;

template <class Space>
using conveyor =
    simulation<detector<bucket, karabassi<>, Space>, emit, gravity, sphere_contact, bounce, friction, moving_bodies<>>;

constexpr double size = 0.012, duration = 0.008;
constexpr double half = 0.12;  // of the belts' width

constexpr auto make = [](auto space, io::film const& film) {
  return conveyor<decltype(space)>(space, emit{film.rate(), {{-0.48, 0, 0.18}, 0.06, {0, 0, -0.5}, 0.05}}, gravity{},
                                   sphere_contact::from_restitution(0.3, duration, size, 2500, 0.5), bounce{0.2},
                                   friction{0.7, 0.6}, moving_bodies<>{});
};

/// Adds a belt that runs along `way`, with its right edge there, and rollers at its ends. `across` leads to the left.
void add_belt(io::film& film, io::point const& corner, io::point const& way, io::point const& across, double speed) {
  constexpr double roller = 0.04;
  io::point const along = io::normalized(way), up = io::normalized(io::cross(way, across));
  io::add_plate(film.stage, corner, way, across, 16, 4);
  body_motion belt;
  std::copy_n((speed * along).begin(), 3, belt.belt);
  io::add_body(film, belt);
  for (io::point const& end : {corner, corner + way}) {
    io::point const middle = end - 1.05 * roller * up;
    io::add_tube(film.stage, middle, middle + across, roller, 8);
    io::add_body(film, io::turning(middle, io::cross(up, along), speed / roller));
  }
}

/// Two belts, a table, what keeps the grains on them, and the floor.
io::film scene() {
  io::film film{"conveyor", "Belts carry grains to a table that turns.", {}, duration / 20, 1'500, 12, 0.7};
  auto& s = film.stage;
  s.radius = size;
  io::point const foot{-0.65, -half, 0.02}, rise{0.8, 0, 0.29}, height{0, 0, 0.12}, width{0, 2 * half, 0};
  io::point const start{0.47, -0.16, 0.12}, level{0, 0.9, 0}, depth{-0.3, 0, 0};
  io::point const table{0.32, 1.15, -0.1};
  constexpr double radius = 0.42, rim = 0.07;
  add_belt(film, foot, rise, width, 0.7);
  add_belt(film, start, level, depth, 0.5);
  io::add_surface(s, 96, 24, false, [&](double across, double along) {
    double const u = 2 * io::pi * across, way = along * (radius + rim), r = std::min(way, radius);
    return table + io::point{r * std::cos(u), r * std::sin(u), way - r};
  });
  io::add_body(film, io::turning(table, {0, 0, 1}, 1));
  // what follows rests
  io::add_plate(s, foot, rise, height);
  io::add_plate(s, foot + width, rise, height);
  io::add_plate(s, foot, width, {0, 0, 0.4});
  io::add_plate(s, start, level, {0, 0, 0.25});
  io::add_plate(s, start + depth, level, height);
  io::add_plate(s, start, depth, {0, 0, 0.2});
  io::add_plate(s, {-1, -0.5, -0.2}, {2, 0, 0}, {0, 2.4, 0});
  return film;
}

}  // namespace

int main(int argc, char** argv) { return io::film_program(argc, argv, scene(), make); }
