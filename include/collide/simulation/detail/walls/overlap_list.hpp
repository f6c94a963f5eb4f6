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

#include <cstdint>
#include <limits>

#include <collide/core/contact.hpp>
#include <collide/exact/detail/geometry/closest_point.hpp>
#include <collide/mesh.hpp>
#include <collide/spaces/detail/algorithms.hpp>

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
COLLIDE_AS_O3 COLLIDE_HD_NOINLINE nearest_of_triangle nearest_to(triangle<S> const& t, vec3<S> const& centre) {
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
  vec3<double> nearest;     ///< its nearest point
  double distance;          ///< of that
  id triangle;              ///< its number in the mesh
  std::uint8_t frame;       ///< of the body; 0 of what rests
  feature kind;             ///< where in the triangle the nearest point lies
  bool is_minimum;          ///< no other triangle leads from there to what is nearer
  bool has_saddle;          ///< of a minimum: its part of the surface joins that of a nearer one
  std::uint32_t saddle;     ///< where: three times the item, plus the number of its edge
  std::uint32_t parent;     ///< the minimum of its part of the surface; of a minimum a nearer one that it has joined
  std::uint32_t neighbour;  ///< of a minimum while parts join: another, to which the lowest way leads
  std::uint32_t pass;       ///< the highest point of that way, as `saddle`,
  double pass_distance;     ///< the distance of the pass
};

/// The triangles that a sphere overlaps, the nearest first: here as long as there are few, else in memory that the
/// caller has. `Corners` is a function: the corners of an item's triangle, relative to the centre.
class overlap_list {
 public:
  static constexpr std::uint32_t capacity = 16;  ///< of the list itself

  std::uint32_t size = 0;
  std::uint32_t added = 0;  ///< how many calls of `add` there were, those with the same triangle too

  /// Points within `tolerance` of each other are one.
  COLLIDE_HD_INLINE explicit overlap_list(double tolerance) : tolerance_{tolerance} {}
  overlap_list(overlap_list const&) = delete;
  overlap_list& operator=(overlap_list const&) = delete;

  COLLIDE_HD_INLINE overlap_item const& operator[](std::uint32_t i) const { return items_[i]; }

  /// Adds a triangle, once each, also if it is added again. To what `use` gave it is appended: `sort` it then.
  COLLIDE_HD_INLINE void add(overlap_item const& item) {
    if (items_ != own_) {
      items_[size++] = item;
      return;
    }
    ++added;
    std::uint32_t at = size;
    COLLIDE_NO_UNROLL
    while (at > 0 && comes_before(item, own_[at - 1])) --at;
    if (at > 0 && own_[at - 1].triangle == item.triangle) return;
    is_full_ |= size == capacity;
    if (at == capacity) return;
    if (size < capacity) ++size;
    COLLIDE_NO_UNROLL
    for (std::uint32_t k = size - 1; k > at; --k) own_[k] = own_[k - 1];
    own_[at] = item;
  }
  /// True if there was no room for all.
  COLLIDE_HD_INLINE bool is_full() const { return is_full_; }

  /// Begins anew in memory for as many triangles as have been `added`.
  COLLIDE_HD_INLINE void use(overlap_item* memory) {
    items_ = memory;
    size = 0;
  }
  /// Sorts, and leaves out those that were added again.
  COLLIDE_HD void sort() {
    heap_sort(items_, size, [this](overlap_item const& a, overlap_item const& b) { return comes_before(a, b); });
    std::uint32_t n = 0;
    COLLIDE_NO_UNROLL
    for (std::uint32_t k = 0; k < size; ++k)
      if (n == 0 || items_[n - 1].triangle != items_[k].triangle) items_[n++] = items_[k];
    size = n;
  }

  /// Finds the minima, and the saddles that are nearer than `reach`. For n triangles, the most that are of one minimum
  /// in a row, O(n sqrt(n)) where these are of a fine mesh.
  template <class Corners>
  COLLIDE_HD void find_contacts(double reach, Corners const& corners) {
    std::uint32_t const minima = find_minima(corners);
    if (minima < 2) return;
    find_passes(minima, reach, corners);
    join(minima, reach);
  }

  /// The saddle of a minimum that has one.
  template <class Corners>
  COLLIDE_HD_INLINE vec3<double> saddle_of(overlap_item const& minimum, Corners const& corners) const {
    return nearest_on_edge(corners(items_[minimum.saddle / 3]), minimum.saddle % 3);
  }

  /// True if a minimum lies straight behind another: the far side of a plate.
  COLLIDE_HD bool is_hidden(std::uint32_t i) const {
    constexpr double straight = 1e-12;  // square of an angle
    overlap_item const& item = items_[i];
    COLLIDE_NO_UNROLL
    for (std::uint32_t k = 0; k < i; ++k) {
      if (!items_[k].is_minimum) continue;
      vec3<double> const aside = cross(items_[k].nearest, item.nearest);
      double const lengths = mul_rn(items_[k].distance, item.distance);
      if (dot(items_[k].nearest, item.nearest) > 0 && dot(aside, aside) <= mul_rn(straight, mul_rn(lengths, lengths)))
        return true;
    }
    return false;
  }

 private:
  /// A triangle is no minimum if its nearest point is one of another that is nearer. Returns how many are.
  template <class Corners>
  COLLIDE_HD std::uint32_t find_minima(Corners const& corners) {
    std::uint32_t minima = 0;
    COLLIDE_NO_UNROLL
    for (std::uint32_t i = 0; i < size; ++i) {
      overlap_item& item = items_[i];
      item.parent = i;
      item.is_minimum = true;
      item.has_saddle = false;
      COLLIDE_NO_UNROLL
      for (std::uint32_t j = i; j-- > 0 && item.is_minimum;) {  // in a fine mesh its neighbours are just before it
        if (!is_at(corners(items_[j]), item.nearest)) continue;
        item.parent = items_[j].parent;
        item.is_minimum = false;
      }
      minima += item.is_minimum;
    }
    return minima;
  }

