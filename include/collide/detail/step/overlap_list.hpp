/// \file
/// The contacts of a sphere with a surface: the points of it that are nearest to the centre among those around them,
/// and where the surface joins them.
///
/// Let d be the distance from the centre, and S(d) the points of the surface that are nearer. As d grows, parts of S(d)
/// appear, each at a local minimum of the distance, and join where it has a saddle. A minimum at distance a is a
/// contact; where its part joins that of a nearer one, at distance b, it counts no further (the elder rule of
/// persistent homology: H. Edelsbrunner, D. Letscher and A. Zomorodian, Discrete & Computational Geometry 28, 2002). A
/// law whose energy at an overlap x is E(x) then gives a sphere of radius r the energy
///
///     sum of E(r - a) - E(r - b)
///
/// over the contacts; the nearest of all that are joined has no b. This is the integral of the law's force over the
/// number of parts of S(d), and it depends on the surface as a set of points alone. So it is the same for every
/// division into triangles, makes no energy, is E(r - a) on a plane and at a convex edge, twice that in a corner whose
/// edge is out of reach, and goes from one to the other in a fold without a jump, as a pair of a minimum and a saddle
/// vanishes where both are the same.
///
/// The surface is the union of triangles, whatever corners they share: they are connected where they are within a
/// tolerance of each other, of all bodies.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/contact.hpp>
#include <collide/detail/geometry/closest_point.hpp>
#include <collide/mesh.hpp>

namespace collide::detail {

/// The closest point of a triangle to a centre, computed in double.
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

/// A triangle that a sphere overlaps. Points are relative to the centre, along the axes of the world.
struct overlap_item {
  vec3<double> nearest;  ///< its nearest point
  double distance;       ///< of that
  id triangle;
  std::uint8_t frame;       ///< of the body; 0 of what rests
  feature kind;             ///< where in the triangle the point lies
  bool is_minimum;          ///< no other triangle leads from there to what is nearer
  bool has_saddle;          ///< of a minimum: its part of the surface joins that of a nearer one
  std::uint32_t parent;     ///< a nearer item of the same part of the surface; its own number if it is the nearest
  std::uint32_t saddle_of;  ///< of a minimum: `saddle_points` times the item, plus the number of its point
};

/// The triangles that a sphere overlaps, the nearest first: here as long as there are few, else in memory that the
/// caller has.
class overlap_list {
 public:
  static constexpr std::uint32_t room = 16;          ///< of the list itself
  static constexpr std::uint32_t saddle_points = 7;  ///< of a triangle, where it may join others

  std::uint32_t size = 0;
  std::uint32_t added = 0;  ///< with those for which there was no room, and those that were added before

  /// Points within `tolerance` of each other are one.
  COLLIDE_HD_INLINE explicit overlap_list(double tolerance) : tolerance_{tolerance} {}
  overlap_list(overlap_list const&) = delete;
  overlap_list& operator=(overlap_list const&) = delete;

  COLLIDE_HD_INLINE overlap_item& operator[](std::uint32_t i) { return items_[i]; }
  COLLIDE_HD_INLINE overlap_item const& operator[](std::uint32_t i) const { return items_[i]; }

  /// Adds a triangle, once each, also if it is added again. To what `use` gave it is appended: `sort` it then.
  COLLIDE_HD_INLINE void add(overlap_item const& item) {
    ++added;
    if (items_ != own_) {
      items_[size++] = item;
      return;
    }
    std::uint32_t at = size;
    COLLIDE_NO_UNROLL
    while (at > 0 && comes_before(item, own_[at - 1])) --at;
    if (at > 0 && own_[at - 1].triangle == item.triangle) --added;
    if ((at > 0 && own_[at - 1].triangle == item.triangle) || at == room) return;
    if (size < room) ++size;
    COLLIDE_NO_UNROLL
    for (std::uint32_t k = size - 1; k > at; --k) own_[k] = own_[k - 1];
    own_[at] = item;
  }
  COLLIDE_HD_INLINE bool is_full() const { return added > size; }
  COLLIDE_HD_INLINE double tolerance() const { return tolerance_; }

  /// Begins anew in memory for as many as have been `added`.
  COLLIDE_HD_INLINE void use(overlap_item* memory) {
    items_ = memory;
    size = added = 0;
  }
  /// A heap sort; then leaves out those that were added again.
  COLLIDE_HD void sort() {
    COLLIDE_NO_UNROLL
    for (std::uint32_t k = size / 2; k-- > 0;) sift(k, size);
    COLLIDE_NO_UNROLL
    for (std::uint32_t n = size; n > 1;) {
      swap(0, --n);
      sift(0, n);
    }
    std::uint32_t n = 0;
    COLLIDE_NO_UNROLL
    for (std::uint32_t k = 0; k < size; ++k)
      if (n == 0 || items_[n - 1].triangle != items_[k].triangle) items_[n++] = items_[k];
    size = n;
  }

