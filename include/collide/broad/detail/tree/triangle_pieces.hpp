/// \file
/// Long thin triangles that lie across the axes, cut into pieces with a box each, which hold far less space than one
/// around all (M. Stich, H. Friedrich, A. Dietrich, "Spatial splits in bounding volume hierarchies", 2009; here before
/// the tree is made). For the host.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <collide/broad/detail/grid/grid.hpp>
#include <collide/broad/detail/tree/tree_node.hpp>
#include <collide/core/memory.hpp>
#include <collide/exact/detail/geometry/bounding_sphere.hpp>
#include <collide/exact/detail/geometry/closest_point.hpp>
#include <collide/exact/detail/geometry/local_triangle.hpp>
#include <collide/mesh.hpp>
#include <collide/spaces/detail/algorithms.hpp>

namespace collide::detail {

/// A box of some of a triangle.
struct triangle_piece {
  aabb<float> box;
  id triangle;
  std::uint32_t before;  ///< how many pieces of the triangle there are before this one
};

/// Makes boxes wider such that from piece to piece they go one way on each axis: those that overlap any box then
/// follow each other.
inline void make_monotone(triangle_piece* of, std::uint32_t n) {
  for (int j = 0; j < 3; ++j) {
    aabb<float> const &first = of[0].box, &last = of[n - 1].box;
    bool const rises = first.lower[j] + first.upper[j] <= last.lower[j] + last.upper[j];
    for (std::uint32_t k = 1; k < n; ++k) {
      std::uint32_t const up = rises ? k : n - 1 - k, down = rises ? n - 1 - k : k;  // where it comes from is done
      of[up].box.upper[j] = max(of[up].box.upper[j], of[rises ? up - 1 : up + 1].box.upper[j]);
      of[down].box.lower[j] = min(of[down].box.lower[j], of[rises ? down + 1 : down - 1].box.lower[j]);
    }
  }
}

/// A triangle, as far as that decides into how many pieces it is cut.
struct triangle_shape {
  double half_surface = 0;  ///< of its box
  double area = 0;
  double length = 0;  ///< of its longest edge

  template <class S>
  explicit triangle_shape(triangle<S> const& t) {
    if (!is_finite(t)) return;
    vec3<double> const a = t.a.template cast<double>(), u = t.b.template cast<double>() - a,
                       v = t.c.template cast<double>() - a;
    vec3<double> const lowest = min(min<double>(u, v), vec3<double>(0, 0, 0)),
                       sides = max(max<double>(u, v), vec3<double>(0, 0, 0)) - lowest;
    half_surface = sides.x() * sides.y() + (sides.y() * sides.z() + sides.z() * sides.x());
    area = std::sqrt(cross(u, v).squaredNorm()) / 2;
    length = std::sqrt(std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()}));
  }

  /// The surface that its box has more than that of a triangle of its area that is not long and thin.
  double wasted() const {
    double const w = half_surface - 8 * area;
    return w > 0 ? w : 0;
  }
};

template <class S>
aabb<double> wide_box_of(triangle<S> const& t) {
  aabb<S> const b = triangle_aabb_of(t);
  aabb<double> wide;
  for (int k = 0; k < 3; ++k) {
    wide.lower[k] = static_cast<double>(b.lower[k]);
    wide.upper[k] = static_cast<double>(b.upper[k]);
  }
  return b.is_empty() ? aabb<double>::empty() : wide;
}

/// The part of a box that another has. Each counts as a bit wider, so that flat ones have a volume.
inline double share_of_box(aabb<double> const& all, aabb<double> const& b) {
  double const lowest = all.max_extent() / 1024;
  double share = b.is_empty() ? 0 : 1;
  for (int k = 0; k < 3; ++k) share *= (b.upper[k] - b.lower[k] + lowest) / (all.upper[k] - all.lower[k] + lowest);
  return share;
}

/// Into how many pieces triangles are cut in the mean: a place in the box of the mesh is in so many boxes of
/// triangles, and of k pieces of each in that by k^2, as each has a part of 1 / k^3 of the volume.
inline int wanted_pieces(double around) {
  constexpr double few = 2;  // boxes; docs/development/experiments.md
  double const pieces = std::sqrt(around / few);
  return pieces < 16 ? static_cast<int>(max(pieces, 2.0)) : 16;
}

/// How many pieces more than triangles there may be, as many as are wanted in the mean: at most 15 for each triangle,
/// and not more than 3 where these are more than 2^18.
inline std::size_t extra_pieces(std::size_t triangles, int wanted) {
  return min(max(3 * triangles, std::size_t{1} << 18), static_cast<std::size_t>(wanted - 1) * triangles);
}

