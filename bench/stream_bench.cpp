/// \file
/// Spheres from host memory through a detector, beside a plain copy of the same bytes:
/// stream_bench [LARGEST [CHUNK]] [OPTION OF GOOGLE BENCHMARK...]
///
/// Names are stream/SPACE/MEMORY/SPHERES; the broad phase is `bucket`, the mesh that of the study, the spheres are
/// uniform in its cube and have its radius, 3. MEMORY is where they are:
///   pinned    host memory that the device copies from by itself;
///   pageable  any other host memory;
///   device    memory of the space, in one query: nothing is streamed.
/// The time is that of a query into the sink `pairs`, for a mesh that is built, from the spheres in that memory to all
/// pairs in host memory of the same kind, with the numbers that the spheres have there; of `device`, to all pairs on
/// the device. Counters: pairs, chunk; GB_per_s, of spheres; copy_GB_per_s, if they are only copied to the device,
/// chunk by chunk, one right after the other; over_copy, the time over that of the copy. LARGEST bounds the spheres.
#include <algorithm>
#include <cstdio>
#include <memory_resource>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include <collide/bucket.cuh>
#include <collide/detectors/streamed.cuh>
#include <collide/spaces/upload.hpp>

#include "io/scenes.hpp"
#include "program.hpp"
#include "stopwatch.hpp"

namespace {

/// Kernel functor of `for_each` over coordinates: uniform in the study's cube, the same everywhere.
struct scatter {
  float* to;
  COLLIDE_HD void operator()(std::size_t i) const {
    std::uint64_t bits = (i + 1) * 0x9e3779b97f4a7c15u;  // SplitMix64
    bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ bits >> 27) * 0x94d049bb133111ebu;
    auto const unit = static_cast<float>(static_cast<std::int32_t>((bits ^ bits >> 31) >> 40) - (1 << 23));
    to[i] = unit * (592.2f / (1 << 23));
  }
};

/// Centres of spheres, in one kind of memory at a time: as many as the largest benchmark takes, made when first asked
/// for.
class centres {
 public:
  explicit centres(std::size_t largest) : largest_{largest} {}

  template <class Space>
  float const* in(Space const& space, std::pmr::memory_resource* memory) {
    if (memory != memory_) {
      space.for_each(3 * largest_, scatter{buffer_.reserve(memory, 3 * largest_)});
      space.synchronize();
      memory_ = memory;
    }
    return buffer_.data();
  }

 private:
  std::size_t largest_;
  std::pmr::memory_resource* memory_ = nullptr;
  collide::buffer<float> buffer_;
};

template <class Space>
collide::uploaded_mesh<float> study_mesh(Space const& space) {
  io::scene const s = io::study_scene(0);
  std::vector<float> const vertices(s.vertices.begin(), s.vertices.end());
  return collide::upload(
      space, collide::indexed_mesh(vertices.data(), vertices.size() / 3, s.corners.data(), s.triangle_count()));
}

/// A detector that is ready for spheres of the study's radius.
template <class Space>
struct detection {
  static constexpr float radius = 3;
  collide::uploaded_mesh<float> mesh;
  collide::detector<collide::bucket, collide::karabassi<>, Space> detector;

  explicit detection(Space const& space) : mesh(study_mesh(space)), detector(space) {
    detector.build(mesh.view(), radius);
  }
};

/// Puts the copy of all chunks on the stream of the space.
template <class Space>
void copy(Space const& space, float* to, float const* from, std::size_t n, std::size_t chunk) {
  for (std::size_t first = 0; first < n; first += chunk) {
    std::size_t const size = std::min(chunk, n - first);
    if constexpr (Space::host_accessible) {
      space.copy_from_host(to, from + first, size);
    } else {
#if defined(__CUDACC__)
      collide::cuda_check(
          cudaMemcpyAsync(to, from + first, size * sizeof(float), cudaMemcpyHostToDevice, space.stream()),
          "cudaMemcpyAsync");
#endif
    }
  }
  space.synchronize();
}

/// Median seconds of copying `n` spheres to memory of the space.
template <class Space>
double copy_of(Space const& space, float const* from, std::size_t n, std::size_t chunk) {
  collide::buffer<float> room;
  float* const to = room.reserve(space.resource(), 3 * std::min(chunk, n));
  bench::host_stopwatch watch(space);
  std::vector<double> seconds;
  for (int i = 0; i < 6; ++i) seconds.push_back(watch([&] { copy(space, to, from, 3 * n, 3 * chunk); }));
  return bench::median({seconds.begin() + 1, seconds.end()});
}

