/// \file
/// A node of a tree of boxes, and what is asked of it: which of its boxes a sphere reaches, how far they are.
///
/// Boxes are floats, rounded outward, whatever the type of the coordinates: doubles are taken relative to a corner of
/// the mesh, so that they lose little far from the origin. Derivation in docs/development/numerics.md.
#pragma once

#include <cstdint>
#include <limits>

#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/exact/detail/geometry/lifted_bounds.hpp>
#include <collide/mesh.hpp>

namespace collide::detail {

/// The next float above, or below; infinities stay.
COLLIDE_HD_INLINE float below(float x) { return is_finite(x) ? next_below(x) : x; }
COLLIDE_HD_INLINE float above(float x) { return -below(-x); }

/// A float at most, or at least, as large as a number that is not NaN. A box of floats then begins with a finite number
/// or -infinity, and ends with a finite one or +infinity.
COLLIDE_HD_INLINE float float_below(float x) { return x; }
COLLIDE_HD_INLINE float float_below(double x) {
  constexpr float largest = std::numeric_limits<float>::max();
  constexpr float far = std::numeric_limits<float>::infinity();
  if (!(x > -static_cast<double>(largest))) return -far;
  return x < static_cast<double>(largest) ? below(static_cast<float>(x)) : largest;
}
template <class S>
COLLIDE_HD_INLINE float float_above(S x) {
  return -float_below(-x);
}

/// The point that the boxes of a tree are relative to: nothing for floats, a corner of the mesh for doubles.
template <class S>
COLLIDE_HD_INLINE vec3<S> tree_origin(mesh_view<S> const& mesh) {
  if constexpr (sizeof(S) == sizeof(float)) return {0, 0, 0};
  return lifted_origin(mesh);
}

/// The box of a triangle in a tree: with room for the rounding of the coarsest narrow phase, as far as it goes with the
/// triangle. Empty if the triangle is not finite.
template <class S>
COLLIDE_HD_INLINE aabb<float> tree_box_of(triangle<S> const& t, vec3<S> const& origin) {
  triangle_aabb<S> const exact = triangle_aabb_of(t);
  if (exact.is_empty()) return aabb<float>::empty();
  float const padding = float_above(exact.padding);
  aabb<float> box;
  COLLIDE_UNROLL
  for (int k = 0; k < 3; ++k) {
    box.lower[k] = below(float_below(exact.lower[k] - origin[k]) - padding);
    box.upper[k] = above(float_above(exact.upper[k] - origin[k]) + padding);
  }
  return box;
}

/// A point, or what has a box, as the boxes of a tree see it: a box of floats around it, which for a point of floats is
/// itself.
struct tree_point {
  float lower[3], upper[3];

  tree_point() = default;
  COLLIDE_HD_INLINE explicit tree_point(aabb<float> const& b)
      : lower{b.lower[0], b.lower[1], b.lower[2]}, upper{b.upper[0], b.upper[1], b.upper[2]} {}
  template <class S>
  COLLIDE_HD_INLINE tree_point(vec3<S> const& x, vec3<S> const& origin) {
    COLLIDE_UNROLL
    for (int k = 0; k < 3; ++k) {
      lower[k] = float_below(x[k] - origin[k]);
      upper[k] = float_above(x[k] - origin[k]);
    }
  }
};

/// True if a box and that of a point or a sphere have a point in common: told without arithmetic, so alike wherever it
/// is asked.
COLLIDE_HD_INLINE bool overlap(aabb<float> const& box, tree_point const& other) {
  bool apart = false;
  COLLIDE_UNROLL
  for (int i = 0; i < 3; ++i) apart = apart | (box.lower[i] > other.upper[i]) | (box.upper[i] < other.lower[i]);
  return !apart;
}

/// Boxes next to each other, number by number, for the processor's vector unit.
struct alignas(32) tree_boxes {
  static constexpr int width = 8;

  float lower[3][width], upper[3][width];

  /// The squared distance of box k, with a few roundings.
  COLLIDE_HD_INLINE float distance_squared(int k, tree_point const& p) const {
    float const x = gap(0, k, p), y = gap(1, k, p), z = gap(2, k, p);
    return mul_add(x, x, mul_add(y, y, z * z));
  }

  /// Boxes for arithmetic: on a device a copy in registers, loaded 16 bytes at a time, as each thread reads another
  /// node.
#if defined(__CUDA_ARCH__)
  __device__ __forceinline__ tree_boxes in_registers() const {
    tree_boxes copy;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < width; k += 4) {
        load(lower[i] + k, copy.lower[i] + k);
        load(upper[i] + k, copy.upper[i] + k);
      }
    }
    return copy;
  }
#else
  tree_boxes const& in_registers() const { return *this; }
#endif

 private:
  COLLIDE_HD_INLINE float gap(int axis, int k, tree_point const& p) const {
    float const outside = max(lower[axis][k] - p.upper[axis], p.lower[axis] - upper[axis][k]);
    return select(outside > 0, outside, 0.0f);
  }
#if defined(__CUDA_ARCH__)
  static __device__ __forceinline__ void load(float const* from, float* to) {
    float4 const x = *reinterpret_cast<float4 const*>(from);
    to[0] = x.x, to[1] = x.y, to[2] = x.z, to[3] = x.w;
  }
