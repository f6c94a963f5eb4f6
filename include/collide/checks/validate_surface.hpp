/// \file
/// Checks whether the triangles of a mesh share their edges, and where they do not: what files of CAD programs have.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <collide/checks/self_intersections.hpp>

namespace collide {

/// A place where triangles make a surface, but do not share their edges.
enum class surface_problem : int {
  hanging_node,  ///< a corner of one lies in an edge of the other, where that has no corner: a T-junction
  crack,         ///< a corner of each lie next to each other, but not in the same point
  overlap,       ///< the two lie on each other in one plane
};

/// Number of kinds of problems.
inline constexpr int surface_problem_count = 3;

/// The findings of `validate_surface`.
class surface_report {
 public:
  /// The pairs of triangles with this problem, sorted. A pair may have several.
  std::vector<triangle_pair> const& where(surface_problem p) const { return found_[static_cast<std::size_t>(p)]; }

  /// True if nothing was found.
  bool ok() const {
    return std::all_of(found_.begin(), found_.end(), [](auto const& pairs) { return pairs.empty(); });
  }

  /// One sentence per problem found; empty if there is none.
  std::string message() const {
    static constexpr char const* texts[surface_problem_count] = {
        " pair(s) of triangles where a corner hangs in an edge", " pair(s) with a crack between two corners",
        " pair(s) that overlap in a plane"};
    std::string text;
    for (std::size_t p = 0; p < found_.size(); ++p) {
      if (found_[p].empty()) continue;
      if (!text.empty()) text += "; ";
      text += std::to_string(found_[p].size()) + texts[p] + ", the first are triangles number " +
              std::to_string(found_[p].front().first) + " and " + std::to_string(found_[p].front().second);
    }
    return text;
  }

  /// A report of pairs, by problems. `validate_surface` makes it.
  explicit surface_report(std::array<std::vector<triangle_pair>, surface_problem_count> found)
      : found_(std::move(found)) {}

 private:
  std::array<std::vector<triangle_pair>, surface_problem_count> found_;
};

namespace detail {

/// A pair of triangles with a problem.
struct surface_finding {
  triangle_pair pair;
  surface_problem problem;

  friend bool operator<(surface_finding const& a, surface_finding const& b) {
    return a.problem != b.problem ? a.problem < b.problem : a.pair < b.pair;
  }
};

/// Two triangles, seen from a corner of the first, in double.
class triangles_side_by_side {
 public:
  template <class S>
  triangles_side_by_side(triangle<S> const& a, triangle<S> const& b, double tolerance)
      : first_{corners(a, a.a)}, second_{corners(b, a.a)}, tolerance_{tolerance} {}

  bool have_crack() const {
    for (auto const& p : first_)
      for (auto const& q : second_)
        if (is_near(p, q) && p != q) return true;
    return false;
  }
  bool have_hanging_node() const { return hangs(first_, second_) || hangs(second_, first_); }
  /// True if the two are in one plane, and have more than an edge of it in common.
  bool overlap() const {
    vec3<double> const normal = normal_of(first_);
    double const length = std::sqrt(dot(normal, normal));
    if (!(length > 0) || !is_in_plane(first_, second_) || !is_in_plane(second_, first_)) return false;
    std::vector<vec3<double>> common(second_.begin(), second_.end());
    double const rounding = 1e-12 * std::sqrt(length);
    for (std::size_t k = 0; k < 3; ++k) {
      vec3<double> const edge = first_[(k + 1) % 3] - first_[k], inward = cross<double>(normal, edge);
      double const scale = std::sqrt(dot(inward, inward));
      if (!(scale > 0)) return false;
      clip(common, [&](vec3<double> const& p) {
        return dot<double>(p - first_[k], inward) / scale - std::max(tolerance_, rounding);
      });
    }
    return common.size() > 2;
  }

 private:
  using corners_type = std::array<vec3<double>, 3>;

  template <class S>
  static corners_type corners(triangle<S> const& t, vec3<S> const& from) {
    vec3<double> const origin = from.template cast<double>();
    return {t.a.template cast<double>() - origin, t.b.template cast<double>() - origin,
            t.c.template cast<double>() - origin};
  }
  static vec3<double> normal_of(corners_type const& t) { return cross<double>(t[1] - t[0], t[2] - t[0]); }

