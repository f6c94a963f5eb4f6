/// \file
/// Marbles roll down a helter-skelter into a bowl, and circle there until they come to rest.

#include <collide/effects/bounce.hpp>
#include <collide/effects/friction.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/effects/spin.hpp>

#include "io/film_program.hpp"
#include "io/scenes/surfaces.hpp"

namespace {

using namespace collide;

template <class Space>
using marbles = simulation<detector<bucket, karabassi<>, Space>, emit, gravity, sphere_contact, bounce, friction, spin>;

constexpr double size = 0.012, duration = 0.008, turn = 2 * 3.14159265358979;
constexpr double turns = 2.25, helix = 0.3, top = 0.7, bottom = 0.38, gutter = 0.04;

constexpr auto make = [](auto space, io::film const& film) {
  return marbles<decltype(space)>(
      space, emit{film.rate(), {{helix, 0.02, top - gutter + size}, 0, {0, 1.5, -0.1}, 0.02}}, gravity{},
      sphere_contact::from_restitution(0.7, duration, size, 2500, 0.2), bounce{0.4}, friction{0.4, 0.3}, spin{0.012});
};

/// A gutter that winds down into a bowl.
io::scene stage() {
  io::scene s;
  s.radius = size;
  io::add_surface(s, 200, 16, false, [](double across, double along) {
    double const u = turn * turns * across, v = turn * (0.62 * along - 0.5);
    double const d = helix + gutter * std::cos(v);
    return io::point{d * std::cos(u), d * std::sin(u), top + (bottom - top) * across + gutter * std::sin(v)};
  });
  io::add_surface(s, 96, 32, false, [](double across, double along) {
    double const u = turn * across, d = 0.6 * along;
    return io::point{d * std::cos(u), d * std::sin(u), d * d * (1.2 + 1.5 * d * d)};
  });
  return s;
}

}  // namespace

int main(int argc, char** argv) {
  return io::film_program(
      argc, argv, {"marbles", "Marbles roll down a helter-skelter into a bowl.", stage(), duration / 20, 400, 14, 0.85},
      make);
}
