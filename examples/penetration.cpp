/// \file
/// A steel ball falls into grains a tenth of its size. Box, sizes and speed are those of a common benchmark of granular
/// codes: M. Dosta et al., Computer Physics Communications 296, 2024. The grains and the steel are softer.

#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/polydisperse.hpp>

#include "io/film_program.hpp"
#include "io/scenes/solids.hpp"

/// An effect of the program's own: what is large is of steel.
struct steel_if_large {
  using reads = collide::columns<collide::radius>;
  using writes = collide::columns<collide::material>;

  template <class Particle, class S>
  COLLIDE_HD void accelerate(Particle& p, S) const {
    p[collide::material{}] = p[collide::radius{}] > S(0.002) ? 1 : 0;
  }
};

namespace {

using namespace collide;

constexpr double size = 0.001, ball = 0.01;                                            // radii
constexpr double half_x = 0.05, half_y = 0.03, floor_at = -0.0902431, top = 0.107757;  // of the box

/// Grains fall from above.
struct chute {
  template <class S>
  COLLIDE_HD void operator()(std::uint64_t number, vec3<S>& x, vec3<S>& v) const {
    io::spot const at(number);
    x = {S((half_x - 2 * size) * at.evenly[0]), S((half_y - 2 * size) * at.evenly[1]), S(0.04)};
    v = {S(0.05 * at.anyhow[0]), S(0.05 * at.anyhow[1]), S(-1)};
  }
};

using law = granular_contact<hertz, mindlin, none, none, materials<2>>;
template <class Space>
using penetration = simulation<detector<bucket, karabassi<>, Space>, emit_from<chute>, polydisperse, gravity, law,
                               steel_if_large, velocity_verlet>;

constexpr auto make = [](auto space, io::film const& film) {
  law contact;
  contact.made_of.set(0, {1e7, 0.2, 2500});
  contact.made_of.set(1, {3e8, 0.2, 7200});
  contact.made_of.set_pair(0, 0, {0.5, 0.3});
  contact.made_of.set_pair(0, 1, {0.4, 0.2});
  contact.made_of.set_pair(1, 1, {0.6, 0.5});
  contact.made_of.wall_material = 1;
  return penetration<decltype(space)>(space, emit_from<chute>{film.rate(), {}, size}, polydisperse{}, gravity{},
                                      contact, steel_if_large{}, velocity_verlet{});
};

/// The ball, where it will be at z = 0.06 with 5 m/s, the benchmark's beginning, after two thirds of the film.
std::vector<io::first_sphere> intruder(io::film const& film) {
  double const time = 2 * film.seconds / 3, speed = 5 - 9.81 * time;
  return {{{0, 0, 0.06 + speed * time + 9.81 / 2 * time * time}, {0, 0, -speed}, ball}};
}

/// The box, open above.
io::film scene() {
  io::film film{"penetration", "A ball falls into grains.", {}, 2e-5, 25'000, 0.42, 0.4};
  auto& s = film.stage;
  s.radius = size;
  film.first = intruder;
  double const x = half_x, y = half_y, high = top - floor_at;
  io::add_plate(s, {-x, -y, floor_at}, {2 * x, 0, 0}, {0, 2 * y, 0});
  for (double const side : {-1.0, 1.0}) {
    io::add_plate(s, {-x, side * y, floor_at}, {2 * x, 0, 0}, {0, 0, high});
    io::add_plate(s, {side * x, -y, floor_at}, {0, 2 * y, 0}, {0, 0, high});
  }
  return film;
}

}  // namespace

int main(int argc, char** argv) { return io::film_program(argc, argv, scene(), make); }
