/// \file
/// Kernel bodies in which clumps move, and their spheres with them.
#pragma once

#include <cstddef>

#include <collide/effects/bounds.hpp>
#include <collide/effects/clumps.hpp>
#include <collide/simulation/detail/step/mesh_ledger.hpp>

namespace collide::detail {

/// A clump. Its spheres are those at places from `first` on that say so.
template <class S, class Effects>
struct moving_clump {
  using state_type = particle_state<S, typename Effects::all>;
  using part = columns<clump_centre, clump_velocity, clump_momentum, clump_rotation, clump_inertia>;
  using sphere_type = particle<S, typename Effects::integration_reads>;

  state_type const& state;
  id first;
  particle<S, part> own;
  sphere_type whole;                                           ///< as effects see it that see one particle
  vec3<S> pushed_by{S(0), S(0), S(0)}, turned_by = pushed_by;  ///< changes of velocity and momentum by contacts

  COLLIDE_HD_INLINE moving_clump(state_type const& of, std::size_t i) : state(of), first(static_cast<id>(i)) {
    state.load(own, i, part{});
    state.load(whole, i);
    whole.the_radius = own[clump_inertia{}].of[3];
  }

  /// Tells the clump, and all of its spheres, that one of them is gone, awake, or in contact.
  COLLIDE_HD_INLINE void gather() {
    using known = typename Effects::clump_writes;
    if constexpr (contains<known, alive> || contains<known, slow_steps>) {
      for_each_sphere([&](std::size_t i) {
        if constexpr (contains<known, alive>) whole[alive{}] = min(whole[alive{}], state.at(alive{})[i]);
        if constexpr (contains<known, slow_steps>) {
          auto const behind = [](int n) { return (n + carried_by_moving) % 256; };  // first those carried by what moves
          std::uint8_t const n = state.at(slow_steps{})[i];
          if (behind(n) < behind(whole[slow_steps{}])) whole[slow_steps{}] = n;
          if (state.at(in_contact{})[i] == 1) whole[in_contact{}] = 1;
        }
      });
      tell_spheres();
    }
  }

  /// Forces on all spheres, in their order, and what else accelerates at the centre, for a time.
  COLLIDE_HD_INLINE void kick(Effects const& effects, S time) {
    turned_axes<S> const axes(own[clump_rotation{}]);
    vec3<S> force(S(0), S(0), S(0)), torque = force, more = force, more_torque = force;  // over the mass
    for_each_sphere([&](std::size_t i) {
      S const r = state.radius_at(i), share = 1 / state.at(clump_mass{})[i];
      vec3<S> const arm = axes.to_space(vector(clump_offset{}, i)), by = vector(pair_acceleration{}, i) * share;
      force += by;
      torque += cross(arm, by) + vector(pair_angular_acceleration{}, i) * (S(0.4) * r * r * share);
      if constexpr (Effects::any_push) {
        vec3<S> const push = pushed(effects, i, time) * share;
        more += push;
        more_torque += cross(arm, push);
      }
    });
    pushed_by = force * time, turned_by = torque * time;
    if constexpr (Effects::any_push) force += more, torque += more_torque;
    whole[position{}] = own[clump_centre{}];
    whole[velocity{}] = own[clump_velocity{}];
    whole[pair_acceleration{}] = force;
    whole[pair_angular_acceleration{}] = vec3<S>(S(0), S(0), S(0));
    effects.template accelerate<true>(whole, time);
    own[clump_velocity{}] = whole[velocity{}];
    own[clump_momentum{}] += torque * time;
  }

