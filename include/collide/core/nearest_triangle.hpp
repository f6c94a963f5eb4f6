/// \file
/// The triangle of a mesh that is nearest to a point, and where on it.
#pragma once

#include <cstdint>

#include <collide/core/contact.hpp>
#include <collide/core/geometry.hpp>

namespace collide {

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
