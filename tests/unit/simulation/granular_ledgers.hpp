/// Momentum that grains lose is what bodies get, after each step: whether they sleep, whatever the integrator, where dt
/// changes and where parameters do between steps; and meetings between steps change nothing. Instantiated by
/// test_granular.cpp and test_granular_cuda.cpp.
#pragma once

#include <collide/effects/contact_forces.hpp>
#include <collide/effects/external_forces.hpp>

#include "simulation/granular.hpp"

namespace tests {

/// Changes between steps.
enum class between { nothing, parameters, forces, mesh, places };

/// One type of simulation for all that grains do on a floor that is a body, and beside a wall.
template <class Integrator, class S, class Space>
class ledger_of_grains {
  using law = granular_contact<hertz, mindlin, collide::epsd>;
  using forces = collide::external_forces<>;
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, Integrator, collide::polydisperse,
                                         collide::sleep, gravity, law, forces, collide::reaction, collide::mesh_forces,
                                         collide::pair_forces, moving_bodies<>>;
  static constexpr double density = 2500, close = sizeof(S) == 4 ? 3e-5 : 1e-11;

 public:
  ledger_of_grains(Space const& space, bool sleeps, gravity const& g, law const& by, world<S> w,
                   body_motion const& motion = {})
      : w_{with_walls(std::move(w))},
        g_{g},
        sums_(space, 1, 1e-14),
        made_(space, w_, {body{0, 2, motion}}, Integrator{}, collide::polydisperse{},
              collide::sleep{sleeps ? 0.005 : 0, 20}, g, by, forces{{density}}, sums_.effect(density),
              collide::mesh_forces{density}, collide::pair_forces{density}, moving_bodies<>{}),
        corners_(space, w_.corners),
        no_forces_(space, std::vector<S>(w_.centres.size())),
        motion_{motion} {}

  simulation& scene() { return made_.simulation; }

  void happens(between what) {
    auto& s = scene();
    if (what == between::parameters) s.template effect<gravity>().z = g_.z;
    if (what == between::forces) s.template assign<collide::external_force>(no_forces_.data());
    if (what == between::mesh) s.set_mesh(collide::triangle_soup(corners_.data(), 4), {body{0, 2, motion_}});
    if (what == between::places) {
      placed<S> const same(s.space(), made_.positions());
      s.template assign<position>(same.data());
      s.space().synchronize();
    }
  }

  /// Momentum of grains and of what they have given, less that of gravity; and angular momentum about the vertical.
  std::array<double, 4> momentum() {
    auto const x = made_.positions(), v = made_.velocities(), turn = scene().template to_host<angular_velocity>();
    std::array<double, 4> sum{};
    for (std::size_t i = 0; i < w_.size(); ++i) {
      double const r = double(w_.radii[i]), m = mass(r);
      double const u[] = {double(v[3 * i]), double(v[3 * i + 1]), double(v[3 * i + 2])};
      for (std::size_t k = 0; k < 3; ++k) sum[k] += m * u[k];
      sum[2] -= m * g_.z * time_;
      sum[3] += m * (double(x[3 * i]) * u[1] - double(x[3 * i + 1]) * u[0] + 0.4 * r * r * double(turn[3 * i + 2]));
    }
    for (auto const& one : sums_.read(scene().space())) {
      for (std::size_t k = 0; k < 3; ++k) sum[k] += one.linear[k];
      sum[3] += one.angular[2];
    }
    return sum;
  }
  static double mass(double r) { return density * 4 / 3 * pi * r * r * r; }
  double weight() const {
    double sum = 0;
    for (S const r : w_.radii) sum += -g_.z * mass(double(r));
    return sum;
  }

  /// Steps of 1 to 0.3 times `dt`, or all of `dt`; every `every` steps something happens. Returns the largest part of
  /// the momentum that is in no ledger.
  double play(int steps, double dt, bool dt_varies, bool changes, int every) {
    auto const before = momentum();
    double worst = 0;
    for (int k = 0; k < steps; ++k) {
      if (changes && k % every == 0) happens(static_cast<between>(k / every % 5));
      S const now = S(dt * (dt_varies ? 1 - 0.35 * (k * k % 3) : 1));
      scene().step(now);
      time_ += double(now);
      if (k % 7 != 0) continue;
      auto const after = momentum();
      for (std::size_t c = 0; c < 4; ++c) worst = std::max(worst, std::abs(after[c] - before[c]));
    }
    return worst / (weight() * steps * dt);
  }

  /// Checks that a grain at rest presses with its weight, and a column's grains on each other with theirs.
  void check_weights(double dt, bool dt_varies, bool sleeps) {
    sums_.clear(scene().space());
    double const began = time_;
    CHECK(play(60, dt, dt_varies, false, 1) < close);
    double pressed = 0, on_grains = 0;
    for (auto const& one : sums_.read(scene().space())) pressed -= one.linear[2];
    auto const f = scene().template to_host<collide::mesh_force>(), p = scene().template to_host<collide::pair_force>();
    for (std::size_t i = 0; i < w_.size(); ++i) on_grains += double(f[3 * i + 2]);
    double const of_rest = sleeps ? close : sizeof(S) == 4 ? 1e-3 : 1e-5;
    CHECK(pressed == doctest::Approx(weight() * (time_ - began)).epsilon(of_rest).scale(0));
    CHECK(on_grains == doctest::Approx(weight()).epsilon(of_rest).scale(0));
    auto const slow = scene().template to_host<collide::slow_steps>();
    for (auto const n : slow) CHECK((n >= 20) == sleeps);
    double const part[] = {-2, 1, 1}, one = -g_.z * mass(0.1);
    for (std::size_t i = 0; i < 3 && !sleeps; ++i)
      CHECK(double(p[3 * i + 2]) == doctest::Approx(part[i] * one).epsilon(1e-3).scale(0));
  }