  /// Tells the effects what holds one that sleeps against what would accelerate and turn it for a time: each surface
  /// that has supported a sphere gives that what it gave on the mean, and there its part of the rest.
  COLLIDE_HD void record_sleeping(Effects const& effects, S time, S dt) {
    turned_axes<S> const axes(own[clump_rotation{}]);
    auto const arm = [&](std::size_t i) { return axes.to_space(vector(clump_offset{}, i)); };
    auto const size = [](vec3<S> const& of) { return sqrt_rn(dot(of, of)); };
    vec3<S> rest = own[clump_velocity{}], torque = own[clump_momentum{}];  // over the mass
    kick(effects, time);
    rest -= own[clump_velocity{}], torque -= own[clump_momentum{}];
    int surfaces = 0;
    S sizes = 0;
    for_each_supported([&](sphere_type& p, S mass) {
      for_each_support(p, [&](vec3<S> const& of, std::uint8_t by) {
        if (by == 0) return;
        ++surfaces;
        sizes += size(of) / mass;
        rest -= of * (time / mass);
        torque -= cross(arm(p.number), of) * (time / mass);
      });
    });
    for_each_supported([&](sphere_type& p, S mass) {
      vec3<S> const none(S(0), S(0), S(0)), about = torque + cross(rest, arm(p.number));
      auto const tell = [&](vec3<S> const& mean, S fraction, id body) {
        mesh_impulse<S> const given{mean * time + rest * fraction,
                                    about * (fraction / (S(0.4) * p.the_radius * p.the_radius)),
                                    p[position{}],
                                    none,
                                    p[velocity{}],
                                    no_id,
                                    body};
        effects.on_mesh_impulse(p, given, dt);
      };
      if (surfaces == 0 && p.number == first) tell(none, mass, no_id);
      for_each_support(p, [&](vec3<S> const& of, std::uint8_t by) {
        if (by != 0) tell(of, sizes > 0 ? size(of) / sizes : mass / S(surfaces), body_of_frame(by - 1));
      });
      state.store(p, p.number, typename Effects::integration_writes{});
    });
  }

  COLLIDE_HD_INLINE void move(S time) {
    own[clump_centre{}] += own[clump_velocity{}] * time;
    turn_freely(own[clump_rotation{}], own[clump_inertia{}], own[clump_momentum{}], time);
  }

  /// Ends its step: it is inside a box that repeats, and effects see it.
  COLLIDE_HD_INLINE void end(Effects const& effects, typename Effects::space_type const& space, S dt) {
    if constexpr (Effects::repeats) own[clump_centre{}] = space.inside(own[clump_centre{}]);
    whole[position{}] = own[clump_centre{}];
    if constexpr (contains<typename Effects::all, slow_steps>)
      whole[angular_velocity{}] =
          turning_of(turned_axes<S>(own[clump_rotation{}]), own[clump_inertia{}], own[clump_momentum{}]);
    effects.template end_step<true>(whole, dt);
    tell_spheres();
  }

  /// Gives spheres their velocities, and, if it has `moved`, their places, which are inside a box that repeats.
  COLLIDE_HD_INLINE void store(typename Effects::space_type const& space, bool moved) const {
    turned_axes<S> const axes(own[clump_rotation{}]);
    vec3<S> const turning = turning_of(axes, own[clump_inertia{}], own[clump_momentum{}]);
    state.store(own, first, part{});
    for_each_sphere([&](std::size_t i) {
      vec3<S> const arm = axes.to_space(vector(clump_offset{}, i));
      particle<S, columns<position, velocity, angular_velocity>> p;
      p[position{}] = own[clump_centre{}] + arm;
      if constexpr (Effects::repeats) p[position{}] = space.inside(p[position{}]);
      p[velocity{}] = own[clump_velocity{}] + cross(turning, arm);
      p[angular_velocity{}] = turning;
      if constexpr (contains<typename Effects::all, clump_push>) {
        particle<S, columns<clump_push, clump_turn>> by;
        by[clump_turn{}] = turning_of(axes, own[clump_inertia{}], turned_by);
        by[clump_push{}] = pushed_by + cross(by[clump_turn{}], arm);
        if (!moved) state.store(by, i, columns<clump_push, clump_turn>{});
      }
      if (moved) state.store(p, i, columns<position>{});
      state.store(p, i, columns<velocity, angular_velocity>{});
    });
  }

  template <class F>
  COLLIDE_HD_INLINE void for_each_sphere(F const& f) const {
    id const* const clump = state.at(in_clump{});
    COLLIDE_NO_UNROLL
    for (std::size_t i = first; i < state.size && clump[i] == clump[first]; ++i) f(i);
  }

