/// \file
/// The effects of a simulation, the columns that they need, and how they are called.
#pragma once

#include <collide/detail/simulation/particle_access.hpp>
#include <collide/detail/simulation/resistance.hpp>
#include <collide/integrators.hpp>

namespace collide::detail {

/// Sees all that an effect names; only to ask what members the effect has.
template <class E, class S>
using archetype =
    particle<S,
             union_of<typename reads_of<E>::type, typename writes_of<E>::type, typename optional_writes_of<E>::type>>;
template <class E, class S>
using archetype_access = particle_access<E, archetype<E, S>>;

// ---- what an effect has

template <class E, class S, class = void>
struct skips_in : std::false_type {};
template <class E, class S>
struct skips_in<
    E, S, std::void_t<decltype(std::declval<E const&>().is_inactive(std::declval<archetype_access<E, S> const&>()))>>
    : std::true_type {};
template <class E, class S, class = void>
struct accelerates_in : std::false_type {};
template <class E, class S>
struct accelerates_in<
    E, S, std::void_t<decltype(std::declval<E const&>().accelerate(std::declval<archetype_access<E, S>&>(), S{}))>>
    : std::true_type {};
/// Drag and wind: what resists the motion that all others accelerate.
template <class E, class S, class = void>
struct resists_in : std::false_type {};
template <class E, class S>
struct resists_in<
    E, S, std::void_t<decltype(std::declval<E const&>().resistance(std::declval<archetype_access<E, S> const&>()))>>
    : std::true_type {};
template <class E, class S>
inline constexpr bool changes_velocity_in = accelerates_in<E, S>::value || resists_in<E, S>::value;
template <class E, class S, class = void>
struct touches_in : std::false_type {};
template <class E, class S>
struct touches_in<E, S,
                  std::void_t<decltype(std::declval<E const&>().on_mesh_contact(
                      std::declval<archetype_access<E, S>&>(), std::declval<mesh_contact<S>&>(), S{}))>>
    : std::true_type {};
template <class E, class S, class = void>
struct settles_in : std::false_type {};
template <class E, class S>
struct settles_in<E, S,
                  std::void_t<decltype(std::declval<E const&>().after_mesh_contact(
                      std::declval<archetype_access<E, S>&>(), std::declval<mesh_contact<S>&>(), S{}))>>
    : std::true_type {};
template <class E, class S, class = void>
struct meets_in : std::false_type {};
template <class E, class S>
struct meets_in<E, S,
                std::void_t<decltype(std::declval<E const&>().on_pair_contact(
                    std::declval<archetype_access<E, S>&>(), std::declval<archetype_access<E, S> const&>(),
                    std::declval<archetype_access<E, S> const&>(), S{}))>> : std::true_type {};
template <class E, class S, class = void>
struct disturbs_in : std::false_type {};
template <class E, class S>
struct disturbs_in<E, S,
                   std::void_t<decltype(std::declval<E const&>().try_wake(
                       std::declval<archetype_access<E, S>&>(), std::declval<archetype_access<E, S> const&>()))>>
    : std::true_type {};
template <class E, class S, class = void>
struct ends_in : std::false_type {};
template <class E, class S>
struct ends_in<E, S,
               std::void_t<decltype(std::declval<E const&>().end_step(std::declval<archetype_access<E, S>&>(), S{}))>>
    : std::true_type {};

/// What an effect may ask at the end of a step: what the forces of a list of effects are.
template <class Effects, class P, class S>
struct forces_on {
  static constexpr S kick_after = S(Effects::integrator::kick_after);  ///< part of the step's acceleration that is last

  Effects const& effects;
  P const& particle;

  /// How much they change the velocity of the particle in the time `dt`.
  COLLIDE_HD_INLINE vec3<S> change(S dt) const {
    P next = particle;
    effects.accelerate(next, dt);
    return next[velocity{}] - particle[velocity{}];
  }
};
template <class E, class S>
struct finishes_in : std::bool_constant<ends_in<E, S>::value || asks_forces<E>> {};
template <class E, class Space, class State, class S, class = void>
struct begins_in : std::false_type {};
template <class E, class Space, class State, class S>
struct begins_in<
    E, Space, State, S,
    std::void_t<decltype(std::declval<E&>().begin_step(std::declval<Space&>(), std::declval<State const&>(), S{}))>>
    : std::true_type {};

/// True for an effect that contacts with the mesh concern.
template <class E, class S>
inline constexpr bool touches_mesh_in = touches_in<E, S>::value || settles_in<E, S>::value;

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
    return skips_in<E, S>::value || changes_velocity_in<E, S> || touches_mesh_in<E, S> || meets_in<E, S>::value ||
           finishes_in<E, S>::value || begins_in<E, Space, state, S>::value || is_integrator<E>::value ||
           archetype<E, S>::list::size != 0;
  }
}();

