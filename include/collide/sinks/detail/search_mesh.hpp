/// \file
/// Shared by sinks that search a mesh for each point.
#pragma once

#include <utility>

#include <collide/query/concepts.hpp>

namespace collide::detail {

template <class Query, class F>
using query_search = decltype(std::declval<Query const&>().search(std::declval<F const&>()));

/// A sink that searches one of the parts of a mesh.
template <class F>
struct search_part {
  F f;

  template <class Space, class Query>
  void run(Space&, Query const& query) const {
    query.search(f);
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

}  // namespace collide::detail