  bool is_near(vec3<double> const& p, vec3<double> const& q) const {
    vec3<double> const between = p - q;
    return dot(between, between) <= tolerance_ * tolerance_;
  }
  /// Is a corner of one in an edge of the other, and near none of its corners?
  bool hangs(corners_type const& one, corners_type const& other) const {
    return std::any_of(one.begin(), one.end(), [&](vec3<double> const& p) {
      bool in_edge = false;
      for (std::size_t k = 0; k < 3; ++k) {
        if (is_near(p, other[k])) return false;
        vec3<double> const edge = other[(k + 1) % 3] - other[k];
        double const along = dot<double>(p - other[k], edge), squared = dot(edge, edge);
        in_edge = in_edge || (along > 0 && along < squared && is_near(p, other[k] + edge * (along / squared)));
      }
      return in_edge;
    });
  }
  bool is_in_plane(corners_type const& of, corners_type const& t) const {
    vec3<double> const normal = normal_of(of);
    double const limit = tolerance_ * std::sqrt(dot(normal, normal));
    return std::all_of(t.begin(), t.end(),
                       [&](vec3<double> const& p) { return std::abs(dot<double>(p - of[0], normal)) <= limit; });
  }
  /// Cuts off the part of a convex polygon where `height` is below 0: I. E. Sutherland and G. W. Hodgman,
  /// Communications of the ACM 17, 1974.
  template <class Height>
  static void clip(std::vector<vec3<double>>& polygon, Height const& height) {
    std::vector<vec3<double>> left;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      vec3<double> const &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
      double const at_p = height(p), at_q = height(q);
      if (at_p > 0) left.push_back(p);
      if ((at_p > 0) != (at_q > 0)) left.push_back(p + (q - p) * (at_p / (at_p - at_q)));
    }
    polygon = std::move(left);
  }

  corners_type first_, second_;
  double tolerance_;
};

}  // namespace detail

/// Checks whether the triangles of a surface share whole edges. Nothing in the library needs that: `granular_contact`
/// feels one wall where points are within 1e-6 of the radius of each other. It tells what a file has, and what a larger
/// tolerance would join. Triangles that are not finite are not there. Walls that cut through each other are found by
/// `self_intersections`.
///
/// \param mesh  in memory that the host can read, fewer than 2^29 triangles
/// \param tolerance  a length, not negative: points that are no farther apart are one
/// \param space  its threads work
/// \return what was found
/// \throws error  if the tolerance is negative or not finite, if a triangle names a vertex that does not exist, CUDA
///                knows that the mesh is in device memory, or there are too many triangles
/// \complexity O(n log n + k) for n triangles and vertices, where the boxes of k pairs are within the tolerance.
///             Allocates as a detector with `bvh`.
template <class S>
surface_report validate_surface(mesh_view<S> const& mesh, double tolerance, host const& space = host()) {
  if (!(tolerance >= 0) || !detail::is_finite(tolerance))
    throw error("collide: validate_surface: the tolerance is a length, not negative and finite");
  detail::check_for_pairs(mesh, "validate_surface");
  auto const all = detail::found_in_pairs<detail::surface_finding>(mesh, static_cast<S>(tolerance), space, [&](id i) {
    return [&, i, first = mesh[i]](id other, std::vector<detail::surface_finding>& to) {
      detail::triangles_side_by_side const pair(first, mesh[other], tolerance);
      if (pair.have_hanging_node()) to.push_back({{i, other}, surface_problem::hanging_node});
      if (pair.have_crack()) to.push_back({{i, other}, surface_problem::crack});
      if (pair.overlap()) to.push_back({{i, other}, surface_problem::overlap});
    };
  });
  std::array<std::vector<triangle_pair>, surface_problem_count> found;
  for (auto const& f : all) found[static_cast<std::size_t>(f.problem)].push_back(f.pair);
  return surface_report(std::move(found));
}

}  // namespace collide
