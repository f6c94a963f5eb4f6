/// The scene of a list of effects: some grains over a floor with side walls, and how the mesh moves.
#pragma once

#include <array>
#include <random>
#include <type_traits>
#include <vector>

#include <collide/effects/lost.hpp>
#include <collide/effects/lost_motion.hpp>

#include "ranks/simulations.hpp"

namespace tests::pairs {

/// How the mesh moves.
enum class surface { at_rest, body, driven_body, deforming };

/// A list of effects, and the scene that it is in.
template <surface Surface, class NarrowPhase, class S, class... Effect>
struct scene_list {};

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

constexpr double dt = 1e-3, density = 1000, grain_radius = 0.05, small_grain_radius = 0.04, half_width = 0.25;
constexpr std::size_t steps = 400, newborns = 12;

/// The parameters of an effect in all scenes.
template <class E>
E parameters(collide::reaction_sums const& sums, bool several_sizes) {
  if constexpr (std::is_same<E, collide::drag>::value) {
    return {0.5, 0.5};
  } else if constexpr (std::is_same<E, collide::wind<>>::value) {
    return {1, 0.5, {0.5, 0, 0}};
  } else if constexpr (std::is_same<E, collide::friction>::value) {
    return {0.5, 0.3};
  } else if constexpr (std::is_same<E, collide::spin>::value) {
    return {0.02};
  } else if constexpr (std::is_same<E, collide::adhesion>::value) {
    return {20, 0.5};
  } else if constexpr (std::is_same<E, collide::sphere_contact>::value) {
    return collide::sphere_contact::from_restitution(0.6, 0.03, grain_radius, density, 0.3);
  } else if constexpr (std::is_same<E, collide::sleep>::value) {
    return {0.02, 20};
  } else if constexpr (std::is_same<E, collide::emit>::value) {
    return {40, {{0, 0, 0.6}, 0.1, {0, 0, -1}, 0.2}, several_sizes ? small_grain_radius : 0};
  } else if constexpr (std::is_same<E, collide::absorbing_box>::value) {
    return {{-0.3, -0.3, 0}, {-0.1, -0.1, 0.12}};
  } else if constexpr (std::is_same<E, collide::box_walls>::value) {
    return {{-0.27, -0.27, -0.1}, {0.27, 0.27, 1}, 0.7};
  } else if constexpr (std::is_same<E, collide::periodic_box>::value) {
    return {{-0.3, -0.3, -0.5}, {0.3, 0.3, 1}};
  } else if constexpr (std::is_same<E, collide::mesh_forces>::value || std::is_same<E, collide::pair_forces>::value) {
    return {density};
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

/// 32 grains in two layers, which move slowly, and fall.
template <class S>
world<S> grains(bool several_sizes) {
  world<S> w;
  w.radius = S(grain_radius);
  std::mt19937 engine(17);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 32; ++i) {
    double const x = i % 4 - 1.5, y = i / 4 % 4 - 1.5, z = i / 16;
    w.particle(0.12 * x + 0.006 * uniform(engine), 0.12 * y + 0.006 * uniform(engine),
               0.08 + 0.11 * z + 0.01 * uniform(engine), 0.3 * uniform(engine), 0.3 * uniform(engine),
               -0.6 + 0.2 * uniform(engine));
    if (several_sizes) w.radii.push_back(S(i % 3 == 0 ? grain_radius : small_grain_radius));
  }
  add_side(w, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
  add_side(w, {-1, -1, 0}, {1, -1, 0}, {1, -1, 2}, {-1, -1, 2});
  add_side(w, {-1, 1, 0}, {1, 1, 0}, {1, 1, 2}, {-1, 1, 2});
  add_side(w, {-1, -1, 0}, {-1, 1, 0}, {-1, 1, 2}, {-1, -1, 2});
  add_side(w, {1, -1, 0}, {1, 1, 0}, {1, 1, 2}, {1, -1, 2});
  return w;
}

}  // namespace tests::pairs
