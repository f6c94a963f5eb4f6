/// \file
/// What a kernel asks where there is no grid: every triangle is a candidate. The members are those of triangle_ref.hpp.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/detail/grid/occupancy.hpp>
#include <collide/detail/grid/triangle_ref.hpp>

namespace collide::detail {

/// The lookup of `all_pairs`.
template <class S>
struct all_pairs_ref : triangle_ref<S> {
  COLLIDE_HD all_pairs_ref const& without_overflown_grids() const { return *this; }

  template <class Sphere>
  COLLIDE_HD bool empty(Sphere const&) const {
    return this->mesh.size() == 0;
  }
  COLLIDE_HD bool has_single_cell_lookup(S) const { return false; }
  COLLIDE_HD occupancy_view<S> occupancy() const { return {}; }
  template <class Sphere>
  COLLIDE_HD candidate_cursor begin(Sphere const&) const {
    return {0, 0, 0, 0};
  }
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
