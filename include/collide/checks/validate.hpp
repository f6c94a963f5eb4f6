/// \file
/// Checks of input: invalid or unusual triangles and spheres, and which they are.
#pragma once

#include <array>
#include <string>

#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>
#include <collide/host.hpp>
#include <collide/mesh.hpp>
#include <collide/spaces/detail/atomic.hpp>
#include <collide/spaces/detail/check_memory.hpp>
#include <collide/spheres.hpp>

namespace collide {

/// A defect of a triangle or a sphere.
enum class problem : int {
  corner_out_of_range,  ///< a triangle names a vertex that does not exist: reading it is undefined behaviour
  triangle_not_finite,  ///< a corner has a NaN or infinite coordinate: the triangle never collides
  triangle_degenerate,  ///< two corners are equal, or the cross product of two sides is zero in double: legal, a
                        ///< segment or point
  centre_not_finite,    ///< a NaN or infinite coordinate: the sphere never collides
  radius_nan,           ///< the sphere never collides
  radius_negative,      ///< the sphere is empty and never collides
  radius_infinite,      ///< legal: the sphere collides with every finite triangle
};

/// Number of kinds of problems.
inline constexpr int problem_count = 7;

/// The findings of `validate`.
class report {
 public:
  /// How many elements have the problem.
  std::uint64_t count(problem p) const { return findings_[index(p)].count; }
  /// The smallest id of an element that has the problem; `no_id` if none has.
  id first(problem p) const { return findings_[index(p)].first; }

  /// True if every element can collide: nothing found but what is legal.
  bool ok() const {
    for (int p = 0; p < problem_count; ++p) {
      if (!legal(static_cast<problem>(p)) && findings_[static_cast<std::size_t>(p)].count != 0) return false;
    }
    return true;
  }

  /// One sentence per problem found, also of the legal ones; empty if there is none.
  std::string message() const {
    std::string text;
    for (int p = 0; p < problem_count; ++p) {
      finding const f = findings_[static_cast<std::size_t>(p)];
      if (f.count == 0) continue;
      if (!text.empty()) text += "; ";
      text += std::to_string(f.count) + describe(static_cast<problem>(p)) + ", the first is number " +
              std::to_string(f.first);
    }
    return text;
  }

  /// True for what is unusual but has a defined meaning.
  static constexpr bool legal(problem p) { return p == problem::triangle_degenerate || p == problem::radius_infinite; }

  /// The count of one kind of problem, in memory of a space.
  struct finding {
    std::uint64_t count;  ///< how many elements have it
    id first;             ///< the smallest id of one; `no_id` if there is none
  };

  /// A report of these findings, one for each kind of problem. `validate` makes it.
  explicit report(std::array<finding, problem_count> const& findings) : findings_(findings) {}

 private:
  static std::size_t index(problem p) { return static_cast<std::size_t>(p); }

  static char const* describe(problem p) {
    static constexpr char const* texts[problem_count] = {" triangle(s) have a corner that is not a vertex of the mesh",
                                                         " triangle(s) have a NaN or infinite coordinate",
                                                         " triangle(s) are degenerate (a segment or a point)",
                                                         " sphere(s) have a NaN or infinite coordinate",
                                                         " sphere(s) have a NaN radius",
                                                         " sphere(s) have a negative radius",
                                                         " sphere(s) have an infinite radius"};
    return texts[index(p)];
  }

  std::array<finding, problem_count> findings_;
};

namespace detail {

/// Common part of the kernels: where findings go.
struct inspection {
  report::finding* findings;

  COLLIDE_HD void found(problem p, std::size_t i) const {
    fetch_add(&findings[static_cast<int>(p)].count, std::uint64_t{1});
    fetch_min(&findings[static_cast<int>(p)].first, static_cast<id>(i));
  }
};

/// Kernel functor of `for_each` over triangles.
template <class S>
struct inspect_triangle : inspection {
  mesh_view<S> mesh;

  inspect_triangle(report::finding* to, mesh_view<S> const& m) : inspection{to}, mesh{m} {}

  COLLIDE_HD void operator()(std::size_t i) const {
    for (unsigned k = 0; k < 3; ++k) {
      if (mesh.corner(i, k) >= mesh.vertices().size()) return this->found(problem::corner_out_of_range, i);
    }
    triangle<S> const t = mesh[i];
    if (!is_finite(t)) return this->found(problem::triangle_not_finite, i);
    vec3<double> const a = t.a.template cast<double>(), b = t.b.template cast<double>(),
                       c = t.c.template cast<double>();
    vec3<double> const n = cross<double>(b - a, c - a);
    bool const flat = n.x() == 0 && n.y() == 0 && n.z() == 0;
    if (flat || a == b || b == c || c == a) this->found(problem::triangle_degenerate, i);
  }
};

/// Kernel functor of `for_each` over spheres.
template <class S>
struct inspect_sphere : inspection {
  sphere_view<S> spheres;

  inspect_sphere(report::finding* to, sphere_view<S> const& s) : inspection{to}, spheres{s} {}

  COLLIDE_HD void operator()(std::size_t i) const {
    sphere<S> const s = spheres[i];
    if (!is_finite(s.centre)) this->found(problem::centre_not_finite, i);
    if (is_infinite(s.radius)) {
      this->found(problem::radius_infinite, i);
    } else if (!is_valid_radius(s.radius)) {
      bool const nan = (to_bits(s.radius) & ~ieee_traits<S>::sign_mask) > ieee_traits<S>::exponent_mask;
      this->found(nan ? problem::radius_nan : problem::radius_negative, i);
    }
  }
};

template <template <class> class Inspect, class Space, class View>
report inspect(Space const& space, View const& view) {
  buffer<report::finding> memory;
  auto* const to = memory.reserve(space.resource(), problem_count);
  std::array<report::finding, problem_count> findings;
  findings.fill({0, no_id});
  space.copy_from_host(to, findings.data(), findings.size());
  space.for_each(view.size(), Inspect<typename View::scalar>(to, view));
  space.copy_to_host(findings.data(), to, findings.size());
  return report(findings);
}

}  // namespace detail

/// Checks all triangles of a mesh. An index that is out of range is found without reading what it points to.
///
/// \param mesh   in memory of the space
/// \param space  where to check: pass that of a mesh in device memory, as the default is the host
/// \return what was found; `ok()` says whether every triangle can collide
/// \throws error  if CUDA knows that the space cannot read the mesh: device memory on the host, or the other way round
/// \throws cuda_error  if a CUDA call fails
/// \complexity O(triangles). Allocates some bytes, and waits for the result.
template <class S, class Space = host>
report validate(mesh_view<S> const& mesh, Space const& space = Space()) {
  detail::check_memory<Space>(mesh, "validate: the mesh is", "pass the space of that memory, as validate(mesh, space)");
  return detail::inspect<detail::inspect_triangle>(space, mesh);
}

/// Checks all spheres of a view.
///
/// \param spheres  in memory of the space
/// \param space    where to check: pass that of spheres in device memory, as the default is the host
/// \return what was found; `ok()` says whether every sphere can collide
/// \throws error  if CUDA knows that the space cannot read them: device memory on the host, or the other way round
/// \throws cuda_error  if a CUDA call fails
/// \complexity O(spheres). Allocates some bytes, and waits for the result.
template <class S, class Space = host>
report validate(sphere_view<S> const& spheres, Space const& space = Space()) {
  detail::check_memory<Space>(spheres, "validate: the spheres are",
                              "pass the space of that memory, as validate(spheres, space)");
  return detail::inspect<detail::inspect_sphere>(space, spheres);
}

}  // namespace collide
