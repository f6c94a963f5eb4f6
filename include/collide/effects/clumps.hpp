/// \file
/// Effect: grains that are clumps, rigid groups of spheres.
#pragma once

#include <collide/effects/detail/effect_list.hpp>
#include <collide/exact/detail/numeric/elementary.hpp>

namespace collide {

/// The place of a sphere of a clump in the frame of the clump's principal axes, around its centre of mass.
struct clump_offset : detail::vector_column {};

/// The centre of mass of a clump. This column and the next ones are of the clump's first sphere.
struct clump_centre : detail::vector_column {};

/// The velocity of the centre of mass.
struct clump_velocity : detail::vector_column {};

/// The angular momentum around the centre of mass over the mass, in space: length squared per time.
struct clump_momentum : detail::vector_column {};

/// The rotation from the frame of the principal axes: a unit quaternion w, x, y, z.
struct clump_rotation : detail::four_column {};

/// The principal moments of inertia over the mass, length squared; and the radius of a sphere of the same volume.
struct clump_inertia : detail::four_column {};

/// Spheres move in clumps, as `set_clumps` has placed them (place_clumps.hpp); the others are grains by themselves. A
/// clump has the density of its spheres' material, and the volume of its shape. The spheres of one have consecutive
/// numbers and do not meet each other. What they meet, and the mesh, acts on them as on spheres of the clump's mass.
/// Forces are summed in the order of the spheres, those of effects too that know more of a sphere than its motion, such
/// as `external_forces`. Other effects that accelerate, such as `gravity` and `drag`, do so at the centre of mass. For
/// `mass_flow`, `absorbing_box` and `sleep` a clump is a sphere of its volume at its centre; it wakes where one of its
/// spheres is woken, and vanishes where one meets a mesh that absorbs.
///
/// With `velocity_verlet` and contact by forces, `granular_contact` or `sphere_contact`. Between the half kicks a clump
/// turns freely by a symplectic splitting into rotations around its principal axes (A. Dullweber, B. Leimkuhler and
/// R. McLachlan, Journal of Chemical Physics 107, 1997), of second order: its energy goes up and down and does not
/// drift, and its angular momentum is the same to the bit. The step must be short beside a turn. 21 scalars a sphere.
///
/// Not with `box_walls`: a wall gives a sphere an impulse through its centre, of a size that the restitution says. On a
/// clump it acts beside the centre of mass, and where several spheres of one are at walls at once, as of a rod that
/// lies, restitution does not say how large each impulse is. A mesh acts by forces.
struct clumps {
  using writes = columns<position, velocity, angular_velocity, in_clump, clump_mass, clump_offset, clump_centre,
                         clump_velocity, clump_momentum, clump_rotation, clump_inertia>;

  double reach = 0;  ///< of any clump from its centre to a sphere's surface, at most: `set_clumps` sets it
};

/// A rotation at random, all equally likely, always the same for a number: w, x, y, z into `rotation`. G. Marsaglia,
/// Annals of Mathematical Statistics 43, 1972.
COLLIDE_HD_INLINE void turn_at_random(double (&rotation)[4], std::uint64_t number) {
  double squares[2], found[4];
  for (int half = 0; half < 2; ++half) {
    for (std::uint64_t trial = 0;; ++trial) {  // a point in the unit disc
      std::uint64_t const n = (number << 20) + (std::uint64_t(half) << 18) + 2 * trial;
      for (int k = 0; k < 2; ++k) found[2 * half + k] = 2 * detail::random_fraction(n + std::uint64_t(k)) - 1;
      squares[half] = found[2 * half] * found[2 * half] + found[2 * half + 1] * found[2 * half + 1];
      if (squares[half] < 1 && squares[half] > 0) break;
    }
  }
  double const part = detail::sqrt_rn(detail::div_rn(1 - squares[0], squares[1]));
  for (int k = 0; k < 4; ++k) rotation[k] = k < 2 ? found[k] : found[k] * part;
}

namespace detail {

/// True of the place of a clump's first sphere. Behind it are the others, in the order of their numbers, on its rank.
template <class State>
COLLIDE_HD_INLINE bool begins_clump(State const& state, std::size_t place) {
  return state.at(in_clump{})[place] == number_of(state, place);
}

/// How many spheres have the clump that begins at a place; 1 if that is of a grain by itself.
template <class State>
COLLIDE_HD_INLINE std::size_t spheres_of_clump([[maybe_unused]] State const& state,
                                               [[maybe_unused]] std::size_t place) {
  std::size_t n = 1;
  if constexpr (contains<typename State::list, in_clump>) {
    id const* const first = state.at(in_clump{});
    while (place + n < state.size && begins_clump(state, place) && first[place + n] == first[place]) ++n;
  }
  return n;
}

/// The place of the first sphere of a sphere's clump on its rank; its own, if it is a grain by itself.
template <class State>
COLLIDE_HD_INLINE std::size_t first_of_grain([[maybe_unused]] State const& state, std::size_t place) {
  if constexpr (contains<typename State::list, in_clump>) {
    id const first = state.at(in_clump{})[place];
    if (first != no_id) return place - (number_of(state, place) - first);
  }
  return place;
}

/// The axes of a frame, that are its unit vectors in space, of a unit quaternion w, x, y, z.
template <class S>
struct turned_axes {
  vec3<S> x, y, z;

