/// \file
/// Compares `automatic` with the faster of `bucket` and `bvh`, in scenes that nothing was tuned for:
/// families_bench [host|device] [SCALE] [FIRST] [END]
///
/// There are 40 families of random scenes: triangles compact, long, in bundles, giants among small ones, of two sizes,
/// few, many; spheres few, many, clustered, far; radii from 1:1 to 1:1000. Prints a line of JSON for each: milliseconds
/// of build and query (`first`), and the mean of the same query again four times (`again`), of each broad phase, least
/// of several in turn, of `bucket` also where `build` is given the largest radius, and how `automatic` compares with
/// the faster one. Even families are to tune on, odd ones to judge by. SCALE divides the numbers of triangles and
/// spheres. On the host, time is that of one processor; on a device, between events. Built by hand: nvcc -x cu
/// -std=c++17 -O3 -arch=sm_90 --extended-lambda -Iinclude -Iexamples -Ibench, or with g++ for the host.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <collide/automatic.cuh>
#include <collide/spaces/upload.hpp>

#include "stopwatch.hpp"

namespace {

/// SplitMix64: the same numbers everywhere.
class random_numbers {
 public:
  explicit random_numbers(std::uint64_t seed) : state_{seed * 0x9e3779b97f4a7c15u + 1} {}
  double unit() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  double between(double from, double to) { return from + (to - from) * unit(); }
  /// As many of each order of magnitude.
  double spread(double from, double to) { return from * std::pow(to / from, unit()); }

