/// \file
/// Which members an effect has, and where it may be in the list.
#pragma once

#include <collide/effects/bodies.hpp>
#include <collide/effects/detail/contact_memory.hpp>
#include <collide/effects/detail/particle_access.hpp>
#include <collide/effects/detail/resistance.hpp>
#include <collide/effects/integrators.hpp>

namespace collide::detail {

/// True of an effect whose particles do the opposite to each other; see pair_actions.hpp.
COLLIDE_MEMBER_OR(is_mutual_effect, is_mutual, false)

/// Sees all that an effect names; only to ask what members the effect has.
template <class E, class S>
using archetype = particle<S, union_of<reads_of<E>, writes_of<E>, optional_writes_of<E>, optional_reads_of<E>>>;
template <class E, class S>
using archetype_access = particle_access<E, archetype<E, S>>;

// ---- what an effect has

template <class E, class S>
using is_inactive_call = decltype(std::declval<E const&>().is_inactive(std::declval<archetype_access<E, S> const&>()));
template <class E, class S>
using has_is_inactive = std::bool_constant<is_valid<is_inactive_call, E, S>>;
template <class E, class S>
using accelerate_call = decltype(std::declval<E const&>().accelerate(std::declval<archetype_access<E, S>&>(), S{}));
template <class E, class S>
using has_accelerate = std::bool_constant<is_valid<accelerate_call, E, S>>;
template <class Effect>
inline constexpr bool is_moving_bodies = false;
template <class Motion>
inline constexpr bool is_moving_bodies<moving_bodies<Motion>> = true;
/// Drag and wind: what resists the motion that all others accelerate.
template <class E, class S>
using resistance_call = decltype(std::declval<E const&>().resistance(std::declval<archetype_access<E, S> const&>()));
template <class E, class S>
using has_resistance = std::bool_constant<is_valid<resistance_call, E, S>>;
/// Wind: what resists motion in a medium that may move.
template <class E, class S>
inline constexpr bool flows_in =
    !std::is_same<detected_or<medium_at_rest, resistance_call, E, S>, medium_at_rest>::value;
template <class E, class S>
inline constexpr bool changes_velocity = has_accelerate<E, S>::value || has_resistance<E, S>::value;
template <class E, class S>
using on_mesh_contact_call = decltype(std::declval<E const&>().on_mesh_contact(std::declval<archetype_access<E, S>&>(),
                                                                               std::declval<mesh_contact<S>&>(), S{}));
template <class E, class S>
using has_on_mesh_contact = std::bool_constant<is_valid<on_mesh_contact_call, E, S>>;
template <class E, class S>
using after_mesh_contact_call = decltype(std::declval<E const&>().after_mesh_contact(
    std::declval<archetype_access<E, S>&>(), std::declval<mesh_contact<S>&>(), S{}));
template <class E, class S>
using has_after_mesh_contact = std::bool_constant<is_valid<after_mesh_contact_call, E, S>>;
template <class E, class S>
using on_mesh_impulse_call = decltype(std::declval<E const&>().on_mesh_impulse(
    std::declval<archetype_access<E, S>&>(), std::declval<mesh_impulse<S> const&>(), S{}));
template <class E, class S>
using has_on_mesh_impulse = std::bool_constant<is_valid<on_mesh_impulse_call, E, S>>;
template <class E, class S>
using holds_call = decltype(std::declval<E const&>().holds(std::declval<archetype_access<E, S> const&>(),
                                                           std::declval<vec3<S> const&>(), S{}));
template <class E, class S>
using has_holds = std::bool_constant<is_valid<holds_call, E, S>>;
template <class E, class S>
using on_pair_contact_call = decltype(std::declval<E const&>().on_pair_contact(
    std::declval<archetype_access<E, S>&>(), std::declval<archetype_access<E, S> const&>(),
    std::declval<archetype_access<E, S> const&>(), S{}));
template <class E, class S>
using has_on_pair_contact = std::bool_constant<is_valid<on_pair_contact_call, E, S>>;
/// True for an effect whose `on_pair_contact` has what contacts remember as its fourth argument.
template <class E, class S>
using archetype_memory = contact_access<remembers_of<E>, contact_values<S, remembers_of<E>>, S>;
template <class E, class S>
using on_pair_contact_with_memory_call = decltype(std::declval<E const&>().on_pair_contact(
    std::declval<archetype_access<E, S>&>(), std::declval<archetype_access<E, S> const&>(),
    std::declval<archetype_access<E, S> const&>(), std::declval<archetype_memory<E, S> const&>(), S{}));
template <class E, class S>
inline constexpr bool remembers_in = remembers_of<E>::size != 0 && is_valid<on_pair_contact_with_memory_call, E, S>;
template <class E, class S>
inline constexpr bool pairs_in = has_on_pair_contact<E, S>::value || remembers_in<E, S>;
/// True for an effect with `on_mesh_overlap`, if it remembers nothing, or with what the contact remembers.
template <class E, class S>
using on_mesh_overlap_call = decltype(std::declval<E const&>().on_mesh_overlap(
    std::declval<archetype_access<E, S>&>(), std::declval<archetype_access<E, S> const&>(),
    std::declval<mesh_overlap<S> const&>(), S{}));
template <class E, class S>
using on_mesh_overlap_with_memory_call = decltype(std::declval<E const&>().on_mesh_overlap(
    std::declval<archetype_access<E, S>&>(), std::declval<archetype_access<E, S> const&>(),
    std::declval<mesh_overlap<S> const&>(), std::declval<archetype_memory<E, S> const&>(), S{}));
template <class E, class S>
inline constexpr bool overlaps_with_memory =
    remembers_of<E>::size != 0 && is_valid<on_mesh_overlap_with_memory_call, E, S>;
template <class E, class S>
inline constexpr bool overlaps_in = overlaps_with_memory<E, S> ||
                                    (remembers_of<E>::size == 0 && is_valid<on_mesh_overlap_call, E, S>);
template <class E, class S>
using try_wake_call = decltype(std::declval<E const&>().try_wake(std::declval<archetype_access<E, S>&>(),
                                                                 std::declval<archetype_access<E, S> const&>()));
template <class E, class S>
using has_try_wake = std::bool_constant<is_valid<try_wake_call, E, S>>;
template <class E, class S>
using end_step_alone_call = decltype(std::declval<E const&>().end_step(std::declval<archetype_access<E, S>&>(), S{}));
template <class E, class S>
using has_end_step_alone = std::bool_constant<is_valid<end_step_alone_call, E, S>>;

/// True of an effect whose `end_step` sees a clump as one sphere, of its volume and at its centre.
COLLIDE_MEMBER_OR(sees_clumps, sees_clumps, false)

/// True of an effect that accelerates by more than motion: in a clump each sphere by itself.
using motion_columns = columns<position, velocity, angular_velocity>;
template <class E, class S>
inline constexpr bool pushes_spheres =
    has_accelerate<E, S>::value&& difference_of<union_of<reads_of<E>, writes_of<E>>, motion_columns>::size != 0;

/// The forces of a list of effects, for an effect at the end of a step, `OfClump` or of a particle.
template <class Effects, bool OfClump, class P, class S>
struct forces_on {
  static constexpr S kick_after = S(Effects::integrator::kick_after);  ///< part of the step's acceleration that is last
  static constexpr bool have_contacts = Effects::keeps_pair_forces;    ///< contacts are among them

