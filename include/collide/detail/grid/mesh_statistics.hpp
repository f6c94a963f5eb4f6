/// \file
/// One pass over a mesh or a sphere set: what the broad phases must know of it.
#pragma once

#include <collide/detail/grid/size_histogram.hpp>
#include <collide/detail/numeric/rounding.hpp>
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

/// The box of a triangle, and the cheap test before the narrow phase: whether a ball comes near it.
template <class S>
struct alignas(4 * sizeof(S)) triangle_box : box<S> {
  S slack;  ///< room for the rounding of the coarsest narrow phase, as far as it goes with the triangle

  /// The box that every ball comes near.
  static COLLIDE_HD_INLINE triangle_box everywhere() {
    constexpr S far = std::numeric_limits<S>::infinity();
    return {{{-far, -far, -far}, {far, far, far}}, S(0)};
  }

  /// How far from the box the centre of a ball that touches the triangle is at most, `slack` apart; the root of the
  /// smallest normal number covers squares that underflow. See docs/numerics.md.
  static COLLIDE_HD_INLINE S reach(S radius) {
    return radius * (1 + 16 * S(format<float>::unit)) + 2 * root(std::numeric_limits<S>::min());
  }

  COLLIDE_HD_INLINE bool reached(vec3<S> const& c, S radius) const {
    S const x = gap(0, c.x()), y = gap(1, c.y()), z = gap(2, c.z()), most = reach(radius) + slack;
    return x * x + (y * y + z * z) <= most * most;
  }

  /// How far a coordinate is outside the box along an axis.
  COLLIDE_HD_INLINE S gap(int axis, S x) const {
    S const outside = larger(this->lower[axis] - x, x - this->upper[axis]);
    return select(outside > 0, outside, S(0));
  }
};

template <class S>
COLLIDE_HD_INLINE triangle_box<S> triangle_box_of(triangle<S> const& t) {
  box<S> const b = box_of(t);
  return {b, 16 * S(format<float>::unit) * b.extent()};
}

/// What a mesh looks like, over its finite triangles. Memory of zeros is a summary of none: `lower` and `upper` are
/// both updated by a maximum.
template <class S>
struct alignas(16) mesh_summary {
  bits_of<S> lower[3];        ///< ~ordered(coordinate)
  bits_of<S> upper[3];        ///< ordered(coordinate)
  size_histogram extents[2];  ///< of the triangles' boxes; of those around 0 and 1, 2 and 3, ..., if asked for

  /// Makes a summary in memory of the space that of no triangles.
  template <class Space>
  static void clear(Space& space, mesh_summary* s) {
    space.fill(s, 0, sizeof *s);
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
  triangle_box<S>* boxes;  ///< and room for one more; null if they are not wanted
  bool pairs = false;      ///< whether they are asked for

  template <class Block>
  struct scratch {
    block_histogram<Block> extents, pairs;
    typename Block::template reduce_scratch<box<S>> reduction;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    static_assert(Block::items % 2 == 0, "collide: a lane looks at both triangles of a pair");
    typename Block::template per_lane<box<S>> all;
    s.extents.clear(block);
    s.pairs.clear(block);
    block.each([&](int lane) {
      constexpr auto n = static_cast<std::size_t>(Block::items);
      std::size_t const first = (block.index() * Block::lanes + static_cast<std::size_t>(lane)) * n;
      all[lane] = box<S>::empty();
      for (std::size_t i = first; i < first + n && i < mesh.size(); i += 2) {
        bool const two = i + 1 < mesh.size();
        triangle<S> const a = mesh[i], b = mesh[two ? i + 1 : i];  // both before anything is written
        triangle_box<S> const of_a = triangle_box_of(a), of_b = triangle_box_of(b);
        if (boxes != nullptr) boxes[i] = of_a;
        if (boxes != nullptr) boxes[i + 1] = of_b;  // there is room for one more
        box<S> const around = typename box<S>::unite{}(of_a, of_b);
        if (around.is_empty()) continue;
        all[lane] = typename box<S>::unite{}(all[lane], around);
        if (!of_a.is_empty()) s.extents.add(block, &summary->extents[0], size_bin(of_a.extent()));
        if (!of_b.is_empty() && two) s.extents.add(block, &summary->extents[0], size_bin(of_b.extent()));
        if (pairs) s.pairs.add(block, &summary->extents[1], size_bin(around.extent()));
      }
    });
    s.extents.flush(block, &summary->extents[0]);
    s.pairs.flush(block, &summary->extents[1]);
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
