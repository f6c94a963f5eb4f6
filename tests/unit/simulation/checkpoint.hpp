/// Simulations that are saved and loaded; instantiated by test_checkpoint.cpp and test_checkpoint_cuda.cpp.
#pragma once

#include <cstring>
#include <sstream>
#include <string>

#include <collide/effects/absorb.hpp>
#include <collide/effects/adhesion.hpp>
#include <collide/effects/bounds.hpp>
#include <collide/effects/contact_forces.hpp>
#include <collide/effects/drag.hpp>
#include <collide/effects/emit.hpp>
#include <collide/effects/friction.hpp>
#include <collide/effects/lost_motion.hpp>
#include <collide/effects/sleep.hpp>
#include <collide/effects/spin.hpp>
#include <collide/effects/wind.hpp>
#include <collide/simulation/checkpoint.hpp>

#include "simulation/bodies.hpp"
#include "simulation/simulation.hpp"

namespace tests {

/// An effect of a user whose parameters mean nothing in another process.
struct pushed_by {
  using writes = collide::columns<velocity>;
  static constexpr bool saves_parameters = false;

  float const* most = nullptr;  ///< in memory of the space

  template <class Particle, class S>
  COLLIDE_HD void accelerate(Particle& p, S dt) const {
    if (most != nullptr) p[velocity{}] += collide::vec3<S>(S(*most), S(0), S(0)) * dt;
  }
};

/// All bits of the particles.
template <class Simulation, class... Column>
std::string bits_of(Simulation const& simulation, collide::columns<Column...>) {
  std::string all;
  auto const add = [&](auto const& values) {
    all.append(reinterpret_cast<char const*>(values.data()), values.size() * sizeof(values[0]));
  };
  (add(simulation.template to_host<Column>()), ...);
  double const time = simulation.time();
  return all.append(reinterpret_cast<char const*>(&time), sizeof time);
}
template <class Simulation>
std::string bits_of(Simulation const& simulation) {
  return bits_of(simulation, typename Simulation::columns());
}

template <class Simulation>
std::string saved(Simulation const& simulation) {
  std::ostringstream to(std::ios::binary);
  collide::save(simulation, to);
  return to.str();
}

template <class Simulation>
void load_from(std::string const& bytes, Simulation& simulation) {
  std::istringstream from(bytes, std::ios::binary);
  collide::load(simulation, from);
}

/// The error; empty if there is none.
template <class Simulation>
std::string fails_to_load(std::string const& bytes, Simulation& simulation) {
  try {
    load_from(bytes, simulation);
  } catch (collide::error const& error) {
    return error.what();
  }
  return "";
}

/// N steps are as k steps, save, load, N - k steps: to the last bit, whatever the simulation into which the state is
/// loaded did before, and whatever its effects' parameters were.
template <class Detector, class... Effect, class... Wanted>
void check_goes_on(typename Detector::execution_space const& space, world<typename Detector::scalar> const& w,
                   std::size_t capacity, double step, Wanted... wanted) {
  using made = running<collide::simulation<Detector, Effect...>>;
  auto const dt = static_cast<typename Detector::scalar>(step);
  constexpr std::size_t before = 301, after = 300;
  made whole(space, w, Effect(wanted)...), first(space, w, Effect(wanted)...);
  whole.place(w, capacity);
  first.place(w, capacity);
  whole.simulation.steps(before + after, dt);
  first.simulation.steps(before, dt);
  std::string const file = saved(first.simulation), then = bits_of(first.simulation);
  CHECK(then != bits_of(whole.simulation));

  world<typename Detector::scalar> other = w;
  other.centres.resize(std::min<std::size_t>(other.centres.size(), 3));
  other.velocities.resize(other.centres.size());
  if (!other.radii.empty()) other.radii.resize(other.size());
  made fresh(space, other, Effect()...);
  fresh.simulation.steps(3, std::min(dt, static_cast<decltype(dt)>(largest_time_step(fresh.simulation))));
  load_from(file, fresh.simulation);
  CHECK(bits_of(fresh.simulation) == then);
  CHECK(fresh.simulation.size() == first.simulation.size());
  fresh.simulation.steps(after, dt);
  CHECK(bits_of(fresh.simulation) == bits_of(whole.simulation));

  first.simulation.steps(after, dt);  // to save changes nothing
  CHECK(bits_of(first.simulation) == bits_of(whole.simulation));
  load_from(file, first.simulation);  // and it can be done again
  first.simulation.steps(after, dt);
  CHECK(bits_of(first.simulation) == bits_of(whole.simulation));
}

/// Balls in layers above a floor.
template <class S>
world<S> layers(int across, int high, double radius) {
  world<S> w;
  add_floor(w, 2, 8);
  w.radius = S(radius);
  for (int k = 0; k < high; ++k)
    for (int i = 0; i < across; ++i)
      for (int j = 0; j < across; ++j) {
        double const at = 2.1 * radius, shift = 0.3 * radius * (k % 3);
        w.particle(at * i + shift - 0.5, at * j - shift - 0.5, at * k + 2 * radius, 0.01 * i, -0.02 * j, 0);
      }
  return w;
}

/// Scenes of all effects, among them those of the gallery.
template <class Space>
void check_scenes_go_on(Space const& space) {
  using namespace collide;
  using collide::sleep;  // not that of unistd.h
  auto const w = layers<float>(5, 4, 0.05);
  auto const soft = sphere_contact::from_restitution(0.3, 0.02, 0.05, 100, 0.5);
  using at_rest = meets_mesh<Space>;
  using swept = meets_mesh<Space, karabassi_swept<>>;
  nozzle const above{{0, 0, 0.8}, 0.3, {0.1, 0, -1}, 0.1};

  SUBCASE("in free flight") { check_goes_on<detector<bucket, karabassi<>, Space>>(space, w, 0, 1e-3); }
  SUBCASE("marbles") {
    check_goes_on<at_rest, emit, gravity, sphere_contact, bounce, friction, spin>(
        space, w, 200, 1e-3, emit{500, above, 0, true}, gravity{}, soft, bounce{0.4}, friction{0.4, 0.3}, spin{0.01});
  }
  SUBCASE("snow") {
    check_goes_on<at_rest, emit, sleep, gravity, drag, sphere_contact, bounce, adhesion, box_walls>(
        space, w, 200, 1e-3, emit{150, above}, sleep{0.05, 20}, gravity{}, drag{0, 1}, soft, bounce{0}, adhesion{200},
        box_walls{{-0.6, -0.6, -box_walls::none}, {0.6, 0.6, box_walls::none}, 0});
  }
  SUBCASE("mud") {
    check_goes_on<at_rest, emit, gravity, sphere_contact, bounce, friction, adhesion, box_walls>(
        space, w, 110, 1e-3, emit{150, above}, gravity{}, soft, bounce{0}, friction{0.2, 0.1}, adhesion{3},
        box_walls{{-2, -2, -box_walls::none}, {2, 2, box_walls::none}, 0});
  }
  SUBCASE("dust") {
    check_goes_on<at_rest, emit, gravity, wind<>, bounce, absorbing_box>(
        space, w, 150, 1e-3, emit{150, above}, gravity{0, 0, -0.3}, wind<>{3, 0, {2.5, 0, 0}}, bounce{0.1},
        absorbing_box{{0.7, -10, -1}, {10, 10, 10}});
  }
  SUBCASE("swept, with doubles") {
    using detector = meets_mesh<Space, karabassi_swept<>, double, all_pairs>;
    check_goes_on<detector, velocity_verlet, gravity, bounce, friction, lost_motion>(
        space, layers<double>(4, 2, 0.05), 0, 2e-3, velocity_verlet{}, gravity{}, bounce{0.8}, friction{0.4, 0.3},
        lost_motion{});
  }
  SUBCASE("half kicks, of other particles too") {
    check_goes_on<at_rest, velocity_verlet, sleep, gravity, sphere_contact, bounce, adhesion, mesh_forces>(
        space, w, 0, 1e-3, velocity_verlet{}, sleep{0.05, 20}, gravity{}, soft, bounce{0.1}, adhesion{3},
        mesh_forces{100});
  }
  SUBCASE("radii that differ") {
    auto mixed = w;
    for (std::size_t i = 0; i < mixed.size(); ++i) mixed.radii.push_back(0.02f + 0.03f * static_cast<float>(i % 7) / 6);
    check_goes_on<swept, gravity, sphere_contact, bounce, polydisperse, absorb>(
        space, mixed, 0, 1e-3, gravity{0, 0, 1}, soft, bounce{0.5}, polydisperse{}, absorb{});
  }
  SUBCASE("forces, a user's column, periodic") {
    check_goes_on<at_rest, gravity, sphere_contact, bounce, warmth, periodic_box, mesh_forces, pair_forces>(
        space, w, 0, 1e-3, gravity{}, soft, bounce{0.5}, warmth{70, 2}, periodic_box{{-1, -1, -1}, {1, 1, 3}},
        mesh_forces{100}, pair_forces{100});
  }
}

/// Bodies go on from where they were: those of the family by the time, driven ones by their poses.
template <class Space, class NarrowPhase, class Motion>
void check_bodies_go_on(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, NarrowPhase>, gravity, bounce, friction, moving_bodies<Motion>>;
  auto const w = layers<float>(4, 2, 0.05);
  body_motion shakes;
  shakes.axis[0] = 0.1, shakes.rate = 1.5;
  shakes.amplitude[2] = 0.02, shakes.frequency = 4;
  auto const make = [&] {
    return running_bodies<simulation>(space, w, one_body(w, shakes), gravity{}, bounce{0.5}, friction{0.4, 0.3},
                                      moving_bodies<Motion>{});
  };
  auto const go = [&](auto& made, int steps) {
    for (int i = 0; i < steps; ++i) {
      if (std::is_same<Motion, collide::driven>::value) {  // on from where it is
        auto states = made.bodies();
        states[0].moving.linear[2] = 0.1;
        states[0].at.position[2] += 0.1 * 1e-3;
        states[0].at.rotation[1] += 1e-5;  // of length 1 only nearly
        made.simulation.space().copy_from_host(made.simulation.bodies().states(), states.data(), 1);
      }
      made.simulation.step(1e-3f);
    }
  };
  auto whole = make(), first = make(), next = make();
  go(whole, 300);
  go(first, 151);
  go(next, 7);
  std::string const file = saved(first.simulation);
  load_from(file, next.simulation);
  CHECK(saved(next.simulation) == file);
  go(next, 149);
  CHECK(bits_of(next.simulation) == bits_of(whole.simulation));
  running_bodies<simulation> none(space, w, {}, gravity{}, bounce{}, friction{}, moving_bodies<Motion>{});
  CHECK(fails_to_load(file, none.simulation).find("collide: load: poses of bodies: the file has") == 0);
}

/// Effects that may not be saved stay as the program that loads has them.
template <class Space>
void check_pointers_stay(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space>, pushed_by, collide::gravity>;
  world<float> const w = layers<float>(2, 1, 0.05);
  placed<float> const one(space, {1.f}), two(space, {2.f});
  running<simulation> first(space, w, pushed_by{one.data()}, collide::gravity{0, 0, 0});
  running<simulation> next(space, w, pushed_by{two.data()}, collide::gravity{});
  load_from(saved(first.simulation), next.simulation);
  CHECK(next.simulation.template effect<pushed_by>().most == two.data());
  CHECK(next.simulation.template effect<collide::gravity>().z == 0);
}

/// A scene saved in one space goes on in another, in the bits of that one if both agree.
template <class From, class To>
void check_other_space(From const& from, To const& to) {
  using collide::bounce;
  using collide::gravity;
  using collide::sleep;  // not that of unistd.h
  world<float> const w = layers<float>(5, 2, 0.05);
  running<collide::simulation<meets_mesh<From>, sleep, gravity, bounce>> first(from, w, sleep{}, gravity{},
                                                                               bounce{0.7});
  running<collide::simulation<meets_mesh<To>, sleep, gravity, bounce>> next(to, w);
  first.simulation.steps(200, 1e-3f);
  std::string const file = saved(first.simulation);
  load_from(file, next.simulation);
  CHECK(bits_of(next.simulation) == bits_of(first.simulation));
  CHECK(saved(next.simulation) == file);
}

}  // namespace tests