  Effects const& effects;
  P const& particle;

  /// How much they change the velocity of the particle in the time `dt`.
  COLLIDE_HD_INLINE vec3<S> change(S dt) const {
    P next = particle;
    effects.template accelerate<OfClump>(next, dt);
    return next[velocity{}] - particle[velocity{}];
  }
};
template <class E, class S>
struct has_end_step : std::bool_constant<has_end_step_alone<E, S>::value || asks_forces<E>> {};
template <class E, class Space, class State, class S>
using begin_step_call =
    decltype(std::declval<E&>().begin_step(std::declval<Space&>(), std::declval<State const&>(), S{}));
template <class E, class Space, class State, class S>
inline constexpr bool has_begin_step = is_valid<begin_step_call, E, Space, State, S>;
/// True of an effect whose `begin_step` does the same to particles wherever they are.
COLLIDE_MEMBER_OR(begins_on_ranks, begins_on_ranks, false)

/// True for an effect that contacts with the mesh concern.
template <class E, class S>
inline constexpr bool has_mesh_contact =
    has_on_mesh_contact<E, S>::value || has_after_mesh_contact<E, S>::value || has_on_mesh_impulse<E, S>::value;

/// An integrator is named in the same list; see integrators.hpp.
template <class E, class = void>
struct is_integrator : std::false_type {};
template <class E>
struct is_integrator<E, std::void_t<decltype(E::kick_before), decltype(E::kick_after)>> : std::true_type {};

/// True for what may be in a simulation's list.
template <class E, class Space, class S>
inline constexpr bool is_effect = [] {
  if constexpr (!std::is_class<E>::value || !std::is_copy_constructible<E>::value) {
    return false;
  } else {
    using state = particle_state<S, typename archetype<E, S>::list>;
    return has_is_inactive<E, S>::value || changes_velocity<E, S> || has_mesh_contact<E, S> || has_holds<E, S>::value ||
           pairs_in<E, S> || overlaps_in<E, S> || has_end_step<E, S>::value || has_begin_step<E, Space, state, S> ||
           is_integrator<E>::value || archetype<E, S>::list::size != 0;
  }
}();

/// True of an effect that makes the mesh solid, and of one that needs a solid mesh.
COLLIDE_MEMBER_OR(repels, repels, false)
COLLIDE_MEMBER_OR(needs_solid_mesh, needs_solid_mesh, false)

/// True if no effect of the list comes before one that makes the mesh solid, and that it needs.
template <class... E>
inline constexpr bool follows_all_that_repel = true;
template <class E, class... Later>
inline constexpr bool follows_all_that_repel<E, Later...> =
    !(needs_solid_mesh<E> && (repels<Later> || ...)) && follows_all_that_repel<Later...>;

/// True of an effect that looks at what others do between particles.
COLLIDE_MEMBER_OR(follows_pair_contacts, follows_pair_contacts, false)

/// True if no effect of the list comes before one that acts between particles and that it follows.
template <class S, class... E>
inline constexpr bool follows_all_pair_contacts = true;
template <class S, class E, class... Later>
inline constexpr bool follows_all_pair_contacts<S, E, Later...> =
    !(follows_pair_contacts<E> && ((pairs_in<Later, S> && !follows_pair_contacts<Later>) || ...)) &&
    follows_all_pair_contacts<S, Later...>;

}  // namespace collide::detail