template <class S>
class triangle_pieces {
 public:
  /// Returns how many pieces there are, those of a triangle next to each other; 0 if nothing is cut. There are as many
  /// as leave a place in a few boxes of others; at most 16 for each triangle, and not more than 4 where these are more
  /// than 2^18 more.
  template <class Space>
  std::size_t build(Space& space, mesh_view<S> const& mesh) {
    std::size_t const n = mesh.size();
    struct sum {
      double wasted, roots, all;
    };
    sum const total = sum_of_parts<sum>(
        space, mesh, {},
        [](sum& to, triangle<S> const& t) {
          triangle_shape const s(t);
          double const w = s.wasted();
          to = {to.wasted + w, to.roots + std::sqrt(w), to.all + s.half_surface};
        },
        [](sum& to, sum const& s) {
          to = {to.wasted + s.wasted, to.roots + s.roots, to.all + s.all};
        });
    if (!(total.wasted > total.all / 2) || !std::isfinite(total.all)) return 0;
    std::uint32_t* const first = first_.reserve(space.resource(), n + 1);
    std::size_t const extra = extra_pieces(n, wanted_pieces(boxes_around(space, mesh)));
    space.for_each(n, [&](std::size_t i) {
      first[i] = pieces_of(triangle_shape(mesh[i]), static_cast<double>(extra) / total.roots);
    });
    first[n] = 0;
    exclusive_scan(space, first, n + 1);
    size_ = first[n];
    triangle_piece* const to = pieces_.reserve(space.resource(), n + extra);
    space.for_each(n, [&](std::size_t i) { cut(mesh, i, to + first[i], first[i + 1] - first[i]); });
    return size_;
  }

  /// Moves the boxes to where the triangles of a mesh are now, as many as the last build had.
  template <class Space>
  void refit(Space& space, mesh_view<S> const& mesh) {
    std::uint32_t const* const first = first_.data();
    space.for_each(mesh.size(),
                   [&](std::size_t i) { cut(mesh, i, pieces_.data() + first[i], first[i + 1] - first[i]); });
  }

  triangle_piece const* data() const { return pieces_.data(); }

 private:
  static constexpr int capacity = 64;  ///< pieces of a triangle

  /// A sum over the triangles of a mesh, the same however many threads there are.
  template <class Sum, class Space, class Add, class Join>
  static Sum sum_of_parts(Space& space, mesh_view<S> const& mesh, Sum const& nothing, Add const& add,
                          Join const& join) {
    constexpr std::size_t parts = 64;
    Sum sums[parts];
    std::size_t const n = mesh.size(), share = (n + parts - 1) / parts;
    for_each_block(space, parts, [&](std::size_t p) {
      sums[p] = nothing;
      for (std::size_t i = p * share; i < n && i < (p + 1) * share; ++i) add(sums[p], mesh[i]);
    });
    Sum all = nothing;
    for (Sum const& s : sums) join(all, s);
    return all;
  }

  /// In how many boxes of triangles a place in the box of the mesh is.
  template <class Space>
  static double boxes_around(Space& space, mesh_view<S> const& mesh) {
    using box = aabb<double>;
    auto const join = [](box& to, box const& b) { to = typename box::merge{}(to, b); };
    box const all = sum_of_parts<box>(
        space, mesh, box::empty(), [&](box& to, triangle<S> const& t) { join(to, wide_box_of(t)); }, join);
    return sum_of_parts<double>(
        space, mesh, 0.0, [&](double& to, triangle<S> const& t) { to += share_of_box(all, wide_box_of(t)); },
        [](double& to, double share) { to += share; });
  }

  /// In proportion to what makes the sum of the boxes least, but none shorter than wide.
  static std::uint32_t pieces_of(triangle_shape const& s, double for_root) {
    double const wanted = 1 + std::sqrt(s.wasted()) * for_root;
    double const slender = s.area > 0 ? s.length * s.length / (2 * s.area) : capacity;
    return static_cast<std::uint32_t>(min(min(wanted, max(slender, 1.0)), static_cast<double>(capacity)));
  }

