/// \file
/// Points, triangles and spheres: plain values, as small as their coordinates.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include <collide/core/config.hpp>

namespace collide {

/// Number of a sphere or a triangle, from 0.
using id = std::uint32_t;

/// The id of nothing.
inline constexpr id no_id = 0xffffffffu;

/// A point or a vector of `S` = float or double, in the units of the scene.
template <class S>
using vec3 = Eigen::Matrix<S, 3, 1>;

namespace detail {

/// Sums and multiples of vectors, as Eigen computes them: the library's own code finds these first, and they are a
/// tenth of what Eigen's expressions take to compile.
namespace vector_operators {

template <class S>
COLLIDE_HD_INLINE vec3<S> operator+(vec3<S> const& a, vec3<S> const& b) {
  return {a.x() + b.x(), a.y() + b.y(), a.z() + b.z()};
}
template <class S>
COLLIDE_HD_INLINE vec3<S> operator-(vec3<S> const& a, vec3<S> const& b) {
  return {a.x() - b.x(), a.y() - b.y(), a.z() - b.z()};
}
template <class S>
COLLIDE_HD_INLINE vec3<S> operator-(vec3<S> const& a) {
  return {-a.x(), -a.y(), -a.z()};
}
template <class S>
COLLIDE_HD_INLINE vec3<S> operator*(vec3<S> const& a, S s) {
  return {a.x() * s, a.y() * s, a.z() * s};
}
template <class S>
COLLIDE_HD_INLINE vec3<S>& operator+=(vec3<S>& a, vec3<S> const& b) {
  return a = a + b;
}
template <class S>
COLLIDE_HD_INLINE vec3<S>& operator-=(vec3<S>& a, vec3<S> const& b) {
  return a = a - b;
}
template <class S>
COLLIDE_HD_INLINE bool operator==(vec3<S> const& a, vec3<S> const& b) {
  return a.x() == b.x() && a.y() == b.y() && a.z() == b.z();
}

}  // namespace vector_operators

// operators of detail/ hide those of the namespace around it
using vector_operators::operator+;
using vector_operators::operator-;
using vector_operators::operator*;
using vector_operators::operator+=;
using vector_operators::operator-=;
using vector_operators::operator==;

}  // namespace detail

using namespace detail::vector_operators;

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
