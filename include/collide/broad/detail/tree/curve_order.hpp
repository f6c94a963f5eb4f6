/// \file
/// Triangles, and points that look for them, in the order of a curve through space: alike in every run.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <collide/broad/detail/bucket/triangle_order.hpp>
#include <collide/broad/detail/grid/mesh_statistics.hpp>
#include <collide/broad/detail/tree/tree_node.hpp>
#include <collide/core/memory.hpp>
#include <collide/spaces/detail/block.hpp>
#if defined(__CUDACC__)
#include <collide/spaces/detail/sort_cuda.cuh>
#endif

namespace collide::detail {

/// The position of a place on Hilbert's curve through a cube, from coordinates of `Bits` bits (J. Skilling,
/// "Programming the Hilbert curve", 2004).
template <int Bits>
COLLIDE_HD_INLINE std::uint64_t place_on_curve(std::uint32_t (&x)[3]) {
  constexpr std::uint32_t top = 1u << (Bits - 1);
  for (std::uint32_t q = top; q > 1; q >>= 1) {
    for (auto& c : x) {
      std::uint32_t const t = (x[0] ^ c) & (q - 1);
      if ((c & q) != 0) {
        x[0] ^= q - 1;
      } else {
        x[0] ^= t;
        c ^= t;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t turned = 0;
  for (std::uint32_t q = top; q > 1; q >>= 1) turned ^= (x[2] & q) != 0 ? q - 1 : 0;
  std::uint64_t place = 0;
  for (int b = Bits - 1; b >= 0; --b) {
    for (auto const c : x) place = place << 1 | ((c ^ turned) >> b & 1);
  }
  return place;
}

/// The position of a place given in parts of the width of the cube, which are limited to 0 and 1.
template <int Bits, class S>
COLLIDE_HD_INLINE std::uint64_t place_of_fractions(vec3<S> const& fractions) {
  std::uint32_t x[3];
  for (int k = 0; k < 3; ++k)
    x[k] = static_cast<std::uint32_t>(static_cast<std::int32_t>(saturate(fractions[k]) * S((1 << Bits) - 1)));
  return place_on_curve<Bits>(x);
}

template <class S>
COLLIDE_HD_INLINE S half_extent(mesh_statistics<S> const& mesh) {
  S half = 0;
  for (int k = 0; k < 3; ++k) half = max(half, mesh.upper_of(k) / 2 - mesh.lower_of(k) / 2);
  return half;
}

/// Kernel functor of `for_each` over triangles: where each is on the curve, and its number.
template <class S>
struct find_places {
  static constexpr int bits = 16;                            ///< of a coordinate
  static constexpr std::uint64_t none = 1ull << (3 * bits);  ///< of what is not finite

  mesh_view<S> mesh;
  mesh_statistics<S> const* summary;
  std::uint64_t* places;
  id* ids;

  COLLIDE_HD void operator()(std::size_t i) const {
    aabb<S> const box = aabb_of(mesh[i]);
    ids[i] = static_cast<id>(i);
    places[i] = none;
    if (box.is_empty()) return;
    S const half = half_extent(*summary);
    vec3<S> fractions;
    for (int k = 0; k < 3; ++k)
      fractions[k] = div_rn((box.lower[k] / 2 + box.upper[k] / 2 - summary->lower_of(k)) / 2, half);
    places[i] = place_of_fractions<bits>(fractions);
  }
};

/// Numbers and their places on the curve, which are sorted.
class curve_sort {
 public:
  /// Makes room for `n` numbers.
  template <class Space>
  void reserve(Space& space, std::size_t n) {
    n_ = n;
    places_.reserve(space.resource(), 2 * n);
    ids_.reserve(space.resource(), 2 * n);
#if defined(__CUDACC__)
    if constexpr (!Space::host_accessible) scratch_.reserve(space.resource(), bytes_to_sort_on_device(n));
#endif
  }

  /// The keys and ids to be sorted.
  std::uint64_t* places() { return places_.data(); }
  id* ids() { return ids_.data(); }
  /// The keys and ids in order; of equal keys the lowest id comes first.
  std::uint64_t const* places_in_order() const { return places_.data() + n_; }
  id const* ids_in_order() const { return ids_.data() + n_; }

  /// Sorts by the lowest `bits` bits, which are all that are set.
  template <class Space>
  void sort([[maybe_unused]] Space& space, [[maybe_unused]] int bits) {
    std::uint64_t *const from = places_.data(), *const to = from + n_;
    id *const ids = ids_.data(), *const ids_to = ids + n_;
    if constexpr (Space::host_accessible) {
      std::copy(ids, ids + n_, ids_to);
      std::stable_sort(ids_to, ids_to + n_, [&](id a, id b) { return from[a] < from[b]; });
      std::transform(ids_to, ids_to + n_, to, [&](id t) { return from[t]; });
    } else {
#if defined(__CUDACC__)
      sort_ids_on_device(space.stream(), from, to, ids, ids_to, n_, bits, scratch_.data());
#else
      throw error("collide: bvh: triangles in memory of a device are sorted where nvcc compiles the program");
#endif
    }
  }

 private:
  std::size_t n_ = 0;
  buffer<std::uint64_t> places_;
  buffer<id> ids_;
  buffer<unsigned char> scratch_;
};

template <class S>
class curve_order {
 public:
  /// Puts triangles in order, of equal places the lowest number first, and makes `summary`. O(triangles).
  template <class Space>
  void sort(Space& space, mesh_view<S> const& mesh) {
    std::size_t const n = mesh.size();
    auto* const summary = summary_.reserve(space.resource(), 1);
    mesh_statistics<S>::clear(space, summary);
    compute_mesh_statistics<S> const seen{mesh, summary, nullptr};
    space.launch(grid_size<Space>(n, seen), seen);
    sort_.reserve(space, n);
    space.for_each(n, find_places<S>{mesh, summary, sort_.places(), sort_.ids()});
    sort_.sort(space, 3 * find_places<S>::bits + 1);
  }

  id const* ids() const { return sort_.ids_in_order(); }
  /// The places of the triangles on the curve, which rise.
  std::uint64_t const* places() const { return sort_.places_in_order(); }
  mesh_statistics<S> const* summary() const { return summary_.data(); }

 private:
  buffer<mesh_statistics<S>> summary_;
  curve_sort sort_;
};

/// Kernel functor of `for_each` over points: where each is on a curve through a cube three times as wide as the mesh.
template <class S>
struct find_places_of_points {
  static constexpr int bits = 10;  ///< of a coordinate

  sphere_view<S> points;
  mesh_statistics<S> const* mesh;
  std::uint64_t* places;
  id* ids;

  COLLIDE_HD void operator()(std::size_t i) const {
    vec3<S> const p = points[i].centre;
    S const half = half_extent(*mesh);
    vec3<S> fractions;
    for (int k = 0; k < 3; ++k) fractions[k] = div_rn(p[k] / 2 - mesh->lower_of(k) / 2 + half, 3 * half);
    places[i] = place_of_fractions<bits>(fractions);
    ids[i] = static_cast<id>(i);
  }
};

/// Sorts points along the curve.
template <class S>
class point_order {
 public:
  template <class Space>
  void reserve(Space& space, std::size_t n) {
    sort_.reserve(space, n);
  }

  /// Their numbers in order. O(points).
  template <class Space>
  id const* sort(Space& space, sphere_view<S> const& points, mesh_statistics<S> const* mesh) {
    sort_.reserve(space, points.size());
    space.for_each(points.size(), find_places_of_points<S>{points, mesh, sort_.places(), sort_.ids()});
    sort_.sort(space, 3 * find_places_of_points<S>::bits);
    return sort_.ids_in_order();
  }

 private:
  curve_sort sort_;
};

/// Sorts points along Morton's curve through the box of a mesh, on the host: points outside count as on its surface,
/// which is where they are nearest to it.
template <class S>
class points_on_curve {
 public:
  template <class Space>
  void reserve(Space& space, std::size_t n) {
    order_.reserve(space.resource(), n);
    spare_.reserve(space.resource(), n);
  }

  /// Their numbers in order, those outside of `searched` last; null if a smaller part of the points than `fewest` is in
  /// there, or those that follow each other mostly are near each other. O(points). `around` is the box of the mesh;
  /// both are as seen from `origin`.
  template <class Space>
  id const* sort(Space& space, sphere_view<S> const& points, aabb<float> const& around, aabb<float> const& searched,
                 double fewest, vec3<S> const& origin) {
    float widest = 0;
    for (int k = 0; k < 3; ++k) widest = max(widest, around.upper[k] / 2 - around.lower[k] / 2);
    float const scale = 512 / widest;
    auto const point = [&](std::size_t i) { return tree_point(points[i].centre, origin); };
    auto const place_of = [&](tree_point const& p) {
      std::uint32_t x[3];
      for (int k = 0; k < 3; ++k) {
        float const at = (p.lower[k] - around.lower[k]) * scale;
        x[k] = static_cast<std::uint32_t>(at > 0 ? min(at, 1023.0f) : 0.0f);  // also of what is NaN
      }
      return morton_place(x[0], x[1], x[2]);
    };
    std::size_t const n = points.size(), step = n / 256 + 1;
    std::size_t apart = 0, pairs = 0, samples = 0;
    for (std::size_t i = 1; i < n; i += step, ++samples) {
      bool const counts = overlap(searched, point(i));
      pairs += counts;
      apart += counts && place_of(point(i - 1)) >> 15 != place_of(point(i)) >> 15;
    }
    if (4 * apart <= pairs || static_cast<double>(pairs) < fewest * static_cast<double>(samples)) return nullptr;
    reserve(space, n);
    triangle_on_curve *const order = order_.data(), *const spare = spare_.data();
    parts_of const parts(space, n);
    std::size_t ends[parts_of::max_count], there = 0;
    for_each_block(space, parts.count, [&](std::size_t p) {
      std::size_t to = parts.begin(p);
      parts.each_of(p, [&](std::size_t i) {
        tree_point const at = point(i);
        if (overlap(searched, at)) order[to++] = {place_of(at), static_cast<id>(i)};
      });
      ends[p] = to;
    });
    for (std::size_t p = 0; p < parts.count; ++p) {
      std::size_t const begin = parts.begin(p), size = ends[p] - begin;
      if (begin != there) std::copy(order + begin, order + ends[p], order + there);
      ends[p] = there += size;
    }
    sort_by_digit(space, order, spare, there, 10);  // a hundred cells on an axis are enough
    sort_by_digit(space, spare, order, there, 20);
    id* const numbers = reinterpret_cast<id*>(spare);
    space.for_each(there, [&](std::size_t i) { numbers[i] = order[i].number; });
    if (there == n) return numbers;
    for_each_block(space, parts.count, [&](std::size_t p) {
      std::size_t to = there + parts.begin(p) - (p == 0 ? 0 : ends[p - 1]);
      parts.each_of(p, [&](std::size_t i) {
        if (!overlap(searched, point(i))) numbers[to++] = static_cast<id>(i);
      });
    });
    return numbers;
  }

 private:
  buffer<triangle_on_curve> order_, spare_;
};

}  // namespace collide::detail
