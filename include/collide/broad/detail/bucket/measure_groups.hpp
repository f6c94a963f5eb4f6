/// \file
/// Kernels of one pass over a mesh or over radii, on the CPU: eight at a time, with histograms that stay in cache.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include <collide/broad/detail/bucket/triangle_order.hpp>
#include <collide/broad/detail/grid/mesh_statistics.hpp>
#include <collide/core/memory.hpp>
#include <collide/mesh.hpp>
#include <collide/spaces/detail/block.hpp>
#include <collide/spaces/detail/multiversion.hpp>
#include <collide/spaces/detail/tuning.hpp>
#include <collide/spheres.hpp>

namespace collide::detail {

/// The histogram of the sizes that a block of one thread sees.
struct histogram_of_block {
  std::uint32_t counts[size_bins], sums[size_bins];
  std::uint32_t first, end;  ///< of the bins in use

  void clear() {
    std::memset(counts, 0, sizeof counts);
    std::memset(sums, 0, sizeof sums);
    first = size_bins, end = 0;
  }

  /// Adds `n` sizes of a bin. The sums must fit into 32 bits.
  void add(std::uint32_t bin, std::uint32_t n, std::uint32_t sum) {
    counts[bin] += n;
    sums[bin] += sum;
    first = min(first, bin);
    end = max(end, bin + 1);
  }

  void flush(size_histogram* to) const {
    for (std::uint32_t b = first; b < end; ++b) {
      if (counts[b] != 0) to->add(b, counts[b], sums[b]);
    }
  }
};

/// Kernel functor of a block of one thread: what `compute_mesh_statistics` finds, and the boxes around groups of
/// triangles.
template <class S>
struct measure_groups {
  static constexpr int items = 4;
  static constexpr std::size_t share = 128;  ///< groups of a block

  grouped_mesh<S> mesh;
  mesh_statistics<S>* summary;
  triangle_aabb<S>* groups;

  template <class>
  struct scratch {
    triangle_group<S> group;
    histogram_of_block extents;
    aabb<S> all;
  };

  std::size_t blocks() const { return (mesh.size() + share - 1) / share; }

  template <class Block>
  void operator()(Block& block, scratch<Block>& s) const {
    static_assert(Block::num_threads == 1, "collide: groups are measured by blocks of one thread");
    s.extents.clear();
    multiversioned([&] { measure(s, block.index() * share); });
    s.extents.flush(&summary->extents);
    for (int k = 0; k < 3; ++k) {
      fetch_max(&summary->lower[k], static_cast<uint_for<S>>(~to_ordered_bits(s.all.lower[k])));
      fetch_max(&summary->upper[k], to_ordered_bits(s.all.upper[k]));
    }
  }

 private:
  template <class Scratch>
  void measure(Scratch& s, std::size_t begin) const {
    constexpr std::uint32_t n = triangle_group<S>::size;
    std::size_t const end = min(begin + share, mesh.size());
    aabb<S> all = aabb<S>::empty();
    for (std::size_t i = begin; i < end; ++i) {
      mesh.load(s.group, i);
      groups[i] = s.group.all;
      all = typename aabb<S>::merge{}(all, s.group.all);
      std::uint32_t bins[n], areas[n];
      measure(s.group, bins, areas);
      std::uint32_t differ = 0, sum = 0;
      for (std::uint32_t k = 0; k < n; ++k) differ |= bins[k] ^ bins[0], sum += s.group.has(k) ? areas[k] : 0;
      if (differ == 0) {  // mostly: a counter that is asked again at once makes it wait
        s.extents.add(bins[0], static_cast<std::uint32_t>(__builtin_popcount(s.group.there)), sum);
        continue;
      }
      for (std::uint32_t k = 0; k < n; ++k) {
        if (s.group.has(k)) s.extents.add(bins[k], 1, areas[k]);
      }
    }
    s.all = all;
  }

  /// The bins of the triangles' extents, and their areas. Without branches, for the processor's vector unit.
  template <std::size_t n>
  static void measure(triangle_group<S> const& group, std::uint32_t (&bins)[n], std::uint32_t (&areas)[n]) {
    float extents[n];
    for (std::size_t i = 0; i < n; ++i) {
      S extent = 0;
      for (int k = 0; k < 3; ++k) extent = max(extent, group.upper[k][i] - group.lower[k][i]);
      extents[i] = static_cast<float>(min(extent, S(std::numeric_limits<float>::max())));
    }
    for (std::size_t i = 0; i < n; ++i) {
      bins[i] = to_bits(extents[i]) >> 21;
      float const scale = 1 / bin_end(bins[i]);
      float u[3], v[3];
      for (int k = 0; k < 3; ++k) {
        u[k] = static_cast<float>(group.corners[1][k][i] - group.corners[0][k][i]) * scale;
        v[k] = static_cast<float>(group.corners[2][k][i] - group.corners[0][k][i]) * scale;
      }
      float const x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
      float const area = 0.5f * std::sqrt(x * x + (y * y + z * z));
      areas[i] = static_cast<std::uint32_t>(static_cast<std::int32_t>(select(area <= 1, area, 0.f) * 0x1p8f + 0.5f));
    }
  }
};

/// Kernel functor of `for_each` over groups: the boxes of the triangles.
template <class S>
struct compute_boxes {
  mesh_view<S> mesh;
  triangle_aabb<S>* boxes;

  template <class Space>
  static void run(Space& space, mesh_view<S> const& mesh, buffer<triangle_aabb<S>>& to) {
    space.for_each(triangle_group<S>::count(mesh.size()),
                   compute_boxes{mesh, to.reserve(space.resource(), mesh.size())});
  }

  void operator()(std::size_t i) const {
    constexpr std::size_t n = triangle_group<S>::size;
    triangle_group<S> group;
    multiversioned([&] { group.load(mesh, i * n); });
    for (std::size_t k = 0; k < n && i * n + k < mesh.size(); ++k) {
      boxes[i * n + k] = group.box(static_cast<std::uint32_t>(k));
    }
  }
};

/// Kernel functor of a block of one thread: the histogram of the finite, valid radii.
template <class S>
struct measure_radii {
  static constexpr int items = 4;
  static constexpr std::size_t share = 4096;  ///< spheres of a block

  sphere_view<S> spheres;
  size_histogram* histogram;

  std::size_t blocks() const { return (spheres.size() + share - 1) / share; }

  template <class>
  struct scratch {
    histogram_of_block radii;
  };

  template <class Block>
  void operator()(Block& block, scratch<Block>& s) const {
    static_assert(Block::num_threads == 1, "collide: radii are measured by blocks of one thread");
    s.radii.clear();
    std::size_t const begin = block.index() * share, end = min(begin + share, spheres.size());
    for (std::size_t i = begin; i < end; ++i) {
      S const r = spheres.radius(i);
      if (is_valid_radius(r) && is_finite(r)) s.radii.add(size_bin(r > 0 ? r : S(0)), 1, 0);
    }
    s.radii.flush(histogram);
  }
};

/// Puts the histogram of the finite, valid radii into memory of the space.
template <class S, class Space>
void measure_radii_of(Space& space, sphere_view<S> const& spheres, size_histogram* to) {
  size_histogram::clear(space, to);
  if constexpr (bucket_tuning<Space>::bins_spheres) {
    measure_radii<S> const kernel{spheres, to};
    space.launch(kernel.blocks(), kernel);
  } else {
    radius_histogram_kernel<S> const kernel{spheres, to};
    space.launch(grid_size<Space>(spheres.size(), kernel), kernel);
  }
}

}  // namespace collide::detail
