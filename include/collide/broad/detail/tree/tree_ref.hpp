/// \file
/// How a tree of boxes is gone through: the triangles that a sphere could touch, one after the other, and those near a
/// point, the nearest boxes first.
#pragma once

#include <cstdint>
#include <limits>

#include <collide/broad/detail/tree/tree_node.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace collide::detail {

/// The most levels of nodes that a tree has. On a device each is of three bits of a place on a curve and a number, but
/// for the lowest.
#if defined(__CUDA_ARCH__)
inline constexpr int max_tree_levels = 32;
#else
inline constexpr int max_tree_levels = 64;
#endif

COLLIDE_HD_INLINE int lowest_bit(std::uint32_t mask) {
#if defined(__CUDA_ARCH__)
  return __ffs(static_cast<int>(mask)) - 1;
#else
  return __builtin_ctz(mask);
#endif
}

/// How far the triangles that a sphere could touch have been gone through: a node, and which of its boxes, and of those
/// of the nodes above it, are still to be looked into. Of more nodes than there is room for that is found out again.
class tree_cursor {
 public:
  /// At a node, with nothing above it.
  COLLIDE_HD_INLINE static tree_cursor at(std::uint32_t node, std::uint32_t boxes) { return {node, boxes, 0}; }
  COLLIDE_HD_INLINE static tree_cursor ended() { return {none, 0, 0}; }

  COLLIDE_HD_INLINE bool at_end() const { return node_ == none; }
  COLLIDE_HD_INLINE std::uint32_t node() const { return node_; }
  COLLIDE_HD_INLINE bool has_box() const { return (low_ & 0xff) != 0; }

  /// The next box of the node.
  COLLIDE_HD_INLINE int take() {
    int const k = lowest_bit(low_ & 0xff);
    low_ &= low_ - 1;
    return k;
  }

  COLLIDE_HD_INLINE void descend(std::uint32_t node, std::uint32_t boxes) {
    std::uint32_t const kept = high_ >> 24;
    high_ = ((high_ << 8 | low_ >> 24) & 0xffffffu) | (kept < max_kept ? kept + 1 : max_kept) << 24;
    low_ = low_ << 8 | boxes;
    node_ = node;
  }

  /// Goes back to a node above; false if it is not known any more which of its boxes are left.
  COLLIDE_HD_INLINE bool ascend(std::uint32_t node) {
    std::uint32_t const kept = high_ >> 24;
    node_ = node;
    if (kept == 0) return false;
    low_ = low_ >> 8 | high_ << 24;
    high_ = (high_ >> 8 & 0xffffu) | (kept - 1) << 24;
    return true;
  }

  COLLIDE_HD_INLINE tree_cursor() = default;

 private:
  static constexpr std::uint32_t none = 0xffffffffu, max_kept = 6;

  COLLIDE_HD_INLINE tree_cursor(std::uint32_t node, std::uint32_t low, std::uint32_t high)
      : node_{node}, low_{low}, high_{high} {}

  std::uint32_t node_;
  std::uint32_t low_, high_;  ///< 8 bits for the boxes of each node, those of this one lowest; then how many are kept
};

/// A tree of boxes of the triangles of a mesh, as kernels have it. The members are those of a `per_sphere` policy.
template <class S>
struct tree_ref {
  mesh_view<S> mesh;
  tree_node const* nodes;      ///< the root first; null if there are none
  boxes_before const* before;  ///< of each node, where triangles are in pieces; else null

  using cursor = tree_cursor;

  /// A sphere as the boxes see it.
  struct reach {
    tree_point centre;
    float squared;
    tree_point around;  ///< its box

    COLLIDE_HD_INLINE reach(sphere<S> const& s, vec3<S> const& origin) : centre(s.centre, origin) {
      float radius;
      if constexpr (sizeof(S) == sizeof(float)) {
        radius = triangle_aabb<S>::padded_radius(s.radius);
      } else {
        radius = triangle_aabb<float>::padded_radius(float_above(s.radius));
      }
      squared = radius * radius;
      COLLIDE_UNROLL
      for (int k = 0; k < 3; ++k) {
        around.lower[k] = below(centre.lower[k] - radius);
        around.upper[k] = above(centre.upper[k] + radius);
      }
    }
  };

  COLLIDE_HD_INLINE bool is_place(sphere<S> const& s) const {
    return nodes != nullptr && is_valid_radius(s.radius) && is_finite(s.centre);
  }

  COLLIDE_HD_INLINE cursor begin(sphere<S> const& s) const {
    return is_place(s) ? begin(reach(s, tree_origin(mesh))) : cursor::ended();
  }
  COLLIDE_HD_INLINE bool next(sphere<S> const& s, cursor& c, id& triangle) const {
    return !c.at_end() && next(reach(s, tree_origin(mesh)), c, triangle);
  }

  template <class F>
  COLLIDE_HD_INLINE void for_each_candidate(sphere<S> const& s, F const& f) const {
    if (!is_place(s)) return;
    reach const r(s, tree_origin(mesh));
    cursor c = begin(r);
    for (id triangle; next(r, c, triangle);) f(triangle);
  }

