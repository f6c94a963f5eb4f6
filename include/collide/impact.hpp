/// \file
/// What is known of a pair that collides within a step: when, and the contact at that time.
#pragma once

#include <collide/contact.hpp>

namespace collide {

/// When, where and how a moving sphere first touches a triangle. Without padding: equal impacts are equal bytes.
template <class S>
struct impact {
  collide::contact<S> contact;  ///< at that time
  S time;                       ///< in 0 .. 1; 0 if the two overlap at the beginning
};

}  // namespace collide
