/// \file
/// A colliding pair of a sphere and a triangle, and its contact: where and how the two touch.
#pragma once

#include <cstdint>

#include <collide/geometry.hpp>

namespace collide {

/// A colliding (sphere, triangle) pair.
struct pair {
  id sphere;
  id triangle;

  friend COLLIDE_HD bool operator==(pair p, pair q) { return p.sphere == q.sphere && p.triangle == q.triangle; }
  friend COLLIDE_HD bool operator!=(pair p, pair q) { return !(p == q); }
  /// Canonical order: by sphere, then by triangle.
  friend COLLIDE_HD bool operator<(pair p, pair q) {
    return p.sphere != q.sphere ? p.sphere < q.sphere : p.triangle < q.triangle;
  }
};

/// Order of the pairs or contacts in an array. `canonical` is sorted by sphere and within a sphere by triangle; it
/// costs a sort, O(n log n) on the host and a radix or merge sort on a GPU.
enum class order { unspecified, canonical };

/// The feature of a triangle that the closest point lies in: its interior (face), one of its edges or vertices.
enum class feature : std::uint32_t { face, edge, vertex };

/// Contact of a sphere and a triangle, lengths in the units of the scene. It has no padding: equal contacts are equal
/// bytes.
template <class S>
struct contact {
  id sphere;
  id triangle;
  vec3<S> point;   ///< closest point of the triangle to the centre
  vec3<S> normal;  ///< unit vector from the triangle to the centre; a normal of the triangle if the centre is on it
  S distance;      ///< from the centre to the triangle
  S depth;         ///< radius - distance: how deep the triangle is in the sphere
  collide::feature feature;     ///< the feature of the triangle that `point` lies in
  std::uint32_t feature_index;  ///< edge 0 = ab, 1 = bc, 2 = ca; vertex 0 = a, 1 = b, 2 = c; face 0
};

}  // namespace collide
