/// \file
/// A reference without a grid: every triangle is a candidate. The members are those of triangle_ref.hpp.
#pragma once

#include <cstdint>

#include <collide/detail/grid/triangle_ref.hpp>

namespace collide::detail {

/// The lookup of `all_pairs`.
template <class S>
struct all_pairs_ref : triangle_ref<S> {
  COLLIDE_HD all_pairs_ref const& without_overflown_grids() const { return *this; }
  template <class Sphere>
  COLLIDE_HD bool next(Sphere const&, candidate_cursor& c, std::uint32_t most, candidate_range& range) const {
    return this->next_of_all(c, most, range);
  }
};

}  // namespace collide::detail
