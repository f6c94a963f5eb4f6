/// Granular contact: two bodies to the digits of other codes, walls that do not depend on their triangles, and what
/// contacts remember. Instantiated by test_granular.cpp and test_granular_cuda.cpp.
#pragma once

#include <sstream>

#include <collide/effects/granular_contact.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/effects/sleep.hpp>
#include <collide/simulation/checkpoint.hpp>
#include <collide/simulation/energy.hpp>

#include "simulation/bodies.hpp"

namespace tests {

using collide::angular_velocity;
using collide::granular_contact;
using collide::hertz;
using collide::mindlin;
using collide::none;
using collide::velocity_verlet;

// the solids of the common benchmark: M. Dosta et al., Computer Physics Communications 296, 2024
constexpr collide::solid glass{1e9, 0.2, 2500}, soft{0.5e9, 0.2, 2000}, steel{210e9, 0.2, 7200};

inline collide::materials<3> benchmark_materials() {
  collide::materials<3> m;
  m.set(0, glass);
  m.set(1, soft);
  m.set(2, steel);
  m.set_pair(0, 0, {0.5, 0.3});
  m.set_pair(1, 1, {0.4, 0.4});
  m.set_pair(0, 1, {0.45, 0.2});
  m.set_pair(0, 2, {0.4, 0.2});
  m.set_pair(1, 2, {0.4, 0.2});
  m.set_pair(2, 2, {0.6, 0.5});
  return m;
}

/// The variant of LAMMPS, `pair_style granular` with `tangential mindlin`.
inline mindlin mindlin_of_lammps(bool dashpot) {
  mindlin law;
  law.damping = dashpot ? collide::tangential_damping::of_normal : collide::tangential_damping::none;
  law.test = collide::slip_test::spring_and_dashpot;
  law.keeps_length = true;
  return law;
}

/// A glass ball that hits a steel wall: LAMMPS 22 Jul 2025 in double; 0.4 as dt goes to 0.
template <class Space>
void check_hertz_rebound(Space const& space) {
  using law = granular_contact<hertz, none, none, none, collide::materials<3>>;
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, double>, law, velocity_verlet>;
  law by;
  by.made_of = benchmark_materials();
  by.made_of.wall_material = 2;
  world<double> w;
  w.radius = 0.001;
  add_floor(w, 0.01, 3);
  w.particle(0, 0, 0.00101, 0, 0, -1);
  running<simulation> made(space, w, by, velocity_verlet{});
  made.simulation.steps(121, 5e-7);
  CHECK(made.positions()[2] == doctest::Approx(0.00100724021038573).epsilon(1e-14));
  CHECK(made.velocities()[2] == doctest::Approx(0.401075050085351).epsilon(1e-13));
  compared<double>("glass hits a steel wall, steps of 5e-7 s", "LAMMPS, all its digits", made.velocities()[2],
                   0.401075050085351);
  made.place(w);
  made.simulation.steps(6050, 1e-8);
  CHECK(made.velocities()[2] == doctest::Approx(0.4).epsilon(1e-4));
}

/// Two glass balls that hit each other aslant: LAMMPS 22 Jul 2025, without and with a dashpot, and LIGGGHTS 3.8, to all
/// their digits; that of LIGGGHTS without a dashpot, and MercuryDPM's, as a program that shares no code with the
/// library has them (it has LIGGGHTS' digits, too). Decks: two spheres of these places and velocities, `fix
/// nve/sphere`, `pair_style granular`, `hertz/material 1e9 0.5 0.2 tangential mindlin NULL 0 0.3 damping
/// coeff_restitution` (0 or 1: the dashpot), or `pair_style gran model hertz tangential history`.
template <class Space>
void check_oblique_pair(Space const& space) {
  using law = granular_contact<hertz, mindlin>;
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, double>, law, velocity_verlet>;
  world<double> w;
  w.radius = 0.001;
  w.particle(0, 0, 0.00101, 0.5, 0, -1);
  w.particle(0, 0, -0.001);
  struct variant {
    mindlin law;
    double slip_shortening, u, v, turn;
    char const* code;
  };
  mindlin liggghts, undamped, mercury;
  undamped.damping = mercury.damping = collide::tangential_damping::none;
  mercury.stiffness_factor = 2.0 / 3;
  char const *const of_lammps = "LAMMPS, all its digits", *const of_liggghts = "LIGGGHTS, all its digits";
  for (variant const& of :
       {variant{mindlin_of_lammps(false), 0, 0.4143449104586469, -0.2516545506517658, 222.5724849225702, of_lammps},
        variant{mindlin_of_lammps(true), 0, 0.4221094177879601, -0.251942726448496, 203.8704097761686, of_lammps},
        variant{liggghts, 0.5, 0.4337713260993947, -0.2517349391960421, 174.2746830981455, of_liggghts},
        variant{undamped, 0.5, 0.4138469662821288, -0.2516507058032295, 223.8107793588897, nullptr},
        variant{mercury, 0.5, 0.3821633589617264, -0.2514506904970039, 302.7419112658760, nullptr}}) {
    law by{collide::one_material(glass, {0.5, 0.3}), {}, of.law};
    by.slip_shortening = of.slip_shortening;
    running<simulation> made(space, w, by, velocity_verlet{});
    made.simulation.steps(16000, 5e-9);
    auto const v = made.velocities(), turn = made.simulation.template to_host<angular_velocity>();
    CHECK(v[0] == doctest::Approx(of.u).epsilon(1e-12));
    CHECK(v[2] == doctest::Approx(of.v).epsilon(1e-12));
    CHECK(turn[1] == doctest::Approx(of.turn).epsilon(1e-12));
    CHECK(turn[4] == turn[1]);
    CHECK(v[0] + v[3] == doctest::Approx(0.5).epsilon(1e-13));
    CHECK(v[2] + v[5] == doctest::Approx(-1).epsilon(1e-13));
    if (of.code == nullptr) continue;
    compared<double>("two glass spheres meet aslant", of.code, v[0], of.u);
    compared<double>("two glass spheres meet aslant", of.code, v[2], of.v);
    // both move on together, so that lists are made anew all the time: what is remembered comes along
    world<double> fast = w;
    fast.velocities[1] = fast.velocities[4] = 100;
    made.place(fast);
    made.simulation.steps(16000, 5e-9);
    CHECK(made.velocities()[0] == doctest::Approx(v[0]).epsilon(1e-9));
    CHECK(made.velocities()[2] == doctest::Approx(v[2]).epsilon(1e-9));
  }
}

/// A steel ball that is pulled over glass: LAMMPS without and with a dashpot, and MercuryDPM.
template <class Space>
void check_pulled_ball(Space const& space) {
  using law = granular_contact<hertz, mindlin, none, none, collide::materials<3>>;
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, double>, gravity, law, velocity_verlet>;
  struct variant {
    mindlin law;
    double arm, x, u, turn;
  };
  mindlin mercury;
  mercury.damping = collide::tangential_damping::none;
  mercury.stiffness_factor = 2.0 / 3;
  variant const variants[] = {{mindlin_of_lammps(false), 0, 5.0017107677534e-05, 0.020002509709596, 12.4999757260097},
                              {mindlin_of_lammps(true), 0, 5.00145666955637e-05, 0.020002000000031, 12.501249999922},
                              {mercury, 0.5, 5.00201149456655e-05, 0.0200031141978808, 12.4983210042401}};
  for (auto const& of : variants) {
    law by{benchmark_materials(), {}, of.law};
    by.arm_shortening = by.slip_shortening = of.arm;
    world<double> w;
    w.radius = 0.001;
    add_floor(w, 0.01, 3);
    w.particle(0, 0, 0.001);
    running<simulation> made(space, w, gravity{5, 0, -5}, by, velocity_verlet{});
    placed<std::uint8_t> const of_steel(space, {2});
    made.simulation.template assign<collide::material>(of_steel.data());
    made.simulation.steps(10001, 5e-7);
    CHECK(made.positions()[0] == doctest::Approx(of.x).epsilon(1e-11));
    CHECK(made.positions()[2] == doctest::Approx(0.000999977169022225).epsilon(1e-14));
    CHECK(made.velocities()[0] == doctest::Approx(of.u).epsilon(1e-11));
    compared<double>("a steel sphere is pulled over glass",
                     of.arm == 0 ? "LAMMPS, all its digits" : "MercuryDPM, all its digits", made.velocities()[0], of.u);
    CHECK(made.simulation.template to_host<angular_velocity>()[1] == doctest::Approx(of.turn).epsilon(1e-11));
  }
}

/// A floor whose sides are divided n times, in the plane z = 0 or turned.
template <class S>
void add_divided_floor(world<S>& w, double half, int n, double slope = 0) {
  double const cell = 2 * half / n;
  auto const at = [&](int i) { return -half + cell * i; };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      double const x[] = {at(i), at(i + 1)}, y[] = {at(k), at(k + 1)}, z[] = {slope * x[0], slope * x[1]};
      w.triangle({x[0], y[0], z[0], x[1], y[0], z[1], x[1], y[1], z[1]});
      w.triangle({x[0], y[0], z[0], x[1], y[1], z[1], x[0], y[1], z[0]});
    }
}

