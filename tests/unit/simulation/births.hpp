/// Births where something is already: counted, and not born if that is asked for. Instantiated by test_births.cpp
/// and test_births_cuda.cpp.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <collide/effects/absorb.hpp>
#include <collide/effects/adhesion.hpp>
#include <collide/effects/emit.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/effects/sphere_contact.hpp>

#include "simulation/simulation.hpp"

namespace tests {

using collide::gravity;
using collide::sphere_contact;
using collide::velocity_verlet;

/// A source and particles that fly through each other, one after the other, as the page says it.
template <class S>
class flight_with_source {
 public:
  flight_with_source(world<S> const& w, std::size_t room, collide::emit const& source, S common)
      : x_(w.centres), v_(w.velocities), alive_(w.size(), 1), radii_(w.radii), placed_(w.size()), source_{source} {
    S const own = source.radius > 0 ? static_cast<S>(source.radius) : common;
    if (radii_.empty()) radii_.assign(placed_, common);
    x_.resize(3 * room);
    v_.resize(3 * room);
    alive_.resize(room);
    radii_.resize(room, own);
  }

  /// `moves_first` with velocity Verlet.
  void step(S dt, bool moves_first) {
    std::vector<std::uint8_t> is_new(alive_.size());
    part_ += source_.rate * static_cast<double>(dt);
    auto const born = static_cast<std::uint64_t>(part_ + 1e-9);
    part_ -= static_cast<double>(born);
    for (std::uint64_t k = 0; k < born; ++k) {
      std::uint64_t const number = counts.due++;
      std::size_t const place = placed_ + static_cast<std::size_t>(number % (alive_.size() - placed_));
      if (source_.only_where_free && alive_[place] != 0) {
        ++counts.not_born;
        continue;
      }
      collide::vec3<S> x, v;
      source_.source(number, x, v);
      for (int c = 0; c < 3; ++c) {
        x_[3 * place + static_cast<std::size_t>(c)] = x[c];
        v_[3 * place + static_cast<std::size_t>(c)] = v[c];
      }
      alive_[place] = is_new[place] = 1;
    }
    if (moves_first) move(dt);
    settle(is_new);
    if (!moves_first) move(dt);
  }

  std::vector<std::uint8_t> const& alive() const { return alive_; }
  std::vector<S> const& centres() const { return x_; }
  collide::birth_counts counts;

 private:
  void move(S dt) {
    for (std::size_t k = 0; k < x_.size(); ++k) {
      if (alive_[k / 3] != 0) x_[k] += v_[k] * dt;
    }
  }
  void settle(std::vector<std::uint8_t> const& is_new) {
    std::vector<std::uint8_t> unborn(alive_.size());
    for (std::size_t i = 0; i < alive_.size(); ++i) {
      if (is_new[i] == 0) continue;
      bool crowded = false;
      for (std::size_t j = 0; j < alive_.size(); ++j) {
        if (j == i || alive_[j] == 0 || (is_new[j] != 0 && j > i)) continue;
        S const a = x_[3 * i] - x_[3 * j], b = x_[3 * i + 1] - x_[3 * j + 1], c = x_[3 * i + 2] - x_[3 * j + 2];
        crowded = crowded || a * a + b * b + c * c < (radii_[i] + radii_[j]) * (radii_[i] + radii_[j]);
      }
      counts.overlapping += crowded;
      unborn[i] = crowded && source_.only_where_free;
      counts.not_born += unborn[i];
    }
    for (std::size_t i = 0; i < alive_.size(); ++i) {
      if (unborn[i] != 0) alive_[i] = 0;
    }
  }

