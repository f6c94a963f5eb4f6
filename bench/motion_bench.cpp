/// \file
/// The time that accuracy of motion takes: motion_bench [PARTICLES [SPHERES]] [OPTION OF GOOGLE BENCHMARK...]
///
/// motion/SCENE/BROAD_x_SPACE/steps  elastic balls fall about inside a closed mesh (motion_scenes.hpp), by each
///     integrator, `euler` and `verlet`, with the discrete test in 1, 2, 4 and 8 steps a frame, and with the swept test
///     in 1. Counters: particles, seconds (simulated), judged (of how many the error is), doubt (of the truth, in
///     radii); for each INTEGRATOR_STEPS (as in euler_4, verlet_swept) its _ms and what class `outcome` has: _error,
///     _drift, _scatter, _tunnelled.
/// motion/study/BROAD_x_SPACE/query  the study's scene, at rest and with displacements up to the radius: static_ms and
///     swept_ms, a query of a prepared mesh into the sink `pairs`, and swept_impacts_ms, into `impacts`; NAME_both_ms,
///     the same with the build; NAME_found, how many pairs; spheres.
///
/// An iteration runs all of them, one after the other, so that what disturbs the machine disturbs all alike. The
/// counters ..._ms are the medians of each; the time of the benchmark is the sum, and of no interest.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include <collide/bucket.cuh>
#include <collide/karabassi_swept.hpp>
#include <collide/simulation.cuh>
#include <collide/sinks/impacts.hpp>
#include <collide/spaces/upload.hpp>

#include "motion_scenes.hpp"
#include "program.hpp"
#include "race.hpp"

namespace {

/// Balls of which the end is known, and the steps per frame that it is known from, where there is no closed form.
constexpr std::size_t most_judged = 1 << 13;
constexpr int finest = 256;

bench::truth const& truth_of(bench::arena const& in, std::size_t balls) {
  static std::map<std::string, bench::truth> made;
  auto const found = made.find(in.name);
  return found != made.end() ? found->second : made.emplace(in.name, bench::truth(in, balls, finest)).first->second;
}

/// An arena and its balls in memory of a space.
template <class Space>
struct stage {
  Space space;
  bench::arena const& in;
  bench::crowd<float> crowd;
  collide::uploaded_mesh<float> mesh;
  collide::uploaded_spheres<float> balls;
  collide::buffer<float> velocities;
  std::map<std::string, double> counters;
  std::vector<bench::contestant> contestants;

  stage(Space const& on, bench::arena const& arena, std::size_t n)
      : space{on}, in{arena}, crowd(arena, n), mesh{upload(space, crowd.mesh())}, balls{upload(space, crowd.balls())} {
    space.copy_from_host(velocities.reserve(space.resource(), 3 * n), crowd.velocities.data(), 3 * n);
    counters = {{"particles", static_cast<double>(n)},
                {"judged", static_cast<double>(judged())},
                {"seconds", bench::seconds},
                {"doubt", truth_of(in, judged()).doubt}};
    add<collide::karabassi<>>("euler", {1, 2, 4, 8});
    add<collide::karabassi<>, collide::velocity_verlet>("verlet", {1, 2, 4, 8});
    add<collide::karabassi_swept<>>("euler_swept", {1});
    add<collide::karabassi_swept<>, collide::velocity_verlet>("verlet_swept", {1});
  }

 private:
  /// How many balls are compared with the truth.
  std::size_t judged() const { return std::min(balls.view().size(), most_judged); }

  template <class NarrowPhase, class... Integrator>
  void add(std::string const& name, std::vector<int> const& all_steps) {
    using detector = collide::detector<collide::bucket, NarrowPhase, Space>;
    using simulation = collide::simulation<detector, Integrator..., collide::gravity, collide::bounce>;
    auto const made = std::make_shared<simulation>(space, Integrator{}..., collide::gravity{0, 0, -bench::gravity},
                                                   collide::bounce{1});
    made->set_mesh(mesh.view());
    for (int const steps : all_steps) {
      bench::contestant c;
      c.name = all_steps.size() == 1 ? name : name + "_" + std::to_string(steps);
      c.begin = [=] { made->set(balls.view(), velocities.data()); };
      c.work = [=] {
        made->steps(static_cast<std::size_t>(bench::frames * steps),
                    static_cast<float>(1.0 / (bench::frames_per_second * steps)));
      };
      // The same steps give the same bits each time: they are judged once.
      c.begin();
      c.work();
      bench::outcome const o(in, crowd, truth_of(in, judged()), made->template to_host<collide::position>(),
                             made->template to_host<collide::velocity>());
      counters[c.name + "_error"] = o.error;
      counters[c.name + "_drift"] = o.drift;
      counters[c.name + "_scatter"] = o.scatter;
      counters[c.name + "_tunnelled"] = o.tunnelled;
      contestants.push_back(std::move(c));
    }
  }
};

template <class Space>
void step(benchmark::State& state, bench::arena const& in, std::size_t n, Space space) {
  static std::map<std::string, std::unique_ptr<stage<Space>>> made;
  auto& here = made[in.name];
  if (here == nullptr) here = std::make_unique<stage<Space>>(space, in, n);
  bench::race(state, space, here->contestants);
  for (auto const& [name, count] : here->counters) state.counters[name] = count;
  if (here->counters["euler_swept_tunnelled"] + here->counters["verlet_swept_tunnelled"] > 0) {
    state.SkipWithError("a ball has passed through the mesh though its way was swept");
  }
}

/// The study's scene, and displacements as long as at most the radius, in memory of a space.
template <class Space>
struct study {
  collide::uploaded_mesh<float> mesh;
  collide::uploaded_spheres<float> spheres;
  collide::buffer<float> displacements;

