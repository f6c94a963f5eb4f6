/// \file
/// Checks that clumps on ranks do the same as those of one simulation, bit for bit, and are never torn.
#pragma once

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <collide/effects/clumps.hpp>
#include <collide/effects/external_forces.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/ranks/distributed_clumps.hpp>

#include "ranks/simulations.hpp"

namespace tests {

/// A scene of clumps, and how it goes on.
template <class Detector, class... Effect>
struct clump_scene {
  using simulation = collide::simulation<Detector, Effect...>;
  using S = typename Detector::scalar;

  std::string name;
  world<S> mesh;
  std::tuple<Effect...> effects;
  std::vector<collide::clump_shape> shapes;
  std::vector<collide::placed_clump> placed;
  int steps;
  S dt;
  std::size_t waiting = 0;
  std::vector<collide::body> bodies = {};

  std::size_t spheres_of(std::size_t clump) const { return shapes[placed[clump].shape].spheres.size(); }
  /// The spheres of some clumps.
  range spheres_of(range of) const {
    range found{0, 0};
    for (std::size_t c = 0; c < of.first; ++c) found.first += spheres_of(c);
    for (std::size_t c = of.first; c < of.first + of.size; ++c) found.size += spheres_of(c);
    return found;
  }
  /// The clumps of a rank; the last one has those that wait.
  range part(split how, int rank, int ranks) const {
    range own = part_of(placed.size() - waiting, how, rank, ranks);
    if (rank + 1 == ranks) own = {own.size == 0 ? placed.size() - waiting : own.first, own.size + waiting};
    return own;
  }
};

/// Sets some clumps of a scene.
template <class Scene, class To>
void set_part(Scene const& scene, To& to, range own) {
  auto const first = scene.placed.begin() + static_cast<std::ptrdiff_t>(own.first);
  std::vector<collide::placed_clump> const mine(first, first + static_cast<std::ptrdiff_t>(own.size));
  collide::set_clumps(to, scene.shapes, mine, scene.waiting);
}
template <class Simulation>
Simulation const& part_here(Simulation const& one) {
  return one;
}
template <class Simulation, class Ranks>
auto const& part_here(collide::distributed<Simulation, Ranks> const& parts) {
  return parts.local();
}
/// Each second clump is of material 1.
template <class Scene, class To>
void paint(Scene const& scene, To& to, range own) {
  if constexpr (collide::detail::contains<typename Scene::simulation::columns, collide::material>) {
    std::vector<std::uint8_t> solid;
    for (std::size_t c = own.first; c < own.first + own.size; ++c)
      solid.insert(solid.end(), scene.spheres_of(c), c % 2);
    auto const& here = part_here(to);
    here.space().copy_from_host(here.template data<collide::material>(), solid.data(), solid.size());
    here.space().synchronize();
  }
}

/// The mesh of a scene in memory of a space.
template <class Space, class Scene>
class mesh_of {
 public:
  mesh_of(Space const& space, Scene const& scene) : corners_(space, scene.mesh.corners), bodies_{scene.bodies} {}
  template <class To>
  void set(To& to) const {
    to.set_mesh(collide::triangle_soup(corners_.data(), corners_.size() / 9), bodies_);
  }

 private:
  placed<typename Scene::S> corners_;
  std::vector<collide::body> bodies_;
};

/// The states of one simulation of a scene: in the middle, and in the end.
template <class Scene>
struct expected_clumps {
  values_of<typename Scene::simulation> middle, end;
  collide::birth_counts births;
  double reach = 0;

