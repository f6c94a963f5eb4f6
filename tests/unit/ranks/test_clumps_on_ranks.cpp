/// Clumps on ranks: as on one, bit for bit.
#include <collide/simulation/energy.hpp>

#include "ranks/clumps.hpp"
#include "ranks/on_threads.hpp"

namespace {

using namespace collide;

/// So many ranks make of the scene what one simulation does. True if clumps have gone to ranks of higher and of lower
/// numbers, after the first tenth part of the steps.
template <class Ranks = thread_ranks, class Scene>
bool check_scene_on_threads(Scene const& scene, std::vector<int> const& sizes,
                            std::vector<tests::split> const& splits) {
  tests::expected_clumps<Scene> const expected(scene);
  std::size_t const spheres = scene.spheres_of(tests::range{0, scene.placed.size()}).size;
  bool go_both_ways = true;
  for (int const n : sizes) {
    for (tests::split const how : splits) {
      std::vector<tests::complaints> wrong(static_cast<std::size_t>(n));
      std::vector<std::vector<int>> owners(10, std::vector<int>(spheres, -1));
      thread_ranks::run(n, [&](thread_ranks const& ranks) {
        tests::check_clumps(Ranks(ranks), scene, expected, how, owners, wrong[static_cast<std::size_t>(ranks.rank())]);
      });
      for (auto const& w : wrong) CHECK(w.text() == "");
      int up = 0, down = 0;
      for (std::size_t k = 1; k < owners.size(); ++k)
        for (std::size_t c = 0; c < spheres; ++c)
          (owners[k][c] > owners[k - 1][c] ? up : down) += owners[k][c] != owners[k - 1][c];
      if (n > 1) go_both_ways = go_both_ways && up > 0 && down > 0;
    }
  }
  return go_both_ways;
}

/// Ranks save the bytes that one saves; one, and any number of ranks, go on from them.
template <class Scene>
void check_checkpoints_of_clumps(Scene const& scene) {
  using simulation = typename Scene::simulation;
  std::apply(
      [&](auto const&... effects) {
        tests::mesh_of<host, Scene> const mesh(host(1), scene);
        auto const half = static_cast<std::size_t>(scene.steps / 2);
        std::ostringstream saved, end;
        simulation one(host(1), effects...);
        mesh.set(one);
        tests::set_part(scene, one, {0, scene.placed.size()});
        tests::paint(scene, one, {0, scene.placed.size()});
        one.steps(half, scene.dt);
        save(one, saved);
        one.steps(half, scene.dt);
        save(one, end);
        for (int const n : {1, 2, 3, 5}) {
          CAPTURE(n);
          std::ostringstream from_start, at_end;
          thread_ranks::run(n, [&](thread_ranks const& ranks) {
            auto const own = scene.part(tests::split::evenly, ranks.rank(), n);
            distributed<simulation, thread_ranks> parts(ranks, host(1), effects...), later(ranks, host(1), effects...);
            mesh.set(parts);
            tests::set_part(scene, parts, own);
            tests::paint(scene, parts, own);
            parts.steps(half, scene.dt);
            save(parts, from_start);
            mesh.set(later);
            std::istringstream before(saved.str());
            load(later, before);
            later.steps(half, scene.dt);
            save(later, at_end);
          });
          CHECK((from_start.str() == saved.str()));
          CHECK((at_end.str() == end.str()));
        }
      },
      scene.effects);
}

/// The energy of one simulation of a scene in the end.
template <class Scene>
energy_sums energy_of_one(Scene const& scene) {
  return std::apply(
      [&](auto const&... effects) {
        typename Scene::simulation one(host(1), effects...);
        one.set_mesh(mesh_view<typename Scene::S>{});
        tests::set_part(scene, one, {0, scene.placed.size()});
        one.steps(static_cast<std::size_t>(scene.steps), scene.dt);
        return energy(one);
      },
      scene.effects);
}

}  // namespace

