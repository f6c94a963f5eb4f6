/// The scenes of a list of effects: some grains over a floor with side walls, or at rest on it; how the mesh moves; and
/// the parameters of effects, which a hunt draws.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <type_traits>
#include <vector>

#include <collide/effects/contact_work.hpp>
#include <collide/effects/external_forces.hpp>
#include <collide/effects/lost.hpp>
#include <collide/effects/lost_motion.hpp>
#include <collide/effects/mass_flow.hpp>
#include <collide/effects/wear.hpp>
#include <collide/simulation/energy.hpp>

#include "ranks/simulations.hpp"

namespace tests::pairs {

/// The parts of a list's mesh that may move.
enum class mesh_kind { fixed, moving, driven };

/// How the mesh moves; the second and third are one body.
enum class surface { at_rest, body, driven_body, deforming };

/// A list of effects, and the mesh that it needs.
template <mesh_kind Kind, class NarrowPhase, class S, class... Effect>
struct scene_list {};

/// From what a scene is made. Seed 0: with the usual numbers; otherwise they are drawn.
struct trial {
  surface how = surface::at_rest;
  std::uint64_t seed = 0;

  /// The usual number, or one between two bounds, with even logarithm. The same for the same `which`.
  double draw(double usual, double least, double most, std::uint64_t which) const {
    if (seed == 0) return usual;
    return least * std::pow(most / least, uniform(which));
  }
  /// A number from 0 to 1, of splitmix64 (Steele, Lea and Flood 2014).
  double uniform(std::uint64_t which) const {
    std::uint64_t x = seed * 0x9e3779b97f4a7c15u + which * 0xd1342543de82ef95u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((x ^ (x >> 31)) >> 11) * 0x1p-53;
  }

  double dt() const { return draw(1e-3, 4e-4, 1.4e-3, 0); }
  double restitution() const { return draw(0.5, 0.1, 0.8, 1); }
  /// Of `sphere_contact`, the duration of a collision of two of the larger grains.
  double duration() const { return draw(0.03, 0.02, 0.05, 2); }
};

/// A user's effect: grains have a temperature, which they get from what they touch.
struct warms {
  struct temperature {
    template <class S>
    using value = S;
    template <class S>
    static constexpr S initial = S(20);
  };
  using reads = collide::columns<position>;
  using writes = collide::columns<temperature>;

  double rate = 3;

  template <class Particle, class S>
  COLLIDE_HD void on_mesh_contact(Particle& p, collide::mesh_contact<S>&, S dt) const {
    p[temperature{}] += (S(80) - p[temperature{}]) * (S(rate) * dt);
  }
  template <class Particle, class Seen, class S>
  COLLIDE_HD void on_pair_contact(Particle& p, Seen const& self, Seen const& other, S dt) const {
    p[temperature{}] += (other[temperature{}] - self[temperature{}]) * (S(rate) * dt);
  }
};

/// Forces that change from step to step, as those of a fluid that turns about the middle of the tray.
struct stirs : collide::external_forces<> {
  using reads = collide::columns<position>;
  using writes = collide::columns<collide::velocity, collide::external_force>;

  double size = 0.2;  ///< of a force, at a distance of 1 for a difference of speed of 1

  template <class Particle, class S>
  COLLIDE_HD void end_step(Particle& p, S) const {
    auto const& x = p[position{}];
    p[collide::external_force{}] = (collide::vec3<S>(-x[1], x[0], S(0.2)) - p[collide::velocity{}]) * S(size);
  }
};

constexpr double density = 1000, grain_radius = 0.05, small_grain_radius = 0.04, half_width = 0.25;
constexpr std::size_t steps = 400, newborns = 12;

/// The sums of a list's effects: on bodies, of which there is one, and of mass that flows down between the layers.
struct list_sums : collide::reaction_sums {
  collide::flow_sums flow;
  collide::wear_sums worn;