  explicit expected_clumps(Scene const& scene) {
    std::apply(
        [&](auto const&... effects) {
          using space_type = typename Scene::simulation::execution_space;
          typename Scene::simulation one(space_of_rank<space_type>(), effects...);
          mesh_of<space_type, Scene> const mesh(one.space(), scene);
          mesh.set(one);
          set_part(scene, one, {0, scene.placed.size()});
          paint(scene, one, {0, scene.placed.size()});
          one.steps(static_cast<std::size_t>(scene.steps / 2), scene.dt);
          middle.read(one);
          one.steps(static_cast<std::size_t>(scene.steps - scene.steps / 2), scene.dt);
          end.read(one);
          reach = std::as_const(one).template effect<collide::clumps>().reach;
          if constexpr (Scene::simulation::effects_type::makes) births = one.births();
        },
        scene.effects);
  }
};

/// Says which rank has each clump, by the number of its first sphere; all of it follow each other in the order of their
/// numbers.
template <class Scene, class Parts>
void find_owners(Scene const& scene, Parts const& parts, int rank, std::vector<int>& owners, complaints& wrong) {
  auto const numbers = parts.local().template to_host<collide::global_number>(),
             clump = parts.local().template to_host<collide::in_clump>();
  std::vector<std::size_t> sizes(owners.size(), 1);
  std::size_t sphere = 0;
  for (std::size_t c = 0; c < scene.placed.size(); sphere += scene.spheres_of(c++)) sizes[sphere] = scene.spheres_of(c);
  std::size_t torn = 0;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t const first = numbers[i], n = sizes[first];
    owners[first] = rank;
    for (std::size_t k = 0; k < n; ++k, ++i)
      torn += i >= numbers.size() || numbers[i] != first + k || clump[i] != (n > 1 ? first : collide::no_id);
  }
  wrong.expect(torn == 0, "clumps are torn");
}

/// Ranks make the same of the scene. `owners` has the ranks of clumps after each tenth part of the steps.
template <class Scene, class Ranks>
void check_clumps(Ranks const& ranks, Scene const& scene, expected_clumps<Scene> const& expected, split how,
                  std::vector<std::vector<int>>& owners, complaints& wrong) {
  using simulation = typename Scene::simulation;
  wrong.in(scene.name + ", " + std::to_string(ranks.size()) + " ranks, split " + std::to_string(int(how)));
  range const own = scene.part(how, ranks.rank(), ranks.size()), spheres = scene.spheres_of(own);
  std::apply(
      [&](auto const&... effects) {
        using space_type = typename simulation::execution_space;
        collide::distributed<simulation, Ranks> parts(ranks, space_of_rank<space_type>(), effects...);
        mesh_of<space_type, Scene> const mesh(parts.space(), scene);
        mesh.set(parts);
        set_part(scene, parts, own);
        paint(scene, parts, own);
        wrong.expect(parts.local().template effect<collide::clumps>().reach == expected.reach, "the reach of all");
        values_of<simulation> found;
        int done = 0;
        for (std::size_t k = 1; k <= owners.size(); ++k) {
          int const next = scene.steps * static_cast<int>(k) / static_cast<int>(owners.size());
          parts.steps(static_cast<std::size_t>(next - done), scene.dt);
          done = next;
          find_owners(scene, parts, ranks.rank(), owners[k - 1], wrong);
          if (2 * done != scene.steps) continue;
          found.read(parts);
          wrong.expect(equal(found, expected.middle.part(spheres.first, spheres.size)), "in the middle");
        }
        found.read(parts);
        wrong.expect(equal(found, expected.end.part(spheres.first, spheres.size)), "in the end");
        if constexpr (simulation::effects_type::makes) {
          auto const births = parts.births();
          wrong.expect(
              births.due == expected.births.due && births.due > 0 && births.overlapping == expected.births.overlapping,
              "what was born");
        }
      },
      scene.effects);
}

// ---- the scenes

inline std::vector<collide::clump_shape> some_shapes() {
  using ball = collide::sphere<double>;
  return {collide::shape_of_clump({ball{{0, 0, 0}, 0.1}, ball{{0.15, 0, 0}, 0.1}}),
          collide::shape_of_clump({ball{{0, 0, 0}, 0.1}, ball{{0.12, 0.04, 0}, 0.08}, ball{{0.06, 0.14, 0.06}, 0.06}}),
          collide::shape_of_clump({ball{{0, 0, 0}, 0.1}}),
          collide::shape_of_clump({ball{{0, 0, 0}, 0.06}, ball{{0.13, 0, 0}, 0.06}, ball{{0.26, 0, 0}, 0.06},
                                   ball{{0.39, 0, 0}, 0.06}, ball{{0.52, 0, 0}, 0.06}})};
}