  /// Finds a tree of the lowest ways from minimum to minimum, as R. C. Prim did.
  template <class Corners>
  COLLIDE_HD void find_passes(std::uint32_t minima, double reach, Corners const& corners) {
    COLLIDE_NO_UNROLL
    for (std::uint32_t i = 0; i < size; ++i) items_[i].neighbour = i, items_[i].pass_distance = reach;
    // of those that are in the tree, has_saddle is true here
    items_[0].has_saddle = true;
    COLLIDE_NO_UNROLL
    for (std::uint32_t last = 0; minima-- > 1;) {
      std::uint32_t next = size;
      COLLIDE_NO_UNROLL
      for (std::uint32_t i = 1; i < size; ++i) {
        if (!items_[i].is_minimum || items_[i].has_saddle) continue;
        find_pass(last, i, items_[i], last, corners);
        find_pass(i, last, items_[i], last, corners);
        if (next == size || items_[i].pass_distance < items_[next].pass_distance) next = i;
      }
      last = next;
      items_[last].has_saddle = true;
    }
    COLLIDE_NO_UNROLL
    for (std::uint32_t i = 0; i < size; ++i) items_[i].has_saddle = false;
  }

  /// Finds the nearest point in which an edge of part a of the surface meets part b, if it is nearer than the pass of
  /// `item`, whose neighbour is then `other`.
  template <class Corners>
  COLLIDE_HD void find_pass(std::uint32_t a, std::uint32_t b, overlap_item& item, std::uint32_t other,
                            Corners const& corners) {
    vec3<double> const across = items_[b].nearest - items_[a].nearest;
    double lowest = std::numeric_limits<double>::max();  // of part b, along this direction
    COLLIDE_NO_UNROLL
    for (std::uint32_t j = b; j < size; ++j) {
      if (items_[j].parent != b) continue;
      local_triangle<double> const t = corners(items_[j]);
      lowest = min(lowest, min(dot(t.a, across), min(dot(t.b, across), dot(t.c, across))));
    }
    lowest -= mul_rn(tolerance_, sqrt_rn(dot(across, across)));
    COLLIDE_NO_UNROLL
    for (std::uint32_t i = a; i < size && items_[i].distance < item.pass_distance; ++i) {
      if (items_[i].parent != a) continue;
      local_triangle<double> const t = corners(items_[i]);
      COLLIDE_NO_UNROLL
      for (std::uint32_t k = 0; k < 3; ++k) {
        vec3<double> const p = nearest_on_edge(t, k);
        double const distance = sqrt_rn(dot(p, p));
        if (!(distance < item.pass_distance) || dot(p, across) < lowest || !meets(b, p, distance, corners)) continue;
        item.neighbour = other;
        item.pass = 3 * i + k;
        item.pass_distance = distance;
      }
    }
  }
  /// Is a point in a part of the surface?
  template <class Corners>
  COLLIDE_HD bool meets(std::uint32_t root, vec3<double> const& p, double distance, Corners const& corners) const {
    COLLIDE_NO_UNROLL
    for (std::uint32_t j = root; j < size && items_[j].distance <= distance + 2 * tolerance_; ++j)
      if (items_[j].parent == root && is_at(corners(items_[j]), p)) return true;
    return false;
  }

  /// Joins parts of the surface in the order of their passes: the minimum that is farther has its saddle there.
  COLLIDE_HD void join(std::uint32_t minima, double reach) {
    COLLIDE_NO_UNROLL
    while (minima-- > 1) {
      std::uint32_t at = 0;
      COLLIDE_NO_UNROLL
      for (std::uint32_t i = 1; i < size; ++i)
        if (items_[i].is_minimum && items_[i].pass_distance < items_[at].pass_distance) at = i;
      if (!(items_[at].pass_distance < reach)) return;
      std::uint32_t const one = nearest_of(at), two = nearest_of(items_[at].neighbour), younger = max(one, two);
      items_[younger].parent = min(one, two);
      items_[younger].has_saddle = true;
      items_[younger].saddle = items_[at].pass;
      items_[at].pass_distance = std::numeric_limits<double>::max();
    }
  }
  COLLIDE_HD_INLINE std::uint32_t nearest_of(std::uint32_t i) const {
    COLLIDE_NO_UNROLL
    while (items_[i].parent != i) i = items_[i].parent;
    return i;
  }

  COLLIDE_HD_INLINE bool is_at(local_triangle<double> t, vec3<double> const& p) const {
    t.a -= p;
    t.b -= p;
    t.c -= p;
    return aabb_within(t, tolerance_) && is_at_origin(t);
  }
  COLLIDE_HD bool is_at_origin(local_triangle<double> const& t) const {
    return closest_to_origin(t, cross<double>(t.b - t.a, t.c - t.a)).distance_squared <= mul_rn(tolerance_, tolerance_);
  }
  static COLLIDE_HD_INLINE vec3<double> nearest_on_edge(local_triangle<double> const& t, std::uint32_t k) {
    vec3<double> const &from = k == 0 ? t.a : k == 1 ? t.b : t.c, &to = k == 0 ? t.b : k == 1 ? t.c : t.a;
    vec3<double> const edge = to - from;
    double const along = -dot(from, edge), squared = dot(edge, edge);
    return along > 0 ? (along < squared ? vec3<double>(from + scaled(edge, div_rn(along, squared))) : to) : from;
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

  overlap_item own_[capacity];
  overlap_item* items_ = own_;
  bool is_full_ = false;
  double tolerance_;
};

}  // namespace collide::detail