/// Balls that slide and roll over a flat wall have the same bits, whatever its triangles are; over one that is turned
/// the same digits.
template <class S, class Space>
void check_divided_walls(Space const& space) {
  using law = granular_contact<hertz, mindlin>;
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, gravity, law, velocity_verlet>;
  law const by{collide::one_material({1e7, 0.2, 2500}, {0.5, 0.3})};
  for (double const slope : {0.0, 0.3}) {
    std::vector<S> x, turn;
    for (int const n : {1, 10, 100}) {
      world<S> w;
      w.radius = S(0.01);
      add_divided_floor(w, 1, n, slope);
      double const steep = std::sqrt(1 + slope * slope);
      for (int k = 0; k < 40; ++k) {
        double const at = 0.013 * k - 0.4;
        w.particle(at, 0.017 * k - 0.5, slope * at + 0.00999 * steep, 1 + 0.03 * k, 0.7 - 0.04 * k,
                   slope * (1 + 0.03 * k));
      }
      running<simulation> made(space, w, gravity{}, by, velocity_verlet{});
      made.simulation.steps(2000, S(2e-5));
      auto const y = made.positions(), turned = made.simulation.template to_host<angular_velocity>();
      if (n == 1) x = y, turn = turned;
      if (slope == 0) {
        CHECK(std::memcmp(x.data(), y.data(), x.size() * sizeof(S)) == 0);
        CHECK(std::memcmp(turn.data(), turned.data(), turn.size() * sizeof(S)) == 0);
      } else {
        double most = 0;
        for (std::size_t k = 0; k < x.size(); ++k) most = std::max(most, std::abs(double(x[k]) - double(y[k])));
        CHECK(most < (sizeof(S) == 4 ? 2e-5 : 1e-10));
      }
    }
  }
}