template <class List, class E>
inline constexpr bool names = false;
template <class... F, class E>
inline constexpr bool names<effects<F...>, E> = (std::is_same<F, E>::value || ...);

/// True if no effect of the list comes before one that it follows.
template <class... E>
inline constexpr bool respects_order = true;
template <class E, class... Later>
inline constexpr bool respects_order<E, Later...> =
    !(names<typename runs_after_of<E>::type, Later> || ...) && respects_order<Later...>;

template <class... E>
struct integrator_of {
  using type = semi_implicit_euler;
};
template <class E, class... Later>
struct integrator_of<E, Later...> {
  using type =
      typename std::conditional_t<is_integrator<E>::value, std::enable_if<true, E>, integrator_of<Later...>>::type;
};

// ---- the list of effects

/// An effect's parameters, in a base class that is found by the effect's type.
template <class E>
struct effect_slot {
  E effect;
};

/// The effects of a simulation and what follows from their list at compile time.
template <class S, class... E>
struct effect_list : effect_slot<E>... {
  using integrator = typename integrator_of<E...>::type;

  static constexpr bool skips = (skips_in<E, S>::value || ...);
  static constexpr bool touches = (touches_mesh_in<E, S> || ...);
  static constexpr bool meets = (meets_in<E, S>::value || ...);
  static constexpr bool finishes = (finishes_in<E, S>::value || ...);
  static constexpr bool resists = (resists_in<E, S>::value || ...);

  using base = columns<position, velocity>;
  /// All columns of the simulation.
  using all = union_of<base, typename reads_of<E>::type..., typename writes_of<E>::type...>;

 private:
  /// What `E` reads or writes in members of which `Has` says whether there is one.
  template <class F, bool Has>
  using reads_if = std::conditional_t<Has,
                                      union_of<typename reads_of<F>::type, typename writes_of<F>::type,
                                               intersection_of<typename optional_writes_of<F>::type, all>>,
                                      columns<>>;
  template <class F, bool Has>
  using writes_if = std::conditional_t<
      Has, union_of<typename writes_of<F>::type, intersection_of<typename optional_writes_of<F>::type, all>>,
      columns<>>;
  template <class F>
  static constexpr bool is_integrated = changes_velocity_in<F, S> || finishes_in<F, S>::value || skips_in<F, S>::value;
  template <class F>
  static constexpr bool writes_while_integrated = changes_velocity_in<F, S> || finishes_in<F, S>::value;
  template <class F>
  static constexpr bool interacts_or_skips = meets_in<F, S>::value || disturbs_in<F, S>::value || skips_in<F, S>::value;
  using own_radius = intersection_of<columns<radius>, all>;
  using own_number = intersection_of<columns<global_number>, all>;
  template <bool Needed>
  using radius_if = std::conditional_t<Needed, own_radius, columns<>>;

 public:
  /// What is read to find out which particles are left out.
  using skipping = union_of<own_number, reads_if<E, skips_in<E, S>::value>...>;
  /// What is read and written for every particle,
  using integration_reads = union_of<base, reads_if<E, is_integrated<E>>..., radius_if<touches>, own_number>;
  using integration_writes = union_of<columns<position>, writes_if<E, writes_while_integrated<E>>...>;
  /// and for those that may touch the mesh.
  using contact = union_of<integration_reads, reads_if<E, touches_mesh_in<E, S>>...>;
  using contact_writes = union_of<integration_writes, writes_if<E, touches_mesh_in<E, S>>...>;
  /// What is read and written for particles that meet others; what is read is also copied.
  using interaction = union_of<columns<position>, reads_if<E, interacts_or_skips<E>>..., radius_if<meets>, own_number>;
  using interaction_copies = difference_of<interaction, columns<position, radius>>;  ///< these two are kept together
  using interaction_writes = union_of<columns<>, writes_if<E, meets_in<E, S>::value || disturbs_in<E, S>::value>...>;

  explicit effect_list(E... e) : effect_slot<E>{std::move(e)}... {}

  /// How many particles a source makes in the time `dt`, and their radius; -1 if there is none.
  double due(double dt) const { return (due_of<E>(dt) + ... + 0.0); }
  S source_radius() const { return (is_source<E> || ...) ? (source_radius_of<E>() + ... + S(0)) : S(-1); }

  template <class F>
  COLLIDE_HD_INLINE F const& of() const {
    return static_cast<effect_slot<F> const&>(*this).effect;
  }
  template <class F>
  F& of() {
    return static_cast<effect_slot<F>&>(*this).effect;
  }

  /// Of two scenes' worth of reasons to leave a particle out, one suffices.
  template <class P>
  COLLIDE_HD_INLINE bool is_skipped([[maybe_unused]] P& p) const {
    return (skipped_by<E>(p) || ...);
  }

