/// \file
/// Actions of spheres on each other, for effects that are asked once a pair; see pair_actions.hpp.
#pragma once

#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/exact/detail/numeric/pack.hpp>

namespace collide::detail {

/// A sphere that meets another, or one each of some pairs.
template <class P>
struct meeting_sphere {
  vec3<P> position, velocity, spin;
  P radius, density;
};

/// The action of another sphere on a sphere: a force, the torque of its tangential part for an arm of 1, and another
/// torque.
template <class P>
struct sphere_action {
  vec3<P> force, twist, torque;
  P overlap;
  mask_of<P> is_there;  ///< the two do anything to each other

  /// f(number, k) for the first `Width` numbers, number k: 3 without torques, 7 without the other torque, or 10.
  template <unsigned Width, class F>
  COLLIDE_HD_INLINE void for_each_number(F const& f) {
    for (int k = 0; k < 3; ++k) {
      f(force[k], k);
      if (Width > 3) f(twist[k], 3 + k);
      if (Width > 7) f(torque[k], 7 + k);
    }
    if (Width > 3) f(overlap, 6);
  }
};

/// An action in memory.
template <class S, unsigned Width>
struct alignas(Width == 7 ? 8 * sizeof(S) : sizeof(S)) stored_action {
  S numbers[Width];

  template <class P>
  COLLIDE_HD_INLINE void set(sphere_action<P>& action, int k) {
    action.template for_each_number<Width>([&](P& x, int n) { numbers[n] = lane(x, k); });
  }
  /// As it acts on the first or the `second` of the two. Of what is 0 the sign stays.
  COLLIDE_HD_INLINE sphere_action<S> on(bool second) const {
    sphere_action<S> action;
    action.torque = vec3<S>(S(0), S(0), S(0));
    action.template for_each_number<Width>([&](S& x, int n) {
      bool const turns_round = second && (n < 3 || n > 6);
      x = select(turns_round, S(0 - numbers[n]), numbers[n]);
    });
    return action;
  }
};

}  // namespace collide::detail