  auto state() {
    return std::make_tuple(made_.positions(), made_.velocities(), scene().template to_host<angular_velocity>());
  }

 private:
  static world<S> with_walls(world<S> w) {
    add_quad(w, {-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0});
    add_quad(w, {0, -9, -9}, {0, 9, -9}, {0, 9, 9}, {0, -9, 9});
    return w;
  }

  world<S> w_;
  gravity g_;
  collide::reaction_sums sums_;
  running_bodies<simulation> made_;
  placed<S> corners_, no_forces_;
  body_motion motion_;
  double time_ = 0;
};

template <class Integrator, class S, class Space>
void check_ledgers(Space const& space) {
  collide::one_material const soft({1e6, 0.25, 2500}, {0.1, 0.5, 0.1});
  world<S> w;
  for (double z : {0.096, 0.288, 0.484}) w.particle(2, -0.5, z);  // a column
  w.particle(0.098, 1, 0.097, -0.1, 0.2, 0);                      // in the corner of floor and wall
  w.particle(1, 1, 0.4, -1, 0.5, -1);                             // falls on the floor, and rolls
  w.particle(1.1, 1.05, 0.6, 0, 0, 0);
  w.radii = {S(0.1), S(0.1), S(0.1), S(0.1), S(0.05), S(0.07)};
  for (bool const sleeps : {false, true})
    for (bool const dt_varies : {false, true})
      for (bool const changes : {false, true}) {
        CAPTURE(sleeps);
        CAPTURE(dt_varies);
        CAPTURE(changes);
        ledger_of_grains<Integrator, S, Space> made(space, sleeps, gravity{}, {soft}, w);
        CHECK(made.play(3500, 1e-3, dt_varies, changes, 37) < (sizeof(S) == 4 ? 3e-5 : 1e-12));
        made.play(60, 1e-3, dt_varies, false, 1);
        made.check_weights(1e-3, dt_varies, sleeps);
      }
}

/// A grain slides on a slope of 45 degrees. What wakes others, and asks for forces between steps, changes no bit; where
/// it is put again forces are asked for again, of what slides as before.
template <class Integrator, class S, class Space>
void check_meetings_between_steps(Space const& space) {
  double const r = 0.05, c = 9.81 * std::sqrt(0.5), mu = 0.2, dt = 5e-4;
  collide::one_material const soft({5e6, 0.25, 2500}, {0.5, mu});
  granular_contact<hertz, mindlin, collide::epsd> by{soft};
  by.arm_shortening = 0;
  world<S> w;
  w.particle(1, 0, r - 2e-5);
  w.radii = {S(r)};
  using scene_type = ledger_of_grains<Integrator, S, Space>;
  auto const run = [&](between what, bool sleeps, auto const& look) {
    scene_type made(space, sleeps, gravity{c, 0, -c}, by, w);
    for (int k = 0; k < 1000; ++k) {
      made.happens(what);
      made.scene().step(S(dt));
    }
    look(made);
  };
  auto plain = scene_type(space, false, gravity{c, 0, -c}, by, w).state();
  run(between::nothing, false, [&](auto& made) { plain = made.state(); });
  for (auto const what : {between::nothing, between::parameters, between::forces, between::mesh})
    run(what, true, [&](auto& made) { CHECK((made.state() == plain)); });
  run(between::places, true, [&](auto& made) {
    auto const [x, v, turn] = made.state();
    CHECK(double(v[0]) == doctest::Approx((c - mu * c) * 1000 * dt).epsilon(2e-3));
    CHECK(double(turn[1]) == doctest::Approx(2.5 * mu * c / r * 1000 * dt).epsilon(2e-3));
  });
}

/// Checks that a grain which touches nothing does not fall asleep, however short the step: at the top of its flight,
/// and where what it lies on goes away slowly. What lies does.
template <class Integrator, class S, class Space>
void check_sleep_needs_contact(Space const& space) {
  collide::one_material const soft({1e6, 0.25, 2500}, {0.1, 0.5, 0.1});
  world<S> w;
  w.particle(1, 0, 0.0995);
  w.particle(2, 0, 0.5, 0, 0, 0.02);
  w.radii = {S(0.1), S(0.1)};
  using scene_type = ledger_of_grains<Integrator, S, Space>;
  scene_type made(space, true, gravity{}, {soft}, w);
  made.scene().steps(5000, S(2e-5));
  CHECK(double(made.scene().template to_host<velocity>()[5]) == doctest::Approx(0.02 - 9.81 * 0.1).epsilon(1e-3));
  made.scene().steps(1500, S(1e-3));
  for (auto const n : made.scene().template to_host<collide::slow_steps>()) CHECK(int(n) >= 20);

  body_motion sinks;
  sinks.velocity[2] = -1e-4;
  scene_type sinking(space, true, gravity{}, {soft}, w, sinks);
  auto const height = [&] { return double(sinking.scene().template to_host<position>()[2]); };
  sinking.scene().steps(10000, S(1e-4));
  double const z = height();
  sinking.scene().steps(5000, S(1e-4));
  CHECK(height() - z == doctest::Approx(-5e-5).epsilon(1e-2).scale(0));
}

}  // namespace tests
