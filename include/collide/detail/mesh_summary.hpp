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

/// The largest side of a triangle's box; +infinity if it overflows.
template <class S>
COLLIDE_HD_INLINE S extent_of(triangle<S> const& t) {
  vec3<S> const lower = smaller(smaller(t.a, t.b), t.c), upper = larger(larger(t.a, t.b), t.c);
  return largest<S>(upper - lower);
}

/// What a mesh looks like, over its finite triangles. `lower` and `upper` are kept such that memory of all ones is the
/// empty box, and both are updated by a minimum.
template <class S>
struct mesh_summary {
  bits_of<S> lower[3];     ///< ordered(coordinate)
  bits_of<S> upper[3];     ///< ~ordered(coordinate)
  size_histogram extents;  ///< of the triangles' boxes

  /// Makes a summary in memory of the space that of no triangles.
  template <class Space>
  static void clear(Space& space, mesh_summary* s) {
    space.fill(s->lower, 0xff, sizeof s->lower + sizeof s->upper);
    size_histogram::clear(space, &s->extents);
  }

  COLLIDE_HD S lower_of(int k) const { return from_ordered<S>(lower[k]); }
  COLLIDE_HD S upper_of(int k) const { return from_ordered<S>(static_cast<bits_of<S>>(~upper[k])); }
};

/// Kernel body: fills the summary, and the bounding spheres if there is room for them.
template <class S>
struct summarise_mesh {
  static constexpr int items = 4;

  mesh_view<S> mesh;
  mesh_summary<S>* summary;
  bounding_sphere<S>* bounds;  ///< null if they are not wanted

  template <class Block>
  struct scratch {
    block_histogram<Block> histogram;
    typename Block::template reduce_scratch<box<S>> reduction;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    typename Block::template per_lane<box<S>> boxes;
    s.histogram.clear(block);
    std::size_t const first = block.index() * Block::lanes * Block::items;
    block.each([&](int lane) {
      boxes[lane] = box<S>::empty();
      for (int k = 0; k < Block::items; ++k) {
        std::size_t const i = first + static_cast<std::size_t>(k) * Block::lanes + static_cast<std::size_t>(lane);
        if (i >= mesh.size()) break;
        triangle<S> const t = mesh[i];
        if (bounds != nullptr) bounds[i] = bounds_of(t);
        if (!finite(t)) continue;
        boxes[lane].extend(t.a);
        boxes[lane].extend(t.b);
        boxes[lane].extend(t.c);
        s.histogram.add(block, &summary->extents, size_bin(extent_of(t)));
      }
    });
    s.histogram.flush(block, &summary->extents);
    box<S> const all = block.reduce(s.reduction, boxes, typename box<S>::unite{});
    block.each([&](int lane) {
      if (lane != 0) return;
      for (int k = 0; k < 3; ++k) {
        fetch_min(&summary->lower[k], ordered(all.lower[k]));
        fetch_min(&summary->upper[k], static_cast<bits_of<S>>(~ordered(all.upper[k])));
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
