/// \file
/// Sink: all colliding pairs with their contacts.
#pragma once

#include <collide/sinks/detail/array_in_space.hpp>

namespace collide {

/// The contact of every colliding pair: closest point, normal, distance, depth and feature; of spheres that move, at
/// the time of impact. In memory of the space, or in the caller's. The pairs are found first and the contacts computed
/// from them in a second pass over the pairs alone, so that a miss costs nothing. `query` waits once, for their number.
/// `S` is the scalar of the detector. Needs a narrow phase with a member `contact_of`, as those of the library have.
template <class S = float>
class contacts : public detail::records<contact<S>, S> {
 public:
  using detail::records<contact<S>, S>::records;
};

}  // namespace collide
