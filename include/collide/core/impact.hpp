/// \file
/// First contact of a pair that collides within a step, and its time.
#pragma once

#include <collide/core/contact.hpp>

namespace collide {

/// First contact of a moving sphere and a triangle within a step. It has no padding: equal impacts are equal bytes.
template <class S>
struct impact {
  collide::contact<S> contact;  ///< at the time of impact
  S time;                       ///< of impact, as a fraction of the step, 0 to 1; 0 if the two overlap at the beginning
};

}  // namespace collide