  template <class Space>
  list_sums(Space const& space, double unit)
      : reaction_sums(space, 1, unit), flow(space, unit), worn(space, 100, unit, unit) {}
};

/// The parameters of an effect.
template <class E>
E parameters(trial const& t, list_sums const& sums, bool several_sizes) {
  if constexpr (std::is_same<E, collide::bounce>::value) {
    return {t.restitution()};
  } else if constexpr (std::is_same<E, collide::drag>::value) {
    return {t.draw(0.5, 0.01, 50, 10), t.draw(0.5, 0.01, 50, 11)};
  } else if constexpr (std::is_same<E, collide::wind<>>::value) {
    return {t.draw(1, 0.01, 50, 12), t.draw(0.5, 0.01, 50, 13), {t.draw(0.5, 0.1, 2, 14), 0, 0}};
  } else if constexpr (std::is_same<E, collide::friction>::value) {
    double const held = t.draw(0.5, 0.01, 2, 15);
    return {held, held * t.draw(0.6, 0.1, 1, 16)};
  } else if constexpr (std::is_same<E, collide::spin>::value) {
    return {t.draw(0.02, 0.001, 0.2, 17)};
  } else if constexpr (std::is_same<E, collide::adhesion>::value) {
    return {t.draw(20, 2, 200, 18), t.draw(0.5, 0.05, 5, 19)};
  } else if constexpr (std::is_same<E, collide::sphere_contact>::value) {
    return collide::sphere_contact::from_restitution(t.draw(0.6, 0.1, 0.95, 20), t.duration(), grain_radius, density,
                                                     t.draw(0.3, 0.01, 1, 21));
  } else if constexpr (collide::detail::is_granular<E>) {  // collisions take about as long as with sphere_contact
    collide::solid const solid{t.draw(2e5, 1e5, 3e5, 26), 0.25, density};
    E law{collide::one_material(solid, {t.draw(0.5, 0.1, 0.8, 27), t.draw(0.3, 0.01, 1, 28), 0.05})};
    if constexpr (std::is_same<decltype(law.normal), collide::linear>::value) law.normal.stiffness = 2850;
    if constexpr (std::is_same<decltype(law.tangential), collide::dashpot>::value) law.tangential.damping = 2;
    return law;
  } else if constexpr (std::is_same<E, collide::sleep>::value) {
    double const speed = t.draw(0.02, 0.001, 0.01, 22);
    int const steps = static_cast<int>(t.draw(20, 60, 120, 23)), at_top = static_cast<int>(2 * speed / (9.81 * t.dt()));
    return {speed, std::max(steps, at_top + 2)};  // what flies does not sleep
  } else if constexpr (std::is_same<E, collide::emit>::value) {
    return {t.draw(40, 1, 400, 24), {{0, 0, 0.6}, 0.1, {0, 0, -1}, 0.2}, several_sizes ? small_grain_radius : 0};
  } else if constexpr (std::is_same<E, collide::absorbing_box>::value) {
    return {{-0.3, -0.3, 0}, {-0.1, -0.1, 0.12}};
  } else if constexpr (std::is_same<E, collide::box_walls>::value) {
    return {{-0.27, -0.27, -0.1}, {0.27, 0.27, 1}, t.draw(0.7, 0.1, 0.9, 25)};
  } else if constexpr (std::is_same<E, collide::periodic_box>::value) {
    return {{-0.3, -0.3, -0.5}, {0.3, 0.3, 1}};
  } else if constexpr (std::is_same<E, collide::mesh_forces>::value || std::is_same<E, collide::pair_forces>::value) {
    return {density};
  } else if constexpr (std::is_same<E, stirs>::value) {
    return {{{density}}, t.draw(0.2, 0.01, 2, 29)};
  } else if constexpr (std::is_same<E, collide::mass_flow<>>::value) {
    return sums.flow.through({0, 0, 0.1}, {0, 0, -1}, collide::one_density{density});
  } else if constexpr (std::is_same<E, collide::wear<>>::value) {
    return sums.worn.effect(collide::one_density{density});
  } else if constexpr (std::is_same<E, collide::contact_work<>>::value) {
    return {{density}};
  } else if constexpr (std::is_same<E, collide::reaction>::value) {
    return sums.effect(density);
  } else {
    return {};
  }
}

/// A square, in half widths of the box.
template <class S>
void add_side(world<S>& w, std::array<double, 3> a, std::array<double, 3> b, std::array<double, 3> c,
              std::array<double, 3> d) {
  for (auto* p : {&a, &b, &c, &d})
    for (double& x : *p) x *= half_width;
  w.triangle({a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]});
  w.triangle({a[0], a[1], a[2], c[0], c[1], c[2], d[0], d[1], d[2]});
}

/// A floor with side walls.
template <class S>
void add_tray(world<S>& w) {
  add_side(w, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
  add_side(w, {-1, -1, 0}, {1, -1, 0}, {1, -1, 2}, {-1, -1, 2});
  add_side(w, {-1, 1, 0}, {1, 1, 0}, {1, 1, 2}, {-1, 1, 2});
  add_side(w, {-1, -1, 0}, {-1, 1, 0}, {-1, 1, 2}, {-1, -1, 2});
  add_side(w, {1, -1, 0}, {1, 1, 0}, {1, 1, 2}, {1, -1, 2});
}

/// 32 grains in two layers, which move slowly, and fall.
template <class S>
world<S> falling_grains(trial const& t, bool several_sizes) {
  world<S> w;
  w.radius = S(grain_radius);
  std::mt19937_64 engine(17 + t.seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  double const speed = t.draw(0.3, 0.01, 2, 30);
  for (int i = 0; i < 32; ++i) {
    double const x = i % 4 - 1.5, y = i / 4 % 4 - 1.5, z = i / 16;
    w.particle(0.12 * x + 0.006 * uniform(engine), 0.12 * y + 0.006 * uniform(engine),
               0.08 + 0.11 * z + 0.01 * uniform(engine), speed * uniform(engine), speed * uniform(engine),
               -0.6 + 0.2 * uniform(engine));
    if (several_sizes) w.radii.push_back(S(i % 3 == 0 ? grain_radius : small_grain_radius));
  }
  add_tray(w);
  return w;
}

/// Four grains that fall a little, apart, and lie on the floor then.
template <class S>
world<S> lying_grains(bool several_sizes) {
  world<S> w;
  w.radius = S(grain_radius);
  for (int i = 0; i < 4; ++i) {
    w.particle(0.18 * (i % 2) - 0.06, 0.18 * (i / 2) - 0.06, grain_radius + 0.01);
    if (several_sizes) w.radii.push_back(S(i % 2 == 0 ? grain_radius : small_grain_radius));
  }
  add_tray(w);
  return w;
}

}  // namespace tests::pairs
