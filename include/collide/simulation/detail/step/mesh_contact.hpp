/// \file
/// Contacts as a simulation needs them: the contact of a sphere and a triangle, and the time at which a moving sphere
/// stops, in double, without the exact digits that `contact_of` gives; and keys, which say which contact comes first.
#pragma once

#include <cstdint>

#include <collide/exact/detail/geometry/local_sweep.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/narrow/detail/contact.hpp>
#include <collide/narrow/detail/intersects_swept.hpp>

namespace collide {

template <class Precision>
struct karabassi_swept;

namespace detail {

/// The contact of a sphere and a finite triangle. Unlike that of `contact_of`, the depth of a sphere that just touches
/// is known to within the rounding of doubles only: resting spheres do just that, all the time.
template <class S>
COLLIDE_HD contact<S> contact_double(triangle<S> const& t, sphere<S> const& s) {
  return narrow_to<S>(contact_of_pair(widened(t), widened(s), digits::of_float, false));
}

/// Tells if a sphere touches a finite triangle, and the contact that `contact_double` tells if so, where doubles
/// suffice for both; `sure` says that they touch. Calls nothing. The foot that it finds is a point of the triangle, so
/// a depth that is clear means a hit. There may be a nearer one inside a sliver, of which the normal is inaccurate, but
/// not by much: docs/development/numerics.md.
template <class S>
COLLIDE_HD_INLINE verdict try_contact_double(triangle<S> const& t, sphere<S> const& s, bool sure, contact<S>& found) {
  constexpr double clear_depth = 0x1p-40, clear_gap = 0x1p-32;
  sphere<S> const centre{s.centre, S(0)};
  local_triangle<double> const l = to_unit_range(to_local<double>(t, centre), t, centre);
  bool apart = false;
  auto const clear = [&](double distance, double depth) {
    apart = !sure && depth < 0;
    return distance >= well_conditioned_length && (sure || depth >= clear_depth || -depth * distance >= clear_gap);
  };
  closest_point<double> closest;
  contact_without_point m;
  if (!contact_if_well_conditioned(l, static_cast<double>(s.radius), clear, closest, m)) return verdict::uncertain;
  found = contact_at_point<S>(m, closest.point, l.scale, s.centre.template cast<double>());
  return apart ? verdict::miss : verdict::hit;
}

/// The moving sphere at a time within the step, rounded once: what comes from far away stops at the mesh as
/// accurately as what comes from near.
template <class S>
COLLIDE_HD_INLINE sphere<S> sphere_at(moving_sphere<S> const& s, S time) {
  vec3<S> at;
  COLLIDE_UNROLL
  for (int k = 0; k < 3; ++k) at[k] = fma_rn(s.displacement[k], time, s.centre[k]);
  return {at, s.radius};
}
template <class S>
COLLIDE_HD_INLINE sphere<S> const& sphere_at(sphere<S> const& s, S) {
  return s;
}

/// When a moving sphere stops that touches a finite triangle on its way. Like `time_of_impact` never late, but early
/// also where doubles leave open whether the two touch: those that rest on the mesh have so short a way to go in a step
/// that their times could not be told apart without exact arithmetic.
template <class S>
COLLIDE_HD_NOINLINE S stopping_time_here(triangle<S> const& t, moving_sphere<S> const& s) {
  return rounded_down<S>(refine_time_of_impact(widened(t), widened(s), time_bits<S>, false));
}

/// When a sphere of a narrow phase stops: of one other than `karabassi_swept`, when that says.
template <class NarrowPhase>
struct stopping_time {
  template <class S>
  static COLLIDE_HD_INLINE S of(triangle<S> const& t, moving_sphere<S> const& s) {
    return NarrowPhase::time_of_impact(t, s);
  }
};
template <class Precision>
struct stopping_time<karabassi_swept<Precision>> {
  template <class S>
  static COLLIDE_HD_INLINE S of(triangle<S> const& t, moving_sphere<S> const& s) {
    return stopping_time_here(t, s);
  }
};

/// A surface has two sides. Where the centre lies on it, the normal faces against the path.
template <class S>
COLLIDE_HD_INLINE void face_against(contact<S>& c, vec3<S> const& path) {
  if (c.distance == 0 && dot(c.normal, path) > 0) c.normal = -c.normal;
}

/// Keys of contacts: the smaller comes first. That is the earlier contact, and of those at the beginning of the motion
/// the deeper one. Ties go to the face, then to the edge, so that on a plane which is divided into triangles the normal
/// is that of the face below the centre; then to the lower triangle number.
inline constexpr std::uint64_t no_contact = ~std::uint64_t{0};
/// Bits for the time or the depth in a key; one more tells which of them it is.
inline constexpr int key_bits = 29;

/// The next time at or below a time from 0 to 1 that keys tell from others: a multiple of 2^-29 below 1.
template <class S>
COLLIDE_HD_INLINE S key_time(S time) {
  constexpr auto ticks = std::uint32_t{1} << key_bits, last = ticks - (sizeof(S) == sizeof(float) ? 32 : 1);
  return S(min(static_cast<std::uint32_t>(time * S(ticks)), last)) * (S(1) / S(ticks));
}

/// `time` is a `key_time`.
template <class S>
COLLIDE_HD_INLINE std::uint64_t contact_key(S time, contact<S> const& c) {
  constexpr auto ticks = std::uint32_t{1} << key_bits;
  std::uint32_t const first = time > 0 ? static_cast<std::uint32_t>(time * S(ticks)) | ticks
                                       : ~to_ordered_bits(static_cast<float>(c.depth)) >> (32 - key_bits);
  return std::uint64_t{first} << 34 | std::uint64_t{static_cast<std::uint32_t>(c.feature)} << 32 | c.triangle;
}

template <class S>
COLLIDE_HD_INLINE S time_of_key(std::uint64_t key) {
  constexpr auto ticks = std::uint32_t{1} << key_bits;
  auto const first = static_cast<std::uint32_t>(key >> 34);
  return (first & ticks) != 0 ? S(first & (ticks - 1)) * (S(1) / S(ticks)) : S(0);
}

}  // namespace detail

}  // namespace collide
