/// \file
/// Fills a region with spheres of many sizes that do not overlap.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <collide/bvh.cuh>
#include <collide/detector.hpp>
#include <collide/host.hpp>
#include <collide/karabassi.hpp>
#include <collide/mesh.hpp>
#include <collide/simulation/detail/drop_and_roll.hpp>
#include <collide/simulation/size_distribution.hpp>
#include <collide/sinks/signed_distance.hpp>

namespace collide {

/// A box, a region to be filled. A region has a box around it, a volume, and `depths`: how far points are inside of its
/// surface at least, below 0 outside.
struct box_region {
  double lower[3];  ///< its corner with the lowest coordinates
  double upper[3];  ///< that with the highest

  /// The volume, of the unit of length cubed.
  double volume() const { return (upper[0] - lower[0]) * (upper[1] - lower[1]) * (upper[2] - lower[2]); }
  /// How far points, x, y, z of each, are inside of the surface; below 0 outside.
  std::vector<double> depths(std::vector<double> const& xyz) const {
    std::vector<double> found(xyz.size() / 3, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < xyz.size(); ++i)
      found[i / 3] = std::min({found[i / 3], xyz[i] - lower[i % 3], upper[i % 3] - xyz[i]});
    return found;
  }
};

/// A cylinder.
struct cylinder_region {
  double from[3];        ///< the middle of one end
  double to[3];          ///< that of the other
  double radius;         ///< of the ends
  double lower[3] = {};  ///< lowest coordinates
  double upper[3] = {};  ///< highest coordinates

  /// From the middle of one end to the middle of the other.
  cylinder_region(double const (&a)[3], double const (&b)[3], double r) : radius{r} {
    for (int k = 0; k < 3; ++k) from[k] = a[k], to[k] = b[k];
    vec3<double> const axis = along();
    for (int k = 0; k < 3; ++k) {
      double const wide = r * std::sqrt(std::max(0.0, 1 - axis[k] * axis[k]));
      lower[k] = std::min(a[k], b[k]) - wide, upper[k] = std::max(a[k], b[k]) + wide;
    }
  }
  /// The distance between the two ends.
  double length() const {
    return std::sqrt(detail::dot(vec3<double>(to[0] - from[0], to[1] - from[1], to[2] - from[2]),
                                 vec3<double>(to[0] - from[0], to[1] - from[1], to[2] - from[2])));
  }
  /// The volume, of the unit of length cubed.
  double volume() const { return 3.14159265358979324 * radius * radius * length(); }
  /// How far points, x, y, z of each, are inside of the surface; below 0 outside.
  std::vector<double> depths(std::vector<double> const& xyz) const {
    std::vector<double> found(xyz.size() / 3);
    for (std::size_t i = 0; i < found.size(); ++i) {
      vec3<double> const x(xyz[3 * i] - from[0], xyz[3 * i + 1] - from[1], xyz[3 * i + 2] - from[2]);
      double const height = detail::dot(x, along()), aside = (x - along() * height).norm();
      found[i] = std::min({height, length() - height, radius - aside});
    }
    return found;
  }

 private:
  vec3<double> along() const { return vec3<double>(to[0] - from[0], to[1] - from[1], to[2] - from[2]) / length(); }
};

/// The inside of a closed mesh, of any number of shells: `signed_distance` says how deep a point is. `error` if
/// triangles do not turn outwards as one, so that the volume is not above 0. The mesh must outlive it.
class mesh_region {
 public:
  double lower[3];  ///< lowest coordinates
  double upper[3];  ///< highest coordinates

