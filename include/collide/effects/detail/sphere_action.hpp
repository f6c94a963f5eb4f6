/// \file
/// Actions of spheres on each other, for effects that are asked once a pair; see pair_actions.hpp.
#pragma once

#include <collide/exact/detail/numeric/pack.hpp>

namespace collide::detail {

/// A sphere that meets another, or one each of some pairs.
template <class P>
struct meeting_sphere {
  vec3<P> position, velocity, spin;
  P radius, density;
};

/// The action of another sphere on a sphere: a force, its tangential part, the torque of that for an arm of 1, and
/// another torque.
template <class P>
struct sphere_action {
  vec3<P> force, aside, twist, torque;
  P overlap;
  mask_of<P> is_there;  ///< the two do anything to each other

  /// f(number, k) for the first `Width` numbers, number k: 4 without torques, 7 without the other torque, 10 without
  /// the tangential part, or 13.
  template <unsigned Width, class F>
  COLLIDE_HD_INLINE void for_each_number(F const& f) {
    for (unsigned k = 0; k < 3; ++k) {
      f(force[k], k);
      if (Width > 4) f(twist[k], 4 + k);
      if (Width > 7) f(torque[k], 7 + k);
      if (Width > 10) f(aside[k], 10 + k);
    }
    f(overlap, 3u);
  }
};

/// A sphere in memory, beside its centre and radius: to be read at once.
template <class S>
struct alignas(8 * sizeof(S)) stored_motion {
  static constexpr unsigned width = 8;
  S numbers[width];  ///< velocity, density, spin, and the number of its solid

  COLLIDE_HD_INLINE void set(meeting_sphere<S> const& s, int solid) {
    for (int k = 0; k < 3; ++k) numbers[k] = s.velocity[k], numbers[4 + k] = s.spin[k];
    numbers[3] = s.density, numbers[7] = S(solid);
  }
  COLLIDE_HD_INLINE int solid() const { return int(numbers[7]); }
  template <class P>
  static COLLIDE_HD_INLINE void get(P const (&columns)[width], meeting_sphere<P>& s) {
    for (int k = 0; k < 3; ++k) s.velocity[k] = columns[k], s.spin[k] = columns[4 + k];
    s.density = columns[3];
  }
};

/// An action on one of two spheres as it is read: vectors are rows of four numbers.
template <class S>
struct read_action {
  row_of<S> force, twist, torque;
  S overlap;
};

template <class S, unsigned Width>
struct alignas(Width == 7 ? 8 * sizeof(S) : sizeof(S)) stored_action {
  S numbers[Width];

  /// As it acts on the first or the `second` of the two. Of what is 0 the sign stays. Up to a number behind is read.
  COLLIDE_HD_INLINE read_action<S> on(bool second) const {
    constexpr S zero[4] = {};
    read_action<S> action{opposite_if(second, load_row(numbers)), load_row(zero), load_row(zero), numbers[3]};
    if constexpr (Width > 4) action.twist = load_row(numbers + 4);
    if constexpr (Width > 7) action.torque = opposite_if(second, load_row(numbers + 7));
    return action;
  }
  /// The tangential part of its force.
  COLLIDE_HD_INLINE row_of<S> aside_on(bool second) const {
    static_assert(Width > 10, "it is kept");
    return opposite_if(second, load_row(numbers + 10));
  }
};

}  // namespace collide::detail
