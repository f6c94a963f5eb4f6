/// \file
/// Which spheres overlap, on the host.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <collide/exact/detail/numeric/repeating_box.hpp>

namespace collide::detail {

/// A sphere, or where it is a length farther in a box that repeats.
struct swept_point {
  std::size_t number;
  vec3<double> centre;
  bool is_image;
};

/// Adds a sphere where it is, unless that is nowhere.
template <class S>
void add_to_sweep(open_space, std::size_t i, vec3<S> const& x, double, std::vector<swept_point>& to) {
  if (is_finite(x)) to.push_back({i, x.template cast<double>(), false});
}
/// Adds a sphere where it is in the box, and in those of its images that are above it: the others would find the same
/// pairs.
template <class S>
void add_to_sweep(repeating_box<S> const& space, std::size_t i, vec3<S> const& x, double reach,
                  std::vector<swept_point>& to) {
  vec3<S> const at = space.inside(x);
  add_to_sweep(open_space(), i, at, reach, to);
  for (int image = 1; is_finite(x) && image < repeating_box<S>::images; ++image) {
    int last = 0;
    for (int k = 0; k < 3; ++k) last = space.lengths_of(image, k) != 0 ? space.lengths_of(image, k) : last;
    if (last > 0 && space.is_near_in(at, image, static_cast<S>(reach)))
      to.push_back({i, space.in_image(at, image).template cast<double>(), true});
  }
}

/// From one point to another: the shortest way, if space repeats.
template <class S>
vec3<S> apart(open_space, vec3<S> const& a, vec3<S> const& b) {
  return b - a;
}
template <class S>
vec3<S> apart(repeating_box<S> const& space, vec3<S> a, vec3<S> b) {
  a = space.inside(a), b = space.inside(b);
  space.bring_together(a, b);
  return b - a;
}

/// f(a, b, overlap) for each two spheres that overlap: `swept_point`s. Spheres that are nowhere overlap nothing. A
/// sweep along x: O(n log n), and the pairs that are near along x.
template <class S, class Space, class F>
void for_each_overlap(std::vector<S> const& xyz, std::vector<S> const& radii, Space const& space, F const& f) {
  S const largest = radii.empty() ? S(0) : *std::max_element(radii.begin(), radii.end());
  double const largest_radius = static_cast<double>(largest);
  std::vector<swept_point> points;
  for (std::size_t i = 0; i < radii.size(); ++i)
    add_to_sweep(space, i, vec3<S>(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]), 2 * largest_radius, points);
  std::sort(points.begin(), points.end(), [](auto const& a, auto const& b) { return a.centre.x() < b.centre.x(); });
  for (auto a = points.begin(); a != points.end(); ++a) {
    double const radius = static_cast<double>(radii[a->number]);
    for (auto b = a + 1; b != points.end(); ++b) {
      vec3<double> const between = b->centre - a->centre;
      if (between.x() > radius + largest_radius) break;
      if (a->is_image && b->is_image) continue;
      double const overlap = radius + static_cast<double>(radii[b->number]) - between.norm();
      if (overlap > 0) f(*a, *b, overlap);
    }
  }
}

}  // namespace collide::detail
