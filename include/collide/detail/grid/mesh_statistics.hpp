/// \file
/// One pass over a mesh or a sphere set: what the broad phases must know of it.
#pragma once

#include <cstddef>

#include <collide/detail/geometry/aabb.hpp>
#include <collide/detail/grid/size_histogram.hpp>
#include <collide/mesh.hpp>
#include <collide/spheres.hpp>

namespace collide::detail {

/// What a mesh looks like, over its finite triangles. Memory of zeros is a summary of none: `lower` and `upper` are
/// both updated by a maximum.
template <class S>
struct mesh_summary {
  bits_of<S> lower[3];     ///< ~ordered(coordinate)
  bits_of<S> upper[3];     ///< ordered(coordinate)
  size_histogram extents;  ///< of the triangles' boxes

  /// Makes a summary in memory of the space that of no triangles.
  template <class Space>
  static void clear(Space& space, mesh_summary* s) {
    space.fill(s, 0, sizeof *s);
  }

  /// The largest coordinate, without its sign; 0 of no triangles.
  COLLIDE_HD S largest_coordinate() const {
    S most = 0;
    if (extents.empty()) return most;
    for (int k = 0; k < 3; ++k) most = larger(most, larger(-lower_of(k), upper_of(k)));
    return most;
  }

  COLLIDE_HD S lower_of(int k) const { return from_ordered<S>(static_cast<bits_of<S>>(~lower[k])); }
  COLLIDE_HD S upper_of(int k) const { return from_ordered<S>(upper[k]); }
};

/// Kernel body: fills the summary, and the boxes of triangles if there is room for them.
template <class S>
struct summarise_mesh {
  static constexpr int items = 2;

  mesh_view<S> mesh;
  mesh_summary<S>* summary;
  triangle_box<S>* boxes;  ///< null if they are not wanted

  template <class Block>
  struct scratch {
    block_histogram<Block> extents;
    typename Block::template reduce_scratch<box<S>> reduction;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    static_assert(Block::items % 2 == 0, "collide: a lane reads two triangles at a time");
    typename Block::template per_lane<box<S>> all;
    s.extents.clear(block);
    block.each([&](int lane) {
      constexpr auto n = static_cast<std::size_t>(Block::items);
      std::size_t const first = (block.index() * Block::lanes + static_cast<std::size_t>(lane)) * n;
      all[lane] = box<S>::empty();
      auto const add = [&](std::size_t i, triangle_box<S> const& b) {
        if (boxes != nullptr) boxes[i] = b;
        if (b.is_empty()) return;
        all[lane] = typename box<S>::unite{}(all[lane], b);
        s.extents.add(block, &summary->extents, size_bin(b.extent()));
      };
      for (std::size_t i = first; i < first + n && i < mesh.size(); i += 2) {
        bool const two = i + 1 < mesh.size();
        triangle<S> const a = mesh[i], b = mesh[two ? i + 1 : i];  // both before anything is written
        add(i, triangle_box_of(a));
        if (two) add(i + 1, triangle_box_of(b));
      }
    });
    s.extents.flush(block, &summary->extents);
    box<S> const extent = block.reduce(s.reduction, all, typename box<S>::unite{});
    block.each([&](int lane) {
      if (lane != 0) return;
      for (int k = 0; k < 3; ++k) {
        fetch_max(&summary->lower[k], static_cast<bits_of<S>>(~ordered(extent.lower[k])));
        fetch_max(&summary->upper[k], ordered(extent.upper[k]));
      }
    });
  }
};

/// Kernel body: the histogram of the finite, valid radii.
template <class S>
struct summarise_radii {
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
    std::size_t const first = block.index() * Block::lanes * Block::items;
    block.each([&](int lane) {
      for (int k = 0; k < Block::items; ++k) {
        std::size_t const i = first + static_cast<std::size_t>(k) * Block::lanes + static_cast<std::size_t>(lane);
        if (i >= spheres.size()) break;
        S const r = spheres.radius(i);
        if (valid_radius(r) && finite(r)) s.histogram.add(block, histogram, size_bin(r > 0 ? r : S(0)));
      }
    });
    s.histogram.flush(block, histogram);
  }
};

}  // namespace collide::detail