  static study make(Space const& space, std::size_t n) {
    io::scene const s = io::study_scene(n);
    std::vector<float> const vertices(s.vertices.begin(), s.vertices.end());
    std::vector<float> const centres(s.centres.begin(), s.centres.end());
    std::vector<float> ways;
    io::random_numbers random(1);
    for (std::size_t i = 0; i < n; ++i) {
      io::point const p = random.in_cube(1);
      bench::vec const way = bench::vec(p[0], p[1], p[2]).normalized() * s.radius * random.unit();
      for (double const d : way) ways.push_back(static_cast<float>(d));
    }
    study made{upload(space, collide::indexed_mesh(vertices.data(), vertices.size() / 3, s.corners.data(),
                                                   s.triangle_count())),
               upload(space, collide::spheres_xyz(centres.data(), n, static_cast<float>(s.radius))),
               {}};
    space.copy_from_host(made.displacements.reserve(space.resource(), 3 * n), ways.data(), 3 * n);
    return made;
  }
  collide::moving_sphere_view<float> moving() const {
    return collide::with_displacements(spheres.view(), displacements.data());
  }
};

template <class Space>
void query(benchmark::State& state, std::size_t n, Space space) {
  static auto const scene = study<Space>::make(space, n);
  std::vector<bench::contestant> contestants;
  auto const add = [&](std::string const& name, auto narrow_phase, auto const& spheres, auto sink_type) {
    using detector_type = collide::detector<collide::bucket, decltype(narrow_phase), Space>;
    auto const detector = std::make_shared<detector_type>(space);
    auto const out = std::make_shared<typename decltype(sink_type)::type>();
    auto const build = [=] { detector->build(scene.mesh.view(), scene.spheres.view().common_radius()); };
    auto const ask = [=] { detector->query(spheres, *out); };
    build();
    ask();
    state.counters[name + "_found"] = static_cast<double>(out->size());
    contestants.push_back({name, ask});
    auto const another = std::make_shared<detector_type>(space);
    contestants.push_back({name + "_both", [=] {
                             another->build(scene.mesh.view(), scene.spheres.view().common_radius());
                             another->query(spheres, *out);
                           }});
  };
  add("static", collide::karabassi<>(), scene.spheres.view(), std::common_type<collide::pairs>());
  add("swept", collide::karabassi_swept<>(), scene.moving(), std::common_type<collide::pairs>());
  add("swept_impacts", collide::karabassi_swept<>(), scene.moving(), std::common_type<collide::impacts<float>>());
  bench::race(state, space, bench::warmed(contestants));
  state.counters["spheres"] = static_cast<double>(n);
}

template <class F>
void add(std::string const& name, F const& f) {
  benchmark::RegisterBenchmark(("motion/" + name).c_str(), f)->UseManualTime()->Unit(benchmark::kMillisecond);
}

template <class Space>
void add_all(std::size_t particles, std::size_t spheres, Space space) {
  std::string const composition = std::string("/bucket_x_") + Space::name();
  for (auto const* const in : {&bench::cube, &bench::torus}) {
    add(in->name + composition + "/steps", [=](benchmark::State& state) { step(state, *in, particles, space); });
  }
  add("study" + composition + "/query", [=](benchmark::State& state) { query(state, spheres, space); });
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  std::size_t const particles = argc > 1 ? bench::count_of(argv[1], 1) : most_judged;
  std::size_t const spheres = argc > 2 ? bench::count_of(argv[2], 1) : io::study_spheres;
  if (particles == 0 || spheres == 0 || argc > 3) {
    std::fputs("usage: motion_bench [PARTICLES [SPHERES]] [OPTION OF GOOGLE BENCHMARK...]\n", stderr);
    return 2;
  }

  add_all(particles, spheres, collide::host(1));
#if defined(__CUDACC__)
  if (bench::has_gpu()) {
    add_all(particles, spheres, collide::cuda_shared());
  }
#endif
  return bench::run();
}
