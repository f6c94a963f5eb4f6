/// \file
/// Materials of granular contact from the numbers that granular.materials makes: three of each solid, and four of each
/// pair, (0, 0), (1, 0), (1, 1), (2, 0) ...
#pragma once

#include <collide/effects/granular/materials.hpp>

namespace collide_python {

inline collide::surface_pair pair_of(double const* v) { return {v[0], v[1], v[2], v[3]}; }

inline void set_materials(collide::one_material& made_of, double const* v) {
  made_of = collide::one_material({v[0], v[1], v[2]}, pair_of(v + 3));
}

template <int N>
void set_materials(collide::materials<N>& made_of, double const* v) {
  for (int i = 0; i < N; ++i, v += 3) made_of.set(i, {v[0], v[1], v[2]});
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j, v += 4) made_of.set_pair(i, j, pair_of(v));
  }
}

}  // namespace collide_python
