/// \file
/// Checks of `reaction`: of its place in a list, and with numbers that its sums cannot hold.
#pragma once

#include <limits>
#include <type_traits>
#include <utility>

#include <collide/effects/contact_forces.hpp>

#include "simulation/bodies.hpp"

namespace tests {

/// A contact that gives what is not finite, or too much, is counted, and is in no sum; too large a sum is an error.
template <class Space>
void check_sums_that_do_not_fit(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, double>, bounce, collide::reaction, moving_bodies<>>;
  world<double> w;
  w.radius = 0.1;
  add_floor(w, 5, 1);
  for (int i = 0; i < 8; ++i) w.particle(0.1 * i - 0.4, 0.3, 0.05, 0, 0, -1);
  double const mass = 4.0 / 3 * pi * 1e-3;  // of density 1
  struct sums_after {
    std::uint64_t refused;
    std::vector<std::int64_t> counts, of_triangles;
    std::string said;
  };
  auto const hit = [&](double density, double unit) {
    collide::reaction_sums sums(space, 1, unit, 2);
    running_bodies<simulation> made(space, w, one_body(w, {}), bounce{1}, sums.effect(density), moving_bodies<>{});
    made.simulation.step(1e-6);
    sums_after found{sums.refused(space), {}, {}, ""};
    try {
      found.of_triangles = sums.triangle_counts(space);
      found.counts = sums.counts(space);
    } catch (collide::error const& e) {
      found.said = e.what();
    }
    sums.clear(space);
    CHECK(sums.refused(space) == 0);
    return found;
  };
  auto const fits = hit(1, 2 * mass * 1e-16);
  CHECK(fits.refused == 0);
  CHECK(double(fits.counts[2]) == doctest::Approx(-8e16));
  for (double const unit : {2 * mass * 1e-19, 1e-300}) {
    auto const small = hit(1, unit);
    CHECK(small.refused == 8);
    CHECK(small.counts == std::vector<std::int64_t>(12, 0));
    CHECK(small.of_triangles == std::vector<std::int64_t>(12, 0));
  }
  CHECK(hit(1e308, 1e-300).refused == 8);  // mass over unit is infinite
  w.particle(0, 0.3, 0.05, 0, 0, -1e30);
  w.particle(0, 0.3, 0.05, 0, 0, -2);
  auto const fast = hit(1, 2 * mass * 1e-16);
  CHECK(fast.refused == 0);  // it has gone through the floor
  CHECK(double(fast.counts[2]) == doctest::Approx(-10e16));
  auto const many = hit(1, 2 * mass * 8e-19);
  CHECK(many.refused == 1);  // the one that is twice as fast
  CHECK(many.said ==
        "collide: reaction_sums: a sum is more than 9e18 units: choose a larger unit, or clear more often");
}

/// The sums of `reaction` and all forces of the mesh, of particles that slide, roll and bounce, with a list of effects.
template <class... Effect, class Space>
auto given_to_mesh(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, double>, Effect..., moving_bodies<>>;
  world<double> w;
  w.radius = 0.1;
  add_floor(w, 5, 1);
  for (int i = 0; i < 8; ++i) w.particle(0.3 * i - 1, 0.3, 0.12, 0.5 * i, 0, -0.1 * i);
  collide::reaction_sums sums(space, 1, 1e-12, 2);
  auto const made_of = [&](auto effect) {
    if constexpr (std::is_same_v<decltype(effect), collide::reaction>)
      return sums.effect(1);
    else
      return effect;
  };
  running_bodies<simulation> made(space, w, one_body(w, {}), made_of(Effect())..., moving_bodies<>{});
  for (int i = 0; i < 50; ++i) made.simulation.step(2e-3);
  return std::pair(sums.counts(space), made.simulation.template to_host<collide::mesh_force>());
}

/// Effects that read the impulses of the mesh have all of them, wherever they stand in the list.
template <class Space>
void check_reaction_anywhere(Space const& space) {
  using collide::reaction, collide::mesh_forces, collide::gravity, collide::bounce, collide::friction, collide::spin;
  auto const last = given_to_mesh<gravity, bounce, friction, spin, mesh_forces, reaction>(space);
  CHECK(last.first[0] > 0);  // friction drags the body along
  CHECK(last.first[2] < 0);
  CHECK(given_to_mesh<reaction, mesh_forces, gravity, bounce, friction, spin>(space) == last);
  CHECK(given_to_mesh<spin, gravity, mesh_forces, bounce, reaction, friction>(space) == last);
}

}  // namespace tests
