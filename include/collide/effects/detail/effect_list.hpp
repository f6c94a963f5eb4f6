/// \file
/// The effects of a simulation, the columns that they need, and how they are called.
#pragma once

#include <algorithm>

#include <collide/effects/detail/effect_traits.hpp>
#include <collide/effects/detail/resistance.hpp>
#include <collide/exact/detail/numeric/repeating_box.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace collide::detail {

/// Why particles meet: in a step, or between two, to know the forces with which the next begins. Then nothing else is
/// written, and nothing that contacts remember changes: old ones are seen a step later, so what slid goes on sliding.
enum class meeting : std::uint8_t {
  in_step,
  of_all,   ///< between steps
  of_woken  ///< between steps: only those that slept ask, the others know
};

/// True of a particle that has been woken between steps, and not met others yet.
template <class State>
COLLIDE_HD_INLINE bool is_just_woken([[maybe_unused]] State const& state, [[maybe_unused]] std::size_t i) {
  if constexpr (contains<typename State::list, in_contact>) return state.at(in_contact{})[i] == just_woken;
  return false;
}

/// An effect's parameters, in a base class that is found by the effect's type.
template <class E>
struct effect_slot {
  E effect;
};

/// The resistance of drag and wind in a step, if there are any; known before it.
template <bool Resists>
struct resistance_slot {};
template <>
struct resistance_slot<true> {
  resistance_in_step resistance;
};

/// The effects of a simulation and what follows from their list at compile time.
template <class S, class... E>
struct effect_list : effect_slot<E>..., resistance_slot<(has_resistance<E, S>::value || ...)> {
  using integrator = typename first_of<semi_implicit_euler, choice<is_integrator<E>::value, E>...>::type;

  static constexpr bool any_inactive = (has_is_inactive<E, S>::value || ...);
  static constexpr bool any_pair_contact = (pairs_in<E, S> || ...);
  static constexpr bool repeats = any_pair_contact && (repeats_space<E> || ...);  ///< particles meet across a box
  using space_type = std::conditional_t<repeats, repeating_box<S>, open_space>;
  using remembered = union_of<columns<>, remembers_of<E>...>;  ///< by contacts between particles
  static constexpr bool any_end_step = (has_end_step<E, S>::value || ...);
  static constexpr bool any_mesh_impulse = (has_on_mesh_impulse<E, S>::value || ...);
  static constexpr bool overlaps = (overlaps_in<E, S> || ...);  ///< particles press on the mesh by forces,
  static constexpr bool remembers_surfaces = overlaps && remembered::size != 0;
  static constexpr double farther = std::max({0.0, farther_of<E>...});
  static constexpr double farthest_saddle = std::max({0.0, farthest_saddle_of<E>...});
  static constexpr bool any_mesh_contact =  ///< or by impulses
      (has_on_mesh_contact<E, S>::value || ...) || (has_after_mesh_contact<E, S>::value || ...) ||
      (any_mesh_impulse && !overlaps);
  static constexpr bool any_resistance = (has_resistance<E, S>::value || ...);
  static constexpr bool any_push = (pushes_spheres<E, S> || ...);
  static constexpr bool flows = (flows_in<E, S> || ...);

  using base = columns<position, velocity>;
  using named = union_of<base, reads_of<E>..., writes_of<E>...>;
  static constexpr bool adheres = any_mesh_contact && contains<named, adhered>;
  static constexpr bool has_clumps = contains<named, in_clump>;
  static constexpr bool has_half_kicks = integrator::kick_after != 0;
  /// Particles that sleep still press on what they lie on.
  static constexpr bool keeps_support = any_mesh_impulse && contains<named, slow_steps>;
  /// Effects that know no mesh may hold particles where they are.
  static constexpr bool holds_without_mesh = ((has_end_step<E, S>::value && contains<writes_of<E>, velocity>) || ...);
  /// The effect of particles on each other is kept as an acceleration, for each half kick, for adhesion and for
  /// sleepers.
  static constexpr bool keeps_pair_forces =
      (any_pair_contact || overlaps) && (adheres || has_half_kicks || keeps_support);
  static constexpr bool keeps_pair_torques =
      (any_pair_contact || overlaps) && (has_half_kicks || keeps_support) && contains<named, angular_velocity>;
  /// A step ends once particles have met where they then are.
  static constexpr bool ends_after_meeting = (any_pair_contact || overlaps) && has_half_kicks;
  /// The forces of the mesh are kept, each by itself: effects are told of each half kick when it is given.
  static constexpr bool keeps_mesh_kicks = overlaps && has_half_kicks && any_mesh_impulse;