  /// Cuts a triangle by planes at equal distances across the longest side of its box.
  static void cut(mesh_view<S> const& mesh, std::size_t i, triangle_piece* to, std::uint32_t n) {
    triangle<S> const t = mesh[i];
    vec3<S> const origin = tree_origin(mesh);
    aabb<float> const whole = tree_box_of(t, origin);
    for (std::uint32_t k = 0; k < n; ++k) to[k] = {whole, static_cast<id>(i), k};
    if (n == 1 || whole.is_empty()) return;
    vec3<double> corners[3];
    int c = 0;
    for (auto const* p : {&t.a, &t.b, &t.c}) corners[c++] = p->template cast<double>() - origin.template cast<double>();
    vec3<double> const lower = min(min(corners[0], corners[1]), corners[2]);
    vec3<double> const sides = max(max(corners[0], corners[1]), corners[2]) - lower;
    int const axis = sides[0] >= sides[1] && sides[0] >= sides[2] ? 0 : (sides[1] >= sides[2] ? 1 : 2);
    float const padding = float_above(triangle_aabb_of(t).padding);
    for (std::uint32_t k = 0; k < n; ++k) {
      double const from = lower[axis] + sides[axis] * k / n, until = lower[axis] + sides[axis] * (k + 1) / n;
      aabb<double> const box = box_between(corners, axis, from, until);
      if (box.is_empty()) continue;
      for (int j = 0; j < 3; ++j) {
        to[k].box.lower[j] = max(whole.lower[j], below(float_below(box.lower[j]) - padding));
        to[k].box.upper[j] = min(whole.upper[j], above(float_above(box.upper[j]) + padding));
      }
    }
    make_monotone(to, n);
  }

  /// The box around what of a triangle is between two planes.
  static aabb<double> box_between(vec3<double> const (&corners)[3], int axis, double from, double until) {
    aabb<double> box = aabb<double>::empty();
    for (int c = 0; c < 3; ++c) {
      vec3<double> const &a = corners[c], &b = corners[(c + 1) % 3];
      double const begin = a[axis], along = b[axis] - begin;
      if (min(begin, b[axis]) > until || max(begin, b[axis]) < from) continue;
      for (double const plane : {from, until}) {
        // of an edge along the planes both ends
        double const fraction = along != 0 ? saturate((plane - begin) / along) : (plane == from ? 0.0 : 1.0);
        for (int j = 0; j < 3; ++j) {
          double const x = a[j] + fraction * (b[j] - a[j]);
          box.lower[j] = min(box.lower[j], x);
          box.upper[j] = max(box.upper[j], x);
        }
      }
    }
    return box;
  }

  buffer<std::uint32_t> first_;
  buffer<triangle_piece> pieces_;
  std::size_t size_ = 0;
};

/// The mean numbers, for a sphere, of triangles whose box it reaches, of those of them that are candidates in a grid,
/// of those of which it reaches the box of a piece, as trees have them, and of those that it reaches itself.
struct reached_by_sphere {
  double boxes, candidates, pieces, triangles;
};

/// Which pairs grids would make candidates of, before triangles are entered; all if there are no grids.
template <class S>
struct planned_candidates {
  grid<S> const* grids = nullptr;  ///< in memory of the host
  int count = 0;

  /// For a triangle's box, a sphere's radius, and the square of their distance.
  bool operator()(aabb<S> const& box, S radius, S distance_squared) const {
    int g = count - 1;  // the tightest that serves it
    while (g >= 0 && !grids[g].serves(radius)) --g;
    if (g < 0 || grids[g].levels == 0) return true;
    grid_level<S> const& l = grids[g].level_of(box);
    cell_box const r = grids[g].range_of(l, box);
    for (int k = 0; k < 3; ++k) {
      if (r.upper[k] - r.lower[k] > l.mask[k]) return true;  // it goes around: see triangle_cells.hpp
    }
    S const far = grids[g].padded_reach + S(0.6) * l.width;  // a place in a cell from the middle of it
    return distance_squared <= far * far;
  }
};

/// In place of spheres, if none are known yet: one in the middle of each triangle. A sample of them lies between the
/// triangles of a sample as large: each at one of these would stand for many that touch as many.
template <class S>
struct middles_as_spheres {
  mesh_view<S> mesh;
  S radius;

  std::size_t size() const { return mesh.size(); }
  sphere<S> operator[](std::size_t i) const {
    triangle<S> const t = mesh[(i + mesh.size() / 256) % mesh.size()];
    return {t.a / S(3) + t.b / S(3) + t.c / S(3), radius};
  }
};

/// Triangles of a mesh at equal distances in its order, and what they tell of a scene. They are as many in a large mesh
/// as in a small one, so all of this takes some microseconds, and spheres a tenth of a millisecond.
template <class S>
class sampled_triangles {
 public:
  static constexpr std::size_t capacity = 128;

