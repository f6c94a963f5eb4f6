/// Simulations on ranks that are threads, on the host.
#include <collide/thread_ranks.hpp>

#include "ranks/simulations.hpp"

namespace {

/// So many ranks make of the scene what one simulation does, however its particles are divided.
template <class Scene>
void check_on_threads(Scene const& scene) {
  tests::expected_values<Scene> const expected(scene);
  for (int const n : {1, 2, 3, 4, 7}) {
    for (tests::split const how : {tests::split::evenly, tests::split::last, tests::split::odd}) {
      if (n == 1 && how != tests::split::evenly) continue;
      std::vector<tests::complaints> wrong(static_cast<std::size_t>(n));
      collide::thread_ranks::run(n, [&](collide::thread_ranks const& ranks) {
        tests::check_scene(ranks, scene, expected, how, wrong[static_cast<std::size_t>(ranks.rank())]);
      });
      for (auto const& w : wrong) CHECK(w.text() == "");
    }
  }
}

}  // namespace

TEST_CASE("simulations on ranks: grains, floats and doubles") {
  check_on_threads(tests::grains_in_a_box<float>());
  check_on_threads(tests::grains_in_a_box<double>());
}

TEST_CASE("simulations on ranks: grains that are swept") {
  check_on_threads(tests::grains_in_a_box<float, collide::karabassi_swept<>>());
}

TEST_CASE("simulations on ranks: many sizes, and ways across several bricks") {
  check_on_threads(tests::sizes_that_repeat());
  check_on_threads(tests::leaps());
}

TEST_CASE("simulations on ranks: sources and sinks, what sticks and what sleeps") {
  check_on_threads(tests::snow());
  check_on_threads(tests::dust());
}

TEST_CASE("simulations on ranks: bodies that move") {
  check_on_threads(tests::piston_and_belt<collide::karabassi<>>());
  check_on_threads(tests::piston_and_belt<collide::karabassi_swept<>>());
}

TEST_CASE("simulations on ranks: particles that are nowhere, at one point, endless, or none") {
  check_on_threads(tests::awkward_places());
  check_on_threads(tests::one_point(80));
  check_on_threads(tests::one_point(1));
  check_on_threads(tests::one_point(0));
  check_on_threads(tests::endless_radius());
}

TEST_CASE("simulations on ranks: short memory, what makes no sense, and what bodies get") {
  for (int const n : {1, 2, 3}) {
    std::vector<tests::complaints> wrong(static_cast<std::size_t>(n));
    collide::thread_ranks::run(n, [&](collide::thread_ranks const& ranks) {
      auto& mine = wrong[static_cast<std::size_t>(ranks.rank())];
      tests::check_short_memory_of_simulations(ranks, mine);
      tests::check_reaction(ranks, mine);
      tests::check_refusals(ranks, mine);
    });
    for (auto const& w : wrong) CHECK(w.text() == "");
  }
}