 private:
  template <bool Needed, class... C>
  using columns_if = std::conditional_t<Needed, columns<C...>, columns<>>;
  using pair_kicks = union_of<columns_if<keeps_pair_forces, pair_acceleration>,
                              columns_if<keeps_pair_torques, pair_angular_acceleration>>;
  using clump_kicks =
      columns_if<has_clumps && ((follows_pair_contacts<E> && asks_forces<E>) || ...), clump_push, clump_turn>;
  using held_columns = columns_if<any_mesh_contact && has_half_kicks, held>;
  using mesh_kick_columns = columns_if<keeps_mesh_kicks, mesh_kicks, mesh_kicks_by, mesh_kick_count>;
  using support_columns = union_of<columns_if<keeps_support, support, supported_by>,
                                   columns_if<keeps_support && (is_moving_bodies<E> || ...), second_support,
                                              second_supported_by, third_support, third_supported_by>>;

 public:
  using all = union_of<named, pair_kicks, clump_kicks, held_columns, support_columns, mesh_kick_columns>;

 private:
  /// Columns that `E` reads or writes in a member, if it `Has` it.
  template <class F, bool Has>
  using reads_if = std::conditional_t<Has,
                                      union_of<reads_of<F>, writes_of<F>, intersection_of<optional_writes_of<F>, all>,
                                               intersection_of<optional_reads_of<F>, all>>,
                                      columns<>>;
  template <class F, bool Has>
  using writes_if =
      std::conditional_t<Has, union_of<writes_of<F>, intersection_of<optional_writes_of<F>, all>>, columns<>>;
  template <class F>
  static constexpr bool is_integrated = changes_velocity<F, S> || has_end_step<F, S>::value ||
                                        has_is_inactive<F, S>::value || has_holds<F, S>::value ||
                                        (has_on_mesh_impulse<F, S>::value && (adheres || keeps_support));
  template <class F>
  static constexpr bool writes_while_integrated = changes_velocity<F, S> || has_end_step<F, S>::value ||
                                                  has_holds<F, S>::value ||
                                                  (has_on_mesh_impulse<F, S>::value && (adheres || keeps_support));
  template <class F>
  static constexpr bool interacts_or_skips =
      pairs_in<F, S> || has_try_wake<F, S>::value || has_is_inactive<F, S>::value;
  using own_radius = intersection_of<columns<radius>, all>;
  using own_number = intersection_of<columns<global_number>, all>;
  using own_clump = intersection_of<columns<in_clump>, all>;
  using own_in_contact = intersection_of<columns<in_contact>, all>;
  using own_slow_steps = columns_if<(is_moving_bodies<E> || ...) && contains<all, slow_steps>, slow_steps>;
  template <bool Needed>
  using radius_if = std::conditional_t<Needed, own_radius, columns<>>;

