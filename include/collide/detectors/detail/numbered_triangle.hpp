/// \file
/// Triangles of a part of a mesh, copied.
#pragma once

#include <cstddef>

#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/mesh.hpp>

namespace collide::detail {

/// A triangle with its number in the whole mesh.
template <class S>
struct numbered_triangle {
  id number;
  S corners[9];

  triangle<S> shape() const {
    return {{corners[0], corners[1], corners[2]},
            {corners[3], corners[4], corners[5]},
            {corners[6], corners[7], corners[8]}};
  }
  aabb<double> box() const {
    aabb<S> const b = aabb_of(shape());
    if (b.is_empty()) return aabb<double>::empty();
    return {{double(b.lower[0]), double(b.lower[1]), double(b.lower[2])},
            {double(b.upper[0]), double(b.upper[1]), double(b.upper[2])}};
  }
  friend bool operator<(numbered_triangle const& a, numbered_triangle const& b) { return a.number < b.number; }
};

/// Kernel functor of `for_each` over triangles: their corners, packed.
template <class S>
struct pack_triangles {
  mesh_view<S> mesh;
  S* to;
  COLLIDE_HD void operator()(std::size_t i) const {
    triangle<S> const t = mesh[i];
    for (unsigned k = 0; k < 3; ++k) {
      to[9 * i + k] = t.a[k];
      to[9 * i + 3 + k] = t.b[k];
      to[9 * i + 6 + k] = t.c[k];
    }
  }
};

}  // namespace collide::detail
