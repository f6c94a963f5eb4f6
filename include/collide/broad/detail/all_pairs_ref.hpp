/// \file
/// A reference without a grid: every triangle is a candidate. The members are those of mesh_lookup.hpp.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/broad/detail/mesh_lookup.hpp>

namespace collide::detail {

/// The lookup of `all_pairs`.
template <class S>
struct all_pairs_ref : mesh_lookup<S> {
  COLLIDE_HD all_pairs_ref const& opened() const { return *this; }
  template <class Sphere>
  COLLIDE_HD bool next(Sphere const&, candidate_cursor& c, std::uint32_t most, candidate_range& range) const {
    return this->next_of_all(c, most, range);
  }

  /// Calls f(triangle) for every triangle, whatever the bound is that it returns.
  template <class F>
  COLLIDE_HD void for_each_nearer(vec3<S> const&, S, F const& f) const {
    for (std::size_t t = 0; t < this->mesh.size(); ++t) f(static_cast<id>(t));
  }

  /// Calls f(triangle) for every triangle, as long as that returns true.
  template <class F>
  COLLIDE_HD void for_each_on_ray(vec3<S> const&, F const& f) const {
    for (std::size_t t = 0; t < this->mesh.size() && f(static_cast<id>(t)); ++t) {
    }
  }
};

}  // namespace collide::detail