  explicit sampled_triangles(mesh_view<S> const& mesh, std::size_t max_count = capacity)
      : all_{mesh.size()}, count_{0} {
    std::size_t const n = min(all_, max_count);
    double wasted = 0, surface = 0;
    aabb<double> all = aabb<double>::empty();
    for (std::size_t i = 0; i < n; ++i) {
      triangle<S> const t = mesh[all_ / n * i + all_ % n * i / n];
      triangle_shape const shape(t);
      if (!is_finite(t)) continue;
      wasted += shape.wasted();
      surface += shape.half_surface;
      boxes_[count_] = triangle_aabb_of(t);
      triangles_[count_++] = t;
      all = aabb<double>::merge{}(all, wide_box_of(t));
    }
    // more than that is cut into pieces
    are_slender_ = wasted > surface / 2 && is_finite(surface);
    if (!are_slender_) return;
    double around = 0;
    for (int k = 0; k < count_; ++k) around += share_of_box(all, wide_box_of(triangles_[k]));
    auto const of = static_cast<double>(all_);
    pieces_ = 1 + static_cast<double>(extra_pieces(all_, wanted_pieces(around * of / count_))) / of;
  }

  /// True if their boxes are mostly empty.
  bool are_slender() const { return are_slender_; }

  /// Into how many pieces a tree cuts them, in the mean.
  double pieces() const { return pieces_; }

  /// The mean number of triangles whose box spheres reach, from at most so many of them.
  template <class Spheres>
  double boxes(Spheres const& spheres, std::size_t max_spheres) const {
    std::size_t reached = 0;
    each_sample(spheres, max_spheres, [&](sphere<S> const& s) {
      for (int k = 0; k < count_; ++k) reached += boxes_[k].overlaps(s.centre, s.radius);
    });
    return static_cast<double>(reached) * scale(min(spheres.size(), max_spheres));
  }

  /// The mean of what spheres reach, at rest or in motion, from at most so many of them.
  template <class Spheres>
  reached_by_sphere reached(Spheres const& spheres, std::size_t max_spheres,
                            planned_candidates<S> const& is_candidate = {}) const {
    reached_by_sphere sum{0, 0, 0, 0};
    each_sample(spheres, max_spheres, [&](sphere<S> const& s) {
      for (int k = 0; k < count_; ++k) {
        triangle_aabb<S> const& box = boxes_[k];
        if (!box.overlaps(s.centre, s.radius)) continue;
        S const square = distance_squared(triangles_[k], s);
        S const x = box.upper[0] - box.lower[0], y = box.upper[1] - box.lower[1], z = box.upper[2] - box.lower[2];
        S const aside = max(min(x, y), min(max(x, y), z));  // the longer side of the box that is not its longest
        S const near_piece = s.radius + aside / static_cast<S>(2 * pieces_);
        sum.boxes += 1;
        sum.candidates += is_candidate(box, s.radius, square);
        sum.pieces += square <= near_piece * near_piece;
        sum.triangles += square <= s.radius * s.radius;
      }
    });
    double const of_all = scale(min(spheres.size(), max_spheres));
    return {sum.boxes * of_all, sum.candidates * of_all, sum.pieces * of_all, sum.triangles * of_all};
  }

 private:
  template <class Spheres, class F>
  static void each_sample(Spheres const& spheres, std::size_t max_spheres, F const& f) {
    std::size_t const n = min(spheres.size(), max_spheres);
    for (std::size_t i = 0; i < n; ++i) {
      sphere<S> const s = swept_bounding_sphere(spheres[spheres.size() / n * i + spheres.size() % n * i / n]);
      if (is_valid_radius(s.radius) && is_finite(s.centre) && is_finite(s.radius)) f(s);
    }
  }

  /// The factor from the triangles that so many spheres found to the mean of all of them.
  double scale(std::size_t spheres) const {
    double const asked = static_cast<double>(spheres) * count_;
    return asked == 0 ? 0 : static_cast<double>(all_) / asked;
  }

  static S distance_squared(triangle<S> const& t, sphere<S> const& s) {
    local_triangle<S> const l = to_local<S>(t, s);
    return closest_to_origin(l, cross<S>(l.b - l.a, l.c - l.a)).distance_squared;
  }

  triangle<S> triangles_[capacity];
  triangle_aabb<S> boxes_[capacity];
  std::size_t all_;  ///< of the mesh
  int count_;        ///< that are finite
  bool are_slender_;
  double pieces_ = 1;
};

}  // namespace collide::detail
