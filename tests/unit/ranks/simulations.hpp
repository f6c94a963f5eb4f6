/// \file
/// Checks that simulations on ranks do the same as one simulation of everything, bit for bit. Each rank checks its own
/// particles, and says what is wrong; used with threads by the unit tests, and with MPI by tests/mpi.
#pragma once

#include <tuple>

#include <collide/effects/absorb.hpp>
#include <collide/effects/adhesion.hpp>
#include <collide/effects/bodies.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/effects/bounds.hpp>
#include <collide/effects/contact_forces.hpp>
#include <collide/effects/drag.hpp>
#include <collide/effects/emit.hpp>
#include <collide/effects/friction.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/effects/sleep.hpp>
#include <collide/effects/spin.hpp>
#include <collide/effects/wind.hpp>
#include <collide/ranks/distributed_simulation.cuh>

#include "ranks/ranks.hpp"
#include "simulation/neighbours.hpp"

namespace tests {

/// A scene, and how it goes on.
template <class Simulation, class... Effect>
struct played_scene {
  using simulation = Simulation;
  using S = typename Simulation::scalar;

  std::string name;
  world<S> w;
  std::tuple<Effect...> effects;
  int steps;
  S dt;
  std::size_t capacity = 0;
  std::vector<collide::body> bodies = {};
};
template <class Simulation, class... Effect>
played_scene<Simulation, Effect...> scene_of(std::string name, world<typename Simulation::scalar> w, int steps,
                                             double dt, Effect... effects) {
  return {std::move(name), std::move(w), {effects...}, steps, static_cast<typename Simulation::scalar>(dt)};
}

/// The values of all columns of particles.
struct column_values {
  struct column {
    std::vector<unsigned char> bytes;
    std::size_t width;  ///< bytes of a particle
    bool is_scalar;     ///< the values are of the type of a simulation's numbers
  };
  std::vector<column> of;

  template <class T>
  void add(std::vector<T> const& values, std::size_t width, bool is_scalar) {
    auto const* const bytes = reinterpret_cast<unsigned char const*>(values.data());
    of.push_back({{bytes, bytes + values.size() * sizeof(T)}, width * sizeof(T), is_scalar});
  }
  /// The values of `n` particles from `first` on.
  column_values part(std::size_t first, std::size_t n) const {
    column_values p;
    for (column const& c : of) {
      auto const begin = c.bytes.begin() + static_cast<std::ptrdiff_t>(c.width * first);
      p.of.push_back({{begin, begin + static_cast<std::ptrdiff_t>(c.width * n)}, c.width, c.is_scalar});
    }
    return p;
  }
  friend bool equal(column_values const& a, column_values const& b) {
    return std::equal(a.of.begin(), a.of.end(), b.of.begin(), b.of.end(),
                      [](column const& x, column const& y) { return x.bytes == y.bytes; });
  }
};
template <class S, class List>
struct all_values;
template <class S, class... C>
struct all_values<S, collide::columns<C...>> : column_values {
  template <class Simulation>
  void read(Simulation& from) {
    of.clear();
    (add(from.template to_host<C>(), std::size_t(collide::detail::column_layout<C, S>::width),
         std::is_same<collide::detail::column_element<C, S>, S>::value),
     ...);
  }
};
template <class Simulation>
using values_of = all_values<typename Simulation::scalar, typename Simulation::columns>;

template <class Space>
Space space_of_rank() {
  if constexpr (std::is_same<Space, collide::host>::value) {
    return collide::host(1);
  } else {
    return Space();
  }
}

/// A world in memory of a space, and how a simulation gets it.
template <class Space, class S>
class world_in {
 public:
  world_in(Space const& space, world<S> const& w)
      : corners_(space, w.corners),
        centres_(space, w.centres),
        velocities_(space, w.velocities),
        radii_(space, w.radii),
        radius_{w.radius} {}

  template <class Simulation>
  void set_mesh(Simulation& to, std::vector<collide::body> const& bodies = {}) const {
    to.set_mesh(collide::triangle_soup(corners_.data(), corners_.size() / 9), bodies);
  }
  /// Sets a part of the particles.
  template <class Simulation>
  void set(Simulation& to, range part, std::size_t capacity = 0) const {
    S const* const centres = centres_.data() + 3 * part.first;
    to.set(radii_.size() == 0 ? collide::spheres_xyz(centres, part.size, radius_)
                              : collide::spheres_xyz(centres, part.size, radii_.data() + part.first),
           velocities_.data() + 3 * part.first, capacity);
    to.space().synchronize();
  }

