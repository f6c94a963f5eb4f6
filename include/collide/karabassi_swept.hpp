/// \file
/// Karabassi's intersection test for spheres that move.
#pragma once

#include <collide/contact.hpp>
#include <collide/detail/decide_swept.hpp>
#include <collide/detail/four_steps.hpp>
#include <collide/impact.hpp>
#include <collide/precision.hpp>

namespace collide {
template <class Precision = exact>
struct karabassi_swept {
  /// True if the closed ball touches the closed triangle.
  template <class S>
  static COLLIDE_HD_INLINE bool intersects(triangle<S> const& t, moving_sphere<S> const& s) {
      return detail::decide(t, s).hit;
  }
};
}  // namespace collide
