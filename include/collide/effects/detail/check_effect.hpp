/// \file
/// The arguments of the members of an effect: a member that cannot be called with them would be left out
/// in silence.
#pragma once

#include <type_traits>

#include <collide/effects/detail/effect_list.hpp>
#include <collide/query/concepts.hpp>

namespace collide::detail {

/// Has a member of each name. What also derives from a class with such a member has two, and its name says nothing.
struct every_effect_member {
  int is_inactive, accelerate, on_mesh_contact, after_mesh_contact, on_mesh_impulse, holds, on_pair_contact,
      on_mesh_overlap, try_wake, end_step, begin_step, check_parameters;
};
template <class E>
struct effect_and_every_member : E, every_effect_member {};

/// Well-formed unless the class E has a member of that name, whatever its parameters are.
#define COLLIDE_LACKS(MEMBER) \
  template <class E>          \
  using MEMBER = decltype(&effect_and_every_member<E>::MEMBER);
struct effect_lacks {
  COLLIDE_LACKS(is_inactive)
  COLLIDE_LACKS(accelerate)
  COLLIDE_LACKS(on_mesh_contact)
  COLLIDE_LACKS(after_mesh_contact)
  COLLIDE_LACKS(on_mesh_impulse)
  COLLIDE_LACKS(holds)
  COLLIDE_LACKS(on_pair_contact)
  COLLIDE_LACKS(on_mesh_overlap)
  COLLIDE_LACKS(try_wake)
  COLLIDE_LACKS(end_step)
  COLLIDE_LACKS(begin_step)
  COLLIDE_LACKS(check_parameters)
};
#undef COLLIDE_LACKS

/// Says which member of an effect is not as effect.hpp has it.
template <class E, class Space, class S>
constexpr bool check_effect() {
  if constexpr (std::is_class<E>::value && !std::is_final<E>::value) {
    using m = effect_lacks;
    using state = particle_state<S, typename archetype<E, S>::list>;
    static_assert(has_is_inactive<E, S>::value || is_valid<m::template is_inactive, E>,
                  "collide: an effect's is_inactive is called as is_inactive(particle) const, with any particle");
    static_assert(has_accelerate<E, S>::value || is_valid<m::template accelerate, E>,
                  "collide: an effect's accelerate is called as accelerate(particle&, dt) const, with any particle");
    static_assert(has_on_mesh_contact<E, S>::value || is_valid<m::template on_mesh_contact, E>,
                  "collide: an effect's on_mesh_contact is called as on_mesh_contact(particle&, mesh_contact&, dt) "
                  "const, with any particle");
    static_assert(has_after_mesh_contact<E, S>::value || is_valid<m::template after_mesh_contact, E>,
                  "collide: an effect's after_mesh_contact is called as after_mesh_contact(particle&, mesh_contact&, "
                  "dt) const, with any particle");
    static_assert(has_on_mesh_impulse<E, S>::value || is_valid<m::template on_mesh_impulse, E>,
                  "collide: an effect's on_mesh_impulse is called as on_mesh_impulse(particle&, mesh_impulse const&, "
                  "dt) const, with any particle");
    static_assert(has_holds<E, S>::value || is_valid<m::template holds, E>,
                  "collide: an effect's holds is called as holds(particle, pull, dt) const, with any particle");
    static_assert(pairs_in<E, S> || is_valid<m::template on_pair_contact, E>,
                  "collide: an effect's on_pair_contact is called as on_pair_contact(particle&, self, other, dt) "
                  "const, or with the memory of the contact before dt if the effect remembers something, with any "
                  "particle");
    static_assert(overlaps_in<E, S> || is_valid<m::template on_mesh_overlap, E>,
                  "collide: an effect's on_mesh_overlap is called as on_mesh_overlap(particle&, self, mesh_overlap "
                  "const&, dt) const, or with the memory of the contact before dt if the effect remembers something, "
                  "with any particle");
    static_assert(has_try_wake<E, S>::value || is_valid<m::template try_wake, E>,
                  "collide: an effect's try_wake is called as try_wake(particle&, other) const, with any particle");
    static_assert(has_end_step<E, S>::value || is_valid<m::template end_step, E>,
                  "collide: an effect's end_step is called as end_step(particle&, dt) const, with any particle");
    static_assert(
        has_begin_step<E, Space, state, S> || is_valid<m::template begin_step, E>,
        "collide: an effect's begin_step is called as begin_step(space&, state, dt), with any space and state");
    static_assert(is_valid<check_parameters_call, E> || is_valid<m::template check_parameters, E>,
                  "collide: an effect's check_parameters is called as check_parameters() const");
  }
  return true;
}

/// Properties of an effect: the mesh is solid with it; it needs that, or that or particles that meet.
COLLIDE_MEMBER_OR(needs_contacts, needs_contacts, false)

template <class Space, class S, class... Effect>
constexpr bool check_effects() {
  static_assert((check_effect<Effect, Space, S>() && ...));
  static_assert((is_effect<Effect, Space, S> && ...),
                "collide: what follows the detector in a simulation are effects, such as gravity or bounce: copyable "
                "classes with at least one of the members that effect.hpp names");
  static_assert((int(is_integrator<Effect>::value) + ... + 0) <= 1, "collide: a simulation has one integrator");
  static_assert((int(is_source<Effect>) + ... + 0) <= 1,
                "collide: a simulation has one source: give emit_from a Source that begins at several places");
  static_assert(
      follows_all_that_repel<Effect...> && follows_all_pair_contacts<S, Effect...>,
      "collide: an effect comes after those whose result it uses: name friction and adhesion after bounce (or what "
      "else repels), wear after granular_contact, and pair_forces and contact_work after all that act between "
      "particles");
  constexpr bool is_solid = (repels<Effect> || ...), meets = (pairs_in<Effect, S> || ...);
  static_assert(
      is_solid || !(needs_solid_mesh<Effect> || ...),
      "collide: friction and adhesion act where the mesh is solid, and wear where granular_contact presses: name "
      "bounce, granular_contact, or an effect of yours with static constexpr bool repels = true, before them");
  static_assert(
      !(overlaps_in<Effect, S> || ...) ||
          !((has_on_mesh_contact<Effect, S>::value || has_after_mesh_contact<Effect, S>::value) || ...),
      "collide: granular_contact makes the mesh solid by forces: leave out bounce, friction, adhesion and spin, "
      "whose impulses would come on top; it has laws of its own for them");
  static_assert(is_solid || meets || !(needs_contacts<Effect> || ...),
                "collide: spin needs contacts that turn particles: name bounce or sphere_contact with it");
  return true;
}

}  // namespace collide::detail
