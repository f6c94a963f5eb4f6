/// \file
/// Checks whether a mesh is closed and oriented, and where it is not: what `contains` and `signed_distance` need.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <collide/core/error.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/host.hpp>
#include <collide/mesh.hpp>
#include <collide/spaces/detail/check_memory.hpp>

namespace collide {

/// A defect of a mesh that is to be the boundary of a solid.
enum class seam_problem : int {
  open_edge,       ///< an edge of one triangle only: the mesh has a hole there, and an inside no more
  crowded_edge,    ///< an edge of three triangles or more
  flipped_edge,    ///< an edge of two triangles that both go along it in the same direction: their normals disagree
  duplicate_face,  ///< a triangle with the same three corners as one with a smaller id
};

/// Number of kinds of problems.
inline constexpr int seam_problem_count = 4;

/// An edge of a triangle.
struct triangle_edge {
  id triangle;         ///< number of the triangle
  std::uint32_t edge;  ///< 0 = ab, 1 = bc, 2 = ca; of a duplicate face 0
};

/// The findings of `validate_closed`.
class seam_report {
 public:
  /// The edges and faces with this problem, by rising number of the triangle: one entry for each open edge, flipped
  /// edge and duplicate face, and one for each triangle at a crowded edge. A flipped edge is named by the triangle of
  /// the larger id.
  std::vector<triangle_edge> const& where(seam_problem p) const { return found_[static_cast<std::size_t>(p)]; }

  /// True if every edge has an even number of triangles: then there is an inside, which `contains` finds.
  bool closed() const { return odd_edges_ == 0; }
  /// True if at every edge as many triangles go along it in one direction as in the other: then it has normals that
  /// point to one side, and winding numbers that are whole.
  bool oriented() const { return unbalanced_edges_ == 0; }
  /// True if nothing was found.
  bool ok() const {
    return closed() && oriented() &&
           std::all_of(found_.begin(), found_.end(), [](auto const& edges) { return edges.empty(); });
  }

  /// One sentence per problem found; empty if there is none.
  std::string message() const {
    static constexpr char const* texts[seam_problem_count] = {
        " open edge(s), of one triangle only", " time(s) a triangle is at an edge of three or more",
        " edge(s) where two triangles have normals that disagree", " triangle(s) are there twice"};
    std::string text;
    for (std::size_t p = 0; p < found_.size(); ++p) {
      if (found_[p].empty()) continue;
      triangle_edge const first = found_[p].front();
      if (!text.empty()) text += "; ";
      text += std::to_string(found_[p].size()) + texts[p] + ", the first is ";
      if (static_cast<seam_problem>(p) != seam_problem::duplicate_face)
        text += "edge " + std::to_string(first.edge) + " of ";
      text += "triangle number " + std::to_string(first.triangle);
    }
    return text;
  }

  /// A report of what was found at each edge. `validate_closed` makes it.
  seam_report(std::array<std::vector<triangle_edge>, seam_problem_count> found, std::size_t odd_edges,
              std::size_t unbalanced_edges)
      : found_(std::move(found)), odd_edges_(odd_edges), unbalanced_edges_(unbalanced_edges) {}

 private:
  std::array<std::vector<triangle_edge>, seam_problem_count> found_;
  std::size_t odd_edges_, unbalanced_edges_;
};

namespace detail {

/// For each vertex the smallest number of one with the same coordinates.
template <class S>
std::vector<std::uint32_t> merged_vertices(point_view<S> const& vertices) {
  struct place {
    std::array<uint_for<S>, 3> at;  ///< sorts like the coordinates, and tells subnormal ones apart in any mode
    std::uint32_t number;
  };
  std::vector<place> places(vertices.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    vec3<S> const v = vertices[i];
    for (int k = 0; k < 3; ++k) {
      bool const is_zero = (to_bits(v[k]) & ~ieee_traits<S>::sign_mask) == 0;
      places[i].at[static_cast<std::size_t>(k)] = to_ordered_bits(is_zero ? S(0) : v[k]);
    }
    places[i].number = static_cast<std::uint32_t>(i);
  }
  std::sort(places.begin(), places.end(),
            [](place const& p, place const& q) { return p.at != q.at ? p.at < q.at : p.number < q.number; });
  std::vector<std::uint32_t> merged(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    bool const same = i != 0 && places[i].at == places[i - 1].at;
    merged[places[i].number] = same ? merged[places[i - 1].number] : places[i].number;
  }
  return merged;
}

/// Throws `error` of a function if a triangle names a vertex that does not exist.
template <class S>
void check_corners(mesh_view<S> const& mesh, char const* function) {
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    for (unsigned k = 0; k < 3; ++k) {
      if (mesh.corner(i, k) < mesh.vertices().size()) continue;
      throw error("collide: " + std::string(function) + ": triangle number " + std::to_string(i) +
                  " has a corner that is not a vertex of the mesh");
    }
  }
}

/// A triangle at an edge between two vertices, of which `low` has the smaller number.
struct seam {
  std::uint32_t low, high;
  id triangle;
  std::uint32_t edge;
  bool rises;  ///< the triangle goes from `low` to `high`