/// Balls at rest on a tilted floor, also next to an edge, overlap it by as much however it is divided, within a unit in
/// the last place of its coordinates, which are rounded: what they gain in a step says so.
template <class S, class Space>
void check_tilted_walls(Space const& space) {
  using law = granular_contact<hertz, mindlin>;
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, gravity, law, velocity_verlet>;
  law const by{collide::one_material({1e7, 0.2, 2500}, {0.5, 0.3})};
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> uniform(-0.9, 0.9);
  std::vector<double> places(400);
  for (double& place : places) place = uniform(engine);
  for (int k = 0; k < 20; ++k) places.insert(places.end(), {0.6 + std::ldexp(k % 2 == 0 ? 1 : -1, -6 - k), 0.3});
  for (double const slope : {0.25, 0.3})
    for (double const overlap : {1e-5, 1e-3}) {
      std::vector<S> of_two;
      for (int const n : {1, 10, 100}) {
        world<S> w;
        w.radius = S(0.01);
        add_divided_floor(w, 1, n, slope);
        for (std::size_t k = 0; k < places.size(); k += 2)
          w.particle(places[k], places[k + 1], slope * places[k] + (0.01 - overlap) * std::sqrt(1 + slope * slope));
        running<simulation> made(space, w, gravity{0, 0, 0}, by, velocity_verlet{});
        made.simulation.steps(2, S(1e-6));
        auto const v = made.velocities();
        if (n == 1) of_two = v;
        double most = 0;
        for (std::size_t k = 0; k < v.size(); k += 3) {
          double off = 0, speed = 0;
          for (std::size_t c = k; c < k + 3; ++c) {
            off = std::hypot(off, double(v[c]) - double(of_two[c]));
            speed = std::hypot(speed, double(of_two[c]));
          }
          most = std::max(most, off / speed * overlap / 1.5);  // the force is as the overlap to 3/2
        }
        CHECK(most < double(std::numeric_limits<S>::epsilon()));
      }
    }
}

