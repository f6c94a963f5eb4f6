/// \file
/// The contacts of a sphere with a surface of triangles: the points of the surface that are nearest to the centre among
/// those around them.
///
/// Each triangle that the sphere overlaps has a nearest point. It is a contact unless another of these triangles has
/// the edge or corner that the point lies in, and comes nearer elsewhere: so the force does not depend on how a surface
/// is divided into triangles, and a sphere that slides over an edge of a flat wall has one contact all the time.
/// Corners are the same where their coordinates are, so meshes without shared vertices are surfaces too.
#pragma once

#include <cstdint>

#include <collide/contact.hpp>
#include <collide/detail/geometry/closest_point.hpp>
#include <collide/mesh.hpp>

// the numbers of elements of small arrays are int
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-conversion"

namespace collide::detail {

/// Where a triangle is nearest to a centre. All is computed in double.
struct nearest_of_triangle {
  vec3<double> normal;  ///< unit vector to the centre
  double distance;
  feature kind;
  int index;
};

/// The nearest point of a finite triangle. Where it lies in an edge or a corner, but straight below the centre to
/// rounding, normal and distance are those of the triangle's plane, which all triangles of a flat wall have in common.
template <class S>
COLLIDE_HD_NOINLINE nearest_of_triangle nearest_to(triangle<S> const& t, vec3<S> const& centre) {
  constexpr double straight = 1e-14;  // square of an angle
  sphere<S> const at{centre, S(0)};
  local_triangle<double> const l = to_local<double>(t, at);
  vec3<double> face = cross<double>(l.b - l.a, l.c - l.a);
  closest_point<double> const foot = closest_to_origin(l, face);
  vec3<double> normal = -foot.point;
  double distance = sqrt_rn(foot.distance_squared);
  double const area = sqrt_rn(dot(face, face));
  if (area > 0) {
    face = vec3<double>(div_rn(face.x(), area), div_rn(face.y(), area), div_rn(face.z(), area));
    vec3<double> const aside = cross(face, normal);
    if (foot.kind == feature::face || dot(aside, aside) <= mul_rn(straight, foot.distance_squared)) {
      double const height = -dot(l.a, face);
      return {height < 0 ? vec3<double>(-face) : face, height < 0 ? -height : height, foot.kind, foot.index};
    }
  }
  if (distance > 0) {
    normal = vec3<double>(div_rn(normal.x(), distance), div_rn(normal.y(), distance), div_rn(normal.z(), distance));
  } else {
    normal = area > 0 ? face : vec3<double>(0, 0, 1);
  }
  return {normal, distance, foot.kind, foot.index};
}

/// The triangles that a sphere overlaps, the nearest first; of more than there is room for, those.
struct overlap_list {
  static constexpr int room = 16;

  struct item {
    double distance;
    id triangle;
    int frame;  ///< of the body; 0 of what rests
    feature kind;
    int index;
  };
  item items[room];
  int size = 0;

  /// Once each, also if it is added again.
  COLLIDE_HD_INLINE void add(item const& added) {
    int at = size;
    COLLIDE_NO_UNROLL
    while (at > 0 && comes_before(added, items[at - 1])) --at;
    if (at > 0 && items[at - 1].triangle == added.triangle) return;
    if (at == room) return;
    if (size < room) ++size;
    COLLIDE_NO_UNROLL
    for (int k = size - 1; k > at; --k) items[k] = items[k - 1];
    items[at] = added;
  }

  /// True if the nearest point of a triangle is one of the surface. `corners(i)` are the triangle of item i.
  template <class Corners>
  COLLIDE_HD bool is_contact(int i, Corners const& corners) const {
    item const& own = items[i];
    if (own.kind == feature::face) return true;
    auto const t = corners(i);
    int const next = own.index == 2 ? 0 : own.index + 1;
    auto const first = corner_of(t, own.index), second = own.kind == feature::edge ? corner_of(t, next) : first;
    COLLIDE_NO_UNROLL
    for (int k = 0; k < i; ++k) {
      if (items[k].frame != own.frame) continue;
      auto const other = corners(k);
      if (has_corner(other, first) && has_corner(other, second)) return false;
    }
    return true;
  }

 private:
  static COLLIDE_HD_INLINE bool comes_before(item const& a, item const& b) {
    if (a.distance != b.distance) return a.distance < b.distance;
    return a.kind != b.kind ? a.kind < b.kind : a.triangle < b.triangle;
  }
  template <class S>
  static COLLIDE_HD_INLINE vec3<S> const& corner_of(triangle<S> const& t, int k) {
    return k == 0 ? t.a : k == 1 ? t.b : t.c;
  }
  template <class S>
  static COLLIDE_HD_INLINE bool has_corner(triangle<S> const& t, vec3<S> const& x) {
    return t.a == x || t.b == x || t.c == x;
  }
};

}  // namespace collide::detail

#pragma GCC diagnostic pop