  std::vector<S> x_, v_;
  std::vector<std::uint8_t> alive_;
  std::vector<S> radii_;
  std::size_t placed_;
  collide::emit source_;
  double part_ = 0;
};

/// A simulation counts, and leaves out, what the plain loops do: sparse and crowded, more and fewer than one a step,
/// while places come to an end.
template <class Integrator, class S, class Space, class... Sizes>
void check_births(Space const& space, Sizes... sizes) {
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, Integrator, collide::emit,
                                         Sizes..., sphere_contact>;
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  auto const any = [&] { return uniform(engine); };
  world<S> w;
  w.radius = S(0.06);
  for (int i = 0; i < 30; ++i) {
    w.particle(0.4 * any(), 0.4 * any(), 0.4 * any(), 0.1 * any(), 0.1 * any(), 0.1 * any());
    if (sizeof...(Sizes) != 0) w.radii.push_back(S(0.04 + 0.02 * any()));
  }
  for (bool const only_where_free : {false, true}) {
    for (double const rate : {40.0, 1500.0, 20000.0}) {
      for (double const half_width : {0.0, 0.3}) {
        collide::emit const source{
            rate, {{0.1, 0, 0}, half_width, {0, 0.5, 0}, 0.4}, sizeof...(Sizes) != 0 ? 0.05 : 0.0, only_where_free};
        running<simulation> made(space, w, Integrator{}, source, sizes..., sphere_contact{0, 0, 0, 0, 1});
        made.place(w, 90);
        flight_with_source<S> plain(w, 90, source, w.radius);
        S const dt = S(1) / 256;
        bool same = true;
        for (int k = 0; k < 60; ++k) {
          made.simulation.step(dt);
          plain.step(dt, std::is_same<Integrator, velocity_verlet>::value);
          auto const counts = made.simulation.births();
          same = same && made.simulation.template to_host<collide::alive>() == plain.alive() &&
                 counts.due == plain.counts.due && counts.overlapping == plain.counts.overlapping &&
                 counts.not_born == plain.counts.not_born;
        }
        CHECK(same);
        if (rate > 100) CHECK(plain.counts.overlapping > 0);
        if (rate > 100) CHECK((plain.counts.not_born > 0) == only_where_free);
        auto const x = made.positions();
        for (std::size_t i = 0; i < 90; ++i)
          CHECK((plain.alive()[i] == 0 || x[3 * i + 1] == plain.centres()[3 * i + 1]));
        made.place(w, 90);
        CHECK(made.simulation.births().due == 0);
      }
    }
  }
}

/// A hundred balls that come in one point throw each other out; those that wait until it is free do not.
template <class Space>
void check_births_in_one_point(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space>, collide::emit, gravity, sphere_contact>;
  auto const most_speed = [&](bool only_where_free) {
    world<float> w;
    w.radius = 0.1f;
    running<simulation> made(space, w, collide::emit{1e5, {}, 0, only_where_free}, gravity{},
                             sphere_contact::from_restitution(0.5, 0.02, 0.1, 1000));
    made.place(w, 100);
    made.simulation.step(1e-3f);
    CHECK(made.simulation.births().due == 100);
    CHECK(made.simulation.births().overlapping == 99);
    CHECK(made.simulation.births().not_born == (only_where_free ? 99 : 0));
    made.simulation.template effect<collide::emit>().rate = 100;
    made.simulation.steps(300, 1e-3f);
    auto const there = made.simulation.template to_host<collide::alive>();
    auto const v = made.velocities();
    float most = 0;
    for (std::size_t i = 0; i < 100; ++i) {
      if (there[i] != 0) most = std::max(most, std::hypot(v[3 * i], v[3 * i + 1]) + std::max(v[3 * i + 2], 0.0f));
    }
    return most;
  };
  CHECK(most_speed(true) == 0);
  CHECK(most_speed(false) > 3);
}

/// Where particles do not meet there is nothing to count, and nothing to wait for.
template <class Space>
void check_births_of_what_does_not_meet(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space>, collide::emit, gravity>;
  simulation made(space, collide::emit{1e4, {}}, gravity{});
  made.set(collide::spheres_xyz(static_cast<float const*>(nullptr), 0, 0.1f), nullptr, 50);
  made.steps(5, 1e-3f);
  CHECK(made.births().due == 50);
  CHECK(made.births().overlapping == 0);
  auto const there = made.template to_host<collide::alive>();
  CHECK(there == std::vector<std::uint8_t>(50, 1));
  made.template effect<collide::emit>().only_where_free = true;
  CHECK_THROWS_WITH_AS(
      made.step(1e-3f),
      "collide: emit: only_where_free needs an effect by which particles meet, such as sphere_contact, "
      "and does not know clumps",
      collide::error);
}

/// A floor, and `n` small grains in a ring above it, which one of radius 0.1 in the middle presses apart.
template <class S>
void add_floor_with_ring(world<S>& w, int n) {
  add_floor(w, 5, 1);
  for (int k = 0; k < n; ++k) {
    double const angle = 2 * 3.141592653589793 * k / n;
    w.particle(0.1095 * std::cos(angle), 0.1095 * std::sin(angle), 0.1);
    w.radii.push_back(S(0.01));
  }
}

/// A source that makes a grain in one place, where it slides over the floor along `n` small ones. Each that takes the
/// place of another in memory moves as the first did: contacts do not remember that one. `dies`: the other is gone
/// then.
template <class S, class Space>
void check_births_touch_nothing(Space const& space, int n, bool dies) {
  using law = collide::granular_contact<collide::hertz, collide::mindlin>;
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, collide::emit,
                                         collide::absorbing_box, collide::polydisperse, law>;
  law by{collide::one_material({1e7, 0.3, 1000}, {0.5, 0.5})};
  collide::emit source{0, {{0, 0, 0.0999}, 0, {0.5, 0, 0}, 0}, 0.1};
  collide::absorbing_box const here{{-0.01, -0.01, 0}, {0.01, 0.01, 1}}, away{{9, 9, 9}, {9, 9, 9}};
  world<S> w;
  add_floor_with_ring(w, n);
  running<simulation> made(space, w, source, away, collide::polydisperse{}, by);
  std::size_t const places = w.size() + 1;
  made.place(w, places);
  w.particle(0, 0, 0);
  placed<S> const centres(space, w.centres), none(space, w.velocities);
  std::vector<S> first;
  for (int life = 0; life < 3; ++life) {
    made.simulation.template assign<position>(centres.data());
    made.simulation.template assign<velocity>(none.data());
    made.simulation.template assign<collide::angular_velocity>(none.data());
    S const dt = S(1e-5);
    for (int k = 0; k < 20; ++k) {
      made.simulation.template effect<collide::emit>().rate = k == 0 ? 1 / static_cast<double>(dt) : 0;
      made.simulation.template effect<collide::absorbing_box>() = dies && k == 19 ? here : away;
      made.simulation.step(dt);
    }
    CHECK(made.simulation.template to_host<collide::alive>().back() == !dies);
    auto now = made.velocities();
    auto const turning = made.simulation.template to_host<collide::angular_velocity>();
    now.insert(now.end(), turning.begin(), turning.end());
    if (life == 0) first = now;
    CHECK(first == now);
    CHECK(now[3 * places - 3] < S(0.4999));  // friction brakes it
  }
}

/// An effect of a user's own that makes a particle at each free place. `Writes`: columns besides `alive`.
template <class... Writes>
struct revives {
  using writes = collide::columns<collide::alive, Writes...>;
  static constexpr bool begins_on_ranks = true;
  bool now = false;