  template <class P>
  COLLIDE_HD_INLINE void accelerate([[maybe_unused]] P& p, [[maybe_unused]] S dt) const {
    if constexpr (resists) {
      vec3<S> const before = p[velocity{}];
      media all(before.template cast<double>());
      (accelerate_by<E, !judges_forces<E>>(p, dt), ...);
      (resist_by<E>(p, all), ...);
      p[velocity{}] = velocity_in(all.sum(), before, p[velocity{}], dt);
      (accelerate_by<E, judges_forces<E>>(p, dt), ...);
    } else {
      (accelerate_by<E, true>(p, dt), ...);
    }
  }
  template <class P>
  COLLIDE_HD_INLINE void on_mesh_contact(P& p, mesh_contact<S>& t, S dt) const {
    (touch_by<E>(p, t, dt), ...);
    (settle_by<E>(p, t, dt), ...);
  }
  template <class P>
  COLLIDE_HD_INLINE void on_pair_contact(P& p, P& self, P& other, S dt) const {
    (meet_by<E>(p, self, other, dt), ...);
  }
  template <class P>
  COLLIDE_HD_INLINE void try_wake(P& p, P& other) const {
    (disturb_by<E>(p, other), ...);
  }
  template <class P>
  COLLIDE_HD_INLINE void end_step([[maybe_unused]] P& p, [[maybe_unused]] S dt) const {
    (finish_by<E>(p, dt), ...);
  }

 private:
  template <class F>
  double due_of([[maybe_unused]] double dt) const {
    if constexpr (is_source<F>) return of<F>().rate * dt;
    return 0;
  }
  template <class F>
  S source_radius_of() const {
    if constexpr (is_source<F>) return static_cast<S>(of<F>().radius);
    return 0;
  }
  template <class F, class P>
  COLLIDE_HD_INLINE bool skipped_by([[maybe_unused]] P& p) const {
    if constexpr (skips_in<F, S>::value) {
      particle_access<F, P> const seen(p);
      return of<F>().is_inactive(seen);
    } else {
      return false;
    }
  }
  template <class F, class P>
  COLLIDE_HD_INLINE void resist_by([[maybe_unused]] P& p, [[maybe_unused]] media& all) const {
    if constexpr (resists_in<F, S>::value) {
      particle_access<F, P> const seen(p);
      all.add(of<F>().resistance(seen));
    }
  }
  template <class F, bool Now, class P>
  COLLIDE_HD_INLINE void accelerate_by([[maybe_unused]] P& p, [[maybe_unused]] S dt) const {
    if constexpr (accelerates_in<F, S>::value && Now) {
      particle_access<F, P> seen(p);
      of<F>().accelerate(seen, dt);
    }
  }
  template <class F, class P>
  COLLIDE_HD_INLINE void touch_by([[maybe_unused]] P& p, [[maybe_unused]] mesh_contact<S>& t,
                                  [[maybe_unused]] S dt) const {
    if constexpr (touches_in<F, S>::value) {
      particle_access<F, P> seen(p);
      of<F>().on_mesh_contact(seen, t, dt);
    }
  }
  template <class F, class P>
  COLLIDE_HD_INLINE void settle_by([[maybe_unused]] P& p, [[maybe_unused]] mesh_contact<S>& t,
                                   [[maybe_unused]] S dt) const {
    if constexpr (settles_in<F, S>::value) {
      particle_access<F, P> seen(p);
      of<F>().after_mesh_contact(seen, t, dt);
    }
  }
  template <class F, class P>
  COLLIDE_HD_INLINE void meet_by([[maybe_unused]] P& p, [[maybe_unused]] P& self, [[maybe_unused]] P& other,
                                 [[maybe_unused]] S dt) const {
    if constexpr (meets_in<F, S>::value) {
      particle_access<F, P> seen(p);
      particle_access<F, P> const seen_self(self), seen_other(other);
      of<F>().on_pair_contact(seen, seen_self, seen_other, dt);
    }
  }
  template <class F, class P>
  COLLIDE_HD_INLINE void disturb_by([[maybe_unused]] P& p, [[maybe_unused]] P& other) const {
    if constexpr (disturbs_in<F, S>::value) {
      particle_access<F, P> seen(p);
      particle_access<F, P> const seen_other(other);
      of<F>().try_wake(seen, seen_other);
    }
  }
  template <class F, class P>
  COLLIDE_HD_INLINE void finish_by([[maybe_unused]] P& p, [[maybe_unused]] S dt) const {
    if constexpr (ends_in<F, S>::value) {
      particle_access<F, P> seen(p);
      of<F>().end_step(seen, dt);
    } else if constexpr (asks_forces<F>) {
      particle_access<F, P> seen(p);
      of<F>().end_step(seen, forces_on<effect_list, P, S>{*this, p}, dt);
    }
  }
};

}  // namespace collide::detail