  /// Finds the minima, and returns how many there are. `reaches(i, p)`: is triangle i within the tolerance of point p?
  template <class Reaches>
  COLLIDE_HD std::uint32_t find_minima(Reaches const& reaches) {
    std::uint32_t minima = 0;
    COLLIDE_NO_UNROLL
    for (std::uint32_t i = 0; i < size; ++i) {
      overlap_item& item = items_[i];
      item.parent = i;
      item.has_saddle = false;
      COLLIDE_NO_UNROLL
      for (std::uint32_t j = i; j-- > 0 && item.parent == i;)
        if (reaches(j, item.nearest)) item.parent = j;
      item.is_minimum = item.parent == i;
      minima += item.is_minimum;
    }
    return minima;
  }

  /// True if a minimum lies behind another that is nearer: the far side of a plate.
  COLLIDE_HD bool is_hidden(std::uint32_t i) const {
    constexpr double parallel = 1e-12;  // square of an angle
    overlap_item const& item = items_[i];
    COLLIDE_NO_UNROLL
    for (std::uint32_t k = 0; k < i; ++k) {
      if (!items_[k].is_minimum) continue;
      vec3<double> const aside = cross(items_[k].nearest, item.nearest);
      double const lengths = mul_rn(items_[k].distance, item.distance);
      if (dot(items_[k].nearest, item.nearest) > 0 && dot(aside, aside) <= mul_rn(parallel, mul_rn(lengths, lengths)))
        return true;
    }
    return false;
  }

  /// Finds the saddles nearer than `reach` where parts of the surface with these minima join, as J. B. Kruskal finds a
  /// tree: the nearest first. `point_of(i, k)`: a point of triangle i in its edge k, the nearest, or its corner k - 3,
  /// or the nearest point of all.
  template <class Reaches, class PointOf>
  COLLIDE_HD void join(std::uint32_t minima, double reach, Reaches const& reaches, PointOf const& point_of) {
    COLLIDE_NO_UNROLL
    while (minima-- > 1) {
      double least = reach * reach;
      std::uint32_t from = 0, to = 0, found = saddle_points;
      COLLIDE_NO_UNROLL
      for (std::uint32_t i = 0; i < size && items_[i].distance < reach; ++i) {
        std::uint32_t const own = minimum_of(i);
        COLLIDE_NO_UNROLL
        for (std::uint32_t k = 0; k < saddle_points; ++k) {
          vec3<double> const p = point_of(i, k);
          double const squared = dot(p, p), farthest = sqrt_rn(squared) + 2 * tolerance_;
          if (!(squared < least)) continue;
          COLLIDE_NO_UNROLL
          for (std::uint32_t j = 0; j < size && items_[j].distance <= farthest; ++j) {
            if (minimum_of(j) == own || !reaches(j, p)) continue;
            least = squared, from = i, to = j, found = k;
            break;
          }
        }
      }
      if (found == saddle_points) return;
      std::uint32_t const a = minimum_of(from), b = minimum_of(to);
      overlap_item& younger = items_[max(a, b)];
      younger.parent = min(a, b);
      younger.has_saddle = true;
      younger.saddle_of = from * saddle_points + found;
    }
  }

 private:
  COLLIDE_HD_INLINE std::uint32_t minimum_of(std::uint32_t i) const {
    COLLIDE_NO_UNROLL
    while (items_[i].parent != i) i = items_[i].parent;
    return i;
  }

  /// A face comes before edges and corners that are as near: in a wall with a step of less than the tolerance the
  /// normal is that of a face.
  COLLIDE_HD_INLINE double rank_of(overlap_item const& a) const {
    return a.kind == feature::face ? a.distance : a.distance + tolerance_;
  }
  COLLIDE_HD_INLINE bool comes_before(overlap_item const& a, overlap_item const& b) const {
    double const rank_a = rank_of(a), rank_b = rank_of(b);
    if (rank_a != rank_b) return rank_a < rank_b;
    return a.kind != b.kind ? a.kind < b.kind : a.triangle < b.triangle;
  }
  COLLIDE_HD_INLINE void swap(std::uint32_t i, std::uint32_t k) {
    overlap_item const item = items_[i];
    items_[i] = items_[k];
    items_[k] = item;
  }
  COLLIDE_HD_INLINE void sift(std::uint32_t k, std::uint32_t n) {
    COLLIDE_NO_UNROLL
    for (std::uint32_t child; (child = 2 * k + 1) < n; k = child) {
      if (child + 1 < n && comes_before(items_[child], items_[child + 1])) ++child;
      if (!comes_before(items_[k], items_[child])) return;
      swap(k, child);
    }
  }

  overlap_item own_[room];
  overlap_item* items_ = own_;
  double tolerance_;
};

}  // namespace collide::detail