  friend bool operator<(seam const& p, seam const& q) {
    if (p.low != q.low) return p.low < q.low;
    if (p.high != q.high) return p.high < q.high;
    return p.triangle != q.triangle ? p.triangle < q.triangle : p.edge < q.edge;
  }
};

/// A triangle by its vertices, sorted.
struct face {
  std::array<std::uint32_t, 3> corners;
  id triangle;

  friend bool operator<(face const& p, face const& q) {
    return p.corners != q.corners ? p.corners < q.corners : p.triangle < q.triangle;
  }
};

}  // namespace detail

/// Checks whether a mesh is the boundary of a solid. Vertices of equal coordinates are one, so triangle soups can be
/// closed. Triangles that are not finite, or have two equal corners, are not there. Triangles that cut through each
/// other are found by `self_intersections`.
///
/// \param mesh  in memory that the host can read
/// \return what was found; `closed()` says whether `contains` has an inside to find
/// \throws error  if a triangle names a vertex that does not exist, or CUDA knows that the mesh is in device memory
/// \complexity O(n log n) for n triangles and vertices, on one thread. Allocates 100 bytes for each triangle.
template <class S>
seam_report validate_closed(mesh_view<S> const& mesh) {
  detail::check_memory<host>(mesh, "validate_closed: the mesh is", "copy it to the host");
  detail::check_corners(mesh, "validate_closed");
  auto const merged = detail::merged_vertices(mesh.vertices());
  std::vector<detail::seam> seams;
  std::vector<detail::face> faces;
  seams.reserve(3 * mesh.size());
  faces.reserve(mesh.size());
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    std::array<std::uint32_t, 3> v{merged[mesh.corner(i, 0)], merged[mesh.corner(i, 1)], merged[mesh.corner(i, 2)]};
    if (!detail::is_finite(mesh[i]) || v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    auto const triangle = static_cast<id>(i);
    for (unsigned k = 0; k < 3; ++k) {
      std::uint32_t const from = v[k], to = v[(k + 1) % 3];
      seams.push_back({std::min(from, to), std::max(from, to), triangle, k, from < to});
    }
    std::sort(v.begin(), v.end());
    faces.push_back({v, triangle});
  }
  std::sort(seams.begin(), seams.end());
  std::sort(faces.begin(), faces.end());

  std::array<std::vector<triangle_edge>, seam_problem_count> found;
  auto const add = [&](seam_problem p, id triangle, std::uint32_t edge) {
    found[static_cast<std::size_t>(p)].push_back({triangle, edge});
  };
  std::size_t odd = 0, unbalanced = 0;
  for (std::size_t begin = 0, end; begin < seams.size(); begin = end) {
    std::size_t rising = 0;
    for (end = begin; end < seams.size() && seams[end].low == seams[begin].low && seams[end].high == seams[begin].high;
         ++end)
      rising += seams[end].rises ? 1 : 0;
    std::size_t const count = end - begin;
    odd += count % 2;
    unbalanced += 2 * rising != count ? 1 : 0;
    if (count == 1) add(seam_problem::open_edge, seams[begin].triangle, seams[begin].edge);
    if (count == 2 && rising != 1) add(seam_problem::flipped_edge, seams[begin + 1].triangle, seams[begin + 1].edge);
    for (std::size_t i = begin; count > 2 && i < end; ++i)
      add(seam_problem::crowded_edge, seams[i].triangle, seams[i].edge);
  }
  for (std::size_t i = 1; i < faces.size(); ++i) {
    if (faces[i].corners == faces[i - 1].corners) add(seam_problem::duplicate_face, faces[i].triangle, 0);
  }
  for (auto& edges : found) {
    std::sort(edges.begin(), edges.end(), [](triangle_edge const& p, triangle_edge const& q) {
      return p.triangle != q.triangle ? p.triangle < q.triangle : p.edge < q.edge;
    });
  }
  return {std::move(found), odd, unbalanced};
}

}  // namespace collide