 private:
  placed<S> corners_, centres_, velocities_, radii_;
  S radius_;
};

/// The states of one simulation of a scene: in the middle, and in the end.
template <class Scene>
struct expected_values {
  values_of<typename Scene::simulation> middle, end;
  collide::birth_counts births;

  explicit expected_values(Scene const& scene) {
    std::apply(
        [&](auto const&... effects) {
          using space_type = typename Scene::simulation::execution_space;
          typename Scene::simulation one(space_of_rank<space_type>(), effects...);
          world_in<space_type, typename Scene::S> const there(one.space(), scene.w);
          there.set_mesh(one, scene.bodies);
          there.set(one, {0, scene.w.size()}, scene.capacity);
          one.steps(static_cast<std::size_t>(scene.steps / 2), scene.dt);
          middle.read(one);
          one.steps(static_cast<std::size_t>(scene.steps - scene.steps / 2), scene.dt);
          end.read(one);
          if constexpr (Scene::simulation::effects_type::makes) births = one.births();
        },
        scene.effects);
  }
};

/// Ranks make the same of the scene.
template <class Scene, class Ranks>
void check_scene(Ranks const& ranks, Scene const& scene, expected_values<Scene> const& expected, split how,
                 complaints& wrong) {
  using simulation = typename Scene::simulation;
  wrong.in(scene.name + ", " + std::to_string(ranks.size()) + " ranks, split " + std::to_string(int(how)));
  range own = part_of(scene.w.size(), how, ranks.rank(), ranks.size());
  std::apply(
      [&](auto const&... effects) {
        using space_type = typename simulation::execution_space;
        collide::distributed<simulation, Ranks> parts(ranks, space_of_rank<space_type>(), effects...);
        world_in<space_type, typename Scene::S> const there(parts.space(), scene.w);
        there.set_mesh(parts, scene.bodies);
        there.set(parts, own, scene.capacity);
        if (ranks.rank() + 1 == ranks.size() && scene.capacity > scene.w.size())
          own.size += scene.capacity - scene.w.size();
        values_of<simulation> found;
        parts.steps(static_cast<std::size_t>(scene.steps / 2), scene.dt);
        found.read(parts);
        wrong.expect(equal(found, expected.middle.part(own.first, own.size)), "in the middle");
        parts.steps(static_cast<std::size_t>(scene.steps - scene.steps / 2), scene.dt);
        found.read(parts);
        wrong.expect(equal(found, expected.end.part(own.first, own.size)), "in the end");
        wrong.expect(parts.size() == std::max(scene.w.size(), scene.capacity), "the number of places is of all");
        if constexpr (simulation::effects_type::makes) {
          auto const births = parts.births();
          wrong.expect(births.due == expected.births.due && births.overlapping == expected.births.overlapping &&
                           births.not_born == expected.births.not_born,
                       "what was born");
        }
      },
      scene.effects);
}

// ---- the scenes

template <class Space, class S = float>
using discrete = meets_mesh<Space, collide::karabassi<>, S>;

/// Grains that fall into a box, roll, and lie on each other.
template <class S, class NarrowPhase = collide::karabassi<>, class Space = collide::host>
auto grains_in_a_box() {
  using namespace collide;
  auto w = crowd<S>(500, 1, 0.09, 2, 11);
  return scene_of<simulation<meets_mesh<Space, NarrowPhase, S>, sphere_contact, gravity, bounce, friction, spin>>(
      "grains", w, 200, 1e-3, sphere_contact::from_restitution(0.6, 0.02, 0.09, 1000, 0.5), gravity{}, bounce{0.5},
      friction{0.5, 0.5}, spin{0.01});
}

/// Grains of three sizes that go round in a box, many at a time.
template <class Space = collide::host>
auto sizes_that_repeat() {
  using namespace collide;
  auto w = packed_cube<float>(500, 0.05, 3);
  for (std::size_t i = 0; i < 500; ++i) w.radii.push_back(i % 50 == 0 ? 0.3f : i % 5 == 0 ? 0.1f : 0.03f);
  return scene_of<simulation<discrete<Space>, velocity_verlet, polydisperse, sphere_contact, greets, periodic_box>>(
      "sizes", w, 100, 2e-3, velocity_verlet{}, polydisperse{}, sphere_contact{5, 0.01, 0.2, 0.01, 1}, greets{},
      periodic_box{{-1, -1, -1}, {1, 1, 1}});
}

/// A cube of grains, and far from it a row: ranks between which nothing meets, and ranks of which all meets others.
template <class Space = collide::host>
auto cube_and_row() {
  using namespace collide;
  auto w = packed_cube<float>(40, 0.2, 0.1);
  for (int i = 0; i < 12; ++i) w.particle(9 + 0.39 * i, 0, 0, i % 2 == 0 ? 0.1 : -0.1);
  return scene_of<simulation<discrete<Space>, sphere_contact, greets>>("cube and row", w, 100, 1e-3,
                                                                       sphere_contact{5, 0.01, 0.2, 0.01, 1}, greets{});
}

/// Particles that cross all subdomains in a step, and meet others there.
template <class Space = collide::host>
auto leaps() {
  using namespace collide;
  auto w = packed_cube<float>(400, 0.1, 1.9);
  return scene_of<simulation<discrete<Space>, greets, periodic_box>>("leaps", w, 40, 1, greets{},
                                                                     periodic_box{{-1, -1, -1}, {1, 1, 1}});
}

/// Snow that comes from a source, sticks, sleeps and wakes; when places end the oldest make room, or nothing is born,
/// nor where something is.
template <class Space = collide::host>
auto snow(bool only_where_free = false) {
  using namespace collide;
  world<float> w = crowd<float>(100, 1, 0.06, 0.5, 3);
  emit const source{700, {{0.2, 0, 0.7}, 0.25, {0.1, 0, -1}, 0.4}, 0, only_where_free};
  auto scene = scene_of<simulation<discrete<Space>, emit, collide::sleep, gravity, drag, sphere_contact, bounce,
                                   adhesion, box_walls, mesh_forces, pair_forces>>(
      "snow", w, 400, 2e-3, source, collide::sleep{0.2, 6}, gravity{}, drag{3, 1},
      sphere_contact::from_restitution(0.2, 0.04, 0.06, 100, 0.9), bounce{0.1}, adhesion{60},
      box_walls{{-1, -1, -1}, {1, 1, 1}, 0.2}, mesh_forces{}, pair_forces{});
  scene.capacity = 400;
  return scene;
}

/// Grains of two sizes from a source that has no room, in the middle of those that are there.
template <class Space = collide::host>
auto crowded_source() {
  using namespace collide;
  world<float> w = crowd<float>(300, 0.4, 0.05, 0.5, 8);
  for (int i = 0; i < 300; ++i) w.radii.push_back(i % 2 == 0 ? 0.05f : 0.03f);
  emit const source{9000, {{0.1, 0, 0}, 0.35, {0, 0, 0}, 1}, 0.03, true};
  auto scene = scene_of<
      simulation<discrete<Space>, velocity_verlet, emit, polydisperse, sphere_contact, absorbing_box, periodic_box>>(
      "crowded source", w, 100, 1e-3, velocity_verlet{}, source, polydisperse{},
      sphere_contact{20, 0.01, 0.2, 0.01, 100}, absorbing_box{{-1, -1, -1}, {-0.2, 1, 1}},
      periodic_box{{-1, -1, -1}, {1, 1, 1}});
  scene.capacity = 600;
  return scene;
}

/// Dust that vanishes in a box; nothing meets anything.
template <class Space = collide::host>
auto dust() {
  using namespace collide;
  world<float> w = crowd<float>(50, 1, 0.02, 0.5, 4);
  emit const source{2000, {{-0.8, 0, 0}, 0.1, {2, 0, 0}, 1}};
  auto scene = scene_of<simulation<discrete<Space>, emit, gravity, wind<uniform_field>, bounce, absorbing_box>>(
      "dust", w, 200, 2e-3, source, gravity{}, wind<uniform_field>{1, 0, {1.5, 0, 0}}, bounce{0.3},
      absorbing_box{{0.5, -1, -1}, {1, 1, 1}});
  scene.capacity = 300;
  return scene;
}

/// A piston that pushes grains about, and a belt below them.
template <class NarrowPhase, class Space = collide::host>
auto piston_and_belt() {
  using namespace collide;
  world<float> w;
  add_floor(w, 1.5, 6, -1);
  std::size_t const belt_size = w.corners.size() / 9;
  world<float> wall;
  wall.triangle({-1, -2, -2, -1, 2, -2, -1, 0, 3});
  w.corners.insert(w.corners.end(), wall.corners.begin(), wall.corners.end());
  auto const grains = packed_cube<float>(300, 0.1, 0.3);
  w.centres = grains.centres;
  w.velocities = grains.velocities;
  w.radius = 0.1f;
  auto scene = scene_of<simulation<meets_mesh<Space, NarrowPhase, float>, sphere_contact, gravity, bounce, friction,
                                   moving_bodies<>, box_walls>>(
      "bodies", w, 200, 2e-3, sphere_contact::from_restitution(0.4, 0.05, 0.1, 1000, 0.5), gravity{}, bounce{0.2},
      friction{0.5, 0.4}, moving_bodies<>{}, box_walls{{-2, -1, -3}, {2, 1, 3}, 0.1});
  body belt{0, belt_size, {}}, piston{belt_size, 1, {}};
  belt.motion.belt[1] = 0.7;
  piston.motion.amplitude[0] = 0.5;
  piston.motion.frequency = 2;
  scene.bodies = {belt, piston};
  return scene;
}

/// Particles that are nowhere, at one point, on a border, and far away.
template <class Space = collide::host>
auto awkward_places() {
  using namespace collide;
  auto w = packed_cube<float>(100, 0.1, 0.01);
  float const nan = std::numeric_limits<float>::quiet_NaN(), far = std::numeric_limits<float>::infinity();
  w.particle(double(nan), 0, 0);
  w.particle(0, double(far), 0);
  w.particle(0, 0, 0, double(nan));
  w.particle(0, 0, 0, double(far));
  w.particle(0, 0, 0, 1e30);
  w.particle(3e38, 0, 0);
  for (int i = 0; i < 30; ++i) w.particle(0.5, 0.5, 0.5);
  for (int i = -8; i <= 8; ++i) w.particle(0.125 * i, 0, 0);
  return scene_of<simulation<discrete<Space>, greets, sphere_contact>>("awkward places", w, 30, 1, greets{},
                                                                       sphere_contact{1e-5, 0, 0, 0, 1});
}

/// All at one point, or nobody at all.
template <class Space = collide::host>
auto one_point(std::size_t n) {
  using namespace collide;
  world<float> w;
  w.radius = 0.1f;
  for (std::size_t i = 0; i < n; ++i) w.particle(0.3, 0.2, 0.1, 0.001 * double(i));
  return scene_of<simulation<discrete<Space>, greets, box_walls>>("one point", w, 60, 1, greets{},
                                                                  box_walls{{-1, -1, -1}, {1, 1, 1}, 1});
}

/// A radius without end: all meet all.
template <class Space = collide::host>
auto endless_radius() {
  auto scene = one_point<Space>(20);
  scene.name = "endless radius";
  scene.w.radius = std::numeric_limits<float>::infinity();
  return scene;
}

/// The particles of all ranks give to bodies the same as those of one do.
template <class Ranks>
void check_reaction(Ranks const& ranks, complaints& wrong) {
  using namespace collide;
  using scene = simulation<discrete<host>, gravity, bounce, moving_bodies<>, box_walls, reaction>;
  auto w = packed_cube<float>(300, 0.05, 0.4);
  w.triangle({-2, -2, -0.5, 2, -2, -0.5, 0, 3, -0.5});
  w.triangle({-2, -2, -1, 2, -2, -1, 0, 3, -1});
  body plate{0, 1, {}};
  plate.motion.amplitude[2] = 0.2;
  plate.motion.frequency = 3;
  box_walls const walls{{-1, -1, -2}, {1, 1, 2}, 1};
  world_in<host, float> const there(host(1), w);
  auto const play = [&](auto& parts, range own) {
    there.set_mesh(parts, {plate});
    there.set(parts, own);
    parts.steps(200, 2e-3f);
  };
  host const space(1);
  reaction_sums const of_one(space, 1, 1e-9), mine(space, 1, 1e-9);
  scene one(space, gravity{}, bounce{0.5}, moving_bodies<>{}, walls, of_one.effect(1000));
  play(one, {0, w.size()});
  distributed<scene, Ranks> parts(ranks, space, gravity{}, bounce{0.5}, moving_bodies<>{}, walls, mine.effect(1000));
  play(parts, part_of(w.size(), split::evenly, ranks.rank(), ranks.size()));
  auto const expected = of_one.read(space), found = parts.total(mine);
  wrong.expect(equal_bytes(found, expected) && expected[0].linear[2] < 0, "what bodies have got");
}

// ---- what goes wrong

/// Memory ends on the last rank, wherever it may: all ranks throw, and `set` begins anew.
template <class Ranks>
void check_short_memory_of_simulations(Ranks const& ranks, complaints& wrong) {
  auto scene = snow();
  scene.steps = 40;
  expected_values<decltype(scene)> const expected(scene);
  range own = part_of(scene.w.size(), split::evenly, ranks.rank(), ranks.size());
  int const failing = ranks.size() - 1;
  range all = own;
  if (ranks.rank() == failing) all.size += scene.capacity - scene.w.size();
  std::uint64_t failures = 0;
  for (std::size_t most = 0;; ++most) {
    short_memory memory;
    if (ranks.rank() == failing) memory.left = most;
    bool failed = false;
    std::apply(
        [&](auto const&... effects) {
          using simulation = typename decltype(scene)::simulation;
          collide::distributed<simulation, Ranks> parts(ranks, collide::host(1, &memory), effects...);
          auto const work = [&] {
            world_in<collide::host, float> const there(collide::host(1), scene.w);
            there.set_mesh(parts);
            there.set(parts, own, scene.capacity);
            parts.steps(40, scene.dt);
          };
          try {
            work();
          } catch (std::bad_alloc const&) {
            failed = true;
            wrong.expect(ranks.rank() == failing, "memory ended elsewhere");
          } catch (collide::rank_error const& e) {
            failed = true;
            std::string const others = "collide: rank " + std::to_string(failing) + " of ";
            wrong.expect(std::string(e.what()).rfind(others, 0) == 0, e.what());
          }
          memory.left = std::numeric_limits<std::size_t>::max();
          std::string said;
          try {
            parts.step(scene.dt);
          } catch (collide::error const& e) {
            said = e.what();
          }
          wrong.expect(failed != said.empty(), "it does not go on from half a step: " + said);
          if (failed || said.empty()) work();
          values_of<simulation> found;
          found.read(parts);
          wrong.expect(equal(found, expected.end.part(all.first, all.size)), "after a failure everything works again");
        },
        scene.effects);
    if (!failed) break;
    ++failures;
  }
  wrong.expect(failures > 10, "memory can end in several places");
}

/// Bad arguments are refused on all ranks.
template <class Ranks>
void check_refusals(Ranks const& ranks, complaints& wrong) {
  using namespace collide;
  auto const expect = [&](char const* text, auto const& f) {
    std::string said = "nothing";
    try {
      f();
    } catch (error const& e) {
      said = e.what();
    }
    wrong.expect(said.rfind(text, 0) == 0, said);
  };
  distributed<simulation<discrete<host>, sphere_contact>, Ranks> parts(ranks, host(1));
  float const centre[] = {0, 0, 0}, radii[] = {1};
  auto const mine = [&](float r) { return spheres_xyz(centre, 1, r); };
  expect("collide: simulation: step needs particles", [&] { parts.step(1); });
  expect("collide: simulation: to_host needs particles", [&] { parts.template to_host<position>(); });
  expect("collide: simulation: there is room for more particles", [&] { parts.set(mine(1), nullptr, 1000); });
  if (ranks.size() > 1) {
    expect("collide: simulation: the radii differ", [&] { parts.set(mine(float(1 + ranks.rank()))); });
  }
  expect("collide: simulation: the radii differ", [&] { parts.set(spheres_xyz(centre, 1, radii)); });
  parts.set(ranks.rank() == 0 ? mine(1) : sphere_view<float>());
  for (float const dt : {std::numeric_limits<float>::infinity(), 0.0f, -0.1f}) {
    expect("collide: simulation: the time dt of a step is finite and above 0", [&] { parts.step(dt); });
  }
  expect("collide: simulation: the time dt of a step, 1, is longer than an effect allows", [&] { parts.step(1); });
  parts.template effect<sphere_contact>().stiffness = 0.01;
  parts.template effect<sphere_contact>().density = -1;
  expect("collide: sphere_contact: density is above 0", [&] { parts.step(1); });
  parts.template effect<sphere_contact>().density = 1;
  parts.step(1);
  wrong.expect(parts.size() == 1 && parts.time() == 1, "and then it goes on");
}

}  // namespace tests
