/// \file
/// A colliding pair of a sphere and a triangle, its contact and its impact: where and how the two touch; and the
/// nearest triangle of a point.
#pragma once

#include <cstdint>

#include <collide/core/geometry.hpp>

namespace collide {

/// A colliding (sphere, triangle) pair.
struct pair {
  id sphere;    ///< number of the sphere
  id triangle;  ///< number of the triangle

  /// True if both numbers are equal.
  friend COLLIDE_HD bool operator==(pair p, pair q) { return p.sphere == q.sphere && p.triangle == q.triangle; }
  /// True if one of the numbers differs.
  friend COLLIDE_HD bool operator!=(pair p, pair q) { return !(p == q); }
  /// Canonical order: by sphere, then by triangle.
  friend COLLIDE_HD bool operator<(pair p, pair q) {
    return p.sphere != q.sphere ? p.sphere < q.sphere : p.triangle < q.triangle;
  }
};

/// Order of the pairs or contacts in an array. `canonical` is sorted by sphere and within a sphere by triangle; it
/// costs a sort, O(n log n) on the host and a radix or merge sort on a GPU.
enum class order {
  unspecified,  ///< any; it may differ from run to run
  canonical     ///< by sphere, then by triangle
};

/// The feature of a triangle that the closest point lies in: its interior (face), one of its edges or vertices.
enum class feature : std::uint32_t {
  face,   ///< the interior
  edge,   ///< between two vertices
  vertex  ///< one of the three corners
};

/// Contact of a sphere and a triangle, lengths in the units of the scene. It has no padding: equal contacts are equal
/// bytes.
template <class S>
struct contact {
  id sphere;       ///< number of the sphere
  id triangle;     ///< number of the triangle
  vec3<S> point;   ///< closest point of the triangle to the centre
  vec3<S> normal;  ///< unit vector from the triangle to the centre; a normal of the triangle if the centre is on it
  S distance;      ///< from the centre to the triangle
  S depth;         ///< radius - distance: how deep the triangle is in the sphere; next to 0 at a time of impact
  collide::feature feature;     ///< the feature of the triangle that `point` lies in
  std::uint32_t feature_index;  ///< edge 0 = ab, 1 = bc, 2 = ca; vertex 0 = a, 1 = b, 2 = c; face 0
};

/// First contact of a moving sphere and a triangle within a step. It has no padding: equal impacts are equal bytes.
template <class S>
struct impact {
  collide::contact<S> contact;  ///< at the time of impact
  S time;                       ///< of impact, as a fraction of the step, 0 to 1; 0 if the two overlap at the beginning
};

/// The nearest triangle to a point, lengths in the units of the scene. Where there is none `triangle` is `no_id`,
/// `distance` +infinity, and what else has the type `S` NaN.
template <class S>
struct nearest_triangle {
  vec3<S> point;                ///< closest point of the triangle
  vec3<S> barycentric;          ///< weights of the corners a, b and c that give `point`: not negative, their sum is 1
  S distance;                   ///< from the point that was asked for to the triangle
  id triangle;                  ///< number of the triangle; of equally near ones the lowest
  collide::feature feature;     ///< the feature of the triangle that `point` lies in
  std::uint32_t feature_index;  ///< edge 0 = ab, 1 = bc, 2 = ca; vertex 0 = a, 1 = b, 2 = c; face 0
};

}  // namespace collide
