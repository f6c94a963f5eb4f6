/// Particles that meet each other, against looking at all pairs; instantiated by test_effects.cpp and
/// test_effects_cuda.cpp.
#pragma once

#include <collide/effects/bounds.hpp>
#include <collide/effects/emit.hpp>

#include "simulation/simulation.hpp"

namespace tests {

/// The particles that one has met, as a number that depends on whom and in which order.
struct greeted {
  template <class S>
  using value = std::uint32_t;
};

inline COLLIDE_HD std::uint32_t after_meeting(std::uint32_t before, collide::id other) {
  return before * 31 + other + 1;
}

struct greets {
  using reads = collide::columns<position>;
  using writes = collide::columns<greeted>;

  template <class Particle, class Seen, class S>
  COLLIDE_HD void on_pair_contact(Particle& p, Seen const&, Seen const& other, S) const {
    p[greeted{}] = after_meeting(p[greeted{}], other.number());
  }
};

/// Particles that come and go as the test has it.
struct ghosts {
  using writes = collide::columns<collide::alive>;

  template <class Particle>
  COLLIDE_HD bool is_inactive(Particle const& p) const {
    return p[collide::alive{}] == 0;
  }
};

/// Particles that grow, up to the size of the largest.
struct grows {
  using writes = collide::columns<collide::radius>;
  double rate = 0, most = 0;

  template <class Particle, class S>
  COLLIDE_HD void end_step(Particle& p, S dt) const {
    S const larger = p[collide::radius{}] * (1 + S(rate) * dt);
    p[collide::radius{}] = larger < S(most) ? larger : S(most);
  }
};

/// A step at a time: what each has met is what it overlaps when a step begins, by rising numbers. `change(simulation,
/// step)` is called before each step.
template <class S, class Simulation, class Change>
void check_meetings(Simulation& simulation, S common_radius, int steps, S dt, Change const& change,
                    std::size_t least_met) {
  using collide::alive;
  using collide::radius;
  std::size_t const n = simulation.size();
  std::vector<std::uint32_t> expected(n);
  std::size_t met = 0, wrong = 0;
  for (int step = 0; step < steps; ++step) {
    change(simulation, step);
    auto const x = simulation.template to_host<position>();
    std::vector<S> radii(n, common_radius);
    if constexpr (collide::detail::contains<typename Simulation::columns, radius>) {
      radii = simulation.template to_host<radius>();
    }
    std::vector<std::uint8_t> there(n, 1);
    if constexpr (collide::detail::contains<typename Simulation::columns, alive>) {
      there = simulation.template to_host<alive>();
    }
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < n; ++k) {
        if (k == i || there[i] == 0 || there[k] == 0) continue;
        collide::vec3<S> const between(x[3 * i] - x[3 * k], x[3 * i + 1] - x[3 * k + 1], x[3 * i + 2] - x[3 * k + 2]);
        S const reach = radii[i] + radii[k];
        if (!(collide::detail::dot(between, between) < reach * reach)) continue;
        expected[i] = after_meeting(expected[i], static_cast<collide::id>(k));
        ++met;
      }
    }
    simulation.step(dt);
    auto const found = simulation.template to_host<greeted>();
    for (std::size_t i = 0; i < n; ++i) wrong += found[i] != expected[i];
  }
  CHECK(wrong == 0);
  CHECK(met >= least_met);
}

inline constexpr auto no_change = [](auto&, int) {};

/// Writes one particle's values of a column.
template <class Column, class Simulation, class T>
void write_particle(Simulation& s, std::size_t i, std::initializer_list<T> values) {
  s.space().copy_from_host(s.template data<Column>() + i * values.size(), values.begin(), values.size());
}

/// A cube full of particles, at `where` from the origin.
template <class S>
world<S> packed_cube(std::size_t n, double radius, double speed, double where = 0) {
  auto w = crowd<S>(n, 1, radius, speed, 5);
  w.corners.clear();
  for (S& c : w.centres) c += static_cast<S>(where);
  return w;
}

