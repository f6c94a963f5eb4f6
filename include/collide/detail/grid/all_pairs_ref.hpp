/// \file
/// What a kernel asks where there is no grid: every triangle is a candidate. The members are those of triangle_ref.hpp.
#pragma once

#include <cstdint>

#include <collide/detail/grid/occupancy.hpp>
#include <collide/detail/grid/triangle_ref.hpp>

namespace collide::detail {

/// The lookup of `all_pairs`.
template <class S>
struct all_pairs_lookup : triangle_lookup<S> {
  COLLIDE_HD all_pairs_lookup const& opened() const { return *this; }

  template <class Ball>
  COLLIDE_HD bool empty(Ball const&) const {
    return this->mesh.size() == 0;
  }
  COLLIDE_HD bool is_simple(S) const { return false; }
  COLLIDE_HD cell_marks<S> marks() const { return {}; }
  template <class Ball>
  COLLIDE_HD candidate_cursor begin(Ball const&) const {
    return {0, 0, 0, 0};
  }
  template <class Ball>
  COLLIDE_HD bool next(Ball const&, candidate_cursor& c, std::uint32_t most, candidate_range& range) const {
    return this->next_of_all(c, most, range);
  }
};

}  // namespace collide::detail
