/// \file
/// Sink: all colliding pairs of spheres that move, with the times of impact and the contacts then.
#pragma once

#include <collide/detail/sinks/pair_records.hpp>

namespace collide {

/// The impact of every pair that touches within the step: when it first does, and the contact then. As `contacts`
/// otherwise. Needs a narrow phase for spheres that move.
template <class S = float>
class impacts : public detail::records<impact<S>, S> {
 public:
  using detail::records<impact<S>, S>::records;
};

}  // namespace collide
