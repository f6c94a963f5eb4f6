/// \file
/// The choice between a tree and a grid for a scene on the host: by a sample of its triangles and spheres.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/atomic_add.hpp>
#include <collide/detail/geometry/closest_point.hpp>
#include <collide/detail/geometry/local_triangle.hpp>
#include <collide/detail/geometry/swept_bounds.hpp>
#include <collide/detail/tree/triangle_pieces.hpp>
#include <collide/memory.hpp>
#include <collide/mesh.hpp>

namespace collide::detail {

/// The number of thing `i` of a sample, at equal distances among all.
COLLIDE_HD_INLINE std::size_t place_in_sample(std::size_t i, std::size_t sample, std::size_t all) {
  return all / sample * i + all % sample * i / sample;
}

/// In place of spheres, if none are known yet: one in the middle of each triangle. A sample of them is not at the
/// triangles of a sample as large, which would count too often, unless it has all.
template <class S>
struct middles_as_spheres {
  mesh_view<S> mesh;
  S radius;

  COLLIDE_HD std::size_t size() const { return mesh.size(); }
  COLLIDE_HD sphere<S> operator[](std::size_t i) const {
    triangle<S> const t = mesh[(i + mesh.size() / 256) % mesh.size()];
    return {t.a / S(3) + t.b / S(3) + t.c / S(3), radius};
  }
};

/// How many triangles of a mesh tell of all: a large one is not looked at longer than a small one.
inline constexpr std::size_t sampled_triangles = 128;

/// True if most of the boxes of a sample of triangles is empty: these are cut into pieces. For the host.
template <class S>
bool are_slender(mesh_view<S> const& mesh) {
  std::size_t const n = min(mesh.size(), sampled_triangles);
  double wasted = 0, surface = 0;
  for (std::size_t i = 0; i < n; ++i) {
    triangle_shape const shape(mesh[place_in_sample(i, n, mesh.size())]);
    wasted += shape.wasted();
    surface += shape.half_surface;
  }
  return wasted > surface / 2 && is_finite(surface);
}

/// Pairs of a sphere and a triangle of which the sphere reaches the box, and those of which it reaches the triangle.
struct reached_pairs {
  std::uint32_t boxes, triangles;
};

/// Kernel functor of `for_each`: counts the pairs of a triangle of the sample and eight of `count` spheres.
template <class S, class Spheres>
struct count_reached {
  static constexpr std::size_t at_once = 8;

  mesh_view<S> mesh;
  Spheres spheres;
  std::size_t triangles, count;  ///< of the samples
  reached_pairs* to;

  COLLIDE_HD void operator()(std::size_t i) const {
    triangle<S> const t = mesh[place_in_sample(i % triangles, triangles, mesh.size())];
    triangle_aabb<S> const box = triangle_aabb_of(t);
    std::size_t const first = i / triangles * at_once, end = min(first + at_once, count);
    for (std::size_t k = first; k < end; ++k) {
      auto const one = spheres[place_in_sample(k, count, spheres.size())];
      sphere<S> const s = swept_bounding_sphere(one);
      if (!is_valid_radius(s.radius) || !is_finite(s.centre) || !is_finite(s.radius)) continue;
      if (!box.overlaps(s.centre, s.radius)) continue;
      atomic_add(&to->boxes, 1);
      local_triangle<S> const l = to_local<S>(t, s);
      S const distance = closest_to_origin(l, cross<S>(l.b - l.a, l.c - l.a)).distance_squared;
      if (distance <= s.radius * s.radius) atomic_add(&to->triangles, 1);
    }
  }
};

/// The mean numbers, for a sphere, of triangles whose box it reaches, and of those that it reaches itself.
struct reached_by_sphere {
  double boxes, triangles;
};

/// The mean of what spheres reach, at rest or in motion, from at most so many of them: on the host some microseconds,
/// or of 128 spheres a tenth of a millisecond. Waits.
template <class S, class Space, class Spheres>
reached_by_sphere mean_reached(Space& space, mesh_view<S> const& mesh, Spheres const& spheres, std::size_t most,
                               buffer<reached_pairs>& memory) {
  std::size_t const n = min(spheres.size(), most), triangles = min(mesh.size(), sampled_triangles);
  using kernel = count_reached<S, Spheres>;
  reached_pairs* const to = memory.reserve(space.resource(), 1);
  space.fill(to, 0, sizeof *to);
  space.for_each(triangles * ((n + kernel::at_once - 1) / kernel::at_once), kernel{mesh, spheres, triangles, n, to});
  reached_pairs const found = space.read(to);
  double const scale = static_cast<double>(mesh.size()) / (static_cast<double>(n) * static_cast<double>(triangles));
  return {found.boxes * scale, found.triangles * scale};
}

}  // namespace collide::detail
