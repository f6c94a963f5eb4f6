/// \file
/// One pass over a mesh or a sphere set: what the broad phases must know of it.
#pragma once

#include <collide/detail/bounding_sphere.hpp>
#include <collide/detail/histogram.hpp>
#include <collide/mesh.hpp>
#include <collide/spheres.hpp>

namespace collide::detail {

/// An axis-aligned box, empty if lower > upper.
template <class S>
struct box {
  S lower[3], upper[3];

  static COLLIDE_HD box empty() {
    constexpr S far = std::numeric_limits<S>::infinity();
    return {{far, far, far}, {-far, -far, -far}};
  }

  COLLIDE_HD void extend(vec3<S> const& p) {
    for (int k = 0; k < 3; ++k) {
      lower[k] = smaller(lower[k], p[k]);
      upper[k] = larger(upper[k], p[k]);
    }
  }

  /// True of the box of nothing, and of that of a triangle that is not finite.
  COLLIDE_HD_INLINE bool is_empty() const { return !(lower[0] <= upper[0]); }

  /// The largest side; +infinity if it overflows.
  COLLIDE_HD_INLINE S extent() const {
    return larger(larger(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
  }

  struct unite {
    COLLIDE_HD box operator()(box const& a, box const& b) const {
      box c;
      for (int k = 0; k < 3; ++k) {
        c.lower[k] = smaller(a.lower[k], b.lower[k]);
        c.upper[k] = larger(a.upper[k], b.upper[k]);
      }
      return c;
    }
  };
};

/// The box of a triangle; empty if the triangle is not finite.
template <class S>
COLLIDE_HD_INLINE box<S> box_of(triangle<S> const& t) {
  constexpr S far = std::numeric_limits<S>::max();
  if (!finite(t)) return {{far, far, far}, {-far, -far, -far}};
  vec3<S> const lower = smaller(smaller(t.a, t.b), t.c), upper = larger(larger(t.a, t.b), t.c);
  return {{lower.x(), lower.y(), lower.z()}, {upper.x(), upper.y(), upper.z()}};
}

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

  COLLIDE_HD S lower_of(int k) const { return from_ordered<S>(static_cast<bits_of<S>>(~lower[k])); }
  COLLIDE_HD S upper_of(int k) const { return from_ordered<S>(upper[k]); }
};

/// Kernel body: fills the summary, and the bounding spheres if there is room for them.
template <class S>
struct summarise_mesh {
  static constexpr int items = 2;

  mesh_view<S> mesh;
  mesh_summary<S>* summary;
  bounding_sphere<S>* bounds;  ///< null if they are not wanted
  box<S>* boxes;               ///< the same

  template <class Block>
  struct scratch {
    block_histogram<Block> histogram;
    typename Block::template reduce_scratch<box<S>> reduction;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    typename Block::template per_lane<box<S>> all;
    s.histogram.clear(block);
    std::size_t const first = block.index() * Block::lanes * Block::items;
    block.each([&](int lane) {
      all[lane] = box<S>::empty();
      for (int k = 0; k < Block::items; ++k) {
        std::size_t const i = first + static_cast<std::size_t>(k) * Block::lanes + static_cast<std::size_t>(lane);
        if (i >= mesh.size()) break;
        triangle<S> const t = mesh[i];
        if (bounds != nullptr) bounds[i] = bounds_of(t);
        box<S> const around = box_of(t);
        if (boxes != nullptr) boxes[i] = around;
        if (around.is_empty()) continue;
        all[lane] = typename box<S>::unite{}(all[lane], around);
        s.histogram.add(block, &summary->extents, size_bin(around.extent()));
      }
    });
    s.histogram.flush(block, &summary->extents);
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
