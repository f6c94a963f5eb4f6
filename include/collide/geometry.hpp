/// \file
/// Points, triangles and spheres: plain values, as small as their coordinates.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include <collide/config.hpp>

namespace collide {

/// Number of a sphere or a triangle, from 0.
using id = std::uint32_t;

/// The id of nothing.
inline constexpr id no_id = 0xffffffffu;

/// A point or a vector of `S` = float or double, in the units of the scene.
template <class S>
using vec3 = Eigen::Matrix<S, 3, 1>;

/// The triangle with vertices a, b, c, its boundary included; a segment or a point if they are collinear or equal.
template <class S>
struct triangle {
  vec3<S> a;  ///< corner 0
  vec3<S> b;  ///< corner 1
  vec3<S> c;  ///< corner 2
};

/// A sphere, as a solid: all points within `radius` of `centre`, the boundary included. Empty if the radius is negative
/// or NaN.
template <class S>
struct sphere {
  vec3<S> centre;  ///< where it is
  S radius;        ///< in the units of the coordinates
};

/// A sphere that moves along a straight path within a step: at time t, from 0 to 1, its centre is at
/// centre + t * displacement, in real arithmetic.
template <class S>
struct moving_sphere : sphere<S> {
  vec3<S> displacement;  ///< of the centre, from the beginning of the step to its end
};

}  // namespace collide