 public:
  /// Columns that are read to find out which particles are inactive.
  using inactive_reads = union_of<own_number, reads_if<E, has_is_inactive<E, S>::value>...>;
  /// Columns that are read and written for every particle,
  using integration_reads =
      union_of<base, reads_if<E, is_integrated<E>>..., radius_if<any_mesh_contact || keeps_support>, own_number,
               own_clump, pair_kicks, columns_if<keeps_pair_torques, angular_velocity>, held_columns, support_columns>;
  using integration_writes = union_of<columns<position>, columns_if<keeps_pair_forces, velocity>,
                                      columns_if<keeps_pair_torques, angular_velocity>, held_columns, support_columns,
                                      writes_if<E, writes_while_integrated<E>>...>;
  /// and for those that may touch the mesh.
  using contact = union_of<integration_reads, reads_if<E, has_mesh_contact<E, S>>...>;
  using contact_writes = union_of<integration_writes, writes_if<E, has_mesh_contact<E, S>>...>;
  /// Columns that are read and written for particles that meet others; those that are read are also copied.
  using interaction = union_of<columns<position>, columns_if<keeps_pair_forces, velocity>,
                               columns_if<keeps_pair_torques, angular_velocity>, reads_if<E, interacts_or_skips<E>>...,
                               radius_if<any_pair_contact>, own_number>;
  using interaction_copies = difference_of<interaction, columns<position, radius>>;  ///< these two are kept together
  using interaction_writes = difference_of<
      union_of<columns<>, writes_if<E, pairs_in<E, S> || has_try_wake<E, S>::value>...>,
      union_of<columns_if<keeps_pair_forces, velocity>, columns_if<keeps_pair_torques, angular_velocity>>>;
  using interaction_kicks = pair_kicks;  ///< what is kept of them in place of velocities
  /// Columns that are written for all spheres of a clump that effects have seen as one.
  using clump_writes = difference_of<union_of<columns<>, writes_if<E, sees_clumps<E>>...>,
                                     columns<position, velocity, angular_velocity>>;
  /// Columns on which forces on a particle depend that is alone.
  using acceleration_reads = union_of<columns<>, reads_if<E, changes_velocity<E, S>>...>;
  /// Columns that are read and written for particles that press on the mesh.
  using overlap_reads =
      union_of<base, own_radius, own_number, pair_kicks, columns_if<keeps_pair_torques, angular_velocity>,
               support_columns, own_slow_steps, own_in_contact,
               reads_if<E, overlaps_in<E, S> || has_is_inactive<E, S>::value ||
                               (overlaps && has_on_mesh_impulse<E, S>::value)>...>;
  using overlap_writes = difference_of<
      union_of<pair_kicks, support_columns, own_slow_steps, own_in_contact,
               writes_if<E, overlaps_in<E, S> || (overlaps && has_on_mesh_impulse<E, S>::value)>...>,
      union_of<columns_if<keeps_pair_forces, velocity>, columns_if<keeps_pair_torques, angular_velocity>>>;

  /// On a CPU particles meet once a pair, for the one effect that is between them; see pair_actions.hpp.
  static constexpr bool meets_once = (int(pairs_in<E, S>) + ... + 0) == 1 && (is_mutual_effect<E> || ...) &&
                                     !any_inactive && !contains<all, global_number> &&
                                     !(has_try_wake<E, S>::value || ...);
  using source = typename first_of<absent, choice<is_source<E>, E>...>::type;
  using mutual_effect = typename first_of<absent, choice<is_mutual_effect<E>, E>...>::type;
  static constexpr bool may_be_reordered = false;  ///< see cell_order.hpp
  static constexpr unsigned action_width =
      mutual_effect::action_width > 4 && contains<all, slide_push> ? 13 : mutual_effect::action_width;
  template <class F>
  void for_mutual(F const& f) const {
    f(of<mutual_effect>());
  }

  explicit effect_list(E... e) : effect_slot<E>{std::move(e)}... {}

  static constexpr bool makes = (is_source<E> || ...);
  double due([[maybe_unused]] double dt) const {
    if constexpr (makes) return of<source>().rate * dt;
    return 0;
  }
  /// True if particles of a source are not born where something is already.
  bool makes_only_where_free() const {
    if constexpr (makes) return of<source>().only_where_free;
    return false;
  }
  /// The radius of the particles of a source; -1 if there is none.
  S source_radius() const {
    if constexpr (makes) return static_cast<S>(of<source>().radius);
    return S(-1);
  }