/// Clumps on a lattice of so many of them along each axis, from -1 to 1, which move and turn at random.
inline std::vector<collide::placed_clump> clumps_on_lattice(int n, std::size_t shapes, double speed) {
  std::vector<collide::placed_clump> all;
  double const apart = 2.0 / n;
  for (int i = 0; i < n * n * n; ++i) {
    collide::placed_clump c;
    int const at[] = {i % n, i / n % n, i / n / n};
    c.shape = std::size_t(i) % shapes;
    collide::turn_at_random(c.at.rotation, std::uint64_t(i));
    for (int k = 0; k < 3; ++k) {
      auto const random = [&](int m) {
        return 2 * collide::detail::random_fraction(std::uint64_t(12 * i + 3 * k + m)) - 1;
      };
      c.at.position[k] = apart * (at[k] + 0.5) - 1;
      c.moving.linear[k] = speed * random(0);
      c.moving.angular[k] = 5 * speed * random(1);
    }
    all.push_back(c);
  }
  return all;
}

/// The six faces of a cube from -half to half.
template <class S>
void add_cube(world<S>& w, double half) {
  for (int axis = 0; axis < 3; ++axis) {
    for (double const side : {-half, half}) {
      double x[4][3];
      for (int k = 0; k < 4; ++k) {
        x[k][axis] = side;
        x[k][(axis + 1) % 3] = k == 1 || k == 2 ? half : -half;
        x[k][(axis + 2) % 3] = k >= 2 ? half : -half;
      }
      for (int const k : {0, 1, 2, 0, 2, 3})
        for (double const c : x[k]) w.corners.push_back(static_cast<S>(c));
    }
  }
}

using law_of_clumps =
    collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd, collide::none, collide::materials<3>>;
inline law_of_clumps three_materials() {
  law_of_clumps by;
  by.made_of.set(0, {2e5, 0.25, 1000});
  by.made_of.set(1, {4e5, 0.3, 2500});
  by.made_of.set(2, {1e6, 0.3, 7800});
  for (int a = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b) by.made_of.set_pair(a, b, {0.3 + 0.1 * a, 0.5 - 0.1 * b, 0.05});
  by.made_of.wall_material = 2;
  return by;
}

/// Grains and clumps of two materials that are thrown about in a cube, and fall.
template <class S, class Space = collide::host>
auto clumps_in_a_cube() {
  using namespace collide;
  world<S> w;
  add_cube(w, 1.5);
  auto all = clumps_on_lattice(5, 4, 2);  // some of them in the middle, where ranks meet
  for (auto& c : all)
    for (int k = 0; k < 3; ++k) c.at.position[k] *= k == 0 ? 1.4 : 1.3;
  return clump_scene<discrete<Space, S>, velocity_verlet, gravity, law_of_clumps, polydisperse, clumps>{
      "clumps in a cube",
      w,
      {velocity_verlet{}, gravity{}, three_materials(), {}, {}},
      some_shapes(),
      all,
      600,
      S(2e-4)};
}

/// A rod of one of two ranks, and a grain of the other that its far end hits, farther from the first than spheres see.
template <class S, class Space = collide::host>
auto rod_across_ranks() {
  using namespace collide;
  using law = granular_contact<hertz, mindlin>;
  std::vector<placed_clump> all(6);
  for (std::size_t c = 0; c < 6; ++c) {
    double const x[] = {-0.31, -3, -3, 0.335, 3, 3};
    all[c].shape = c == 0 ? 0 : 1;
    all[c].at.position[0] = x[c], all[c].at.position[1] = c % 3 == 2 ? 1 : 0.02;
  }
  all[3].moving.linear[0] = -1;
  return clump_scene<discrete<Space, S>, velocity_verlet, law, clumps>{
      "a rod across ranks",
      {},
      {velocity_verlet{}, law{one_material({2e5, 0.25, 1000}, {0.6, 0.4})}, {}},
      {some_shapes()[3], shape_of_clump({sphere<double>{{0, 0, 0}, 0.06}})},
      all,
      200,
      S(2e-4)};
}

