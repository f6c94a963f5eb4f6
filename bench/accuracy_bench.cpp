/// \file
/// The time that accuracy takes: accuracy_bench [SPHERES] [OPTION OF GOOGLE BENCHMARK...]
///
/// Names are accuracy/SCENE/BROAD_x_SPACE/WHAT. WHAT is
///   detect  a whole detection, build and query, into the sink `pairs`. Counters: triangles, spheres;
///   tests   the narrow phase alone, on candidates of `bucket`, the same in every space. Counters: timed_tests (what
///           the time is of), tests (what the others are of), colliding (those that truly do), for each precision
///           PRECISION_false_hits and PRECISION_false_misses, and how many tests each stage of `exact` decided.
///   nearest a query of `nearest` on the host, in processor time, after the build. Counters: triangles, points, and for
///           each precision PRECISION_wrong: how many points have another triangle that is nearer.
/// The scenes are those of accuracy_scenes.hpp with coordinates of type float; study_double has type double.
///
/// An iteration runs all precisions, one after the other, so that what disturbs the machine disturbs all alike. The
/// counters PRECISION_ms are the medians of each; the time of the benchmark is the sum, and of no interest. Beside the
/// precisions of the library there is `textbook`, the test of textbook.hpp.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/bvh.cuh>
#include <collide/narrow/detail/distance_bounds.hpp>
#include <collide/sinks/nearest.hpp>
#include <collide/spaces/upload.hpp>

#include "accuracy_scenes.hpp"
#include "program.hpp"
#include "race.hpp"
#include "textbook.hpp"

namespace {

/// As many spheres as `all_pairs` can be asked for on the host, and as many tests as time is taken of.
constexpr std::size_t few_spheres = 2048, timed_tests = 1 << 20;

/// make(NarrowPhase()) of each narrow phase, by the name of its precision.
template <class Make>
std::vector<bench::contestant> each_precision(Make const& make) {
  return {{"textbook", make(bench::textbook())},
          {"baseline", make(collide::karabassi<collide::baseline>())},
          {"single", make(collide::karabassi<collide::single_precision>())},
          {"double", make(collide::karabassi<collide::double_precision>())},
          {"exact", make(collide::karabassi<collide::exact>())}};
}

/// A scene in memory of a space. Made once.
template <class Space, class S>
struct scene_in {
  collide::uploaded_mesh<S> mesh;
  collide::uploaded_spheres<S> spheres;
  S largest_radius;

  static scene_in& get(bench::scene_kind const& kind, Space const& space) {
    static std::map<std::string, scene_in> made;
    std::string const name = kind.name + std::to_string(kind.spheres);
    auto const found = made.find(name);
    if (found != made.end()) return found->second;
    bench::scene<S> const s(kind.make(kind.spheres, 0));
    scene_in in{collide::upload(space, s.mesh()), collide::upload(space, s.spheres()), s.largest_radius()};
    return made.emplace(name, std::move(in)).first->second;
  }
};

template <class S>
bench::test_list<S> const& tests_of(bench::scene_kind const& kind) {
  static std::map<std::string, bench::test_list<S>> made;
  auto const found = made.find(kind.name);
  return found != made.end() ? found->second : made.emplace(kind.name, bench::test_list<S>(kind)).first->second;
}

template <class Broad, class S, class Space>
void detect(benchmark::State& state, bench::scene_kind const& kind, Space space) {
  auto const& scene = scene_in<Space, S>::get(kind, space);
  bench::race(state, space, bench::warmed(each_precision([&](auto of) {
                using narrow_phase = decltype(of);
                auto const detector = std::make_shared<collide::detector<Broad, narrow_phase, Space, S>>(space);
                auto const pairs = std::make_shared<collide::pairs>();
                return [=, &scene] {
                  detector->build(scene.mesh.view(), scene.largest_radius);
                  detector->query(scene.spheres.view(), *pairs);
                };
              })));
  state.counters["triangles"] = static_cast<double>(scene.mesh.view().size());
  state.counters["spheres"] = static_cast<double>(kind.spheres);
}

/// Kernel functor of `for_each` over candidates.
template <class NarrowPhase, class S>
struct decide_all {
  collide::mesh_view<S> mesh;
  collide::sphere_view<S> spheres;
  collide::pair const* tests;
  std::uint8_t* hits;

