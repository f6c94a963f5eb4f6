/// The cells of triangles, against distances.
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <vector>

#include <doctest/doctest.h>

#include <collide/broad/detail/grid/triangle_cells.hpp>
#include <collide/bucket.cuh>

/// The host, where spheres look for triangles as on a GPU.
struct wide_cells : collide::host {};

template <>
struct collide::bucket_tuning<wide_cells> : collide::device_bucket_tuning {};

namespace {

struct point {
  double x, y, z;
};
point operator-(point const& p, point const& q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
double dot(point const& p, point const& q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
point cross(point const& p, point const& q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}

double distance_of_segment(point const& p, point const& a, point const& b) {
  point const ab = b - a;
  double const length = dot(ab, ab), t = length > 0 ? std::clamp(dot(p - a, ab) / length, 0., 1.) : 0;
  point const d = p - point{a.x + t * ab.x, a.y + t * ab.y, a.z + t * ab.z};
  return std::sqrt(dot(d, d));
}

template <class S>
double distance(point const& p, collide::triangle<S> const& t) {
  auto const wide = [](collide::vec3<S> const& v) { return point{double(v[0]), double(v[1]), double(v[2])}; };
  point const a = wide(t.a), b = wide(t.b), c = wide(t.c), n = cross(b - a, c - a);
  double least = std::min({distance_of_segment(p, a, b), distance_of_segment(p, b, c), distance_of_segment(p, c, a)});
  bool const inside =
      dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 && dot(cross(a - c, p - c), n) >= 0;
  if (inside && dot(n, n) > 0) least = std::min(least, std::abs(dot(p - a, n)) / std::sqrt(dot(n, n)));
  return least;
}

}  // namespace

TEST_CASE_TEMPLATE("triangle cells: a triangle is in the cells of all centres within its reach, and in few others", S,
                   float, double) {
  using collide::detail::cell_coverage;
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  // thick, slivers, large, flat in a plane between cells, points; in the last two grids coordinates wrap
  double const shapes[][3] = {{1, 1, 1}, {1, 1, 0.001}, {9, 9, 0.01}, {6, 6, 0}, {0.001, 0.001, 0.001}, {0, 0, 0}};
  for (double width : {0., 0.3, 0.05, 2., 20., 0.02, 0.004}) {
    for (auto const& shape : shapes) {
      std::vector<S> corners;
      std::size_t const n = 60;
      for (std::size_t i = 0; i < n; ++i) {
        double const at[3] = {5 * uniform(engine), 5 * uniform(engine) + 100, 5 * uniform(engine) - 1000};
        double const along[3] = {uniform(engine), uniform(engine), uniform(engine)};
        double const turn[3] = {uniform(engine), uniform(engine), uniform(engine)};
        for (int c = 0; c < 3; ++c) {
          double const u = shape[0] * (c - 1), v = c == 1 ? shape[2] : 0;
          for (int k = 0; k < 3; ++k) {
            bool const flat = shape[2] == 0 && k == static_cast<int>(i % 3);
            double const free = shape[0] == shape[2] ? shape[0] * uniform(engine) : u * along[k] + v * turn[k];
            corners.push_back(static_cast<S>(flat ? std::round(at[k]) : at[k] + free));
          }
        }
      }
      wide_cells space;
      collide::bucket options;
      options.cell_width = width;
      collide::bucket::index<S> index;
      auto const mesh = collide::triangle_soup(corners.data(), n);
      index.build(space, options, mesh);
      S const radius = S(0.25);
      index.prepare(space, options, collide::spheres_xyz(corners.data(), 3 * n, radius));
      auto const& grid = index.mesh_lookup().grids[0];
      REQUIRE(grid.levels > 0);
      std::size_t within = 0, missing = 0, twice = 0, far = 0, listed = 0, covered_wrongly = 0;
      for (std::size_t i = 0; i < n; ++i) {
        collide::triangle<S> const t = mesh[i];
        auto const b = collide::detail::aabb_of(t);
        auto const& level = grid.level_of(b);
        collide::detail::triangle_cells<S> const cells(grid, level, b);
        std::map<std::uint32_t, std::uint32_t> parts;
        std::size_t entries = 0;
        auto const enter = [&](std::uint32_t y, std::uint32_t z, std::uint32_t first, std::uint32_t last) {
          for (std::uint32_t x = first; x <= last; ++x) {
            auto const cell = cells.at(x, y, z);
            parts[cell.number] = cell.coverage;
            ++entries;
            if (!level.is_spread()) continue;
            // no farther from the triangle than the cell is wide on its diagonal, and the reach
            double const w = static_cast<double>(level.width);
            point const middle{static_cast<double>(grid.lower[0]) + (x + 0.5) * w,
                               static_cast<double>(grid.lower[1]) + (y + 0.5) * w,
                               static_cast<double>(grid.lower[2]) + (z + 0.5) * w};
            far += distance(middle, t) > 1.8 * (static_cast<double>(radius) + w) + 1e-3 ? 1 : 0;
          }
        };
        auto const& r = cells.range();
        if (cells.is_small()) {
          for (std::uint32_t z = r.lower[2]; z <= r.upper[2]; ++z) {
            for (std::uint32_t y = r.lower[1]; y <= r.upper[1]; ++y) enter(y, z, r.lower[0], r.upper[0]);
          }
        } else {
          for (std::uint32_t k = 0; k < cells.slabs(); ++k) cells.each_run(k, t, enter);
        }
        std::set<std::uint32_t> ranged;
        std::size_t of_ranges = 0;
        collide::detail::each_range(
            grid, b, [&] { return t; },
            [&](std::uint32_t first, std::uint32_t count) {
              of_ranges += count;
              for (std::uint32_t k = 0; k < count; ++k) ranged.insert(first + k);
            });
        listed += entries;
        twice += entries - parts.size() + (of_ranges - ranged.size());
        for (int j = 0; j < 300; ++j) {
          double const u = std::abs(uniform(engine)), v = (1 - u) * std::abs(uniform(engine)), w = 1 - u - v;
          double direction[3] = {uniform(engine), uniform(engine), uniform(engine)};
          double const length = std::hypot(direction[0], direction[1], direction[2]) + 1e-9;
          double const away = static_cast<double>(radius) * (j % 3 == 0 ? 1 : std::abs(uniform(engine)));
          collide::vec3<S> p;
          for (int k = 0; k < 3; ++k) {
            bool const on_axis = j % 5 == 0;  // the farthest on one axis
            double const part = on_axis ? (k == j % 3 ? std::copysign(1., direction[k]) : 0.) : direction[k] / length;
            p[k] = static_cast<S>(u * static_cast<double>(t.a[k]) + v * static_cast<double>(t.b[k]) +
                                  w * static_cast<double>(t.c[k]) + away * part);
          }
          if (distance({double(p[0]), double(p[1]), double(p[2])}, t) > static_cast<double>(radius)) continue;
          ++within;
          auto const place = grid.cell_at(level, p);
          auto const found = parts.find(place.number);
          missing += found == parts.end() ? 1 : 0;
          missing += ranged.count(place.number) == 0 ? 1 : 0;
          covered_wrongly += found != parts.end() && !cell_coverage::overlaps(found->second, place.coverage) ? 1 : 0;
        }
      }
      CAPTURE(width);
      CAPTURE(shape[0]);
      CAPTURE(shape[2]);
      CHECK(missing == 0);
      CHECK(covered_wrongly == 0);
      CHECK(twice == 0);
      CHECK(far == 0);
      CHECK(within > 50 * n);
      CHECK(listed >= n);
    }
  }
}
