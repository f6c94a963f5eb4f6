/// Simulations on ranks that are threads, on the host.
#include <collide/effects/polydisperse.hpp>

#include "counted_ranks.hpp"
#include "ranks/on_threads.hpp"

TEST_CASE("simulations on ranks: grains, floats and doubles") {
  tests::check_on_threads(tests::grains_in_a_box<float>());
  tests::check_on_threads(tests::grains_in_a_box<double>());
}

TEST_CASE("simulations on ranks: grains that are swept") {
  tests::check_on_threads(tests::grains_in_a_box<float, collide::karabassi_swept<>>());
}

TEST_CASE("simulations on ranks: many sizes, and ways across several subdomains") {
  tests::check_on_threads(tests::sizes_that_repeat());
  tests::check_on_threads(tests::leaps());
}

TEST_CASE("simulations on ranks: sources and sinks, what sticks and what sleeps") {
  tests::check_on_threads(tests::snow());
  tests::check_on_threads(tests::snow(true));
  tests::check_on_threads(tests::crowded_source());
  tests::check_on_threads(tests::dust());
}

TEST_CASE("simulations on ranks: sources where nobody is, and with fewer places than ranks") {
  auto snow = tests::snow();
  auto careful = tests::snow(true);
  auto dust = tests::dust();
  auto const empty = [](auto& scene) {
    scene.w.centres.clear();
    scene.w.velocities.clear();
    scene.capacity = 5;
    scene.steps = 60;
    tests::check_on_threads(scene);
  };
  empty(snow);
  empty(careful);
  empty(dust);
}

TEST_CASE("simulations on ranks: messages that come late") {
  tests::check_on_threads<tests::late_ranks>(tests::sizes_that_repeat());
  tests::check_on_threads<tests::late_ranks>(tests::snow(true), {1, 3});
  tests::check_on_threads<tests::late_ranks>(tests::cube_and_row(), {1, 2, 3, 4, 7, 12});
}

TEST_CASE("simulations on ranks: bodies that move") {
  tests::check_on_threads(tests::piston_and_belt<collide::karabassi<>>());
  tests::check_on_threads(tests::piston_and_belt<collide::karabassi_swept<>>());
}

TEST_CASE("simulations on ranks: particles that are nowhere, at one point, endless, or none") {
  tests::check_on_threads(tests::awkward_places());
  tests::check_on_threads(tests::one_point(80));
  tests::check_on_threads(tests::one_point(1));
  tests::check_on_threads(tests::one_point(0));
  tests::check_on_threads(tests::endless_radius());
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

TEST_CASE("simulations on ranks: subdomains have as many particles, and know who is near") {
  for (int const n : {1, 2, 5, 8, 13}) {
    collide::thread_ranks::run(n, [&](collide::thread_ranks const& ranks) {
      std::mt19937 engine(static_cast<unsigned>(ranks.rank()));
      std::normal_distribution<double> normal;
      std::vector<double> x;  // denser in the middle, long along y, and not the same on all ranks
      for (int i = 0; i < 300 * (1 + ranks.rank() % 3); ++i) {
        x.insert(x.end(), {normal(engine), 7 * normal(engine), normal(engine)});
      }
      collide::detail::bisection subdomains;
      subdomains.build(ranks, x);
      auto const lookup = subdomains.lookup();
      std::vector<std::uint64_t> mine(static_cast<std::size_t>(n)), all(mine.size());
      std::size_t missing = 0;
      for (std::size_t i = 0; i < x.size(); i += 3) {
        int const at = lookup.rank_at(x.data() + i);
        ++mine[static_cast<std::size_t>(at)];
        for (std::size_t k = 0; k < 30; k += 3) {  // with a neighbour anywhere within reach
          double const reach = 0.3 * static_cast<double>(k),
                       near[] = {x[i] - reach, x[i + 1] + reach, x[i + 2] - reach};
          bool found = false;
          lookup.for_each_rank(near, reach * (1 + 1e-12), [&](int rank) { found = found || rank == at; });
          missing += !found;
        }
      }
      ranks.reduce(mine.data(), all.data(), all.size(), collide::reduction::sum);
      std::uint64_t const sum = std::accumulate(all.begin(), all.end(), std::uint64_t{0});
      std::uint64_t const most = *std::max_element(all.begin(), all.end());
      collide::together(ranks, [&] {
        if (missing != 0) throw collide::error("a rank does not know who is near");
        if (most * static_cast<std::uint64_t>(n) > sum * 6 / 5) throw collide::error("not divided evenly");
      });
    });
  }
}

TEST_CASE("simulations on ranks: a step takes one reduction, and steps one more") {
  using simulation = collide::simulation<tests::discrete<collide::host>, collide::sphere_contact>;
  using ranks_type = bench::counted_ranks<collide::thread_ranks>;
  for (int const n : {1, 2, 5}) {
    std::vector<bench::traffic> sent(static_cast<std::size_t>(n));
    collide::thread_ranks::run(n, [&](collide::thread_ranks const& threads) {
      auto& mine = sent[static_cast<std::size_t>(threads.rank())];
      collide::distributed<simulation, ranks_type> parts(ranks_type(threads, mine), collide::host(1));
      auto const x = static_cast<float>(threads.rank());
      float const centre[] = {x, 0, 0};
      parts.set(collide::spheres_xyz(centre, 1, 0.1f));
      parts.step(1e-4f);  // makes subdomains
      mine = {};
      parts.steps(10, 1e-4f);
    });
    for (auto const& mine : sent) {
      CHECK(mine.reductions == 11);
      CHECK(mine.reduced_bytes == 10 * 16 + 8);
      CHECK(mine.exchanges == 10);
    }
  }
}

namespace {

/// In how many of 1000 steps particles change ranks where all fly by 0.0001 in each, a large and a small one on both of
/// two ranks.
template <class... Effect>
std::vector<int> migrations(float small) {
  using simulation = collide::simulation<tests::discrete<collide::host>, Effect...>;
  using ranks_type = bench::counted_ranks<collide::thread_ranks>;
  std::vector<int> found(2, 0);
  collide::thread_ranks::run(2, [&](collide::thread_ranks const& threads) {
    bench::traffic sent;
    collide::distributed<simulation, ranks_type> parts(ranks_type(threads, sent), collide::host(1));
    auto const x = static_cast<float>(threads.rank());
    float const centres[] = {x, 0, 0, x, 0.5f, 0}, velocities[] = {0, 0, 10, 0, 0, 10}, radii[] = {0.1f, small};
    parts.set(small < 0.1f ? collide::spheres_xyz(centres, 2, radii) : collide::spheres_xyz(centres, 2, 0.1f),
              velocities);
    parts.step(1e-5f);  // makes subdomains
    for (int k = 0; k < 1000; ++k) {
      auto const before = sent.reductions;
      parts.step(1e-5f);
      found[static_cast<std::size_t>(threads.rank())] += sent.reductions - before > 2;
    }
  });
  return found;
}

}  // namespace

TEST_CASE("simulations on ranks: particles change ranks when one has moved by half the skin of the largest") {
  std::vector<int> const expected(2, 10);  // the skin is 0.02, and 0.0099 are crossed in 99 steps or 100
  CHECK(migrations<collide::sphere_contact>(0.1f) == expected);
  CHECK(migrations<collide::polydisperse, collide::sphere_contact>(0.09f) == expected);
  // lists of neighbours are made anew more often, as their skin is of the small ones
  CHECK(migrations<collide::polydisperse, collide::sphere_contact>(0.02f) == expected);
}