 private:
  std::uint64_t state_;
};

struct point {
  double x[3];
  friend point operator+(point a, point const& b) {
    for (int k = 0; k < 3; ++k) a.x[k] += b.x[k];
    return a;
  }
  friend point operator*(double s, point a) {
    for (double& x : a.x) x *= s;
    return a;
  }
};

point in_cube(random_numbers& random, double half) {
  double const a = random.between(-half, half), b = random.between(-half, half), c = random.between(-half, half);
  return {{a, b, c}};
}

point direction(random_numbers& random) {
  for (;;) {
    point const p = in_cube(random, 1);
    double const square = p.x[0] * p.x[0] + p.x[1] * p.x[1] + p.x[2] * p.x[2];
    if (square > 0.01 && square < 1) return 1 / std::sqrt(square) * p;
  }
}

struct family {
  char const *triangles, *spheres;
  std::size_t triangle_count, sphere_count;
  double ratio;   ///< of the largest radius to the smallest
  double radius;  ///< the largest, in units of the distance that spheres have between them in the cube
};

struct scene {
  std::vector<float> corners, centres, radii;
};

constexpr double half = 100;  ///< of the cube that all is in

void add_triangle(scene& s, point const& a, point const& b, point const& c) {
  for (point const* p : {&a, &b, &c}) {
    for (double const x : p->x) s.corners.push_back(static_cast<float>(x));
  }
}

/// A triangle with two edges of a length, of which the second is `thin` times as long, if that is less than 1 nearly
/// across.
void add_triangle(scene& s, random_numbers& random, point const& at, double length, double thin) {
  point const along = direction(random);
  add_triangle(s, at, at + length * along, at + (length * thin) * direction(random));
}

/// A bumpy ball.
void add_surface(scene& s, std::size_t triangles) {
  auto const rows = static_cast<std::size_t>(std::sqrt(static_cast<double>(triangles) / 4)) + 2, columns = 2 * rows;
  auto const at = [&](std::size_t i, std::size_t j) {
    double const pi = 3.14159265358979, u = 2 * pi * static_cast<double>(i % columns) / static_cast<double>(columns),
                 v = pi * static_cast<double>(j) / static_cast<double>(rows);
    double const r = 0.7 * half * (1 + 0.15 * std::sin(5 * u) * std::sin(3 * v));
    return point{{r * std::sin(v) * std::cos(u), r * std::sin(v) * std::sin(u), r * std::cos(v)}};
  };
  for (std::size_t i = 0; i < columns; ++i) {
    for (std::size_t j = 0; j < rows; ++j) {
      add_triangle(s, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      add_triangle(s, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
}

scene make(family const& f, std::uint64_t seed) {
  scene s;
  random_numbers random(seed);
  auto const n = f.triangle_count;
  std::string const kind = f.triangles;
  double const apart = 2 * half / std::cbrt(static_cast<double>(n));  // triangles
  if (kind == "surface") {
    add_surface(s, n);
  } else {
    double const long_edge = kind == "long" ? half * random.between(0.3, 1) : half * random.between(0.05, 0.3);
    for (std::size_t i = 0; i < n; ++i) {
      point const at = in_cube(random, half);
      if (kind == "soup") add_triangle(s, random, at, apart * random.between(0.3, 1), 1);
      if (kind == "long" || kind == "rods") add_triangle(s, random, at, long_edge, 0.002);
      if (kind == "bundle") {  // side by side, across the axes
        point const along = half * point{{0.8, 0.5, 0.4}} + 0.02 * in_cube(random, half),
                    from = 0.2 * at + -0.5 * along;
        add_triangle(s, from, from + along, from + 0.01 * in_cube(random, half));
      }
      if (kind == "bars") {  // along the axes
        point along{}, across{};
        along.x[i % 3] = long_edge, across.x[(i + 1) % 3] = long_edge * 0.01;
        add_triangle(s, at, at + along, at + along + across);
      }
      if (kind == "giants") add_triangle(s, random, at, i % 1000 == 0 ? half : apart / 2, 1);
      if (kind == "two sizes") add_triangle(s, random, at, i % 20 == 0 ? 8 * apart : apart / 4, 1);
      if (kind == "uneven") add_triangle(s, random, at, random.spread(0.01, 5) * apart, random.spread(0.03, 1));
    }
  }
  std::string const where = f.spheres;
  double const between = 2 * half / std::cbrt(static_cast<double>(f.sphere_count));
  point const middle = in_cube(random, 0.5 * half);
  std::size_t const all = s.corners.size() / 9;
  for (std::size_t i = 0; i < f.sphere_count; ++i) {
    point p = in_cube(random, half);
    bool const is_near = where == "near" || (where == "far" && i % 100 == 0);
    if (where == "cluster") p = middle + 0.1 * p;
    if (where == "far" && !is_near) p = p + point{{6 * half, 0, 0}};
    if (is_near) {
      auto const t = static_cast<std::size_t>(random.unit() * static_cast<double>(all));
      double u = random.unit(), v = random.unit();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      float const* const c = s.corners.data() + 9 * t;
      for (int k = 0; k < 3; ++k) {
        p.x[k] = c[k] + u * (c[3 + k] - c[k]) + v * (c[6 + k] - c[k]) + random.between(-1, 1) * f.radius * between;
      }
    }
    for (double const x : p.x) s.centres.push_back(static_cast<float>(x));
    s.radii.push_back(static_cast<float>(f.radius * between * random.spread(1 / f.ratio, 1)));
  }
  return s;
}

/// Family `i`; each stands for many scenes.
family family_of(int i, std::size_t scale) {
  char const* const triangle_kinds[] = {"surface", "long", "giants", "two sizes", "soup",
                                        "rods",    "bars", "uneven", "long",      "surface"};
  char const* const sphere_kinds[] = {"volume", "near", "cluster", "far", "volume"};
  random_numbers random(static_cast<std::uint64_t>(i) + 1000);
  family f{};
  f.triangles = triangle_kinds[static_cast<int>(random.unit() * 1000 + i / 2) % 10];
  f.spheres = sphere_kinds[static_cast<int>(random.unit() * 5)];
  double const triangles = i % 4 < 2 ? random.spread(100, 3000) : random.spread(1e4, 1e6);
  double const spheres = i % 3 == 0 ? random.spread(1e3, 3e4) : random.spread(1e5, 3e6);
  double const least = std::string(f.triangles) == "giants" ? 3000 : 12;
  f.triangle_count = static_cast<std::size_t>(std::max(least, triangles / static_cast<double>(scale)));
  f.sphere_count = static_cast<std::size_t>(std::max(100.0, spheres / static_cast<double>(scale)));
  if (std::strchr("lrb", f.triangles[0]) != nullptr)
    f.triangle_count = std::min<std::size_t>(f.triangle_count, 100000 / scale);
  f.ratio = random.unit() < 0.5 ? 1 : random.spread(3, 1000);
  f.radius = random.spread(0.05, f.ratio > 1 ? 2 : 0.6);
  return f;
}

/// The processor's time, or that between events on a device.
template <class Space>
struct watch_of : bench::stopwatch<Space> {
  using bench::stopwatch<Space>::stopwatch;
};
template <>
struct watch_of<collide::host> : bench::processor_stopwatch {
  explicit watch_of(collide::host const&) {}
};

/// One of the broad phases, and the least of what it took.
template <class Broad, class Space>
struct contestant {
  float radius;  ///< that `build` is given, if it is not negative
  collide::detector<Broad, collide::karabassi<>, Space> detector;
  collide::pairs found;
  double first_ms = 1e9, again_ms = 1e9;

  explicit contestant(Space const& space, float radius = -1) : radius{radius}, detector{space} {}

  /// Build and query, and the mean of four more; returns the seconds of all.
  double race(Space const& space, collide::mesh_view<float> mesh, collide::sphere_view<float> spheres) {
    watch_of<Space> watch(space);
    double const first = watch([&] {
      radius < 0 ? detector.build(mesh) : detector.build(mesh, radius);
      detector.query(spheres, found);
    });
    double again = 0;
    for (int k = 0; k < 4; ++k) again += watch([&] { detector.query(spheres, found); });
    first_ms = std::min(first_ms, 1e3 * first);
    again_ms = std::min(again_ms, 1e3 * again / 4);
    return first + again;
  }
};

template <class Space>
void run(Space const& space, std::size_t scale, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    family const f = family_of(i, scale);
    scene const s = make(f, static_cast<std::uint64_t>(i));
    auto const mesh = collide::upload(space, collide::triangle_soup(s.corners.data(), s.corners.size() / 9));
    auto const spheres =
        collide::upload(space, f.ratio > 1 ? collide::spheres_xyz(s.centres.data(), s.radii.size(), s.radii.data())
                                           : collide::spheres_xyz(s.centres.data(), s.radii.size(), s.radii[0]));
    float const largest = *std::max_element(s.radii.begin(), s.radii.end());
    contestant<collide::bucket, Space> by_bucket(space), given(space, largest);
    contestant<collide::bvh, Space> by_bvh(space);
    contestant<collide::automatic, Space> by_automatic(space);
    double spent = 0;
    auto const one = [&](auto& c) { spent += c.race(space, mesh.view(), spheres.view()); };
    for (int k = 0; k < 4 || (k < 200 && spent < 1); ++k) {  // the first allocates
      for (int const which : k % 2 == 0 ? std::array{0, 1, 2, 3} : std::array{2, 1, 0, 3}) {
        if (which == 0) one(by_bucket);
        if (which == 1) one(by_bvh);
        if (which == 2) one(by_automatic);
        if (which == 3) one(given);
      }
    }
    std::uint64_t const pairs = by_bucket.found.total();
    bool const same =
        pairs == by_bvh.found.total() && pairs == by_automatic.found.total() && pairs == given.found.total();
    std::printf(
        "{\"family\": %d, \"triangles\": \"%s\", \"spheres\": \"%s\", \"triangle_count\": %zu, \"sphere_count\": %zu, "
        "\"ratio\": %.3g, \"radius\": %.3g, \"pairs\": %llu, \"same\": %s, \"bucket\": [%.4g, %.4g], "
        "\"bucket_given\": [%.4g, %.4g], \"bvh\": [%.4g, %.4g], \"automatic\": [%.4g, %.4g], \"over_best\": [%.3f, "
        "%.3f], \"cells\": [%.3g, %.3g]}\n",
        i, f.triangles, f.spheres, mesh.view().size(), spheres.view().size(), f.ratio, f.radius,
        static_cast<unsigned long long>(pairs), same ? "true" : "false", by_bucket.first_ms, by_bucket.again_ms,
        given.first_ms, given.again_ms, by_bvh.first_ms, by_bvh.again_ms, by_automatic.first_ms, by_automatic.again_ms,
        by_automatic.first_ms / std::min(by_bucket.first_ms, by_bvh.first_ms),
        by_automatic.again_ms / std::min(by_bucket.again_ms, by_bvh.again_ms), by_bucket.detector.cell_width(),
        by_automatic.detector.cell_width());
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  bool const on_device = argc > 1 && std::strcmp(argv[1], "device") == 0;
  std::size_t const scale = argc > 2 ? static_cast<std::size_t>(std::atoi(argv[2])) : 1;
  int const begin = argc > 3 ? std::atoi(argv[3]) : 0, end = argc > 4 ? std::atoi(argv[4]) : 40;
#if defined(__CUDACC__)
  if (on_device) return run(collide::cuda_shared(), scale, begin, end), 0;
#else
  if (on_device) return std::fputs("families_bench: compile it with nvcc for that\n", stderr), 2;
#endif
  run(collide::host(1), scale, begin, end);
}