/// Grains that fall onto each other, some of many sizes.
template <class S>
world<S> falling_grains(int n, bool many_sizes) {
  world<S> w;
  add_divided_floor(w, 0.2, 8);
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  w.radius = S(0.01);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        double const cell = 0.0201;
        w.particle(cell * (i - n / 2) + 1e-4 * uniform(engine), cell * (j - n / 2) + 1e-4 * uniform(engine),
                   0.0101 + cell * k + 1e-4 * uniform(engine), 0.3 * uniform(engine), 0.3 * uniform(engine), -0.5);
        if (many_sizes) w.radii.push_back(S(k == n - 1 ? 0.01 : 0.004));
      }
  if (many_sizes) {
    w.particle(0, 0, 0.0101 + 0.0201 * n + 0.04, 0, 0, -1);
    w.radii.push_back(S(0.04));
  }
  return w;
}

template <class Simulation, class... Effect>
auto bits_of_grains(typename Simulation::execution_space const& space, world<typename Simulation::scalar> const& w,
                    int steps, bool save, Effect... effects) {
  using S = typename Simulation::scalar;
  running<Simulation> made(space, w, effects...);
  for (int half = 0; half < 2; ++half) {
    made.simulation.steps(std::size_t(steps / 2), S(1e-5));
    if (!save || half == 1) continue;
    std::stringstream file;
    collide::save(made.simulation, file);
    made.place(w);
    made.simulation.step(S(1e-5));
    collide::load(made.simulation, file);
  }
  auto bits = made.positions();
  for (auto const& more : {made.velocities(), made.simulation.template to_host<angular_velocity>()})
    bits.insert(bits.end(), more.begin(), more.end());
  return bits;
}

/// The memory of contacts is the same in every space, and goes on after a checkpoint, with lists and with runs of them.
template <class S, class Space>
void check_same_grains(Space const& space) {
  using law = granular_contact<hertz, mindlin, collide::epsd>;
  law const by{collide::one_material({1e7, 0.2, 2500}, {0.5, 0.3, 0.1})};
  auto const check = [&](auto const& w, int steps, auto... effects) {
    using on_host = collide::simulation<meets_mesh<collide::host, collide::karabassi<>, S>, decltype(effects)...>;
    using there = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, decltype(effects)...>;
    auto const expected = bits_of_grains<on_host>(collide::host(1), w, steps, false, effects...);
    for (bool const save : {false, true}) {
      auto const found = bits_of_grains<there>(space, w, steps, save, effects...);
      CHECK(std::memcmp(found.data(), expected.data(), found.size() * sizeof(S)) == 0);
    }
  };
  check(falling_grains<S>(4, false), 1600, gravity{}, by, velocity_verlet{});
  check(falling_grains<S>(5, true), 1000, collide::polydisperse{}, gravity{}, by, velocity_verlet{});
}

