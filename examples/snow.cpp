/// \file
/// Snow falls on hilly ground and a statue, sticks to them and piles up.

#include <collide/effects/adhesion.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/effects/bounds.hpp>
#include <collide/effects/drag.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/sleep.hpp>
#include <collide/effects/sphere_contact.hpp>

#include "io/cohesion.hpp"
#include "io/film_program.hpp"
#include "io/scenes/surfaces.hpp"

namespace {

using namespace collide;
using collide::sleep;  // not that of unistd.h
using io::cohesion;

/// Snow comes from everywhere above the ground.
struct sky {
  double half, height, speed;

  template <class S>
  COLLIDE_HD void operator()(std::uint64_t number, vec3<S>& x, vec3<S>& v) const {
    io::spot const at(number);
    x = {S(half * at.evenly[0]), S(half * at.evenly[1]), S(height)};
    v = {S(0.7 * at.anyhow[0]), S(0.7 * at.anyhow[1]), S(-speed)};
  }
};

template <class Space>
using snow = simulation<detector<bucket, karabassi<>, Space>, emit_from<sky>, sleep, gravity, drag, sphere_contact,
                        cohesion, bounce, adhesion, box_walls>;

constexpr double half = 0.7, size = 0.025, speed = 1.4, duration = 0.016;

constexpr auto make = [](auto space, io::film const& film) {
  return snow<decltype(space)>(
      space, emit_from<sky>{film.rate(), {half - size, 1.65, speed}}, sleep{0.05, 40}, gravity{},
      drag{0, 9.81 / (speed * speed)}, sphere_contact::from_restitution(0.2, duration, size, 100, 0.9), cohesion{60},
      bounce{0}, adhesion{200}, box_walls{{-half, -half, -box_walls::none}, {half, half, box_walls::none}, 0});
};

/// Hills, and on them a bumpy ring on a pedestal.
io::scene stage() {
  io::scene s;
  s.radius = size;
  constexpr double turn = 2 * 3.14159265358979;
  io::add_surface(s, 64, 64, false, [](double across, double along) {
    double const x = half * (2 * across - 1), y = half * (2 * along - 1);
    return io::point{x, y, 0.1 * std::sin(4 * x + 1) * std::cos(3 * y) - 0.1};
  });
  io::add_surface(s, 96, 48, true, [](double across, double along) {
    double const u = turn * across, v = turn * along;
    double const r = 0.13 * (1 + 0.15 * std::sin(5 * u) * std::cos(3 * v)), d = 0.36 + r * std::cos(v);
    return io::point{d * std::cos(u), r * std::sin(v), 0.85 + d * std::sin(u)};
  });
  io::add_surface(s, 48, 5, false, [](double across, double along) {
    constexpr double outline[][2] = {{0.4, -0.2}, {0.4, 0.12}, {0.25, 0.16}, {0.22, 0.34}, {0.3, 0.42}, {0, 0.42}};
    auto const& p = outline[std::lround(5 * along)];
    return io::point{p[0] * std::cos(turn * across), p[0] * std::sin(turn * across), p[1]};
  });
  return s;
}

}  // namespace

int main(int argc, char** argv) {
  return io::film_program(
      argc, argv,
      {"snow", "Snow falls on hills and a statue, sticks and piles up.", stage(), duration / 20, 9'000, 6, 0.75}, make);
}
