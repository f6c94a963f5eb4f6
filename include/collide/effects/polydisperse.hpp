/// \file
/// Effect: each particle has its own radius.
#pragma once

#include <collide/effects/effect.hpp>

namespace collide {

/// Each particle has its own radius: a column more, read wherever a radius is needed. Without it there is one radius
/// for all, which takes no memory. Where particles meet, an effect may change radii up to the largest that `set` and
/// `assign<radius>` of the simulation have seen.
struct polydisperse {
  using reads = columns<radius>;
};

}  // namespace collide