  /// O(triangles log triangles), with the threads of `space`. `error` if the volume is not above 0.
  explicit mesh_region(mesh_view<double> const& mesh, host space = host()) : tree_(space) {
    for (int k = 0; k < 3; ++k) lower[k] = std::numeric_limits<double>::infinity(), upper[k] = -lower[k];
    for (std::size_t i = 0; i < mesh.size(); ++i) {
      triangle<double> const t = mesh[i];
      vec3<double> const apex = mesh[0].a;  // not the origin, beside which a mesh that is far away has no volume
      volume_ += detail::dot(t.a - apex, detail::cross(t.b - apex, t.c - apex)) / 6;
      for (vec3<double> const& corner : {t.a, t.b, t.c})
        for (int k = 0; k < 3; ++k) lower[k] = std::min(lower[k], corner[k]), upper[k] = std::max(upper[k], corner[k]);
    }
    detail::check_parameter(volume_ > 0, "mesh_region: the mesh is closed, and its triangles turn outwards");
    tree_.build(mesh);
  }
  /// The volume, of the unit of length cubed.
  double volume() const { return volume_; }
  /// How far points, x, y, z of each, are inside of the surface; below 0 outside.
  std::vector<double> depths(std::vector<double> const& xyz) const {
    signed_distance<double> sink;
    auto const found = tree_.query(points(xyz.data(), xyz.size() / 3), std::move(sink)).to_host();
    std::vector<double> depth(found.size());
    for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = -found[i].distance;
    return depth;
  }

 private:
  double volume_ = 0;
  mutable detector<bvh, karabassi<>, host, double> tree_;
};

/// The space inside of a region and outside of another, which is inside of that.
template <class Outer, class Inner>
struct region_between {
  Outer const& outer;                      ///< must outlive it
  Inner const& inner;                      ///< must outlive it
  double const (&lower)[3] = outer.lower;  ///< lowest coordinates
  double const (&upper)[3] = outer.upper;  ///< highest coordinates

