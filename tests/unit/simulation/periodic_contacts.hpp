/// Particles that meet across the sides of a box that repeats, against the same ones in its middle, and against all
/// pairs; instantiated by test_periodic_contacts.cpp and test_granular_cuda.cpp.
#pragma once

#include <collide/effects/bounds.hpp>
#include <collide/effects/contact_forces.hpp>
#include <collide/effects/spin.hpp>

#include "simulation/granular.hpp"
#include "simulation/neighbours.hpp"

namespace tests {

using collide::periodic_box;

/// Positions, velocities and angular velocities after some steps, of particles that are moved by `shift` before.
template <class S, class Space, class... Effect>
std::vector<S> after_steps(Space const& space, world<S> w, double const (&shift)[3], int steps, double dt,
                           Effect... effects) {
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, Effect..., periodic_box>;
  periodic_box const box{{0, 0, 0}, {4, 4, 4}};
  for (std::size_t i = 0; i < w.centres.size(); ++i) {
    S& x = w.centres[i];
    x += static_cast<S>(shift[i % 3]);
    if (x < 0) x += 4;
    if (x >= 4) x -= 4;
  }
  running<simulation> made(space, w, effects..., box);
  made.simulation.steps(static_cast<std::size_t>(steps), static_cast<S>(dt));
  auto all = made.positions(), v = made.velocities();
  for (std::size_t i = 0; i < all.size(); ++i) {  // back to the middle
    S& x = all[i];
    x -= static_cast<S>(shift[i % 3]);
    if (x < 0) x += 4;
    if (x >= 4) x -= 4;
  }
  all.insert(all.end(), v.begin(), v.end());
  if constexpr (collide::detail::contains<typename simulation::columns, angular_velocity>) {
    auto const turn = made.simulation.template to_host<angular_velocity>();
    all.insert(all.end(), turn.begin(), turn.end());
  }
  return all;
}

/// Three that overlap across each side, edge and corner of the box do what they do in its middle: velocities after a
/// step to the bit, as positions are such that nothing is rounded; after many to rounding.
template <class S, class Space, class... Effect>
void check_as_in_the_middle(Space const& space, double dt, Effect... effects) {
  world<S> w;
  w.radius = S(0.125);
  w.particle(2 - 0.0625, 2 - 0.0625, 2 - 0.0625, 0.5, 0, 0.25);
  w.particle(2 + 0.0625, 2 + 0.078125, 2 + 0.0625, -0.25, 0.125, -0.5);
  w.particle(2 + 0.0625, 2 - 0.09375, 2 + 0.078125, -0.25, 0.5, -0.5);
  double const still[3] = {0, 0, 0};
  auto const first = after_steps<S>(space, w, still, 1, dt, effects...),
             last = after_steps<S>(space, w, still, 300, dt, effects...);
  double most = 0, moved = 0;
  std::size_t wrong = 0;
  for (int where = 1; where < 27; ++where) {
    double const shift[3] = {2.0 * (where % 3 - 1), 2.0 * (where / 3 % 3 - 1), 2.0 * (where / 9 - 1)};
    if (shift[0] == 0 && shift[1] == 0 && shift[2] == 0) continue;
    auto const one = after_steps<S>(space, w, shift, 1, dt, effects...),
               many = after_steps<S>(space, w, shift, 300, dt, effects...);
    wrong += std::memcmp(one.data() + 9, first.data() + 9, (one.size() - 9) * sizeof(S)) != 0;
    for (std::size_t i = 0; i < many.size(); ++i) {
      most = std::max(most, std::abs(double(many[i]) - double(last[i])));
      moved = std::max(moved, std::abs(double(last[i]) - double(first[i])));
    }
  }
  CHECK(wrong == 0);
  CHECK(most < (sizeof(S) == 4 ? 2e-3 : 2e-11));
  CHECK(moved > 0.1);
}

template <class S, class Space>
void check_contacts_across(Space const& space) {
  using namespace collide;
  check_as_in_the_middle<S>(space, 1e-3, sphere_contact{2000, 5, 0.3, 3, 1000}, spin{0.1});
  granular_contact<hertz, mindlin, epsd, jkr> sticky;
  sticky.made_of = one_material({1e4, 0.2, 1000}, {0.5, 0.4, 0.1, 2});
  check_as_in_the_middle<S>(space, 1e-3, sticky, pair_forces{});
}

/// A coordinate beside another, whichever of the two must come down by a length.
template <class S>
S apart_across(S a, S b, double length) {
  S best = a - b;
  for (S const other :
       {static_cast<S>(static_cast<double>(a) - length) - b, a - static_cast<S>(static_cast<double>(b) - length)}) {
    if (std::abs(other) < std::abs(best)) best = other;
  }
  return best;
}

/// A step at a time: what each has met is what all pairs say, by rising numbers.
template <class S, class Simulation>
void check_meetings_across(Simulation& simulation, S common_radius, double side, int steps, S dt,
                           std::size_t least_met) {
  std::size_t const n = simulation.size();
  std::vector<std::uint32_t> expected(n);
  std::size_t met = 0, wrong = 0;
  for (int step = 0; step < steps; ++step) {
    auto const x = simulation.template to_host<position>();
    std::vector<S> radii(n, common_radius);
    if constexpr (collide::detail::contains<typename Simulation::columns, collide::radius>)
      radii = simulation.template to_host<collide::radius>();
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < n; ++k) {
        if (k == i) continue;
        collide::vec3<S> between(0, 0, 0);
        bool across = false;
        for (std::size_t c = 0; c < 3; ++c) {
          S const d = apart_across(x[3 * i + c], x[3 * k + c], side);
          across = across || d != x[3 * i + c] - x[3 * k + c];
          between[static_cast<int>(c)] = d;
        }
        S const reach = radii[i] + radii[k];
        if (!(collide::detail::dot(between, between) < reach * reach)) continue;
        expected[i] = after_meeting(expected[i], static_cast<collide::id>(k));
        met += across;
      }
    }
    simulation.step(dt);
    auto const found = simulation.template to_host<greeted>();
    for (std::size_t i = 0; i < n; ++i) wrong += found[i] != expected[i];
  }
  CHECK(wrong == 0);
  CHECK(met >= least_met);
}

