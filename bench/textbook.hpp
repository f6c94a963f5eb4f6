/// \file
/// The test of a sphere and a triangle as textbooks have it, to be compared with.
#pragma once

#include <collide/core/config.hpp>
#include <collide/core/geometry.hpp>

namespace bench {

/// Narrow phase: the closest point of the triangle (C. Ericson, Real-Time Collision Detection, 5.1.5), in float and in
/// the coordinates of the world, and whether it is within the radius. The weights of a point inside a sliver are the
/// small differences of large products: the point may be anywhere along it. Most users of a library of trees have this
/// test.
struct textbook {
  template <class S>
  static COLLIDE_HD bool intersects(collide::triangle<S> const& of, collide::sphere<S> const& s) {
    using vec = collide::vec3<float>;
    vec const p = s.centre.template cast<float>();
    vec const away =
        closest(of.a.template cast<float>(), of.b.template cast<float>(), of.c.template cast<float>(), p) - p;
    auto const r = static_cast<float>(s.radius);
    return away.dot(away) <= r * r;
  }

 private:
  static COLLIDE_HD collide::vec3<float> closest(collide::vec3<float> const& a, collide::vec3<float> const& b,
                                                 collide::vec3<float> const& c, collide::vec3<float> const& p) {
    using vec = collide::vec3<float>;
    vec const ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    float const d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d1 <= 0 && d2 <= 0) return a;
    if (d3 >= 0 && d4 <= d3) return b;
    float const vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
    if (d6 >= 0 && d5 <= d6) return c;
    float const vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
    float const va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
    float const one = 1 / (va + vb + vc);
    return a + vb * one * ab + vc * one * ac;
  }
};

}  // namespace bench
