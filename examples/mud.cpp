/// \file
/// Mud is thrown at a slope, splats, and slides down; what is left on it sticks.

#include <collide/effects/adhesion.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/effects/bounds.hpp>
#include <collide/effects/friction.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/sphere_contact.hpp>

#include "io/cohesion.hpp"
#include "io/film_program.hpp"
#include "io/scenes/surfaces.hpp"

namespace {

using namespace collide;
using io::cohesion;

/// Shovelfuls of mud, one after the other in other directions.
struct shovel {
  double each, width;

  template <class S>
  COLLIDE_HD void operator()(std::uint64_t number, vec3<S>& x, vec3<S>& v) const {
    io::spot const at(number), aim(static_cast<std::uint64_t>(static_cast<double>(number) / each));
    x = {S(-0.6), S(width * at.evenly[0]), S(0.6 + width * at.evenly[1])};
    v = {S(4.5), S(1.5 * aim.evenly[0] + 0.3 * at.anyhow[0]), S(1.4 + 0.6 * aim.evenly[1] + 0.3 * at.anyhow[1])};
  }
};

template <class Space>
using mud = simulation<detector<bucket, karabassi<>, Space>, emit_from<shovel>, gravity, sphere_contact, cohesion,
                       bounce, friction, adhesion, box_walls>;

constexpr double half = 0.7, size = 0.014, duration = 0.008;

constexpr auto make = [](auto space, io::film const& film) {
  return mud<decltype(space)>(
      space, emit_from<shovel>{film.rate(), {static_cast<double>(film.particles) / 6, 0.1}}, gravity{},
      sphere_contact::from_restitution(0.15, duration, size, 1800, 0.1), cohesion{20}, bounce{0}, friction{0.3, 0.2},
      adhesion{60, 8},
      box_walls{{-box_walls::none, -half, -box_walls::none}, {box_walls::none, half, box_walls::none}, 0});
};

/// Level ground, which rises to a slope that is steep and uneven.
io::scene stage() {
  io::scene s;
  s.radius = size;
  io::add_surface(s, 80, 64, false, [](double across, double along) {
    double const way = 2.4 * across - 1, steepest = 1.15, bend = 0.5;
    double const angle = std::max(0.0, std::min(steepest, way / bend * steepest));
    double const before = std::min(way, 0.0), after = std::max(0.0, way - bend), r = bend / steepest;
    double const y = half * (2 * along - 1), bump = angle * 0.025 * std::sin(11 * way) * std::cos(9 * y + way);
    return io::point{before + r * std::sin(angle) + after * std::cos(angle) - bump * std::sin(angle), y,
                     r * (1 - std::cos(angle)) + after * std::sin(angle) + bump * std::cos(angle)};
  });
  return s;
}

}  // namespace

int main(int argc, char** argv) {
  return io::film_program(
      argc, argv, {"mud", "Mud is thrown at a slope, splats and slides down.", stage(), duration / 20, 6'000, 4, 0.45},
      make);
}