  COLLIDE_HD_INLINE explicit turned_axes(several<S, 4> const& q) {
    S const w = q.of[0], a = q.of[1], b = q.of[2], c = q.of[3];
    x = {1 - 2 * (b * b + c * c), 2 * (a * b + w * c), 2 * (a * c - w * b)};
    y = {2 * (a * b - w * c), 1 - 2 * (a * a + c * c), 2 * (b * c + w * a)};
    z = {2 * (a * c + w * b), 2 * (b * c - w * a), 1 - 2 * (a * a + b * b)};
  }
  COLLIDE_HD_INLINE vec3<S> to_space(vec3<S> const& local) const {
    return x * local.x() + y * local.y() + z * local.z();
  }
  COLLIDE_HD_INLINE vec3<S> to_frame(vec3<S> const& in_space) const {
    return {dot(x, in_space), dot(y, in_space), dot(z, in_space)};
  }
};

/// The angular velocity in space of what has such an angular momentum over mass, in space.
template <class S>
COLLIDE_HD_INLINE vec3<S> turning_of(turned_axes<S> const& axes, several<S, 4> const& inertia, vec3<S> momentum) {
  vec3<S> turning = axes.to_frame(momentum);
  for (int k = 0; k < 3; ++k) turning[k] = turning[k] / inertia.of[k];
  return axes.to_space(turning);
}

/// Turns a frame around its own axis number `axis`, by nearly the angle 4 t, of which a quarter has the
/// tangent t; `local` is a vector of space as the frame sees it.
template <class S>
COLLIDE_HD_INLINE void turn_around(several<S, 4>& q, vec3<S>& local, int axis, S t) {
  S const part = 1 / (1 + t * t), c = (1 - t * t) * part, s = 2 * t * part;  // of half the angle
  int const j = (axis + 1) % 3, k = (axis + 2) % 3;
  S const w = q.of[0], a = q.of[axis + 1], b = q.of[j + 1], d = q.of[k + 1];
  q.of[0] = w * c - a * s;
  q.of[axis + 1] = a * c + w * s;
  q.of[j + 1] = b * c + d * s;
  q.of[k + 1] = d * c - b * s;
  S const cosine = c * c - s * s, sine = 2 * s * c, x = local[j], y = local[k];
  local[j] = cosine * x + sine * y;
  local[k] = cosine * y - sine * x;
}

/// Turns what is free for a time. The rotation by about the angle rate * dt around an axis depends on the angular
/// momentum along that axis alone, so that each is the motion of a Hamiltonian.
template <class S>
COLLIDE_HD_INLINE void turn_freely(several<S, 4>& q, several<S, 4> const& inertia, vec3<S> const& momentum, S dt) {
  vec3<S> local = turned_axes<S>(q).to_frame(momentum);
  COLLIDE_UNROLL
  for (int i = 0; i < 5; ++i) {
    int const axis = i < 3 ? i : 4 - i;
    turn_around(q, local, axis, (axis == 2 ? dt : dt / 2) * (local[axis] / inertia.of[axis]) / 4);
  }
  S squared = 0;
  for (S const x : q.of) squared += x * x;
  S const length = sqrt_rn(squared);
  for (S& x : q.of) x = x / length;
}

}  // namespace detail
}  // namespace collide
