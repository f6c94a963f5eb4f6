/// Contacts that remember, on ranks: as on one, bit for bit.
#include <atomic>

#include <collide/effects/granular_contact.hpp>
#include <collide/simulation/energy.hpp>

#include "ranks/on_threads.hpp"
#include "simulation/surfaces.hpp"

namespace {

using namespace collide;

constexpr solid soft{1e6, 0.2, 1000};
constexpr surface_pair rough{0.5, 0.5, 0.1, 1};

/// Grains of three sizes that go round in a box, many at a time, and stick: small ones have lists, large ones runs.
auto sizes() {
  using law = granular_contact<hertz, mindlin_rescale, none, jkr>;
  auto w = tests::packed_cube<double>(300, 0.05, 3);
  for (std::size_t i = 0; i < 300; ++i) w.radii.push_back(i % 50 == 0 ? 0.3 : i % 5 == 0 ? 0.1 : 0.05);
  return tests::scene_of<simulation<tests::discrete<host, double>, velocity_verlet, polydisperse, law, periodic_box>>(
      "sizes that remember", w, 150, 2e-4, velocity_verlet{}, polydisperse{}, law{one_material(soft, rough)},
      periodic_box{{-1, -1, -1}, {1, 1, 1}});
}

/// Grains of a source that fall onto a belt, sleep, wake, and vanish at its end.
auto belt() {
  using law = granular_contact<hertz, mindlin, epsd>;
  tests::world<float> w;
  tests::add_floor(w, 1.5, 6, -1);
  std::size_t const size = w.corners.size() / 9;
  auto const some = tests::packed_cube<float>(150, 0.1, 0.3);
  w.centres = some.centres;
  w.velocities = some.velocities;
  w.radius = 0.1f;
  auto scene = tests::scene_of<simulation<tests::discrete<host>, emit, collide::sleep, gravity, law, velocity_verlet,
                                          box_walls, absorbing_box, moving_bodies<>>>(
      "belt", w, 500, 5e-4, emit{150, {{-0.5, 0, 0.8}, 0.3, {0, 0, -1}, 0.4}, 0, false}, collide::sleep{0.1, 20},
      gravity{}, law{one_material(soft, rough)}, velocity_verlet{}, box_walls{{-1.4, -1.4, -3}, {1.4, 1.4, 3}, 0.1},
      absorbing_box{{1, -2, -2}, {2, 2, 2}}, moving_bodies<>{});
  body moving{0, size / 2, {}};
  moving.motion.belt[0] = 0.7;
  scene.bodies = {moving};
  scene.capacity = 200;
  return scene;
}

/// Grains of a lattice, of which planes lie just where ranks meet, and in the bounds of the box that repeats.
auto lattice() {
  using law = granular_contact<hertz, mindlin>;
  tests::world<double> w;
  w.radius = 0.0625;
  for (int i = 0; i < 512; ++i)
    w.particle(0.125 * (i / 64 - 4), 0.125 * (i / 8 % 8 - 4), 0.125 * (i % 8 - 4), 0.01 * (i % 5), 0.01 * (i % 3));
  tests::add_floor(w, 2, 4, -0.55);
  return tests::scene_of<simulation<tests::discrete<host, double>, velocity_verlet, law, periodic_box>>(
      "a lattice where ranks meet", w, 100, 2e-4, velocity_verlet{}, law{one_material(soft, rough)},
      periodic_box{{-0.5, -0.5, -2}, {0.5, 0.5, 2}});
}

/// Grains on a wall of many pieces, to which they stick.
auto pieces() {
  using law = granular_contact<hertz, mindlin, none, jkr>;
  return tests::scene_of<simulation<tests::discrete<host, double>, velocity_verlet, gravity, law>>(
      "pieces of a wall", tests::grains_on_pieces<double>(16, 60), 150, 1e-5, velocity_verlet{}, gravity{},
      law{one_material({1e7, 0.2, 2500}, {0.5, 0.5, 0, 0.05})});
}

/// A plate runs into a layer of grains that sleep, and touch each other.
template <class Integrator>
auto plate() {
  using law = granular_contact<hertz, mindlin>;
  tests::world<float> w;
  w.radius = 0.1f;
  tests::add_floor(w, 2, 6, 0);
  body pushes{w.corners.size() / 9, 2, {}};
  float const side = -0.85f;
  float const corners[] = {side, -1, 0.02f, side, 1, 0.02f, side, 1, 1, side, -1, 0.02f, side, 1, 1, side, -1, 1};
  w.corners.insert(w.corners.end(), std::begin(corners), std::end(corners));
  pushes.motion.velocity[0] = 0.5;
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < 4; ++k) w.particle(0.1999 * i - 0.5, 0.1999 * k - 0.3, 0.0999);
  auto scene =
      tests::scene_of<simulation<tests::discrete<host>, Integrator, collide::sleep, gravity, law, moving_bodies<>>>(
          "plate", w, 700, 1e-3, Integrator{}, collide::sleep{0.02, 20}, gravity{}, law{one_material(soft, rough)},
          moving_bodies<>{});
  scene.bodies = {pushes};
  return scene;
}

}  // namespace

