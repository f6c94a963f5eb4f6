/// \file
/// Hits of a mesh of which parts have poses, what of the spheres is near a part, and which part is nearest, or around a
/// point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <collide/query/hit.hpp>
#include <collide/simulation/detail/bodies/moving_mesh.hpp>
#include <collide/sinks/detail/search_mesh.hpp>
#include <collide/sinks/k_nearest.hpp>
#include <collide/sinks/signed_distance.hpp>
#include <collide/spaces/detail/atomic.hpp>
#include <collide/spheres.hpp>

namespace collide {

namespace detail {

/// A narrow phase that judges triangles in the frames of their bodies: it names the kind of a hit.
template <class NarrowPhase>
struct in_frames : NarrowPhase {};

}  // namespace detail

/// A hit of a triangle of a body: its contact is in the world.
template <class NarrowPhase, class S>
class hit<detail::in_frames<NarrowPhase>, S> {
 public:
  id sphere;    ///< number of the sphere
  id triangle;  ///< number of the triangle

  /// As for other hits.
  using spheres_type = detail::sphere_view_for<NarrowPhase, S>;

  /// A hit of `p`, whose geometry is in `mesh` and `spheres`: both must outlive it.
  COLLIDE_HD hit(pair p, detail::moving_mesh<S> const& mesh, spheres_type const& spheres)
      : sphere{p.sphere}, triangle{p.triangle}, mesh_{mesh}, spheres_{spheres} {}

  /// Contact of the pair, computed by this call in the frame of the body.
  COLLIDE_HD collide::contact<S> contact() const {
    static_assert(
        detail::has_contact<NarrowPhase, S>,
        "collide: contacts need a narrow phase with a static member contact_of(triangle, sphere) that returns a "
        "contact");
    int const frame = mesh_.frame_of(triangle);
    return in_world(frame, NarrowPhase::contact_of(mesh_[triangle], mesh_.seen_from(frame, spheres_[sphere], 1)));
  }

  /// First time of contact of a sphere that moves, and the contact at that time, computed by this call in the frame of
  /// the body.
  COLLIDE_HD collide::impact<S> impact() const {
    static_assert(detail::has_impact<NarrowPhase, S>,
                  "collide: impacts need a narrow phase for spheres that move, such as karabassi_swept");
    int const frame = mesh_.frame_of(triangle);
    collide::impact<S> i = NarrowPhase::impact_of(mesh_[triangle], mesh_.seen_from(frame, spheres_[sphere], 1));
    i.contact = in_world(frame, i.contact);
    return i;
  }

 private:
  COLLIDE_HD collide::contact<S> in_world(int frame, collide::contact<S> c) const {
    c.sphere = sphere;
    c.triangle = triangle;
    mesh_.to_world(c, frame, 1);
    return c;
  }

  detail::moving_mesh<S> const& mesh_;
  spheres_type const& spheres_;
};

namespace detail {

template <class NarrowPhase, class S>
COLLIDE_HD hit<NarrowPhase, S> hit_of(pair p, moving_mesh<S> const& mesh,
                                      sphere_view_for<NarrowPhase, S> const& spheres) {
  return {p, mesh, spheres};
}

/// How far from its centre a sphere is on its way, at most.
template <class S>
COLLIDE_HD_INLINE S reach_of(sphere<S> const& s) {
  return s.radius;
}
template <class S>
COLLIDE_HD_INLINE S reach_of(moving_sphere<S> const& s) {
  return s.radius + absolute(s.displacement).sum();
}

/// Kernel functor of `for_each` over groups of spheres: lists those that may touch something. A host tries a group at a
/// time in the lanes of its vector unit.
template <class Spheres, unsigned Group>
struct list_near_bodies {
  using S = typename Spheres::scalar;
  moving_mesh<S> mesh;
  S margin;  ///< how far rounding may move what a body sees
  Spheres spheres;
  std::uint32_t* count;
  id* numbers;