  /// The space in which particles meet.
  space_type space() const {
    space_type found{};
    if constexpr (repeats) {
      auto const& box = of<typename first_of<absent, choice<repeats_space<E>, E>...>::type>();
      for (int k = 0; k < 3; ++k) {
        found.lower[k] = static_cast<S>(box.lower[k]);
        found.upper[k] = static_cast<S>(box.upper[k]);
      }
    }
    return found;
  }

  /// True of a particle that is left out, if that is because it sleeps.
  template <class P>
  COLLIDE_HD_INLINE bool only_sleeps(P p) const {
    p[slow_steps{}] = 0;
    return !is_inactive(p);
  }

  template <class F>
  COLLIDE_HD_INLINE F const& of() const {
    return static_cast<effect_slot<F> const&>(*this).effect;
  }
  template <class F>
  F& of() {
    return static_cast<effect_slot<F>&>(*this).effect;
  }

  /// True if any effect says that the particle is inactive.
  template <class P>
  COLLIDE_HD_INLINE bool is_inactive(P& p) const {
    bool any = false;
    ask<has_is_inactive>(p, [&](auto const& e, auto const& seen) COLLIDE_HOT { any = any || e.is_inactive(seen); });
    return any;
  }

  /// Makes ready for steps of the time `dt`.
  void prepare([[maybe_unused]] S dt) {
    if constexpr (any_resistance) this->resistance = resistance_over(S(integrator::kick_before) * dt);
  }
  /// Accelerates a particle, or `OfClump` one in place of a clump, without what `push_sphere` does.
  template <bool OfClump = false, class P>
  COLLIDE_HD_INLINE void accelerate([[maybe_unused]] P& p, [[maybe_unused]] S dt) const {
    if constexpr (any_resistance) {
      vec3<S> const before = p[velocity{}];
      vec3<double> const flow = flow_around(p);
      accelerate_without_resistance<OfClump>(p, dt);
      bool const is_ready = this->resistance.time == static_cast<double>(dt);
      p[velocity{}] = velocity_in(is_ready ? this->resistance : resistance_over(dt), flow, before, p[velocity{}]);
    } else {
      accelerate_without_resistance<OfClump>(p, dt);
    }
  }
  /// Lets effects accelerate a sphere of a clump that do so for each sphere.
  template <class P>
  COLLIDE_HD_INLINE void push_sphere(P& p, S dt) const {
    (accelerate_by<E, pushes_spheres<E, S>>(p, dt), ...);
  }
  /// Accelerates some particles, each for its own time, on a CPU; those for 0 are left out.
  template <class P, unsigned N>
  COLLIDE_HD_INLINE void accelerate_together(P (&p)[N], S const (&dt)[N]) const {
    auto const& r = this->resistance;
    S const time = S(r.time);
    bool ready = !r.is_none();
    for (unsigned k = 0; k < N; ++k) ready = ready && (dt[k] == time || dt[k] == 0);
    if (!ready) {
      for (unsigned k = 0; k < N; ++k) {
        if (dt[k] != 0) accelerate(p[k], dt[k]);
      }
      return;
    }
    velocities_in<S, N, flows> velocities;
    for (unsigned k = 0; k < N; ++k) {
      velocities.set_before(k, flow_around(p[k]), p[k][velocity{}]);
      if (dt[k] != 0) accelerate_without_resistance(p[k], time);
      velocities.set_pushed(k, p[k][velocity{}]);
    }
    multiversioned([&] { r.quadratic == 0 ? velocities.ease(r) : velocities.find(r); });
    velocities.keep();
    for (unsigned k = 0; k < N; ++k) {
      if (dt[k] != 0) velocities.get(k, p[k][velocity{}], r);
    }
  }
  template <class P>
  COLLIDE_HD_INLINE void on_mesh_contact(P& p, mesh_contact<S>& t, S dt) const {
    ask<has_on_mesh_contact>(p, [&](auto const& e, auto& seen) COLLIDE_HOT { e.on_mesh_contact(seen, t, dt); });
    ask<has_after_mesh_contact>(p, [&](auto const& e, auto& seen) COLLIDE_HOT { e.after_mesh_contact(seen, t, dt); });
  }
  template <class P>
  COLLIDE_HD_INLINE void on_mesh_impulse(P& p, mesh_impulse<S> const& given, S dt) const {
    ask<has_on_mesh_impulse>(p, [&](auto const& e, auto& seen) COLLIDE_HOT { e.on_mesh_impulse(seen, given, dt); });
  }
  /// True if an effect holds a particle that is adhered.
  template <class P>
  COLLIDE_HD_INLINE bool holds(P& p, vec3<S> const& pull, S dt) const {
    bool any = false;
    ask<has_holds>(p, [&](auto const& e, auto const& seen) COLLIDE_HOT { any = any || e.holds(seen, pull, dt); });
    return any;
  }
  template <class P>
  COLLIDE_HD_INLINE void on_pair_contact(P& p, P& self, P& other, S dt) const {
    (on_pair_contact_of<E>(p, self, other, dt), ...);
  }
  /// With what the contact remembers; `overlap` if the two do: what remembers nothing is left out if not, unless it
  /// looks at what others do. True if the contact goes on.
  template <class P, class Values>
  COLLIDE_HD_INLINE bool on_pair_contact(P& p, P& self, P& other, bool overlap, Values& values, S elapsed, S dt) const {
    bool goes_on = false;
    ((goes_on = meet_with_memory_by<E>(p, self, other, overlap, values, elapsed, dt) || goes_on), ...);
    return goes_on;
  }
  /// True if the contact goes on.
  template <class P, class Values>
  COLLIDE_HD_INLINE bool on_mesh_overlap(P& p, P& self, mesh_overlap<S> const& o, Values& values, S elapsed,
                                         S dt) const {
    bool goes_on = false;
    ((goes_on = overlap_by<E>(p, self, o, values, elapsed, dt) || goes_on), ...);
    return goes_on;
  }
  template <class P>
  COLLIDE_HD_INLINE void try_wake(P& p, P& other) const {
    ask<has_try_wake>(p, [&](auto const& e, auto& seen) COLLIDE_HOT {
      std::decay_t<decltype(seen)> const seen_other(other);
      e.try_wake(seen, seen_other);
    });
  }
  /// Ends the step of a particle, or, of those that see it as one sphere, of a clump.
  template <bool OfClump = false, class P>
  COLLIDE_HD_INLINE void end_step([[maybe_unused]] P& p, [[maybe_unused]] S dt) const {
    (end_step_of<E, OfClump>(p, dt), ...);
  }

