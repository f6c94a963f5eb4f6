/// \file
/// Exact test, on the host, of two triangles that meet elsewhere than at corners and edges that they share.
///
/// What two triangles have in common is convex, and an edge of one meets the other in each of its corners. So edges are
/// asked: whether they go through the other's plane within the triangle, or meet it in that plane.
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>

#include <collide/exact/detail/predicates/exact_ray.hpp>

namespace collide::detail {

/// A finite triangle, the numbers of its vertices, and an axis along which it is seen as one.
class seen_triangle {
 public:
  seen_triangle(triangle<double> const& t, std::array<std::uint32_t, 3> const& vertices)
      : corners_{{t.a, t.b, t.c}}, vertices_{vertices} {
    // guard: pair-axis
    do {
      turn_ = side(t.a, t.b, t.c);
    } while (turn_ == 0 && ++axis_ < 3);
  }

  /// False if its corners lie on a line.
  bool has_area() const { return turn_ != 0; }

  /// True if two triangles, both with an area, have a point in common that is not of a shared corner or edge, or have
  /// the same corners.
  static bool meet(seen_triangle const& s, seen_triangle const& t) {
    int shared = 0;
    for (unsigned i = 0; i < 3; ++i) shared += t.shares(s, i) ? 1 : 0;
    // guard: pair-same
    if (shared == 3) return true;
    heights const of_s = t.heights_of(s);
    if (std::abs(of_s[0] + of_s[1] + of_s[2]) == 3 - shared) return false;
    heights const of_t = s.heights_of(t);
    if (std::abs(of_t[0] + of_t[1] + of_t[2]) == 3 - shared) return false;
    for (unsigned i = 0; i < 3; ++i)
      if (t.meets_edge(s, i, of_s) || s.meets_edge(t, i, of_t)) return true;
    return false;
  }

 private:
  using heights = std::array<int, 3>;  ///< -1, 0 or 1 for each corner: below, in or above the other triangle's plane

  std::array<vec3<double>, 3> corners_;
  std::array<std::uint32_t, 3> vertices_;
  int axis_ = 0, turn_;  ///< 1 if counter-clockwise

  static unsigned next(unsigned i) { return (i + 1) % 3; }

  /// Which corner is corner i of the other triangle; 3 if none.
  unsigned corner_of(seen_triangle const& other, unsigned i) const {
    unsigned k = 0;
    while (k < 3 && vertices_[k] != other.vertices_[i]) ++k;
    return k;
  }
  bool shares(seen_triangle const& other, unsigned i) const { return corner_of(other, i) != 3; }

  heights heights_of(seen_triangle const& other) const {
    heights h;
    for (unsigned i = 0; i < 3; ++i)
      h[i] = shares(other, i) ? 0 : sign_of_height({corners_[0], corners_[1], corners_[2]}, other.corners_[i]);
    return h;
  }

  /// On which side of the line from p to q a point is, as seen along the axis.
  int side(vec3<double> const& p, vec3<double> const& q, vec3<double> const& of) const {
    auto const seen = [&](vec3<double> const& v) { return vec3<double>(v[(axis_ + 1) % 3], v[(axis_ + 2) % 3], 0); };
    return side_of_line(seen(p), seen(q), seen(of));
  }
  /// On which side of the edge from corner k a point of the plane is: 1 on that of the triangle.
  int side_of_edge(unsigned k, vec3<double> const& p) const { return turn_ * side(corners_[k], corners_[next(k)], p); }

  /// True if the edge from corner i of the other triangle meets this one elsewhere than at what they share.
  bool meets_edge(seen_triangle const& other, unsigned i, heights const& h) const {
    vec3<double> const &p = other.corners_[i], &q = other.corners_[next(i)];
    unsigned const p_at = corner_of(other, i), q_at = corner_of(other, next(i));
    bool const in_plane = h[i] == 0 && h[next(i)] == 0;
    if (p_at != 3 || q_at != 3) {
      // guard: pair-shared-edge, pair-shared-corner
      if (p_at != 3 && q_at != 3) return false;
      return in_plane && begins_inside(p_at != 3 ? p_at : q_at, p_at != 3 ? q : p);
    }
    // guard: pair-plane, pair-one-side
    if (in_plane) return meets_in_plane(p, q);
    if (h[i] * h[next(i)] > 0) return false;
    bool left = false, right = false;  // how the line goes around the edges of this triangle
    for (unsigned k = 0; k < 3; ++k) {
      int const turn = sign_of_height({q, corners_[k], corners_[next(k)]}, p);
      left = left || turn > 0;
      right = right || turn < 0;
    }
    // guard: pair-through
    return !(left && right);
  }

  /// True if the way from corner k to a point of the plane begins in the triangle or along its edge.
  bool begins_inside(unsigned k, vec3<double> const& to) const {
    // guard: pair-begins
    return side_of_edge(k, to) >= 0 && side_of_edge(next(next(k)), to) >= 0;
  }

  /// True if a segment in the plane meets the triangle: if no line along an edge or the segment is between them.
  bool meets_in_plane(vec3<double> const& p, vec3<double> const& q) const {
    bool left = true, right = true;
    // guard: pair-along-edge, pair-along-segment
    for (unsigned k = 0; k < 3; ++k) {
      if (side_of_edge(k, p) < 0 && side_of_edge(k, q) < 0) return false;
      int const of_corner = side(p, q, corners_[k]);
      left = left && of_corner > 0;
      right = right && of_corner < 0;
    }
    return !left && !right;
  }
};

}  // namespace collide::detail