TEST_CASE("granular contact on ranks: a body wakes what sleeps as on one") {
  tests::check_on_threads(plate<semi_implicit_euler>(), {1, 2, 3}, {tests::split::odd});
  tests::check_on_threads(plate<velocity_verlet>(), {1, 2, 3}, {tests::split::odd});
}

TEST_CASE("granular contact on ranks: contacts remember as on one") {
  tests::check_on_threads(sizes(), {1, 2, 3, 7}, {tests::split::odd});
  tests::check_on_threads<tests::late_ranks>(sizes(), {2, 3}, {tests::split::odd});
  tests::check_on_threads<tests::late_ranks>(plate<velocity_verlet>(), {2, 3}, {tests::split::odd});
  tests::check_on_threads(belt(), {1, 2, 3, 7}, {tests::split::last});
}

TEST_CASE("granular contact on ranks: grains where ranks meet, and on a wall of many pieces, are as on one") {
  tests::check_on_threads(lattice(), {2, 4}, {tests::split::odd});
  tests::check_on_threads(pieces(), {2, 3}, {tests::split::odd});
  tests::check_checkpoints(pieces());
}

TEST_CASE("granular contact on ranks: checkpoints have what contacts remember") { tests::check_checkpoints(belt()); }

TEST_CASE("granular contact on ranks: of what a rank has, energy is that of its own pairs") {
  using law = granular_contact<hertz, mindlin>;
  using alone = simulation<tests::discrete<host, double>, law>;
  tests::world<double> w;
  for (int i = 0; i < 42; ++i) w.particle(i / 2 + 0.019 * (i % 2), 0, 0, 0, i % 2 != 0 ? 0.1 : -0.1, 0);
  alone one(host(1), law{one_material(soft, rough)});
  one.set_mesh(mesh_view<double>{});
  one.set(spheres_xyz(w.centres.data(), 42, 0.01), w.velocities.data());
  one.steps(3, 1e-5);
  double const of_pair = energy(one).tangential / 21;
  REQUIRE(of_pair > 0);
  std::atomic<int> pairs{0};
  thread_ranks::run(4, [&](thread_ranks const& ranks) {
    distributed<alone, thread_ranks> some(ranks, host(1), law{one_material(soft, rough)});
    some.set_mesh(mesh_view<double>{});
    std::size_t const first = ranks.rank() == 2 ? 0 : 42, n = 42 - first;
    some.set(spheres_xyz(w.centres.data() + 3 * first, n, 0.01), w.velocities.data() + 3 * first);
    some.steps(3, 1e-5);
    auto const here = some.local().to_host<global_number>();
    int both = 0;
    for (id const number : here)
      both += number % 2 == 0 && std::find(here.begin(), here.end(), number + 1) != here.end();
    CHECK(energy(some.local()).tangential == doctest::Approx(both * of_pair).scale(of_pair));
    pairs += both;
  });
  CHECK(pairs < 21);  // others are cut in two
  CHECK(pairs > 10);
}

TEST_CASE("granular contact on ranks: solids that only walls have do not limit the step") {
  using law = granular_contact<hertz, none, none, none, materials<2>>;
  using alone = simulation<tests::discrete<host, double>, law, velocity_verlet>;
  law by;
  by.made_of.set(0, soft);
  by.made_of.set(1, {2e11, 0.3, 7800});  // steel
  for (int k = 0; k < 3; ++k) by.made_of.set_pair(k / 2, (k + 1) / 2, rough);
  by.made_of.wall_material = 1;
  tests::world<double> w;
  w.radius = 0.1;
  tests::add_floor(w, 1, 3);
  for (int i = 0; i < 8; ++i) w.particle(0.1 * i - 0.4, 0, 0.1);
  tests::running<alone> one(host(1), w, by, velocity_verlet{});
  double const longest = 4 * largest_time_step(one.simulation);
  CHECK(longest > 1e-5);
  thread_ranks::run(2, [&](thread_ranks const& ranks) {
    distributed<alone, thread_ranks> some(ranks, host(1), by, velocity_verlet{});
    some.set_mesh(triangle_soup(w.corners.data(), w.corners.size() / 9));
    some.set(spheres_xyz(w.centres.data() + 12 * ranks.rank(), 4, w.radius), w.velocities.data() + 12 * ranks.rank());
    some.step(0.99 * longest);
    CHECK_THROWS_AS(some.step(1.01 * longest), error);
  });
}