#endif
};

/// A node: boxes, and the nodes and triangles in them.
struct tree_node : tree_boxes {
  static constexpr std::uint32_t leaf = 0x80000000u;  ///< what has this bit is a triangle, else the number of a node

  std::uint32_t child[width];
  std::uint32_t there;      ///< bit k: there is a box k
  std::uint32_t parent;     ///< number of a node; of the root, itself
  std::uint32_t slot;       ///< which box of the parent this node is
  std::uint32_t continues;  ///< bit k: box k is of a piece of a triangle, and not of the first
  std::uint32_t arrived;    ///< while boxes are made: how many there are

  COLLIDE_HD_INLINE void set_box(int k, aabb<float> const& box) {
    for (int i = 0; i < 3; ++i) {
      lower[i][k] = box.lower[i];
      upper[i][k] = box.upper[i];
    }
  }
  COLLIDE_HD_INLINE void set(int k, aabb<float> const& box, std::uint32_t what) {
    set_box(k, box);
    child[k] = what;
  }

  COLLIDE_HD_INLINE aabb<float> box() const {
    aabb<float> all = aabb<float>::empty();
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < width; ++k) {
        if ((there >> k & 1) == 0) continue;
        all.lower[i] = min(all.lower[i], lower[i][k]);
        all.upper[i] = max(all.upper[i], upper[i][k]);
      }
    }
    return all;
  }

  /// Bit k: box k is within a distance, given as its square.
  COLLIDE_HD_INLINE std::uint32_t reached(tree_point const& p, float reach_squared) const {
    auto const& boxes = in_registers();
    return mask_of([&](int k) { return boxes.distance_squared(k, p) <= reach_squared; }) & there;
  }

  /// Bit k: box k and another have a point in common; see `overlap`.
  COLLIDE_HD_INLINE std::uint32_t overlapping(tree_point const& other) const {
    auto const& boxes = in_registers();
    float const x = other.lower[0], y = other.lower[1], z = other.lower[2], x_end = other.upper[0],
                y_end = other.upper[1], z_end = other.upper[2];
    return ~mask_of([&](int k) {
      float apart = select(boxes.lower[0][k] > x_end, 1.0f, 0.0f);
      apart = select(boxes.upper[0][k] < x, 1.0f, apart);
      apart = select(boxes.lower[1][k] > y_end, 1.0f, apart);
      apart = select(boxes.upper[1][k] < y, 1.0f, apart);
      apart = select(boxes.lower[2][k] > z_end, 1.0f, apart);
      return select(boxes.upper[2][k] < z, 1.0f, apart) > 0;
    }) & there;
  }

  /// The squared distances of boxes as numbers that sort like them, rounded down so far that rounding cannot make one
  /// larger than it is; the number of the box is in the lowest bits. `none` for boxes that are not in `boxes`.
  COLLIDE_HD_INLINE void find_keys(tree_point const& p, std::uint32_t boxes, std::uint32_t (&keys)[width]) const {
    auto const& all = in_registers();
    for (int k = 0; k < width; ++k) {
      std::uint32_t const key = (to_bits(all.distance_squared(k, p)) & ~7u) | static_cast<std::uint32_t>(k);
      keys[k] = key | ((boxes >> k & 1) - 1);
    }
  }
  static COLLIDE_HD_INLINE std::uint32_t min_of(std::uint32_t const (&keys)[width]) {
    std::uint32_t half[width / 2];
    for (int k = 0; k < width / 2; ++k) half[k] = min(keys[k], keys[k + width / 2]);
    return min(min(half[0], half[1]), min(half[2], half[3]));
  }
  static COLLIDE_HD_INLINE void remove(std::uint32_t (&keys)[width], std::uint32_t key) {
    for (auto& other : keys) other = other == key ? none : other;
  }

  /// The largest key of a box that may have something within a distance, given as its square in any precision.
  template <class S>
  static COLLIDE_HD_INLINE std::uint32_t key_of(S squared) {
    if (!(squared >= 0)) return 0;
    // a computed square is at most 8 units in the last place too large, and a key drops as many
    float const largest = above(float_above(squared)) * (1 + 16 * ieee_traits<float>::unit_roundoff);
    return min(to_bits(max(largest, std::numeric_limits<float>::min())), 0x7f800000u) | 7u;
  }

  static constexpr std::uint32_t none = 0xffffffffu;

 private:
  /// Bit k: f(k) holds. In lanes of the processor's vector unit, which g++ uses where the bits are no constants.
  template <class F>
  static COLLIDE_HD_INLINE std::uint32_t mask_of(F const& f) {
    std::uint32_t mask = 0;
#if defined(__CUDA_ARCH__)
    for (int k = 0; k < width; ++k) mask |= f(k) ? 1u << k : 0u;
#else
    std::uint32_t const bits[width] = {1, 2, 4, 8, 16, 32, 64, 128};  // SSE cannot shift lanes by different amounts
    for (int k = 0; k < width; ++k) mask |= f(k) ? bits[k] : 0u;
#endif
    return mask;
  }
};

/// For the boxes of a node that are of pieces of triangles: the boxes of the pieces before them.
struct boxes_before {
  aabb<float> of[tree_node::width];
};

}  // namespace collide::detail