/// Particles that drift through boxes, large and as small as can be, with few and many neighbours.
template <class S, class Space>
void check_neighbours_across(Space const& space) {
  using collide::polydisperse;
  struct {
    std::size_t n;
    double radius, way;
    double small;  ///< radius of most, beside others of 0.3 and 0.12; 0: all are the same
  } const cases[] = {{300, 0.08, 0.004, 0}, {300, 0.08, 0.7, 0},     {40, 0.452, 0.01, 0},
                     {150, 0.25, 0.05, 0},  {300, 0.08, 0.02, 0.05}, {700, 0.08, 0.02, 0.02}};
  for (auto const& one : cases) {
    CAPTURE(one.radius);
    CAPTURE(one.way);
    auto w = packed_cube<S>(one.n, one.radius, one.way);
    for (S& x : w.velocities) x += static_cast<S>(one.way);
    periodic_box const box{{-1, -1, -1}, {1, 1, 1}};
    if (one.small != 0) {
      for (std::size_t i = 0; i < one.n; ++i)
        w.radii.push_back(S(i % 30 == 0 ? 0.3 : i % 20 == 1 && one.small < 0.05 ? 0.12 : one.small));
      running<collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, greets, polydisperse, periodic_box>> made(
          space, w, greets{}, polydisperse{}, box);
      check_meetings_across<S>(made.simulation, S(0), 2, 40, S(1), 150);
    } else {
      running<collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, greets, periodic_box>> made(
          space, w, greets{}, box);
      check_meetings_across<S>(made.simulation, S(one.radius), 2, 40, S(1), 150);
    }
  }
}

/// A gas of grains with memory in a box that repeats has the same bits in each space and after a checkpoint; its
/// momentum stays.
template <class S, class Space>
void check_gas_across(Space const& space) {
  using law = granular_contact<hertz, mindlin, collide::epsd>;
  law const by{collide::one_material({1e6, 0.2, 2500}, {0.9, 0.3, 0.1})};
  periodic_box const box{{-0.05, -0.05, -0.05}, {0.05, 0.05, 0.05}};
  world<S> w;
  w.radius = S(0.01);
  std::mt19937 engine(9);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 64; ++i) {
    double const x = i % 4 * 0.025, y = i / 4 % 4 * 0.025, z = i / 16 * 0.025;
    w.particle(x - 0.05, y - 0.05, z - 0.05, 1 + 2 * uniform(engine), 2 * uniform(engine), 2 * uniform(engine));
  }
  using on_host =
      collide::simulation<meets_mesh<collide::host, collide::karabassi<>, S>, law, velocity_verlet, periodic_box>;
  using there = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, law, velocity_verlet, periodic_box>;
  auto const expected = bits_of_grains<on_host>(collide::host(1), w, 3000, false, by, velocity_verlet{}, box);
  for (bool const save : {false, true}) {
    auto const found = bits_of_grains<there>(space, w, 3000, save, by, velocity_verlet{}, box);
    CHECK(std::memcmp(found.data(), expected.data(), found.size() * sizeof(S)) == 0);
  }
  double changed = 0, scattered = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    double sum = 0;
    for (std::size_t i = 0; i < 64; ++i) {
      double const change = double(expected[192 + 3 * i + k]) - double(w.velocities[3 * i + k]);
      sum += change;
      scattered = std::max(scattered, std::abs(change));
    }
    changed = std::max(changed, std::abs(sum));
  }
  CHECK(scattered > 1);
  CHECK(changed < (sizeof(S) == 4 ? 1e-3 : 1e-12));
}

/// Grains that sleep against each other across a side keep their bits, until one is hit from across another side.
template <class S, class Space>
void check_sleep_across(Space const& space) {
  using law = granular_contact<hertz, mindlin>;
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, collide::sleep, law,
                                         velocity_verlet, periodic_box>;
  law const by{collide::one_material({1e6, 0.2, 2500}, {0.2, 0.3})};
  world<S> w;
  w.radius = S(0.01);
  w.particle(0.00995, 0.05, 0.05);
  w.particle(0.09005, 0.05, 0.05);
  w.particle(0.09005, 0.05, 0.09);
  running<simulation> made(space, w, collide::sleep{0.01, 20}, by, velocity_verlet{},
                           periodic_box{{0, 0, 0}, {0.1, 0.1, 0.1}});
  for (std::size_t i = 0; i < 3; ++i) write_particle<collide::slow_steps>(made.simulation, i, {std::uint8_t(20)});
  made.simulation.steps(2000, S(1e-5));
  CHECK(std::memcmp(w.centres.data(), made.positions().data(), w.centres.size() * sizeof(S)) == 0);
  write_particle<collide::slow_steps>(made.simulation, 2, {std::uint8_t(0)});
  write_particle<velocity>(made.simulation, 2, {S(0), S(0), S(1)});
  made.simulation.steps(3500, S(1e-5));
  CHECK(made.velocities()[3] == 0);
  made.simulation.steps(2500, S(1e-5));
  auto const v = made.velocities();
  CHECK(double(v[5]) > 0.3);                                      // has been hit from across the side in z
  CHECK(std::abs(double(v[0])) + std::abs(double(v[2])) > 1e-3);  // and has woken the one across the side in x
}

}  // namespace tests