  template <class State>
  struct revive {
    State state;
    COLLIDE_HD void operator()(std::size_t i) const { state.at(collide::alive{})[i] = 1; }
  };
  template <class Space, class State, class S>
  void begin_step(Space& space, State const& state, S) const {
    if (now) space.for_each(state.size, revive<State>{state});
  }
};

/// Particles that an effect makes begin anew in a column that only another maker of particles writes.
template <class Space>
void check_two_makers(Space const& space) {
  using other = revives<temperature>;
  using maker = revives<>;
  using simulation = collide::simulation<meets_mesh<Space>, other, maker, collide::absorbing_box>;
  world<float> w;
  w.radius = 0.1f;
  w.particle(0, 0, 1);
  running<simulation> made(space, w, other{}, maker{}, collide::absorbing_box{{-1, -1, 0}, {1, 1, 2}});
  made.simulation.step(1e-3f);
  CHECK(made.simulation.template to_host<collide::alive>()[0] == 0);
  placed<float> const warm(space, {100});
  made.simulation.template assign<temperature>(warm.data());
  made.simulation.template effect<maker>().now = true;
  made.simulation.template effect<collide::absorbing_box>() = {{9, 9, 9}, {9, 9, 9}};
  made.simulation.step(1e-3f);
  CHECK(made.simulation.template to_host<collide::alive>()[0] == 1);
  CHECK(made.simulation.template to_host<temperature>()[0] == 20);
}

/// A particle that a user's effect makes where a grain slid over the floor along `n` small ones moves as that
/// did: contacts do not remember it.
template <class S, class Space>
void check_revived_touch_nothing(Space const& space, int n) {
  using law = collide::granular_contact<collide::hertz, collide::mindlin>;
  using maker = revives<position, velocity, collide::angular_velocity>;
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, maker, collide::absorbing_box,
                                         collide::polydisperse, law>;
  collide::absorbing_box const here{{-0.01, -0.01, 0}, {0.01, 0.01, 1}}, away{{9, 9, 9}, {9, 9, 9}};
  world<S> w;
  add_floor_with_ring(w, n);
  w.particle(0, 0, 0.0999, 0.5);
  w.radii.push_back(S(0.1));
  running<simulation> made(space, w, maker{}, away, collide::polydisperse{},
                           law{collide::one_material({1e7, 0.3, 1000}, {0.5, 0.5})});
  placed<S> const centres(space, w.centres), speeds(space, w.velocities),
      none(space, std::vector<S>(w.centres.size(), S(0)));
  std::vector<S> first;
  for (int life = 0; life < 3; ++life) {
    made.simulation.template assign<position>(centres.data());
    made.simulation.template assign<velocity>(speeds.data());
    made.simulation.template assign<collide::angular_velocity>(none.data());
    for (int k = 0; k < 20; ++k) {
      made.simulation.template effect<maker>().now = k == 0;
      made.simulation.template effect<collide::absorbing_box>() = k == 19 ? here : away;
      made.simulation.step(S(1e-5));
    }
    CHECK(made.simulation.template to_host<collide::alive>().back() == 0);
    auto now = made.velocities();
    auto const turning = made.simulation.template to_host<collide::angular_velocity>();
    now.insert(now.end(), turning.begin(), turning.end());
    if (life == 0) first = now;
    CHECK(first == now);
    CHECK(now[3 * w.size() - 3] < S(0.4999));  // friction brakes it
  }
}

/// A particle that a user's effect makes where one stuck to the mesh falls: nothing holds it.
template <class Integrator, class Space>
void check_revived_falls(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space>, revives<>, collide::absorbing_box, Integrator, gravity,
                                         collide::bounce, collide::adhesion>;
  collide::absorbing_box const here{{-9, -9, -9}, {9, 9, 9}}, away{{90, 90, 90}, {90, 90, 90}};
  world<float> w;
  w.radius = 0.1f;
  add_floor(w, 5, 1);
  w.particle(0, 0, 0.1);
  running<simulation> made(space, w, revives<>{}, away, Integrator{}, gravity{}, collide::bounce{0},
                           collide::adhesion{100});
  made.simulation.steps(10, 1e-3f);
  made.simulation.template effect<collide::absorbing_box>() = here;
  made.simulation.step(1e-3f);
  CHECK(made.simulation.template to_host<collide::alive>()[0] == 0);
  made.simulation.template effect<collide::absorbing_box>() = away;
  placed<float> const above(space, {0, 0, 1});
  made.simulation.template assign<position>(above.data());
  made.simulation.template effect<revives<>>().now = true;
  made.simulation.steps(100, 1e-3f);
  CHECK(made.velocities()[2] == doctest::Approx(-0.981).epsilon(1e-4));
}

}  // namespace tests