/// A ball that is laid on a belt, or on a plate that moves, rolls at 2/7 of its speed once it no longer slides; what it
/// has got the body has lost, and its weight.
template <class S, class Space>
void check_moving_walls(Space const& space) {
  using law = granular_contact<hertz, mindlin>;
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, gravity, law, collide::reaction,
                                         velocity_verlet, moving_bodies<>>;
  law const by{collide::one_material({1e7, 0.2, 2500}, {0.3, 0.3})};
  double const speed = 0.1, dt = 2e-5, mass = 2500 * 4 / 3 * pi * 1e-6;
  for (bool const is_belt : {false, true}) {
    world<S> w;
    w.radius = S(0.01);
    add_divided_floor(w, 1, 4);
    w.particle(0, 0, 0.01);
    body_motion motion{};
    (is_belt ? motion.belt : motion.velocity)[0] = speed;
    collide::reaction_sums sums(space, 1, mass * 1e-12);
    running_bodies<simulation> made(space, w, one_body(w, motion), gravity{}, by, sums.effect(2500), velocity_verlet{},
                                    moving_bodies<>{});
    made.simulation.steps(10000, S(dt));
    double const u = double(made.velocities()[0]);
    CHECK(u == doctest::Approx(speed * 2 / 7).epsilon(2e-3));
    CHECK(double(made.simulation.template to_host<angular_velocity>()[1]) ==
          doctest::Approx((u - speed) / 0.01).epsilon(2e-3));
    auto const given = sums.read(space)[0];
    CHECK(given.linear[0] == doctest::Approx(-mass * u).epsilon(1e-3).scale(0));
    CHECK(given.linear[2] == doctest::Approx(-mass * 9.81 * 10000 * dt).epsilon(1e-2).scale(0));
  }
}

/// Grains that have come to rest sleep, keep their bits, and press with their weight.
template <class S, class Space>
void check_sleeping_grains(Space const& space) {
  using law = granular_contact<hertz, mindlin, collide::epsd>;
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, collide::sleep, gravity, law,
                                         collide::reaction, velocity_verlet>;
  law const by{collide::one_material({1e7, 0.2, 2500}, {0.2, 0.5, 0.1})};
  world<S> w;
  w.radius = S(0.01);
  add_divided_floor(w, 1, 4);
  for (int k = 0; k < 4; ++k) w.particle(0.0199 * (k % 2), 0.0199 * (k / 2), 0.01);
  w.particle(0.00995, 0.00995, 0.0242);
  double const mass = 5 * 2500 * 4 / 3 * pi * 1e-6, dt = 2e-5;
  collide::reaction_sums sums(space, 0, mass * 1e-12);
  running<simulation> made(space, w, collide::sleep{1e-3, 100}, gravity{}, by, sums.effect(2500), velocity_verlet{});
  made.simulation.steps(40000, S(dt));
  auto const x = made.positions(), turn = made.simulation.template to_host<angular_velocity>();
  for (auto const slow : made.simulation.template to_host<collide::slow_steps>()) CHECK(int(slow) >= 100);
  sums.clear(space);
  made.simulation.steps(10000, S(dt));
  CHECK(std::memcmp(x.data(), made.positions().data(), x.size() * sizeof(S)) == 0);
  CHECK(sums.read(space)[0].linear[2] == doctest::Approx(-mass * 9.81 * 10000 * dt).epsilon(1e-2).scale(0));
}