 private:
  /// Calls f(sphere, mass of the clump over its own).
  template <class F>
  COLLIDE_HD_INLINE void for_each_supported(F const& f) const {
    for_each_sphere([&](std::size_t i) {
      sphere_type p;
      state.load(p, i);
      f(p, state.at(clump_mass{})[i]);
    });
  }
  /// Writes what effects have written that see the clump as one sphere.
  COLLIDE_HD_INLINE void tell_spheres() const {
    for_each_sphere([&](std::size_t i) { state.store(whole, i, typename Effects::clump_writes{}); });
  }
  /// The acceleration of a sphere by effects that know more of it than its motion.
  COLLIDE_HD_INLINE vec3<S> pushed(Effects const& effects, std::size_t i, S time) const {
    sphere_type p;
    state.load(p, i);
    vec3<S> const before = p[velocity{}];
    effects.push_sphere(p, time);
    return (p[velocity{}] - before) * (1 / time);
  }
  template <class Column>
  COLLIDE_HD_INLINE vec3<S> vector(Column, std::size_t i) const {
    S const* const x = state.at(Column{}) + 3 * i;
    return {x[0], x[1], x[2]};
  }
};

/// Kernel functor of `for_each` over particles: the first half kick of clumps and their way, or the second, which
/// `Ends` their step.
template <class S, class Effects, bool Ends>
struct step_clumps {
  particle_state<S, typename Effects::all> state;
  Effects effects;
  typename Effects::space_type space;
  S dt;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (!begins_clump(state, i)) return;
    moving_clump<S, Effects> clump(state, i);
    clump.gather();
    S const time = S(Ends ? Effects::integrator::kick_after : Effects::integrator::kick_before) * dt;
    if (effects.is_inactive(clump.whole)) {
      if constexpr (Effects::keeps_support) {
        if (effects.only_sleeps(clump.whole)) clump.record_sleeping(effects, time, dt);
      }
      return;
    }
    clump.kick(effects, time);
    if constexpr (Ends) {
      clump.end(effects, space, dt);
    } else {
      clump.move(dt);
    }
    clump.store(space, !Ends);
  }
};

/// Kernel functor of `for_each` over particles: puts the spheres of clumps where their columns say that these are; they
/// are of the material of the first.
template <class S, class Effects>
struct place_clumps {
  particle_state<S, typename Effects::all> state;
  typename Effects::space_type space;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (!begins_clump(state, i)) return;
    moving_clump<S, Effects> const clump(state, i);
    clump.store(space, true);
    if constexpr (contains<typename Effects::all, material>)
      clump.for_each_sphere([&](std::size_t k) { state.at(material{})[k] = state.at(material{})[i]; });
  }
};

/// Says which effect of a scene with clumps would act on a sphere of one as if that were free.
template <class Space, class S, class Effects, class E>
constexpr bool check_beside_clumps() {
  using motion = std::conditional_t<has_accelerate<E, S>::value, columns<position, angular_velocity>, motion_columns>;
  using written = writes_of<E>;
  constexpr bool is_known = std::is_same<E, clumps>::value || std::is_same<E, periodic_box>::value || sees_clumps<E> ||
                            follows_pair_contacts<E> || is_source<E>;
  constexpr bool moves =
      intersection_of<motion, written>::size != 0 &&
      (has_end_step<E, S>::value || has_begin_step<E, Space, particle_state<S, typename Effects::all>, S>);
  static_assert(is_known || !(moves || asks_forces<E>),
                "collide: clumps: an effect that moves particles when a step begins or ends, such as box_walls, does "
                "not know them: take a mesh in place of box_walls");
  static_assert(is_known || !(has_is_inactive<E, S>::value || contains<written, alive>),
                "collide: clumps: effects that make or leave out particles do so with single spheres, not with clumps");
  static_assert(is_known || !(has_on_mesh_contact<E, S>::value || has_after_mesh_contact<E, S>::value ||
                              (has_on_mesh_impulse<E, S>::value && !Effects::overlaps)),
                "collide: clumps press on the mesh by the forces of granular_contact: bounce, friction, adhesion and "
                "other impulses do not know them");
  return true;
}
template <class Space, class S, class Effects, class... E>
constexpr bool check_clumps() {
  if constexpr (Effects::has_clumps) {
    static_assert(Effects::ends_after_meeting && Effects::keeps_pair_torques,
                  "collide: clumps need velocity_verlet, and forces between particles: name granular_contact");
    static_assert((check_beside_clumps<Space, S, Effects, E>() && ...));
  }
  return true;
}

}  // namespace collide::detail
