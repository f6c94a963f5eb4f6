/// \file
/// One pass over a mesh or a sphere set: what the broad phases must know of it.
#pragma once

#include <cstddef>
#include <limits>

#include <collide/broad/detail/grid/grid.hpp>
#include <collide/broad/detail/grid/size_histogram.hpp>
#include <collide/core/memory.hpp>
#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/mesh.hpp>
#include <collide/spaces/detail/block.hpp>
#include <collide/spheres.hpp>

namespace collide::detail {

/// Statistics of a mesh, over its finite triangles. Memory of zeros is a summary of none: `lower` and `upper` are
/// both updated by a maximum.
template <class S>
struct mesh_statistics {
  uint_for<S> lower[3];    ///< ~ordered(coordinate)
  uint_for<S> upper[3];    ///< ordered(coordinate)
  size_histogram extents;  ///< of the triangles' boxes; its sums are of areas, 256 the square of the bin's end

  /// Makes a summary in memory of the space that of no triangles.
  template <class Space>
  static void clear(Space& space, mesh_statistics* s) {
    space.fill(s, 0, sizeof *s);
  }

  /// The largest coordinate, without its sign; 0 of no triangles.
  COLLIDE_HD S largest_coordinate() const {
    S largest = 0;
    if (extents.empty()) return largest;
    for (int k = 0; k < 3; ++k) largest = max(largest, max(-lower_of(k), upper_of(k)));
    return largest;
  }

  COLLIDE_HD S lower_of(int k) const { return from_ordered_bits<S>(static_cast<uint_for<S>>(~lower[k])); }
  COLLIDE_HD S upper_of(int k) const { return from_ordered_bits<S>(upper[k]); }
};

/// The area of a triangle whose extent is in a bin, as the histogram's sums have it: from 0 to 256; from two edges that
/// leave a corner, in units of the bin's end.
COLLIDE_HD_INLINE std::uint32_t relative_area(float const (&u)[3], float const (&v)[3]) {
  float const x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
  float const area = 0.5f * sqrt_rn(x * x + (y * y + z * z));
  return area <= 1 ? static_cast<std::uint32_t>(static_cast<std::int32_t>(area * 0x1p8f + 0.5f)) : 0;
}
template <class S>
COLLIDE_HD_INLINE std::uint32_t relative_area(triangle<S> const& t, std::uint32_t bin) {
  float const scale = 1 / bin_end(bin);
  float u[3], v[3];
  for (int k = 0; k < 3; ++k) {
    u[k] = static_cast<float>(t.b[k] - t.a[k]) * scale;
    v[k] = static_cast<float>(t.c[k] - t.a[k]) * scale;
  }
  return relative_area(u, v);
}

/// Kernel functor: fills the summary, and the boxes of triangles if there is room for them.
template <class S>
struct compute_mesh_statistics {
  static constexpr int items = 2;

  mesh_view<S> mesh;
  mesh_statistics<S>* summary;
  triangle_aabb<S>* boxes;  ///< null if they are not wanted

  template <class Block>
  struct scratch {
    block_histogram<Block> extents;
    typename Block::template reduce_storage<aabb<S>> reduction;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    static_assert(Block::items % 2 == 0, "collide: a thread reads two triangles at a time");
    typename Block::template thread_private<aabb<S>> all;
    s.extents.clear(block);
    block.for_each_thread([&](int thread_rank) {
      constexpr auto n = static_cast<std::size_t>(Block::items);
      std::size_t const first = (block.index() * Block::num_threads + static_cast<std::size_t>(thread_rank)) * n;
      all[thread_rank] = aabb<S>::empty();
      auto const add = [&](std::size_t i, triangle<S> const& t) {
        triangle_aabb<S> const b = triangle_aabb_of(t);
        if (boxes != nullptr) boxes[i] = b;
        if (b.is_empty()) return;
        all[thread_rank] = typename aabb<S>::merge{}(all[thread_rank], b);
        std::uint32_t const bin = size_bin(b.max_extent());
        s.extents.add(block, &summary->extents, bin, relative_area(t, bin));
      };
      for (std::size_t i = first; i < first + n && i < mesh.size(); i += 2) {
        bool const two = i + 1 < mesh.size();
        triangle<S> const a = mesh[i], b = mesh[two ? i + 1 : i];  // both before anything is written
        add(i, a);
        if (two) add(i + 1, b);
      }
    });
    s.extents.flush(block, &summary->extents);
    aabb<S> const extent = block.reduce(s.reduction, all, typename aabb<S>::merge{});
    block.for_each_thread([&](int thread_rank) {
      if (thread_rank != 0) return;
      for (int k = 0; k < 3; ++k) {
        fetch_max(&summary->lower[k], static_cast<uint_for<S>>(~to_ordered_bits(extent.lower[k])));
        fetch_max(&summary->upper[k], to_ordered_bits(extent.upper[k]));
      }
    });
  }
};

/// The largest coordinate of a mesh, without its sign. Waits.
template <class Space, class S>
S largest_coordinate(Space& space, mesh_view<S> const& mesh, buffer<mesh_statistics<S>>& memory) {
  auto* const seen = memory.reserve(space.resource(), 1);
  mesh_statistics<S>::clear(space, seen);
  compute_mesh_statistics<S> const kernel{mesh, seen, nullptr};
  space.launch(grid_size<Space>(mesh.size(), kernel), kernel);
  return space.read(seen).largest_coordinate();
}

/// Kernel functor: the histogram of the finite, valid radii.
template <class S>
struct radius_histogram_kernel {
  static constexpr int items = 4;

