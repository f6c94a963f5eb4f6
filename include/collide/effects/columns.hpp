/// \file
/// The columns of a simulation's state: arrays with one value per particle (SoA).
///
/// A column is a type with a member template `value<S>`, the type of its values, where S is the scalar of the
/// simulation: `vec3<S>`, `S`, or a plain integer. `static constexpr value<S> initial<S>` is the value that a particle
/// begins with, zero by default. An effect may name columns of its own:
///
///     struct temperature {
///       template <class S> using value = S;
///       template <class S> static constexpr S initial = S(20);
///     };
#pragma once

#include <cstdint>

#include <collide/core/geometry.hpp>

namespace collide {

namespace detail {

/// In `slow_steps` from here on: the particle touches, by way of so many others, what moves.
inline constexpr int carried_by_moving = 128;
/// In `adhered`: the particle is free, and came too fast to stick.
inline constexpr std::uint8_t came_too_fast = 255;
COLLIDE_HD_INLINE bool is_stuck(std::uint8_t adhered) { return adhered != 0 && adhered != came_too_fast; }

/// In `held`: the second half kick of the last step is still to come; or the particle stuck all through the step.
inline constexpr std::uint8_t owes_a_kick = 1, stuck_all_along = 2;

/// In `in_contact`: the particle has been woken between steps, and forces on it are not known.
inline constexpr std::uint8_t just_woken = 2;

/// For how many steps a particle has been slow.
COLLIDE_HD_INLINE int steps_slow(int slow_steps) { return slow_steps < carried_by_moving ? slow_steps : 0; }

/// How many steps, this one included, are in the mean that `support` is: those since the last power of two.
COLLIDE_HD_INLINE int steps_in_mean(int slow_steps) {
  int const slow = steps_slow(slow_steps);
  int power = 64;
  while (power > slow && power > 1) power /= 2;
  return slow == 0 ? 1 : slow - power + 1;
}

/// `N` numbers of a column.
template <class T, std::size_t N>
struct several {
  T of[N];
  COLLIDE_HD explicit several(T all = T(0)) {
    for (T& one : of) one = all;
  }
};

/// Column of a vector for each particle.
struct vector_column {
  template <class S>
  using value = vec3<S>;
};
/// Column of a number of the simulation's scalar.
struct number_column {
  template <class S>
  using value = S;
};
/// Column of a number of a certain type.
template <class T>
struct column_of {
  template <class S>
  using value = T;
};
/// Column of a small integer.
using byte_column = column_of<std::uint8_t>;
/// Column of four numbers of the simulation's scalar.
struct four_column {
  template <class S>
  using value = several<S, 4>;
};

}  // namespace detail

/// A list of columns.
template <class... Column>
struct columns {
  static constexpr std::size_t size = sizeof...(Column);  ///< how many
};

/// A list of columns that each contact has, not each particle: what an effect remembers of it from step to step. See
/// `remembers` in effect.hpp.
template <class... Column>
struct contact_columns {
  using list = columns<Column...>;  ///< the columns
};

/// The centre, in the units of the scene.
struct position : detail::vector_column {};

/// The velocity, in units of length per unit of time.
struct velocity : detail::vector_column {};

/// The radius, in the units of the scene, where each particle has its own; see `polydisperse`.
struct radius : detail::number_column {};

/// The material of a particle, as a number: see `materials`. Scenes have it that name `granular_contact` with
/// `materials`.
struct material : detail::byte_column {};

/// Radians per unit of time, around the axis that it points along; see `spin`.
struct angular_velocity : detail::vector_column {};

/// 1 if the particle is there, 0 if its place is free, within a step 2 to 4 if it has just been made; see `emit` and
/// `absorb`. An effect of your own makes a particle in its `begin_step` by writing 1 at a free place. No contact
/// remembers what was there, and columns that no such effect writes have their first values again, except for position,
/// velocity and radius.
struct alive : detail::byte_column {
  template <class S>
  static constexpr std::uint8_t initial = 1;
};

/// For how many steps the particle has been slow, or 128 and more if it lies on what moves; see `sleep`.
struct slow_steps : detail::byte_column {};

/// 1 if the particle has touched something in this step: only then does it come closer to sleep. 2 if it has been woken
/// between steps and forces on it are not known yet. See `sleep`.
struct in_contact : detail::byte_column {};

/// 1 if the particle sticks to what rests of the mesh, 2 + k if to body number k, 0 if it is free; 255 if it is free
/// and touched the mesh too fast to stick when it last came to it. See `adhesion`.
struct adhered : detail::byte_column {};

/// 1 if the mesh held the particle at the end of the last step, whose second half kick is then part of the next one; 2
/// if it stuck to the mesh all the time. Scenes have it that name `velocity_verlet` and an effect that touches the
/// mesh.
struct held : detail::byte_column {};

/// Acceleration by other particles, in length per time squared. Scenes have it that name an effect with
/// `on_pair_contact`, and `velocity_verlet`, `adhesion`, or `sleep` with `reaction` or `mesh_forces`.
struct pair_acceleration : detail::vector_column {};

/// Angular acceleration by other particles, in radians per time squared. Scenes have it that name an effect with
/// `on_pair_contact`, `spin`, and `velocity_verlet` or `sleep` with an effect with `on_mesh_impulse`.
struct pair_angular_acceleration : detail::vector_column {};

/// Accelerations by the mesh and angular accelerations, of up to four contacts, six numbers each: what they were when
/// particles last met, for the half kick with which the next step begins. The last one has those of all others with it.
/// Scenes have it and the next two that name `velocity_verlet`, an effect with `on_mesh_overlap` and one with
/// `on_mesh_impulse`.
struct mesh_kicks {
  static constexpr int contacts = 4;  ///< of a particle
  template <class S>
  using value = detail::several<S, 6 * contacts>;
};

/// Triangle and body of each of `mesh_kicks`.
struct mesh_kicks_by : detail::column_of<detail::several<id, 2 * mesh_kicks::contacts>> {};

/// How many `mesh_kicks` there are.
struct mesh_kick_count : detail::byte_column {};

/// Acceleration by the mesh, on the mean over the steps in which the particle has been slow: so it is known on what a
/// particle presses that sleeps. Scenes have it that name `sleep` and an effect with `on_mesh_impulse`.
struct support : detail::vector_column {};

/// Which surface `support` is of: 0 none, 1 what rests of the mesh, 2 + k body number k.
struct supported_by : detail::byte_column {};

/// Acceleration by a second surface, in the corner of two. Scenes have it, and the next three, that have `support` and
/// name `moving_bodies`.
struct second_support : detail::vector_column {};

/// Which surface `second_support` is of.
struct second_supported_by : detail::byte_column {};

/// Acceleration by a third surface, and all others.
struct third_support : detail::vector_column {};

/// Which surface `third_support` is of: the first of them.
struct third_supported_by : detail::byte_column {};

/// The number of the first sphere of the clump that a sphere is of; `no_id` of one that is a grain by itself. See
/// `clumps`.
struct in_clump : detail::column_of<id> {
  template <class S>
  static constexpr id initial = no_id;  ///< of a grain by itself
};

/// The mass of a sphere's clump over that of the sphere by itself: dashpots know it. 1 of a grain by itself.
struct clump_mass : detail::number_column {
  template <class S>
  static constexpr S initial = S(1);
};

/// By how much the last half kick by contacts has changed the velocity of a sphere of a clump. Scenes have it and the
/// next one that name `clumps` and `contact_work`.
struct clump_push : detail::vector_column {};

/// By how much it has changed the angular velocity.
struct clump_turn : detail::vector_column {};

namespace detail {

// changes of a particle's velocity and spin in a step by other particles, and parts of them, and of those by walls:
// those of tangential forces; see contact_work.hpp
struct pairs_push : vector_column {};
struct pairs_turn : vector_column {};
struct slide_push : vector_column {};
struct slide_turn : vector_column {};

}  // namespace detail

/// The number of the particle among those of all ranks, where there are several; see distributed_simulation.cuh.
struct global_number : detail::column_of<id> {};

}  // namespace collide