/// Grains asleep on a body are woken where that begins to move, and go with it, however slowly: the lowest of a stack
/// and what lies on it.
template <class Integrator, class S, class Space>
void check_sleep_on_bodies(Space const& space) {
  using law = granular_contact<hertz, mindlin, collide::epsd>;
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, Integrator, collide::sleep,
                                         gravity, law, moving_bodies<collide::driven>>;
  law const by{collide::one_material({1e7, 0.2, 2500}, {0.2, 0.5, 0.1})};
  world<S> w;
  w.radius = S(0.1);
  add_divided_floor(w, 1, 4);
  w.particle(0.01, 0.02, 0.0985);
  w.particle(0.01, 0.02, 0.2975);
  running_bodies<simulation> made(space, w, one_body(w, {}), Integrator{}, collide::sleep{0.01, 100}, gravity{}, by,
                                  moving_bodies<collide::driven>{});
  double const dt = 1e-3;
  auto const height = [&](std::size_t k) { return double(made.positions()[3 * k + 2]); };
  made.simulation.steps(600, S(dt));
  for (auto const slow : made.simulation.template to_host<collide::slow_steps>()) CHECK((slow >= 100 && slow < 128));
  double const low = height(0), high = height(1);
  collide::body_state state;
  for (double const speed : {-0.005, -0.1, 0.005}) {
    state.moving.linear[2] = speed;
    for (int i = 0; i < 300; ++i) {
      state.at.position[2] += speed * dt;
      made.simulation.space().copy_from_host(made.simulation.bodies().states(), &state, 1);
      made.simulation.step(S(dt));
      made.simulation.space().synchronize();
    }
    CHECK(std::abs(height(0) - low - state.at.position[2]) < 5e-4);
    CHECK(std::abs(height(1) - high - state.at.position[2]) < 1e-3);
  }
}

/// A grain that falls asleep and is woken again and again lies still, and presses with its weight all the time.
template <class Integrator, class S, class Space>
void check_weight_of_naps(Space const& space) {
  using law = granular_contact<hertz, mindlin>;
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, Integrator, collide::sleep,
                                         gravity, law, collide::reaction>;
  law const by{collide::one_material({1e7, 0.2, 2500}, {0.2, 0.5})};
  world<S> w;
  w.radius = S(0.1);
  add_divided_floor(w, 1, 4);
  w.particle(0.01, 0.02, 0.1);
  double const mass = 2500 * 4 / 3 * pi * 1e-3, dt = 1e-3;
  collide::reaction_sums sums(space, 0, mass * 1e-12);
  running<simulation> made(space, w, Integrator{}, collide::sleep{0.01, 127}, gravity{}, by, sums.effect(2500));
  made.simulation.steps(400, S(dt));
  sums.clear(space);
  for (int i = 0; i < 20; ++i) {
    CHECK(made.simulation.template to_host<collide::slow_steps>()[0] == 127);
    made.simulation.template effect<gravity>();
    made.simulation.step(S(dt));
    CHECK(std::abs(double(made.velocities()[2])) < 0.05 * 9.81 * dt);
    made.simulation.steps(199, S(dt));
  }
  CHECK(std::abs(sums.read(space)[0].linear[2] / (mass * 9.81 * dt) + 4000) < 1);
}

/// A body that the caller drives presses on nothing where it lies in memory.
template <class S, class Space>
void check_first_pose_of_walls(Space const& space) {
  using law = granular_contact<hertz>;
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, law, velocity_verlet,
                                         moving_bodies<collide::driven>>;
  world<S> w;
  w.radius = S(0.1);
  add_divided_floor(w, 1, 4);
  w.particle(0.01, 0.02, 0.09);
  running_bodies<simulation> made(space, w, one_body(w, {}), law{collide::one_material({1e7, 0.2, 2500}, {0.2, 0.5})},
                                  velocity_verlet{}, moving_bodies<collide::driven>{});
  collide::body_state state;
  state.at.position[2] = -5;
  made.simulation.space().copy_from_host(made.simulation.bodies().states(), &state, 1);
  made.simulation.steps(2, S(1e-4));
  CHECK(made.velocities()[2] == 0);
}

