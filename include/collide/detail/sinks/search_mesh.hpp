/// \file
/// Shared by sinks that search a mesh for each point.
#pragma once

#include <utility>

#include <collide/concepts.hpp>

namespace collide::detail {

template <class Query, class F>
using query_search = decltype(std::declval<Query const&>().search(std::declval<F const&>()));

/// Puts the search on the space's stream.
template <class Query, class F>
void search_mesh(Query const& query, F const& f) {
  static_assert(
      is_valid<query_search, Query, F>,
      "collide: nearest, k_nearest, contains, signed_distance and winding_number are of a whole mesh: not of one in "
      "passes, or divided among ranks");
  if constexpr (is_valid<query_search, Query, F>) query.search(f);
}

}  // namespace collide::detail