  COLLIDE_HD_INLINE cursor begin(reach const& r) const { return cursor::at(0, reached(0, r)); }

  /// Moves on to the next triangle; false if there is none.
  COLLIDE_HD_INLINE bool next(reach const& r, cursor& c, id& triangle) const {
    for (;;) {
      while (c.has_box()) {
        int const k = c.take();
        std::uint32_t const child = nodes[c.node()].child[k];
        if ((child & tree_node::leaf) != 0) {
          if (!is_first(c.node(), k, r.around)) continue;
          triangle = child & ~tree_node::leaf;
          return true;
        }
        c.descend(child, reached(child, r));
      }
      if (c.node() == 0) {
        c = cursor::ended();
        return false;
      }
      tree_node const& here = nodes[c.node()];
      std::uint32_t const behind = 0xfeu << here.slot, above = here.parent;
      if (!c.ascend(above)) c = cursor::at(above, reached(above, r) & behind & 0xff);
    }
  }

  /// Calls bound = f(triangle) for triangles near a point, the nearest boxes first: at least for all whose squared
  /// distance is at most `bound`, which only falls; for some more than once. Nothing if it is negative, or the point is
  /// not finite.
  template <class F>
  COLLIDE_HD void for_each_nearer(vec3<S> const& point, S bound, F const& f) const {
    if (nodes == nullptr || !(bound >= 0) || !is_finite(point)) return;
    tree_point const p(point, tree_origin(mesh));
    struct level {
      std::uint32_t node, boxes;  ///< those still to be looked into
      std::uint32_t nearest;      ///< the least key of these
    };
    level above[max_tree_levels], here;
    std::uint32_t keys[tree_node::width], limit = tree_node::key_of(bound);
    auto const enter = [&](std::uint32_t node, std::uint32_t boxes) {
      here = {node, boxes & nodes[node].there, 0};
      multiversioned([&] { nodes[node].find_keys(p, here.boxes, keys); });
    };
    enter(0, 0xff);
    for (int levels = 0;;) {
      // threads of a warp come to their triangles at different times, and look at them at the same
      std::uint32_t child;
      for (;;) {
        std::uint32_t const key = tree_node::min_of(keys), k = key % tree_node::width;
        level next{0, 0xff, 0};
        if (key <= limit) {
          next.node = child = nodes[here.node].child[k];
          tree_node::remove(keys, key);
          here.boxes &= ~(1u << k);
          if ((child & tree_node::leaf) != 0) break;
          here.nearest = tree_node::min_of(keys);
          if (here.nearest <= limit) above[levels++] = here;
        } else {
          do {
            if (levels == 0) return;
            next = above[--levels];
          } while (next.nearest > limit);
        }
        enter(next.node, next.boxes);
      }
      limit = tree_node::key_of(f(child & ~tree_node::leaf));
    }
  }

  /// Calls f(triangle) for all triangles whose box the ray from a point along +z meets, as long as that returns true.
  template <class F>
  COLLIDE_HD void for_each_on_ray(vec3<S> const& point, F const& f) const {
    if (nodes == nullptr || !is_finite(point)) return;
    tree_point ray(point, tree_origin(mesh));
    ray.upper[2] = std::numeric_limits<float>::infinity();
    multiversioned([&] { for_each_overlapping(ray, f); });
  }

  /// Calls f(triangle) for all triangles whose box overlaps another, as long as that returns true. There is a tree.
  template <class F>
  COLLIDE_HD_INLINE void for_each_overlapping(tree_point const& box, F const& f) const {
    struct level {
      std::uint32_t node, boxes;  ///< those still to be looked into
    };
    level stack[max_tree_levels];
    stack[0] = {0, nodes[0].overlapping(box)};
    for (int top = 0; top >= 0;) {
      level& here = stack[top];
      if (here.boxes == 0) {
        --top;
        continue;
      }
      int const k = lowest_bit(here.boxes);
      std::uint32_t const child = nodes[here.node].child[k];
      here.boxes &= here.boxes - 1;
      if ((child & tree_node::leaf) == 0) {
        stack[++top] = {child, nodes[child].overlapping(box)};
      } else if (is_first(here.node, k, box) && !f(child & ~tree_node::leaf)) {
        return;
      }
    }
  }

 private:
  /// The boxes of a node that a sphere reaches. Where triangles are in pieces its box counts.
  COLLIDE_HD_INLINE std::uint32_t reached(std::uint32_t node, reach const& r) const {
    return before != nullptr ? nodes[node].overlapping(r.around) : nodes[node].reached(r.centre, r.squared);
  }

  /// True if no other piece of the triangle in a box overlaps what this one does and comes before: so each triangle is
  /// found once. Pieces that overlap a box follow each other, so the one before tells of all.
  COLLIDE_HD_INLINE bool is_first(std::uint32_t node, int k, tree_point const& around) const {
    return (nodes[node].continues >> k & 1) == 0 || !overlap(before[node].of[k], around);
  }
};

}  // namespace collide::detail