/// The springs of walls hold what a ball has lost of its motion, to the bound of the integrator: velocity Verlet keeps
/// energy + dt^2 (k v^2 / 12 - F^2 / (24 m)).
template <class Space>
void check_energy_at_walls(Space const& space) {
  using law = granular_contact<hertz, mindlin>;
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, double>, gravity, law, velocity_verlet>;
  mindlin spring;
  spring.damping = collide::tangential_damping::none;
  law const by{collide::one_material({1e6, 0.25, 1000}, {1, 1e3}), {}, spring};
  world<double> w;
  w.radius = 0.01;
  add_divided_floor(w, 1, 4);
  double const speed = 0.5, overlap = 1e-4, mass = 1000 * 4.0 / 3 * pi * 1e-6, young = 1e6 / (2 * (1 - 0.0625));
  w.particle(0.05, 0.02, 0.0101, 0, 0, -speed);
  running<simulation> made(space, w, gravity{0, 0, 0}, by, velocity_verlet{});
  double const start = collide::energy(made.simulation).total();
  CHECK(start == doctest::Approx(0.5 * mass * speed * speed).scale(0));
  auto const largest_error = [&](int steps, double dt) {
    double off = 0, most = 0, deepest = 0;
    made.place(w);
    for (int k = 0; k < steps; ++k) {
      made.simulation.step(dt);
      auto const now = collide::energy(made.simulation);
      off = std::max(off, std::abs(now.total() - start));
      most = std::max(most, now.elastic);
      deepest = std::max(deepest, 0.01 - made.positions()[2]);
    }
    CHECK(most > 0.999 * start);
    CHECK(made.velocities()[2] > 0.99 * speed);
    double const a = std::sqrt(0.01 * deepest), force = 4.0 / 3 * young * a * deepest;
    CHECK(off < 1.1 * dt * dt * std::max(2 * young * a * speed * speed / 12, force * force / (24 * mass)));
    return off;
  };
  double const coarse = largest_error(500, 1e-5), fine = largest_error(1000, 5e-6);
  CHECK(coarse > 3.5 * fine);

  w.centres[2] = 0.01 - overlap;
  w.velocities = {speed, 0, 0};
  made.place(w);
  made.simulation.step(1e-6);
  auto const found = collide::energy(made.simulation);
  double const shear = 1e6 / 2.5 / (2 * 1.75), a = std::sqrt(0.01 * overlap), slip = speed * 1e-6;
  CHECK(found.elastic == doctest::Approx(8.0 / 15 * young * a * overlap * overlap).epsilon(1e-6).scale(0));
  CHECK(found.tangential == doctest::Approx(0.5 * 8 * shear * a * slip * slip).epsilon(1e-3).scale(0));
}

/// Grains each of which overlaps many more than sixteen: room that steps find by themselves gives the bits of room that
/// was reserved. A space that does not wait says that there is none.
template <class S, class Space>
void check_many_neighbours(Space const& space) {
  using law = granular_contact<hertz, mindlin>;
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, law, velocity_verlet>;
  law const by{collide::one_material({1e4, 0.2, 2500}, {0.5, 0.3})};
  world<S> w;
  w.radius = S(0.01);
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-0.01, 0.01);
  for (int i = 0; i < 60; ++i)
    w.particle(uniform(engine), uniform(engine), uniform(engine), 10 * uniform(engine), 10 * uniform(engine), 0);
  auto const played = [&](std::size_t reserved) {
    running<simulation> made(space, w, by, velocity_verlet{});
    if (reserved != 0) {
      made.simulation.reserve(reserved);
      made.place(w);
    }
    std::size_t const before = made.simulation.bytes();
    made.simulation.steps(150, S(2e-5));
    CHECK((made.simulation.bytes() > before) == (reserved == 0 && Space::host_accessible));
    auto bits = made.positions(), v = made.velocities();
    bits.insert(bits.end(), v.begin(), v.end());
    return bits;
  };
  auto const expected = played(600 * 60);
  CHECK(std::abs(double(expected[0]) - double(w.centres[0])) > 1e-5);
  if (Space::host_accessible) {
    auto const found = played(0);
    CHECK(std::memcmp(found.data(), expected.data(), found.size() * sizeof(S)) == 0);
  } else {
    CHECK_THROWS_WITH_AS(played(0),
                         "collide: simulation: contacts have found no room for what they remember, as many particles "
                         "have more than 16 neighbours: call reserve with several times as many particles before set, "
                         "and begin anew",
                         collide::error);
  }
}

}  // namespace tests
