/// \file
/// Sink: all colliding pairs of spheres that move, with the times of impact and the contacts then.
#pragma once

#include <collide/sinks/detail/array_in_space.hpp>

namespace collide {

/// The impact of every pair that touches within the step: when it first does, and the contact then. In memory of the
/// space, or in the caller's. `query` waits once, for their number. `S` is the scalar of the detector. Needs a narrow
/// phase for spheres that move, such as `karabassi_swept`.
template <class S = float>
class impacts : public detail::records<impact<S>, S> {
 public:
  using detail::records<impact<S>, S>::records;
};

}  // namespace collide
