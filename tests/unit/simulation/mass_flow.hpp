/// Mass that flows through a surface, in a space; instantiated by test_coupling.cpp and test_effects_cuda.cpp.
#pragma once

#include <collide/effects/absorb.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/effects/bounds.hpp>
#include <collide/effects/emit.hpp>
#include <collide/effects/mass_flow.hpp>

#include "simulation/simulation.hpp"

namespace tests {

/// Particles that bounce to and fro: each crossing of a tilted plane, or of a disc of it, is counted once, as the
/// positions after each step say.
template <class Space>
void check_crossings(Space const& space, double disc) {
  using simulation = collide::simulation<meets_mesh<Space>, collide::polydisperse, collide::gravity, collide::box_walls,
                                         collide::mass_flow<>>;
  constexpr double density = 2000, unit = 1e-9, point[3] = {0.1, 0.2, 0}, normal[3] = {1, 2, 2};
  world<float> w;
  w.triangle({90, 90, 90, 91, 90, 90, 90, 91, 90});
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 100; ++i) {
    w.particle(0.9 * uniform(engine), 0.9 * uniform(engine), 0.9 * uniform(engine), 2 * uniform(engine),
               2 * uniform(engine), 2 * uniform(engine));
    w.radii.push_back(0.01f * float(1 + i % 7));
  }
  collide::flow_sums flow(space, unit);
  running<simulation> made(space, w, collide::polydisperse{}, collide::gravity{0, 0, -2},
                           collide::box_walls{{-1, -1, -1}, {1, 1, 1}, 0.9},
                           flow.through(point, normal, collide::one_density{density}, disc));
  collide::flow_counts expected;
  std::vector<int> sides(100);
  std::size_t crossings = 0;
  for (int step = 0; step < 400; ++step) {
    made.simulation.step(5e-3f);
    auto const all = made.positions();
    for (std::size_t i = 0; i < 100; ++i) {
      double x[3], height = 0, square = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        x[k] = double(all[3 * i + k]) - point[k];
        height += x[k] * normal[k] / 3;
        square += x[k] * x[k];
      }
      int const before = sides[i], now = height < 0 ? -1 : 1;
      sides[i] = now;
      if (before == 0 || before == now || square - height * height > disc * disc) continue;
      ++crossings;
      expected.particles += now;
      double const r = double(w.radii[i]);
      expected.mass += now * density * 4.18879020478639 * r * r * r;
    }
  }
  CHECK(crossings > (disc > 1 ? 100 : 10));
  auto const found = flow.read(made.simulation.space());
  CHECK(found.particles == expected.particles);
  CHECK(std::abs(found.mass - expected.mass) <= unit * double(crossings));
  flow.clear(made.simulation.space());
  CHECK(flow.read(made.simulation.space()).particles == 0);
}

/// Grains that go round in a box that repeats come through once each time, also where the plane is next to a side.
template <class Space>
void check_rounds(Space const& space, double plane) {
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, double>, collide::periodic_box, collide::mass_flow<>>;
  world<double> w;
  w.triangle({90, 90, 90, 91, 90, 90, 90, 91, 90});
  w.radius = 0.01;
  for (int i = 0; i < 10; ++i) w.particle(0.1 * i + 0.003, 0.5, 0.5, i < 7 ? 1 : -1);
  collide::flow_sums flow(space, 1e-12);
  running<simulation> made(space, w, collide::periodic_box{},
                           flow.through({plane, 0, 0}, {1, 0, 0}, collide::one_density{1}));
  made.simulation.steps(3000, 1e-2);  // 30 times around
  CHECK(flow.read(made.simulation.space()).particles == 30 * 4);
}

/// A grain that the mesh stops dead far behind the plane, in the step in which it passes that, has come through.
template <class NarrowPhase, class S, class Space>
void check_stopped_behind(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, collide::bounce, collide::mass_flow<>>;
  world<S> w;
  w.triangle({-9, -9, 0, 9, -9, 0, 0, 18, 0});
  w.radius = S(0.01);
  for (int i = 0; i < 10; ++i) w.particle(0.1 * i, 0, 0.201 + 0.0008 * i, 0, 0, -10);
  collide::flow_sums flow(space, 1e-12);
  running<simulation> made(space, w, collide::bounce{0},
                           flow.through({0, 0, 0.05}, {0, 0, -1}, collide::one_density{1}));
  made.simulation.steps(4, S(0.01));
  auto const all = made.positions();
  for (std::size_t i = 2; i < all.size(); i += 3) CHECK(all[i] == doctest::Approx(0.01));
  CHECK(flow.read(made.simulation.space()).particles == 10);
}

/// Where particles are made above and vanish below, the flow between is that of the source.
template <class Space>
void check_steady_flow(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, double>, collide::emit,
                                         collide::absorbing_box, collide::mass_flow<>>;
  world<double> w;
  w.triangle({90, 90, 90, 91, 90, 90, 90, 91, 90});
  w.radius = 0.01;
  w.particle(5, 5, 5);
  collide::flow_sums flow(space, 1e-12);
  running<simulation> made(space, w, collide::emit{100, {{0, 0, 1}, 0.001, {0, 0, -2}, 0}},
                           collide::absorbing_box{{-1, -1, -2}, {1, 1, -1}},
                           flow.through({0, 0, 0}, {0, 0, -1}, collide::one_density{1}));
  made.place(w, 150);  // fewer places than births: they are taken anew
  made.simulation.steps(1000, 1e-3);
  auto& on = made.simulation.space();
  flow.clear(on);
  made.simulation.steps(2000, 1e-3);
  auto const found = flow.read(on);
  CHECK(std::abs(found.particles - 200) <= 1);
  CHECK(found.mass == doctest::Approx(double(found.particles) * 4.18879020478639e-6).epsilon(1e-6));
}

}  // namespace tests