template <class S, class Space>
void check_neighbours(Space const& space) {
  using collide::box_walls;
  using collide::radius;
  auto const in_cube = [](double at) { return box_walls{{at - 1, at - 1, at - 1}, {at + 1, at + 1, at + 1}, 1}; };
  std::size_t const n = 700;

  SUBCASE("that stay near, move away now and then, or in each step, or leave several cells behind") {
    for (double const way : {0.0003, 0.004, 0.05, 1.5}) {
      CAPTURE(way);
      running<collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, greets, box_walls>> made(
          space, packed_cube<S>(n, 0.1, way), greets{}, in_cube(0));
      check_meetings<S>(made.simulation, S(0.1), 60, S(1), no_change, 50000);
    }
  }
  SUBCASE("far away from the origin") {
    running<collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, greets, box_walls>> made(
        space, packed_cube<S>(n, 0.1, 0.004, -5000), greets{}, in_cube(-5000));
    check_meetings<S>(made.simulation, S(0.1), 60, S(1), no_change, 50000);
  }
  SUBCASE("of many sizes, more than lists have room for, and growing") {
    using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, collide::polydisperse, greets,
                                           grows, box_walls>;
    auto w = packed_cube<S>(n, 0.05, 0.002);
    for (std::size_t i = 0; i < n; ++i) w.radii.push_back(i % 50 == 0 ? S(0.4) : i % 5 == 0 ? S(0.1) : S(0.02));
    running<simulation> made(space, w, collide::polydisperse{}, greets{}, grows{0.02, 0.4}, in_cube(0));
    check_meetings<S>(made.simulation, S(0), 60, S(1), no_change, 100000);
  }
  SUBCASE("of sizes far apart: small ones, others of 5 times their radius, which look into their cells, and of 20") {
    using simulation =
        collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, collide::polydisperse, greets, box_walls>;
    for (double const at : {0.0, -300.0}) {
      CAPTURE(at);
      auto w = packed_cube<S>(n, 0.05, 0.003, at);
      for (std::size_t i = 0; i < n; ++i) w.radii.push_back(i % 70 == 0 ? S(0.4) : i % 14 == 1 ? S(0.1) : S(0.02));
      running<simulation> made(space, w, collide::polydisperse{}, greets{}, in_cube(at));
      check_meetings<S>(made.simulation, S(0), 40, S(1), no_change, 20000);
    }
  }
  SUBCASE("that grow where they are, up to the largest, or up to what they were before smaller radii were assigned") {
    using simulation =
        collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, collide::polydisperse, greets, grows>;
    for (bool const is_assigned : {false, true}) {
      CAPTURE(is_assigned);
      world<S> w;
      for (int i = 0; i < 200; ++i) w.particle(0.3 * (i % 6), 0.3 * (i / 6 % 6), 0.3 * (i / 36));
      w.radii.assign(w.size(), is_assigned ? S(0.2) : S(0.1));
      w.radii[7] = S(0.2);
      running<simulation> made(space, w, collide::polydisperse{}, greets{}, grows{is_assigned ? 0.1 : 0.03, 0.2});
      placed<S> const smaller(space, std::vector<S>(w.size(), S(0.02)));
      if (is_assigned) made.simulation.template assign<radius>(smaller.data());
      check_meetings<S>(made.simulation, S(0), 40, S(1), no_change, 5000);
    }
  }
  SUBCASE("that shrink and grow again, while others are put elsewhere") {
    using simulation =
        collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, collide::polydisperse, greets, box_walls>;
    std::size_t const many = 300;
    auto w = packed_cube<S>(many, 0.2, 0.0005);
    w.radii.assign(many, S(0.2));
    running<simulation> made(space, w, collide::polydisperse{}, greets{}, in_cube(0));
    std::mt19937 engine(9);
    std::uniform_real_distribution<double> uniform(-0.8, 0.8);
    auto const change = [&](auto& s, int step) {
      for (std::size_t i = 0; i < many / 2; ++i) {
        if (step % 10 == 3) write_particle<radius>(s, i, {S(0.1)});
        if (step % 10 == 6) write_particle<radius>(s, i, {S(0.2)});
      }
      write_particle<position>(s, many / 2 + engine() % (many / 2),
                               {static_cast<S>(uniform(engine)), static_cast<S>(uniform(engine)), S(0)});
    };
    check_meetings<S>(made.simulation, S(0.2), 60, S(1), change, 50000);
  }
  SUBCASE("that come as close as the skin allows, from two cells apart or one") {
    using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, greets>;
    world<S> w;
    w.radius = S(0.1);
    for (int i = 0; i < 300; ++i) {
      double first[3] = {1.037 * (i % 10), 1.037 * (i / 10 % 10), 1.037 * (i / 100)}, way[3] = {};
      way[i % 3] = 1.0 / 4096;
      w.particle(first[0], first[1], first[2], way[0], way[1], way[2]);
      w.particle(first[0] + 892 * way[0], first[1] + 892 * way[1], first[2] + 892 * way[2], -way[0], -way[1], -way[2]);
    }
    running<simulation> made(space, w, greets{});
    check_meetings<S>(made.simulation, w.radius, 45, S(1), no_change, 600);
  }
  SUBCASE("that come and go") {
    using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, ghosts, greets, box_walls>;
    running<simulation> made(space, packed_cube<S>(n, 0.1, 0.001), ghosts{}, greets{}, in_cube(0));
    auto const change = [&](auto& s, int step) {
      if (step % 3 != 1) return;
      auto const i = static_cast<std::size_t>(step * 11 % 700);
      write_particle<collide::alive>(s, i, {std::uint8_t(0)});
      if (step > 20)
        write_particle<collide::alive>(s, static_cast<std::size_t>((step - 18) * 11 % 700), {std::uint8_t(1)});
    };
    check_meetings<S>(made.simulation, S(0.1), 60, S(1), change, 50000);
  }
  SUBCASE("that come one after the other, also where lists are full, while some are fast, and many at a time") {
    using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, ghosts, greets, box_walls>;
    auto w = packed_cube<S>(n, 0.15, 0.0005);
    for (std::size_t i = 0; i < 9; ++i) w.velocities[3 * 11 * i] = S(0.05 * (double(i) - 4));
    running<simulation> made(space, w, ghosts{}, greets{}, in_cube(0));
    auto const change = [&](auto& s, int step) {
      auto const several = [&](std::size_t from, std::size_t count, int there) {
        for (std::size_t i = from; i < from + count; ++i)
          write_particle<collide::alive>(s, i % 700, {std::uint8_t(there)});
      };
      auto const at = static_cast<std::size_t>(step);
      if (step == 0) several(300, 400, 0);
      if (step > 0) several(300 + 3 * at, 3, 1);
      if (step % 4 == 0) several(100 + at, 1, 0);
      if (step == 30) several(500, 150, 1);
      if (step == 50) several(0, 300, 1);
    };
    check_meetings<S>(made.simulation, S(0.15), 60, S(1), change, 100000);
  }
  SUBCASE("that are placed anew, fewer of them, more, or larger") {
    using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, greets, box_walls>;
    running<simulation> made(space, packed_cube<S>(n, 0.1, 0.004), greets{}, in_cube(0));
    check_meetings<S>(made.simulation, S(0.1), 10, S(1), no_change, 5000);
    made.place(packed_cube<S>(50, 0.4, 0.004));
    check_meetings<S>(made.simulation, S(0.4), 10, S(1), no_change, 500);
    made.place(packed_cube<S>(2 * n, 0.08, 0.004));
    check_meetings<S>(made.simulation, S(0.08), 10, S(1), no_change, 5000);
  }
  SUBCASE("from a source, whether lists are kept or others make them anew in each step") {
    using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, collide::emit, greets>;
    auto w = packed_cube<S>(300, 0.1, 0.0005);
    std::size_t const others = 100, resting = w.size();
    for (std::size_t i = 0; i < others; ++i) w.particle(1000.0 + 10.0 * double(i), 0, 0);
    collide::emit const source{3, {{0, 0, 0}, 0.9, {0, 0, 0}, 0.0005}};
    running<simulation> kept(space, w, source, greets{}), anew(space, w, source, greets{});
    for (auto* one : {&kept, &anew}) one->place(w, w.size() + 100);
    std::size_t wrong = 0;
    for (int step = 0; step < 60; ++step) {
      for (std::size_t i = 0; i < others; ++i) {
        write_particle<position>(anew.simulation, resting + i, {S(1000 + 10 * int(i)), S(step % 2), S(0)});
      }
      for (auto* one : {&kept, &anew}) one->simulation.step(S(1));
      auto const found = kept.simulation.template to_host<greeted>(),
                 expected = anew.simulation.template to_host<greeted>();
      for (std::size_t i = 0; i < found.size(); ++i) wrong += found[i] != expected[i];
    }
    CHECK(wrong == 0);
    auto const found = kept.simulation.template to_host<greeted>();
    auto const met = std::count_if(found.begin() + static_cast<std::ptrdiff_t>(w.size()), found.end(),
                                   [](std::uint32_t greetings) { return greetings != 0; });
    CHECK(met > 50);
  }
  SUBCASE("that come, go and come back at random") {
    using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, ghosts, greets, box_walls>;
    for (unsigned seed = 0; seed < 8; ++seed) {
      running<simulation> made(space, packed_cube<S>(120, 0.3, 0.003), ghosts{}, greets{}, in_cube(0));
      std::mt19937 engine(seed);
      auto const change = [&](auto& s, int step) {
        for (int k = 0; k < (step == 0 ? 40 : 2); ++k) {
          std::size_t const i = engine() % 120;
          std::uint8_t const there = s.template to_host<collide::alive>()[i];
          write_particle<collide::alive>(s, i, {std::uint8_t(1 - there)});
        }
      };
      check_meetings<S>(made.simulation, S(0.3), 40, S(1), change, 10000);
    }
  }
  SUBCASE("that are put elsewhere, also from nowhere") {
    using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, greets>;
    running<simulation> made(space, packed_cube<S>(n, 0.1, 0.0005), greets{});
    S const nan = std::numeric_limits<S>::quiet_NaN();
    auto const change = [&](auto& s, int step) {
      if (step == 10) write_particle<position>(s, 3, {S(0), S(0.1), S(0)});
      if (step == 20) write_particle<position>(s, 5, {nan, S(0), S(0)});
      if (step == 30) write_particle<position>(s, 5, {S(0), S(-0.1), S(0)});
      if (step == 40) write_particle<position>(s, 8, {S(3), S(3), S(3)});
      // one that is nowhere while another comes, and then is where it was
      if (step == 42) write_particle<position>(s, 20, {S(5), S(5), S(5)});
      if (step == 43) write_particle<position>(s, 20, {S(5), nan, S(5)});
      if (step == 44) write_particle<position>(s, 21, {S(5), S(5.1), S(5)});
      if (step == 45) write_particle<position>(s, 20, {S(5), S(5), S(5)});
    };
    check_meetings<S>(made.simulation, S(0.1), 50, S(1), change, 50000);
  }
}

}  // namespace tests