  COLLIDE_HD void operator()(std::size_t group) const {
    std::size_t const first = group * Group, left = spheres.size() - first;
    unsigned const n = left < Group ? static_cast<unsigned>(left) : Group;
    S x[Group] = {}, y[Group] = {}, z[Group] = {}, reach[Group] = {};
    std::uint32_t near[Group] = {};
    for (unsigned k = 0; k < n; ++k) {
      auto const own = spheres[first + k];
      x[k] = own.centre.x(), y[k] = own.centre.y(), z[k] = own.centre.z(), reach[k] = reach_of(own);
    }
    for (int frame = mesh.first_frame; frame < mesh.frame_count; ++frame) {
      body_frame<S> const& f = mesh.frames[frame];
      for (unsigned k = 0; k < Group; ++k) near[k] |= f.is_far(vec3<S>(x[k], y[k], z[k]), reach[k], margin) ? 0u : 1u;
    }
    for (unsigned k = 0; k < n; ++k) {
      if (near[k] != 0) numbers[fetch_add(count, 1u)] = static_cast<id>(first + k);
    }
  }
};

/// Kernel functor of `for_each` over spheres that are listed: lists those that may touch a body, as the body sees them.
template <class Spheres>
struct list_near_body {
  using S = typename Spheres::scalar;
  moving_mesh<S> mesh;
  int frame;
  S margin;
  Spheres spheres;
  id const* from;
  std::uint32_t* count;
  id* numbers;
  S* centres;
  S* radii;          ///< null if all have one
  S* displacements;  ///< of spheres that move

  COLLIDE_HD void operator()(std::size_t i) const {
    id const number = from[i];
    auto const own = spheres[number];
    if (mesh.frames[frame].is_far(own.centre, reach_of(own), margin)) return;
    auto const seen = mesh.seen_from(frame, own, 1);
    std::size_t const slot = fetch_add(count, 1u);
    numbers[slot] = number;
    for (unsigned k = 0; k < 3; ++k) {
      centres[3 * slot + k] = seen.centre[k];
      if constexpr (!std::is_same<Spheres, sphere_view<S>>::value) displacements[3 * slot + k] = seen.displacement[k];
    }
    if (radii != nullptr) radii[slot] = own.radius;
  }
};

/// Kernel functor of `for_each` over spheres: how a body sees them.
template <class S>
struct see_from_body {
  moving_mesh<S> mesh;
  int frame;
  sphere_view<S> spheres;
  S* centres;
  S* radii;  ///< null if all have one

  COLLIDE_HD void operator()(std::size_t i) const {
    sphere<S> const seen = mesh.seen_from(frame, spheres[i], 1);
    for (unsigned k = 0; k < 3; ++k) centres[3 * i + k] = seen.centre[k];
    if (radii != nullptr) radii[i] = seen.radius;
  }
};

/// True if what is found in a body counts more than what was found before.
template <class S>
COLLIDE_HD bool comes_before(nearest_triangle<S> const& a, nearest_triangle<S> const& b) {
  return a.distance < b.distance || (a.distance == b.distance && b.triangle > a.triangle);
}
COLLIDE_HD_INLINE bool comes_before(std::uint8_t a, std::uint8_t b) { return a > b; }

/// How many results a search has for each sphere.
template <class Find>
std::size_t width_of(Find const&) {
  return 1;
}
template <class S, class Precision>
std::size_t width_of(find_k_nearest<S, Precision> const& f) {
  return static_cast<std::size_t>(f.k);
}

/// Kernel functor of `for_each` over spheres: of what counts most so far, and in a body which begins with triangle
/// `first`, both in order, as much as there is room for.
template <class S, class Found>
struct take_first {
  moving_mesh<S> mesh;
  int frame;
  id first;
  std::size_t width;
  Found const* of_body;
  Found* to;
  bool is_first_body;

  COLLIDE_HD void operator()(std::size_t i) const {
    Found* const row = to + i * width;
    std::size_t next = 0;  // those of the body stay in their order
    for (std::size_t j = 0; j < width; ++j) {
      Found found = of_body[i * width + j];
      if constexpr (!std::is_same<Found, std::uint8_t>::value) to_whole(found);
      if (is_first_body) {
        row[j] = found;
        continue;
      }
      std::size_t place = width;
      while (place > next && comes_before(found, row[place - 1])) --place;
      if (place == width) return;
      for (std::size_t k = width - 1; k > place; --k) row[k] = row[k - 1];
      row[place] = found;
      next = place + 1;
    }
  }

 private:
  COLLIDE_HD void to_whole(Found& n) const {
    if (n.triangle == no_id) return;
    n.triangle += first;
    contact<S> c{};
    c.point = n.point;
    if constexpr (std::is_same<Found, signed_nearest_triangle<S>>::value) c.normal = n.gradient;
    mesh.to_world(c, frame, 1);
    n.point = c.point;
    if constexpr (std::is_same<Found, signed_nearest_triangle<S>>::value) n.gradient = c.normal;
  }
};

template <class Sink>
inline constexpr bool searches_bodies = std::is_same<Sink, collide::contains>::value;
template <class S>
inline constexpr bool searches_bodies<nearest<S>> = true;
template <class S>
inline constexpr bool searches_bodies<k_nearest<S>> = true;
template <class S>
inline constexpr bool searches_bodies<signed_distance<S>> = true;

}  // namespace detail

}  // namespace collide
