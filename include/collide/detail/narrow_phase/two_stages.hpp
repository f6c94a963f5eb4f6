/// \file
/// A pair's verdict in two stages: what is quick to tell, and what that leaves open.
#pragma once

#include <collide/detail/narrow_phase/intersects.hpp>

namespace collide::detail {

/// Whether a sphere touches a triangle, where the narrow phase is quick to tell. `uncertain` is left to `resolve`,
/// which takes long: where threads run together, as few of them as possible should go through it.
template <class NarrowPhase, class S, class Sphere>
COLLIDE_HD_INLINE verdict filter(triangle<S> const& t, Sphere const& s) {
  if constexpr (filtered_predicate<NarrowPhase>::value) {
    return filtered_predicate<NarrowPhase>::filter(t, s);
  } else {
    return NarrowPhase::intersects(t, s) ? verdict::hit : verdict::miss;
  }
}

/// Whether a sphere touches a triangle of which `filter` is unsure.
template <class NarrowPhase, class S, class Sphere>
COLLIDE_HD_INLINE bool resolve([[maybe_unused]] triangle<S> const& t, [[maybe_unused]] Sphere const& s) {
  if constexpr (filtered_predicate<NarrowPhase>::value) {
    return filtered_predicate<NarrowPhase>::resolve(t, s);
  } else {
    return false;  // it never is
  }
}

}  // namespace collide::detail