TEST_CASE("clumps on ranks: grains of two materials in a cube, with what contacts remember, as on one") {
  using tests::split;
  CHECK(check_scene_on_threads(tests::clumps_in_a_cube<double>(), {1, 2, 3}, {split::evenly, split::odd}));
  CHECK(check_scene_on_threads<tests::late_ranks>(tests::clumps_in_a_cube<double>(), {2, 3}, {split::evenly}));
}

TEST_CASE("clumps on ranks: a clump meets what is near its far end") {
  check_scene_on_threads(tests::rod_across_ranks<double>(), {1, 2}, {tests::split::evenly});
}

TEST_CASE("clumps on ranks: across the sides of a box as on one, and their momentum stays") {
  auto const scene = tests::clumps_that_repeat<double>();
  CHECK(check_scene_on_threads(scene, {1, 2, 3, 7}, {tests::split::evenly}));
  CHECK(check_scene_on_threads<tests::late_ranks>(tests::clumps_that_repeat<float>(), {3}, {tests::split::odd}));
  std::vector<energy_sums> found(3);
  thread_ranks::run(3, [&](thread_ranks const& ranks) {
    std::apply(
        [&](auto const&... effects) {
          distributed<std::decay_t<decltype(scene)>::simulation, thread_ranks> parts(ranks, host(1), effects...);
          parts.set_mesh(mesh_view<double>{});
          tests::set_part(scene, parts, scene.part(tests::split::evenly, ranks.rank(), 3));
          auto const mass_times = [&](auto const& f) {  // over all ranks, in parts of 1e-9
            auto const v = parts.local().template to_host<velocity>();
            auto const heavier = parts.local().template to_host<clump_mass>();
            auto const clump = parts.local().template to_host<in_clump>();
            auto const speed = parts.local().template to_host<clump_velocity>();
            auto const numbers = parts.local().template to_host<global_number>();
            auto const radii = parts.local().template to_host<radius>();
            double sum = 0;
            for (std::size_t i = 0; i < radii.size(); ++i) {
              if (clump[i] != no_id && clump[i] != numbers[i]) continue;
              sum += heavier[i] * radii[i] * radii[i] * radii[i] * f(clump[i] == no_id ? v[3 * i] : speed[3 * i]);
            }
            std::uint64_t const mine = static_cast<std::uint64_t>(static_cast<std::int64_t>(sum * 0x1p50));
            std::uint64_t all = 0;
            ranks.reduce(&mine, &all, 1, reduction::sum);
            return static_cast<double>(static_cast<std::int64_t>(all)) / 0x1p50;
          };
          auto const itself = [](double v) { return v; };
          double const before = mass_times(itself), size = mass_times([](double v) { return std::abs(v); });
          parts.steps(1000, 2e-4);
          CHECK(std::abs(mass_times(itself) - before) < 1e-12 * size);
          found[static_cast<std::size_t>(ranks.rank())] = energy(parts.local());
        },
        scene.effects);
  });
  energy_sums const whole = energy_of_one(scene);
  CHECK(found[0].kinetic + found[1].kinetic + found[2].kinetic == doctest::Approx(whole.kinetic).epsilon(1e-12));
  CHECK(found[0].rotational + found[1].rotational + found[2].rotational ==
        doctest::Approx(whole.rotational).epsilon(1e-12));
}

TEST_CASE("clumps on ranks: they sleep, and wake, as on one") {
  auto const scene = tests::clumps_that_sleep<float>();
  check_scene_on_threads(scene, {1, 2, 3}, {tests::split::odd});
  check_scene_on_threads(tests::clumps_that_sleep<double>(), {3}, {tests::split::evenly});
  check_checkpoints_of_clumps(scene);
}

TEST_CASE("clumps on ranks: a source and a sink as on one, and checkpoints") {
  CHECK(check_scene_on_threads(tests::source_of_clumps<float>(), {1, 2, 3, 7},
                               {tests::split::evenly, tests::split::odd}));
  check_checkpoints_of_clumps(tests::source_of_clumps<double>());
  check_checkpoints_of_clumps(tests::clumps_in_a_cube<double>());
}
