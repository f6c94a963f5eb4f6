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

#include <collide/geometry.hpp>

namespace collide {

/// A list of columns.
template <class... Column>
struct columns {
  static constexpr std::size_t size = sizeof...(Column);  ///< how many
};

/// The centre, in the units of the scene.
struct position {
  template <class S>
  using value = vec3<S>;
};

/// The velocity, in units of length per unit of time.
struct velocity {
  template <class S>
  using value = vec3<S>;
};

/// The radius, in the units of the scene, where each particle has its own; see `polydisperse`.
struct radius {
  template <class S>
  using value = S;
};

/// Radians per unit of time, around the axis that it points along; see `spin`.
struct angular_velocity {
  template <class S>
  using value = vec3<S>;
};

/// 1 if the particle is there, 0 if its place is free; see `emit` and `absorb`.
struct alive {
  template <class S>
  using value = std::uint8_t;
  template <class S>
  static constexpr std::uint8_t initial = 1;
};

/// For how many steps the particle has been slow; see `sleep`.
struct slow_steps {
  template <class S>
  using value = std::uint8_t;
};

/// 1 if the particle sticks to what rests of the mesh, 2 + k if to body number k, 0 if it is free; see `adhesion`.
struct adhered {
  template <class S>
  using value = std::uint8_t;
};

/// The number of the particle among those of all ranks, where there are several; see distributed_simulation.cuh.
struct global_number {
  template <class S>
  using value = id;
};

}  // namespace collide