/// Clumps that meet across the sides of a box, which nothing else acts on.
template <class S, class Space = collide::host>
auto clumps_that_repeat() {
  using namespace collide;
  using law = granular_contact<hertz, mindlin>;
  return clump_scene<discrete<Space, S>, velocity_verlet, law, polydisperse, clumps, periodic_box>{
      "clumps that repeat",
      {},
      {velocity_verlet{},
       law{one_material({2e5, 0.25, 1000}, {0.6, 0.4})},
       {},
       {},
       periodic_box{{-1, -1, -1}, {1, 1, 1}}},
      some_shapes(),
      clumps_on_lattice(4, 4, 3),
      1000,
      S(2e-4)};
}

/// Clumps that lie on a floor and a belt, and sleep, until others fall on them.
template <class S, class Space = collide::host>
auto clumps_that_sleep() {
  using namespace collide;
  using law = granular_contact<hertz, mindlin>;
  world<S> w;
  add_floor(w, 3, 6, 0);
  std::vector<placed_clump> all;
  for (int i = 0; i < 32; ++i) {
    placed_clump c;
    c.shape = i % 2;
    c.at.position[0] = 0.5 * (i % 4) - 0.8, c.at.position[1] = 0.5 * (i / 4 % 4) - 0.8;
    c.at.position[2] = i < 16 ? 0.11 : 1.9;
    if (i >= 16) c.shape = 3, turn_at_random(c.at.rotation, std::uint64_t(i));
    all.push_back(c);
  }
  clump_scene<discrete<Space, S>, velocity_verlet, gravity, law, collide::sleep, mesh_forces, polydisperse, clumps,
              moving_bodies<>>
      scene{"clumps that sleep",
            w,
            {velocity_verlet{},
             gravity{},
             law{one_material({2e5, 0.25, 1000}, {0.2, 0.5})},
             collide::sleep{0.05, 20},
             {},
             {},
             {},
             {}},
            some_shapes(),
            all,
            1800,
            S(5e-4)};
  body belt{0, w.corners.size() / 18, {}};
  belt.motion.belt[1] = 0.5;
  scene.bodies = {belt};
  return scene;
}

/// A source of clumps above a belt, at whose end they vanish; others are there already. More come than there is room
/// for.
template <class S, class Space = collide::host>
auto source_of_clumps() {
  using namespace collide;
  using law = granular_contact<hertz, mindlin>;
  world<S> w;
  add_floor(w, 3, 4, 0);
  auto all = clumps_on_lattice(2, 4, 0.5);
  for (auto& c : all) c.at.position[2] += 2;
  std::size_t const waiting = 30;
  for (std::size_t i = 0; i < waiting; ++i) all.push_back({1, {}, {}, 0.5 + 0.01 * double(i)});
  clump_scene<discrete<Space, S>, emit, velocity_verlet, gravity, law, absorbing_box, polydisperse, clumps,
              moving_bodies<>>
      scene{"source of clumps",
            w,
            {emit{150, {{-0.5, 0, 1.5}, 0.6, {0, 0, -2}, 0.5}},
             velocity_verlet{},
             gravity{},
             law{one_material({2e5, 0.25, 1000}, {0.2, 0.5})},
             absorbing_box{{0.5, -3, -1}, {3, 3, 3}},
             {},
             {},
             {}},
            some_shapes(),
            all,
            1200,
            S(5e-4),
            waiting};
  body belt{0, w.corners.size() / 9, {}};
  belt.motion.belt[0] = 1.5;
  scene.bodies = {belt};
  return scene;
}

}  // namespace tests