  sphere_view<S> spheres;
  size_histogram* histogram;

  template <class Block>
  struct scratch {
    block_histogram<Block> histogram;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    s.histogram.clear(block);
    std::size_t const first = block.index() * Block::num_threads * Block::items;
    block.for_each_thread([&](int thread_rank) {
      for (int k = 0; k < Block::items; ++k) {
        std::size_t const i =
            first + static_cast<std::size_t>(k) * Block::num_threads + static_cast<std::size_t>(thread_rank);
        if (i >= spheres.size()) break;
        S const r = spheres.radius(i);
        if (is_valid_radius(r) && is_finite(r)) s.histogram.add(block, histogram, size_bin(r > 0 ? r : S(0)), 0);
      }
    });
    s.histogram.flush(block, histogram);
  }
};

template <class S>
struct grid_reaches {
  S reaches[max_grids];  ///< falling; -1 behind the last
  int count;
  bool are_new;  ///< the grids must be made: they are not those of the query before
};

/// Kernel functor of one block: chooses how far the grids of spheres of many radii reach. The reaches are a factor of 4
/// or more apart, down to one that is at most `enough`; the first is for all spheres, or for those up to the radius
/// that is given, each of the others for more than `fewest` spheres of the histogram. Of no spheres there is one of 0.
template <class S>
struct choose_reaches {
  static constexpr int items = 1;
  static constexpr bool is_cooperative = true;

  size_histogram const* radii;
  grid_reaches<S>* chosen;  ///< in: those that are there, unless all are made anew
  S given;                  ///< negative: none
  S enough;
  std::uint64_t fewest;
  int max_count;  ///< reaches
  bool makes_anew;

  template <class>
  struct scratch {
    std::uint32_t counts[size_bins];
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    int const first = radii->empty() ? 0 : radii->first(), last = radii->empty() ? -1 : radii->last();
    block.for_each_thread([&](int thread_rank) {
      for (int b = first + thread_rank; b <= last; b += Block::num_threads) s.counts[b] = radii->counts[b];
    });
    block.for_each_thread([&](int thread_rank) {
      if (thread_rank == 0) choose(s.counts, first, last);
    });
  }

 private:
  COLLIDE_HD void choose(std::uint32_t const* counts, int first, int last) const {
    constexpr int bins_per_factor_4 = 8;
    std::uint64_t left = 0;  // spheres of this bin and of smaller ones
    COLLIDE_NO_UNROLL
    for (int b = first; b <= last; ++b) left += counts[b];
    grid_reaches<S> wanted{{}, 0, makes_anew};
    int n = 0, next = last;
    if (given >= 0) {
      wanted.reaches[n++] = given;
      next = static_cast<int>(size_bin(given)) - bins_per_factor_4;
    } else if (last < first) {
      wanted.reaches[n++] = 0;
    }
    COLLIDE_NO_UNROLL
    for (int b = last; b >= first && n < max_count; left -= counts[b--]) {
      if (b > next || counts[b] == 0 || (n != 0 && left <= fewest)) continue;
      if (n != 0 && wanted.reaches[n - 1] <= enough) break;
      float const end = bin_end(static_cast<std::uint32_t>(b));
      wanted.reaches[n++] = static_cast<S>(min(end, std::numeric_limits<float>::max()));
      next = b - bins_per_factor_4;
    }
    wanted.count = n;
    for (int g = 0; g < max_grids; ++g) {
      if (g >= n) wanted.reaches[g] = -1;
      wanted.are_new = wanted.are_new || wanted.reaches[g] != chosen->reaches[g];
    }
    *chosen = wanted;
  }
};

}  // namespace collide::detail
