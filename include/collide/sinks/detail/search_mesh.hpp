/// \file
/// Shared by sinks that search a mesh, or each part of a mesh, for each point.
#pragma once

#include <cstddef>
#include <utility>

#include <collide/core/contact.hpp>
#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/mesh.hpp>
#include <collide/query/concepts.hpp>
#include <collide/spaces/detail/algorithms.hpp>

namespace collide::detail {

template <class Query, class F>
using query_search = decltype(std::declval<Query const&>().search(std::declval<F const&>()));

template <class F>
struct search_part {
  F f;

  template <class Space, class Query>
  void run(Space&, Query const& query) const {
    query.search(f);
  }
};

/// The query of a sink that searches a mesh in parts, as it sees it. `Search` is a function search(spheres, f).
template <class Detector, class Search>
struct search_query {
  using narrow_phase = typename Detector::narrow_phase;
  using scalar = typename Detector::scalar;

  typename Detector::spheres_type const& spheres;
  Search const& search_parts;

  template <class F>
  void search(F const& f) const {
    search_parts(spheres, f);
  }
};

/// Puts the search on the space's stream.
template <class Query, class F>
void search_mesh(Query const& query, F const& f) {
  static_assert(
      is_valid<query_search, Query, F>,
      "collide: k_nearest, contains, signed_distance and winding_number are of a whole mesh: not of one in passes, or "
      "divided among ranks, as nearest may be");
  if constexpr (is_valid<query_search, Query, F>) query.search(f);
}

/// Numbers of some of a whole: a plain value.
struct numbering {
  id first;           ///< the number of the first; they follow each other,
  id const* numbers;  ///< unless they are here

  COLLIDE_HD id operator[](id i) const { return numbers != nullptr ? numbers[i] : first + i; }
};

/// Some triangles of a mesh: a plain value.
template <class S>
struct mesh_subset {
  mesh_view<S> triangles;
  numbering number_of;

  /// The last place whose triangle has a number up to `t`, if the numbers rise; 0 if there is none.
  COLLIDE_HD id find(id t) const {
    auto const is_before = [&](std::size_t k) { return number_of[static_cast<id>(k)] <= t; };
    return static_cast<id>(first_not_before(std::size_t{1}, triangles.size(), is_before) - 1);
  }
  COLLIDE_HD bool has_at(id place, id t) const { return place < triangles.size() && number_of[place] == t; }
};

/// Kernel functor of `for_each` over pairs of spheres and triangles that are some of others: as pairs of the whole.
struct renumber_pairs {
  pair const* from;
  numbering sphere, triangle;
  pair* to;

  COLLIDE_HD void operator()(std::size_t i) const { to[i] = {sphere[from[i].sphere], triangle[from[i].triangle]}; }
};

template <class S>
struct numbered_triangle {
  id number;
  S corners[9];

  COLLIDE_HD static numbered_triangle of(id number, triangle<S> const& t) {
    return {number, {t.a[0], t.a[1], t.a[2], t.b[0], t.b[1], t.b[2], t.c[0], t.c[1], t.c[2]}};
  }
  COLLIDE_HD triangle<S> shape() const {
    return {{corners[0], corners[1], corners[2]},
            {corners[3], corners[4], corners[5]},
            {corners[6], corners[7], corners[8]}};
  }
  aabb<double> box() const {
    aabb<S> const b = aabb_of(shape());
    if (b.is_empty()) return aabb<double>::empty();
    return {{double(b.lower[0]), double(b.lower[1]), double(b.lower[2])},
            {double(b.upper[0]), double(b.upper[1]), double(b.upper[2])}};
  }
  friend bool operator<(numbered_triangle const& a, numbered_triangle const& b) { return a.number < b.number; }
};

/// Kernel functor of `for_each` over triangles: their corners, packed.
template <class S>
struct pack_triangles {
  mesh_view<S> mesh;
  S* to;
  COLLIDE_HD void operator()(std::size_t i) const {
    triangle<S> const t = mesh[i];
    for (unsigned k = 0; k < 3; ++k) {
      to[9 * i + k] = t.a[k];
      to[9 * i + 3 + k] = t.b[k];
      to[9 * i + 6 + k] = t.c[k];
    }
  }
};

}  // namespace collide::detail
