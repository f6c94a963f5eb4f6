/// \file
/// Bodies: parts of a simulation's mesh that move as a whole, such as drums, belts, pistons and screws.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <collide/effects/effect.hpp>
#include <collide/exact/detail/numeric/elementary.hpp>

namespace collide {

namespace detail {

/// A vector, rotated by a unit quaternion.
COLLIDE_HD_INLINE vec3<double> rotated(double const (&q)[4], vec3<double> const& x) {
  vec3<double> const axis_part(q[1], q[2], q[3]), twice = scaled(cross(axis_part, x), 2.0);
  return x + scaled(twice, q[0]) + cross(axis_part, twice);
}

}  // namespace detail

/// The pose of a body: a point x of its mesh is at position + R x, R the rotation.
struct pose {
  double position[3] = {0, 0, 0};     ///< of the origin of the mesh
  double rotation[4] = {1, 0, 0, 0};  ///< unit quaternion w, x, y, z

  /// The position of a point of the mesh. O(1).
  COLLIDE_HD vec3<double> operator()(vec3<double> const& x) const {
    return vec3<double>(position[0], position[1], position[2]) + detail::rotated(rotation, x);
  }
};

/// How a body moves: a point x of space that belongs to it has the velocity linear + angular x (x - pose.position).
struct twist {
  double linear[3] = {0, 0, 0};   ///< of `pose.position`, units of length per unit of time
  double angular[3] = {0, 0, 0};  ///< radians per unit of time, around the axis that it points along
};

/// The pose and the velocity of a body at a time.
struct body_state {
  pose at;                     ///< where it is
  twist moving;                ///< how `at` changes
  double belt[3] = {0, 0, 0};  ///< velocity of a belt that runs on the surface, which stays where it is
};

/// A motion of a small family, which may be combined: all zero is at rest. `belt` is the velocity of a belt that runs
/// on the surface while the body stays where it is.
///
/// At time t, with s = sin(2 pi (frequency t + phase)): the pivot is at pivot + velocity t + amplitude s, and the body
/// is turned around the axis through it by the angle rate t + swing s, in radians.
struct body_motion {
  double pivot[3] = {0, 0, 0};      ///< a point of the body's mesh
  double velocity[3] = {0, 0, 0};   ///< of the pivot
  double axis[3] = {0, 0, 1};       ///< of any length; 0: the body does not turn
  double rate = 0;                  ///< radians per unit of time
  double amplitude[3] = {0, 0, 0};  ///< of the pivot
  double swing = 0;                 ///< amplitude of the angle, radians
  double frequency = 0;             ///< cycles per unit of time
  double phase = 0;                 ///< cycles
  double belt[3] = {0, 0, 0};       ///< velocity of the surface

  /// Pose and twist at a time. The same bits in every space. O(1).
  COLLIDE_HD body_state operator()(double time) const {
    using namespace detail;
    constexpr double two_pi = 6.283185307179586;
    sin_cos const wave = sin_cos_of_turns(mul_rn(frequency, time) + phase);
    double const wave_rate = mul_rn(mul_rn(two_pi, frequency), wave.cos);
    vec3<double> const given(axis[0], axis[1], axis[2]);
    vec3<double> const direction = scaled(given, inverse_power_of_two(max_component<double>(detail::absolute(given))));
    double const length = sqrt_rn(dot(direction, direction));
    double const angle = mul_rn(rate, time) + mul_rn(swing, wave.sin), angle_rate = rate + mul_rn(swing, wave_rate);
    sin_cos const half = sin_cos_of_turns(div_rn(angle, 2 * two_pi));
    body_state s;
    s.at.rotation[0] = length > 0 ? half.cos : 1;
    for (int k = 0; k < 3; ++k) {
      double const along = length > 0 ? div_rn(direction[k], length) : 0;
      s.at.rotation[k + 1] = mul_rn(along, half.sin);
      s.moving.angular[k] = mul_rn(along, angle_rate);
      s.belt[k] = belt[k];
    }
    vec3<double> const arm = rotated(s.at.rotation, vec3<double>(pivot[0], pivot[1], pivot[2]));
    vec3<double> const w(s.moving.angular[0], s.moving.angular[1], s.moving.angular[2]), turning = cross(w, arm);
    for (int k = 0; k < 3; ++k) {
      s.at.position[k] = (pivot[k] - arm[k]) + mul_rn(velocity[k], time) + mul_rn(amplitude[k], wave.sin);
      s.moving.linear[k] = velocity[k] + mul_rn(amplitude[k], wave_rate) - turning[k];
    }
    return s;
  }
};

/// A body: the `size` triangles of the mesh from number `first` on, and how they move.
struct body {
  std::size_t first = 0;    ///< number of the first triangle
  std::size_t size = 0;     ///< how many triangles
  body_motion motion = {};  ///< how they move
};

/// In place of a motion: poses and twists are what the caller's kernels write to `simulation::bodies()`.
struct driven {};

/// The report on bodies, counted since `set_mesh`: see `simulation::bodies().report(space)`.
struct body_report {
  /// How often a body was to get a pose that is no rotation or not finite; it then stays where it was, at rest.
  std::uint32_t refused_poses = 0;
  /// How often a body of a simulation that is not swept moved in a step by more than the radius of the smallest
  /// particle that `set` has seen, and so may have passed through some.
  std::uint32_t fast_steps = 0;
  /// How often a body of a simulation that is swept turned by more than 0.05 rad in a step where the smallest radius is
  /// less than 512 units in the last place of its coordinates (2048 if by more than 1.7): what it encloses may then get
  /// through it.
  std::uint32_t rough_steps = 0;
};

/// Named in a scene's list: parts of the mesh move, as `simulation::set_mesh(mesh, bodies)` says. `Motion` is
///   - `body_motion`, the default: each body has its own, of a small family;
///   - a copyable function object of your own: COLLIDE_HD body_state operator()(std::size_t body, double time) const;
///   - `driven`: kernels of your own write poses and twists to `simulation::bodies()` before each step. In the first
///     step after `set_mesh` or `set` a body is all the time where its first pose says.
///
/// At most 64 bodies. Triangles of no body rest. The mesh is indexed once, as it lies in memory: that is each body's
/// own frame, and nothing is built again while bodies move. O(bodies) more per particle.
template <class Motion = body_motion>
struct moving_bodies {
  static_assert(std::is_same<Motion, driven>::value ||
                    std::is_invocable_r<body_state, Motion const&, std::size_t, double>::value ||
                    std::is_same<Motion, body_motion>::value,
                "collide: a motion of moving_bodies is called as motion(body, time) const, with a std::size_t and a "
                "double, and gives a body_state");
  static constexpr std::size_t max_bodies = 64;  ///< most bodies of a mesh
  static constexpr bool begins_on_ranks = true;  ///< `begin_step` does its work whatever rank a particle is on

  Motion motion = Motion();  ///< of all bodies, if it is a function object of your own

  template <class F>
  void for_each_part(F const& f) {
    detail::for_each_part_of(motion, f);
  }

  /// Nothing: but with it the simulation keeps the time on the device.
  template <class Space, class State, class S>
  void begin_step(Space&, State const&, S) const {}
};

}  // namespace collide