  /// The volume, of the unit of length cubed.
  double volume() const { return outer.volume() - inner.volume(); }
  /// How far points, x, y, z of each, are inside of the surface; below 0 outside.
  std::vector<double> depths(std::vector<double> const& xyz) const {
    auto found = outer.depths(xyz), of_inner = inner.depths(xyz);
    for (std::size_t i = 0; i < found.size(); ++i) found[i] = std::min(found[i], -of_inner[i]);
    return found;
  }
};
/// The region between two surfaces: `region_between`.
template <class Outer, class Inner>
region_between<Outer, Inner> between(Outer const& outer, Inner const& inner) {
  return {outer, inner};
}
template <class Outer, class Inner>
void between(Outer const&&, Inner const&) = delete;  // it would not outlive the expression
template <class Outer, class Inner>
void between(Outer const&, Inner const&&) = delete;
template <class Outer, class Inner>
void between(Outer const&&, Inner const&&) = delete;

/// Spheres in a region.
struct filling {
  std::vector<double> centres;  ///< x, y, z of each
  std::vector<double> radii;    ///< of each
  double fraction = 0;          ///< of the region's volume that they take
};

namespace detail {

/// Fills a region once, with spheres that are `larger` times as large as they are.
template <class Region>
filling fill_once(Region const& region, size_distribution const& sizes, double larger, std::uint64_t seed) {
  constexpr std::size_t batch = 4096;
  vec3<double> const lower(region.lower[0], region.lower[1], region.lower[2]);
  vec3<double> const upper(region.upper[0], region.upper[1], region.upper[2]);
  double const usual = std::cbrt(sizes.mean_volume() / 4.18879020478639);
  dropped_spheres bed(lower, upper, larger * usual, larger * sizes.largest());
  std::vector<std::size_t> open(bed.columns());
  std::vector<int> misses(bed.columns(), 0);
  for (std::size_t i = 0; i < open.size(); ++i) open[i] = i;
  std::uint64_t number = seed << 40, drawn = (seed << 40) + (std::uint64_t{1} << 39);
  std::vector<double> returned, centres, radii;  // radii of spheres that were not kept are those of the next ones
  std::size_t next = 0;
  filling kept;
  while (!open.empty()) {
    centres.clear(), radii.clear();
    for (std::size_t n = 0; n < batch && !open.empty(); ++n) {
      std::size_t const which = next++ % open.size();  // side by side: what is near is in the cache
      std::size_t const column = open[which];
      double r;
      if (returned.empty()) {
        r = sizes.radius_below(random_fraction(drawn++));
      } else {
        r = returned.back();
        returned.pop_back();
      }
      double const wide = larger * r;
      double start[2];
      for (int k = 0; k < 2; ++k)
        start[k] = std::min(std::max(bed.column_side(column, k, random_fraction(number++)), lower[k] + wide * 1.001),
                            upper[k] - wide * 1.001);
      vec3<double> at;
      if (bed.drop(start[0], start[1], wide, at)) {
        bed.add(at, wide);
        for (int k = 0; k < 3; ++k) centres.push_back(at[k]);
        radii.push_back(r);
        continue;
      }
      returned.push_back(r);
      if (++misses[column] < 4) continue;
      open[which] = open.back();
      open.pop_back();
    }
    auto const depths = region.depths(centres);
    for (std::size_t i = 0; i < radii.size(); ++i) {
      if (!(depths[i] >= radii[i])) {
        returned.push_back(radii[i]);
        continue;
      }
      kept.centres.insert(kept.centres.end(), {centres[3 * i], centres[3 * i + 1], centres[3 * i + 2]});
      kept.radii.push_back(radii[i]);
    }
  }
  return kept;
}

/// The volume of a region, or `error` if it is none.
template <class Region>
double volume_of(Region const& region) {
  double const volume = region.volume();
  check_parameter(is_positive(volume), "fill: the volume of the region is above 0, and finite");
  for (int k = 0; k < 3; ++k)
    check_parameter(region.lower[k] < region.upper[k], "fill: the region has lower below upper, along each axis");
  return volume;
}

/// Keeps the first `n` of a random order.
inline void keep_at_random(filling& all, std::size_t n, std::uint64_t seed) {
  std::vector<std::size_t> order(all.radii.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  for (std::size_t i = 0; i < n; ++i) {
    double const fraction = random_fraction((seed << 40) + (std::uint64_t{3} << 38) + i);
    std::swap(order[i], order[i + static_cast<std::size_t>(fraction * static_cast<double>(order.size() - i))]);
  }
  std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(n));
  for (std::size_t i = 0; i < n; ++i) {  // order[i] is not below i
    for (std::size_t k = 0; k < 3; ++k) all.centres[3 * i + k] = all.centres[3 * order[i] + k];
    all.radii[i] = all.radii[order[i]];
  }
  all.centres.resize(3 * n);
  all.radii.resize(n);
}

}  // namespace detail

/// Fills a region with so many spheres, or throws `error`, which says how many there is room for. See `fill`.
template <class Region>
filling fill_number(Region const& region, size_distribution const& sizes, std::size_t n, std::uint64_t seed = 0) {
  detail::check_parameter(seed < (1u << 24), "fill: seed is below 2^24");
  double const volume = detail::volume_of(region), wanted = static_cast<double>(n) * sizes.mean_volume() / volume;
  double narrowest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) narrowest = std::min(narrowest, region.upper[k] - region.lower[k]);
  double larger = std::min(std::cbrt(0.56 / wanted), 0.3 * narrowest / sizes.largest());
  filling found;
  for (int i = 0; i < 6; ++i) {
    larger = std::max(larger, 1.0);
    found = detail::fill_once(region, sizes, larger * (1 + 1e-6), seed);
    if (found.radii.size() >= n) {
      detail::keep_at_random(found, n, seed);
      for (double const r : found.radii) found.fraction += detail::sphere_mass(1.0, r) / volume;
      return found;
    }
    if (larger <= 1) break;
    larger *= 0.997 * std::cbrt(static_cast<double>(found.radii.size()) / static_cast<double>(n));
    if (i == 4) larger = 1;
  }
  throw error("collide: fill: there is room for " + std::to_string(found.radii.size()) + " spheres of " +
              std::to_string(n));
}

/// Fills a region up to a fraction of its volume, above 0, with spheres that do not overlap. They are dropped along -z
/// into the box around the region, each rolls down the others until three hold it (W. M. Visscher and M. Bolsterli,
/// Nature 239, 1972), and those stay that are in the region as a whole. If less is wanted than that gives, they are
/// dropped as larger spheres, so that gaps are everywhere. Equal spheres reach 0.58 far from walls, 0.568 in a box 50
/// diameters wide. The same seed, below 2^24, gives the same spheres. On the host, in double; O(n) for sizes of one
/// order. Throws `error` if there is not so much room.
template <class Region>
filling fill(Region const& region, size_distribution const& sizes, double fraction, std::uint64_t seed = 0) {
  detail::check_parameter(fraction > 0 && fraction < 1, "fill: fraction is above 0 and below 1");
  auto const n = static_cast<std::size_t>(std::llround(fraction * detail::volume_of(region) / sizes.mean_volume()));
  return fill_number(region, sizes, n, seed);
}

}  // namespace collide
