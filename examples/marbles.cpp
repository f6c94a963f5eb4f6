/// \file
/// Marbles roll down a helter-skelter into a bowl, and circle there until they come to rest.

#include <collide/bounce.hpp>
#include <collide/friction.hpp>
#include <collide/gravity.hpp>
#include <collide/sphere_contact.hpp>
#include <collide/spin.hpp>

#include "io/film.hpp"

namespace {

using namespace collide;

template <class Space>
using marbles = simulation<detector<bucket, karabassi<>, Space>, emit, gravity, sphere_contact, bounce, friction, spin>;

constexpr double size = 0.012, duration = 0.008, turn = 2 * 3.14159265358979;
constexpr double turns = 2.25, helix = 0.3, top = 0.75, bottom = 0.3, gutter = 0.04;

constexpr auto make = [](auto space, io::film const& film) {
  double const rate = std::min(film.rate(0.7), 60.0);  // what the gutter takes
  return marbles<decltype(space)>(space, emit{rate, {{helix, 0.02, top - gutter + size}, 0, {0, 1.5, -0.2}, 0.02}},
                                  gravity{}, sphere_contact::of_collision(0.7, duration, size, 2500, 0.2), bounce{0.6},
                                  friction{0.4, 0.3}, spin{0.004});
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
    double const u = turn * across, d = 0.55 * along;
    return io::point{d * std::cos(u), d * std::sin(u), 1.0 * d * d};
  });
  return s;
}

}  // namespace

int main(int argc, char** argv) {
  return io::film_program(
      argc, argv, {"marbles", "Marbles roll down a helter-skelter into a bowl.", stage(), duration / 20, 600, 14},
      make);
}
