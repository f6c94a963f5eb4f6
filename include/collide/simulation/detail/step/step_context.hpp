/// \file
/// The context of a step: all that its parts share.
#pragma once

#include <collide/effects/detail/effect_list.hpp>
#include <collide/narrow/detail/traits.hpp>
#include <collide/simulation/detail/bodies/bodies_ref.hpp>

namespace collide::detail {

/// The particles, the effects, the mesh, and the time. `NarrowPhase` judges spheres at rest, or spheres that move: then
/// particles that may touch the mesh stay where they are until their contacts are resolved. `Triangles` is what an
/// index's `mesh_lookup()` returns (mesh_lookup.hpp).
template <class S, class NarrowPhase, class Triangles, class Effects>
struct step_context {
  using scalar = S;
  using narrow_phase = NarrowPhase;
  using triangles_type = Triangles;
  using effects_type = Effects;
  using state_type = particle_state<S, typename Effects::all>;

  static constexpr bool is_swept = !is_discrete<NarrowPhase, S>;
  static constexpr bool any_mesh_contact = Effects::any_mesh_contact;
  static constexpr bool has_bodies = has_moving_mesh<Triangles>;
  /// The parts of a step's acceleration that come before positions change, and at the end of the step.
  static constexpr S kick_before = S(Effects::integrator::kick_before), kick_after = S(Effects::integrator::kick_after);

  state_type state;
  Effects effects;
  Triangles triangles;
  id* overflow;  ///< room for the numbers of all particles and their padding; only where threads share a block
  S dt;
  bool reverse_order;  ///< the last particles first: what the step before has written last is still in the caches
  S min_radius;        ///< swept particles are searched for as if they were at least so large
};

}  // namespace collide::detail