  COLLIDE_HD void operator()(std::size_t i) const {
    collide::pair const p = tests[i];
    hits[i] = NarrowPhase::intersects(mesh[p.triangle], spheres[p.sphere]);
  }
};

/// The tests of a scene in memory of a space. Made once.
template <class Space, class S>
struct tests_in {
  collide::uploaded_mesh<S> mesh;
  collide::uploaded_spheres<S> spheres;
  collide::buffer<collide::pair> tests;
  collide::buffer<std::uint8_t> hits;

  static tests_in& get(bench::scene_kind const& kind, Space const& space) {
    static std::map<std::string, tests_in> made;
    auto const found = made.find(kind.name);
    if (found != made.end()) return found->second;
    bench::scene<S> const s(kind.make(1, 0));
    auto const& list = tests_of<S>(kind);
    tests_in in{collide::upload(space, s.mesh()), collide::upload(space, list.spheres()), {}, {}};
    std::size_t const size = list.tests.size();
    space.copy_from_host(in.tests.reserve(space.resource(), size), list.tests.data(), size);
    in.hits.reserve(space.resource(), size);
    return made.emplace(kind.name, std::move(in)).first->second;
  }
};

template <class S, class Space>
void test(benchmark::State& state, bench::scene_kind const& kind, Space space) {
  auto const& in = tests_in<Space, S>::get(kind, space);
  auto const& truth = tests_of<S>(kind).truth;
  std::size_t const n = truth.size(), timed = std::min(n, timed_tests);
  auto const decide = [&](auto of, std::size_t count) {
    using narrow_phase = decltype(of);
    space.for_each(count,
                   decide_all<narrow_phase, S>{in.mesh.view(), in.spheres.view(), in.tests.data(), in.hits.data()});
  };

  // The verdicts are the same each time: they are counted once.
  static std::map<std::string, std::map<std::string, double>> counted;
  auto& counts = counted[kind.name];
  if (counts.empty()) {
    counts["timed_tests"] = static_cast<double>(timed);
    counts["tests"] = static_cast<double>(n);
    static char const* const stages[] = {"box", "single_certificate", "double_certificate", "integers"};
    for (auto const* const stage : stages) counts[stage] = 0;
    for (auto const& t : truth) {
      counts["colliding"] += t.hit;
      ++counts[stages[static_cast<int>(t.decided_by)]];
    }
    for (auto const& c : each_precision([&](auto of) { return [=] { decide(of, n); }; })) {
      c.work();
      std::vector<std::uint8_t> hits(n);
      space.copy_to_host(hits.data(), in.hits.data(), hits.size());
      double false_hits = 0, false_misses = 0;
      for (std::size_t i = 0; i < n; ++i) {
        false_hits += hits[i] && !truth[i].hit;
        false_misses += !hits[i] && truth[i].hit;
      }
      counts[c.name + "_false_hits"] = false_hits;
      counts[c.name + "_false_misses"] = false_misses;
    }
  }
  bench::race(state, space, bench::warmed(each_precision([&](auto of) { return [=] { decide(of, timed); }; })));
  for (auto const& [name, count] : counts) state.counters[name] = count;
  if (counts["exact_false_hits"] + counts["exact_false_misses"] > 0) {
    state.SkipWithError("exact is not what it is on the host");
  }
}

template <class S>
void ask_nearest(benchmark::State& state, bench::scene_kind const& kind, collide::host space) {
  bench::scene<S> const scene(kind.make(kind.spheres, 0));
  auto const mesh = scene.mesh();
  auto const points = scene.spheres().centres();
  std::map<std::string, std::vector<collide::nearest_triangle<S>>> found;
  auto const asks = [&](std::string const& name, auto of) {
    using narrow_phase = decltype(of);
    auto const detector = std::make_shared<collide::detector<collide::bvh, narrow_phase, collide::host, S>>(space);
    auto const nearest = std::make_shared<collide::nearest<S>>();
    detector->build(mesh);
    found[name] = detector->query(points, *nearest).to_host();
    return bench::contestant{name, [=] { detector->query(points, *nearest); }};
  };
  std::vector<bench::contestant> const all{asks("single", collide::karabassi<collide::single_precision>()),
                                           asks("double", collide::karabassi<collide::double_precision>()),
                                           asks("exact", collide::karabassi<collide::exact>())};
  auto const& truth = found["exact"];
  for (auto const& [name, guesses] : found) {
    double wrong = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (guesses[i].triangle == truth[i].triangle) continue;
      int const order =
          collide::detail::compare_distances(mesh[guesses[i].triangle], mesh[truth[i].triangle], points[i]);
      wrong += order > 0;
      if (order < 0) state.SkipWithError("exact has not found the nearest triangle");
    }
    state.counters[name + "_wrong"] = wrong;
  }
  state.counters["triangles"] = static_cast<double>(mesh.size());
  state.counters["points"] = static_cast<double>(points.size());
  bench::processor_stopwatch watch;
  bench::race_by(state, watch, all);
}

