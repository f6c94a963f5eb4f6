/// \file
/// Grains are poured into a silo with a cone below, and flow out when a gate is drawn away. The silo is that of a
/// common benchmark of granular codes, with the large orifice: M. Dosta et al., Computer Physics Communications 296,
/// 2024. The grains are twice as large, fewer and softer.

#include <collide/effects/absorb.hpp>
#include <collide/effects/bodies.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>

#include "io/film_program.hpp"
#include "io/scenes/solids.hpp"

namespace {

using namespace collide;

/// Grains fall from above.
struct chute {
  double half, height;

  template <class S>
  COLLIDE_HD void operator()(std::uint64_t number, vec3<S>& x, vec3<S>& v) const {
    io::spot const at(number);
    x = {S(half * at.evenly[0]), S(half * at.evenly[1]), S(height)};
    v = {S(0.1 * at.anyhow[0]), S(0.1 * at.anyhow[1]), S(-1)};
  }
};

using law = granular_contact<hertz, mindlin, epsd>;
template <class Space>
using silo = simulation<detector<bucket, karabassi<>, Space>, emit_from<chute>, gravity, law, absorbing_box,
                        velocity_verlet, moving_bodies<>>;

constexpr double size = 0.004;
constexpr double radius = 0.1, orifice = 0.03, foot = 0.014578, top = 0.314578;  // of the cylinder; the cone is of 45°
constexpr double low = foot - (radius - orifice);
constexpr double opens = 1.4, speed = 0.15;  // of the gate: when, and how fast

constexpr auto make = [](auto space, io::film const& film) {
  law const contact{one_material({2e6, 0.2, 2500}, {0.5, 0.3, 0.05})};
  return silo<decltype(space)>(space, emit_from<chute>{film.rate(), {0.06, top}}, gravity{}, contact,
                               absorbing_box{{-1, -1, -9}, {1, 1, low - 0.12}}, velocity_verlet{}, moving_bodies<>{});
};

/// The cylinder with its cone, and the gate.
io::film scene() {
  io::film film{"silo", "Grains flow out of a silo.", {}, 1.5e-4, 4'000, 3, 0.4};
  auto& s = film.stage;
  s.radius = size;
  constexpr double gate = orifice + size, behind = orifice + speed * opens;
  io::add_plate(s, {-behind, -gate, low - size / 4}, {behind + gate, 0, 0}, {0, 2 * gate, 0});
  body_motion drawn;
  drawn.velocity[0] = speed;
  io::add_body(film, drawn);
  auto const add_ring = [&](double r, double z, double to_r, double to_z) {
    io::add_surface(s, 96, 8, false, [=](double across, double along) {
      double const u = 2 * io::pi * across, here = r + along * (to_r - r);
      return io::point{here * std::cos(u), here * std::sin(u), z + along * (to_z - z)};
    });
  };
  add_ring(orifice, low, radius, foot);
  add_ring(radius, foot, radius, top);
  return film;
}

}  // namespace

int main(int argc, char** argv) { return io::film_program(argc, argv, scene(), make); }