 private:
  /// Calls f(effect, the particle as it sees it) for each effect that has a member.
  template <template <class, class> class Has, class P, class Call>
  COLLIDE_HD_INLINE void ask(P& p, Call const& f) const {
    (ask_one<E, Has<E, S>::value>(p, f), ...);
  }
  template <class F, bool Does, class P, class Call>
  COLLIDE_HD_INLINE void ask_one([[maybe_unused]] P& p, [[maybe_unused]] Call const& f) const {
    if constexpr (Does) {
      particle_access<F, P> seen(p);
      f(of<F>(), seen);
    }
  }
  template <class P>
  COLLIDE_HD_INLINE vec3<double> flow_around(P& p) const {
    if constexpr (!flows) return {0, 0, 0};
    media around(p[velocity{}].template cast<double>());
    ask<has_resistance>(p, [&](auto const& e, auto const& seen) COLLIDE_HOT { around.add(e.resistance(seen)); });
    return around.flow();
  }
  template <class F>
  COLLIDE_HD_INLINE void add_resistance([[maybe_unused]] double& linear, [[maybe_unused]] double& quadratic) const {
    if constexpr (has_resistance<F, S>::value) {
      linear += of<F>().linear;
      quadratic += of<F>().quadratic;
    }
  }
  COLLIDE_HD_INLINE resistance_in_step resistance_over(S time) const {
    double linear = 0, quadratic = 0;
    (add_resistance<E>(linear, quadratic), ...);
    return {linear, quadratic, static_cast<double>(time)};
  }
  /// Lets all effects accelerate a particle but those with a resistance.
  template <bool OfClump = false, class P>
  COLLIDE_HD_INLINE void accelerate_without_resistance([[maybe_unused]] P& p, [[maybe_unused]] S dt) const {
    if constexpr (keeps_pair_forces) p[velocity{}] += p[pair_acceleration{}] * dt;
    if constexpr (keeps_pair_torques) p[angular_velocity{}] += p[pair_angular_acceleration{}] * dt;
    (accelerate_by<E, !(OfClump && pushes_spheres<E, S>)>(p, dt), ...);
  }
  template <class F, bool Does, class P>
  COLLIDE_HD_INLINE void accelerate_by(P& p, S dt) const {
    ask_one<F, Does && has_accelerate<F, S>::value>(
        p, [&](auto const& e, auto& seen) COLLIDE_HOT { e.accelerate(seen, dt); });
  }
  template <class F, class P>
  COLLIDE_HD_INLINE void on_pair_contact_of([[maybe_unused]] P& p, [[maybe_unused]] P& self, [[maybe_unused]] P& other,
                                            [[maybe_unused]] S dt) const {
    if constexpr (has_on_pair_contact<F, S>::value) {
      particle_access<F, P> seen(p);
      particle_access<F, P> const seen_self(self), seen_other(other);
      of<F>().on_pair_contact(seen, seen_self, seen_other, dt);
    }
  }
  template <class F, class P, class Values>
  COLLIDE_HD_INLINE bool meet_with_memory_by([[maybe_unused]] P& p, [[maybe_unused]] P& self, [[maybe_unused]] P& other,
                                             [[maybe_unused]] bool overlap, [[maybe_unused]] Values& values,
                                             [[maybe_unused]] S elapsed, [[maybe_unused]] S dt) const {
    if constexpr (remembers_in<F, S>) {
      particle_access<F, P> seen(p);
      particle_access<F, P> const seen_self(self), seen_other(other);
      contact_access<remembers_of<F>, Values, S> const memory(values, elapsed);
      return of<F>().on_pair_contact(seen, seen_self, seen_other, memory, dt);
    } else {
      if (overlap || follows_pair_contacts<F>) on_pair_contact_of<F>(p, self, other, dt);
      return false;
    }
  }
  template <class F, class P, class Values>
  COLLIDE_HD_INLINE bool overlap_by([[maybe_unused]] P& p, [[maybe_unused]] P& self,
                                    [[maybe_unused]] mesh_overlap<S> const& o, [[maybe_unused]] Values& values,
                                    [[maybe_unused]] S elapsed, [[maybe_unused]] S dt) const {
    if constexpr (overlaps_in<F, S>) {
      particle_access<F, P> seen(p);
      particle_access<F, P> const seen_self(self);
      if constexpr (overlaps_with_memory<F, S>) {
        contact_access<remembers_of<F>, Values, S> const memory(values, elapsed);
        return of<F>().on_mesh_overlap(seen, seen_self, o, memory, dt);
      } else {
        of<F>().on_mesh_overlap(seen, seen_self, o, dt);
      }
    }
    return false;
  }
  template <class F, bool OfClump, class P>
  COLLIDE_HD_INLINE void end_step_of([[maybe_unused]] P& p, [[maybe_unused]] S dt) const {
    if constexpr (has_clumps && !OfClump && sees_clumps<F>) {
      if (p[in_clump{}] != no_id) return;
    }
    if constexpr (OfClump && !sees_clumps<F>) {
      return;
    } else if constexpr (has_end_step_alone<F, S>::value) {
      particle_access<F, P> seen(p);
      of<F>().end_step(seen, dt);
    } else if constexpr (asks_forces<F>) {
      particle_access<F, P> seen(p);
      of<F>().end_step(seen, forces_on<effect_list, OfClump, P, S>{*this, p}, dt);
    }
  }
};

}  // namespace collide::detail