template <class F>
void add(std::string const& name, F const& f) {
  benchmark::RegisterBenchmark(("accuracy/" + name).c_str(), f)->UseManualTime()->Unit(benchmark::kMillisecond);
}

template <class Broad, class S, class Space>
void add_detect(bench::scene_kind const& kind, std::string const& broad, Space space) {
  add(kind.name + ("/" + broad) + "_x_" + Space::name() + "/detect",
      [=](benchmark::State& state) { detect<Broad, S>(state, kind, space); });
}

/// `bucket` and the narrow phase alone.
template <class S, class Space>
void add_scene(bench::scene_kind const& kind, Space space) {
  add_detect<collide::bucket, S>(kind, "bucket", space);
  add(std::string(kind.name) + "/bucket_x_" + Space::name() + "/tests",
      [=](benchmark::State& state) { test<S>(state, kind, space); });
}

/// Every scene. Slivers and contacts have so many candidates that fewer spheres do.
template <class Space>
void add_scenes(std::size_t spheres, Space space) {
  add_scene<float>({"study", spheres, bench::study}, space);
  add_scene<float>({"offset", spheres, bench::far_away}, space);
  add_scene<float>({"slivers", spheres / 2, bench::thin}, space);
  add_scene<float>({"long_slivers", spheres / 8, bench::long_slivers}, space);
  add_scene<float>({"contact", spheres / 4, bench::contact}, space);
  add_scene<double>({"study_double", spheres, bench::study}, space);
}

template <class S>
void add_nearest(bench::scene_kind const& kind, collide::host space) {
  add(kind.name + std::string("/bvh_x_host/nearest"),
      [=](benchmark::State& state) { ask_nearest<S>(state, kind, space); });
}

template <class Space>
void add_all_pairs(std::size_t spheres, Space space) {
  add_detect<collide::all_pairs, float>({"study", spheres, bench::study}, "all_pairs", space);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  std::size_t const spheres = argc > 1 ? bench::count_of(argv[1], 8) : io::study_spheres;
  if (spheres == 0 || argc > 2) {
    std::fputs("usage: accuracy_bench [SPHERES, at least 8] [OPTION OF GOOGLE BENCHMARK...]\n", stderr);
    return 2;
  }

  collide::host const one(1);
  add_scenes(spheres, one);
  add_all_pairs(std::min(spheres, few_spheres), one);
  // `nearest` takes longer, so an eighth of the points do
  add_nearest<float>({"study", spheres / 8, bench::study}, one);
  add_nearest<float>({"offset", spheres / 8, bench::far_away}, one);
  add_nearest<float>({"slivers", spheres / 8, bench::thin}, one);
  add_nearest<float>({"surface", spheres / 8, bench::on_surface}, one);
  add_nearest<double>({"study_double", spheres / 8, bench::study}, one);
#if defined(__CUDACC__)
  if (bench::has_gpu()) {
    add_scenes(spheres, collide::cuda());
    add_scenes(spheres, collide::cuda_shared());
    add_all_pairs(spheres, collide::cuda_shared());
  }
#endif
  return bench::run();
}