/// Measures find(), which returns the number of pairs and waits for them, once it has run.
template <class Space, class Find>
double measure(benchmark::State& state, Space const& space, std::size_t n, Find const& find) {
  std::uint64_t pairs = find();
  bench::host_stopwatch watch(space);
  double seconds = 0;
  for (auto _ : state) {
    double const t = watch([&] { pairs = find(); });
    state.SetIterationTime(t);
    seconds += t;
  }
  seconds /= static_cast<double>(state.iterations());
  state.counters["pairs"] = static_cast<double>(pairs);
  state.counters["GB_per_s"] = 12e-9 * static_cast<double>(n) / seconds;
  return seconds;
}

template <class Space>
void run_streamed(benchmark::State& state, Space const& space, float const* xyz, std::pmr::memory_resource* memory,
                  std::size_t n, std::size_t chunk) {
  detection<Space> with(space);
  auto const spheres = collide::spheres_xyz(xyz, n, with.radius);
  collide::streamed streamed(with.detector, chunk);
  std::uint64_t total = 0;
  collide::pairs pairs;
  streamed.query(spheres, pairs, [&](collide::id, auto const& found) { total += found.total(); });
  collide::buffer<collide::pair> buffer;
  collide::pair* const all = buffer.reserve(memory, total);
  double const seconds = measure(state, space, n, [&] {
    collide::pair* end = all;
    streamed.query(spheres, pairs, [&](collide::id first, auto const& found) {
      space.copy_to_host(end, found.data(), found.size());
      for (std::size_t i = 0; i < found.size(); ++i) (end++)->sphere += first;
    });
    return static_cast<std::uint64_t>(end - all);
  });
  double const copied = copy_of(space, xyz, n, chunk);
  state.counters["chunk"] = static_cast<double>(chunk);
  state.counters["copy_GB_per_s"] = 12e-9 * static_cast<double>(n) / copied;
  state.counters["over_copy"] = seconds / copied;
}

/// All spheres are where the space reads them.
template <class Space>
void run_resident(benchmark::State& state, Space const& space, float const* xyz, std::size_t n) {
  detection<Space> with(space);
  collide::pairs pairs;
  measure(state, space, n,
          [&] { return with.detector.query(collide::spheres_xyz(xyz, n, with.radius), pairs).total(); });
}

template <class F>
void add(std::string const& name, std::size_t largest, F const& f) {
  for (std::size_t n = std::min(largest, std::size_t{1} << 22); n <= largest; n *= 4) {
    benchmark::RegisterBenchmark(("stream/" + name + "/" + std::to_string(n)).c_str(),
                                 [=](benchmark::State& state) { f(state, n); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  }
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  std::size_t const largest = argc > 1 ? bench::count_of(argv[1], 1) : std::size_t{1} << 26;
  std::size_t const chunk = argc > 2 ? bench::count_of(argv[2], 1) : std::size_t{1} << 20;
  if (largest == 0 || chunk == 0 || argc > 3) {
    std::fputs("usage: stream_bench [LARGEST [CHUNK]] [OPTION OF GOOGLE BENCHMARK...]\n", stderr);
    return 2;
  }
  centres xyz(largest);
  auto const from_host = [&](auto const& space, char const* name, std::pmr::memory_resource* memory) {
    add(name, largest, [=, &xyz](benchmark::State& state, std::size_t n) {
      run_streamed(state, space, xyz.in(collide::host(), memory), memory, n, chunk);
    });
  };
#if defined(__CUDACC__)
  if (bench::has_gpu()) {
    collide::cuda_shared const space;
    from_host(space, "cuda_shared/pinned", collide::cuda_pinned_memory::get());
    add("cuda_shared/device", largest, [space, &xyz](benchmark::State& state, std::size_t n) {
      run_resident(state, space, xyz.in(space, space.resource()), n);
    });
    from_host(space, "cuda_shared/pageable", std::pmr::new_delete_resource());
  }
#endif
  from_host(collide::host(), "host/pageable", std::pmr::new_delete_resource());
  return bench::run();
}
