/// \file
/// The ledger of what the mesh gives to particles, whether they touch it, stick to it, or sleep on it: the one place
/// where effects are told of it.
#pragma once

#include <collide/effects/detail/effect_list.hpp>
#include <collide/simulation/detail/bodies/bodies_ref.hpp>
#include <collide/simulation/detail/bodies/moving_mesh.hpp>

namespace collide::detail {

/// Calls f(support, supported_by) of each surface that may support a particle.
template <class Particle, class F>
COLLIDE_HD_INLINE void for_each_support(Particle& p, F const& f) {
  f(p[support{}], p[supported_by{}]);
  if constexpr (contains<typename Particle::list, second_support>) {
    f(p[second_support{}], p[second_supported_by{}]);
    f(p[third_support{}], p[third_supported_by{}]);
  }
}

/// Keeps a mean of what the mesh gives to a particle in a step, for when the particle sleeps.
template <class Context, class Particle>
COLLIDE_HD_INLINE void keep_support([[maybe_unused]] Context const& context, [[maybe_unused]] Particle& p,
                                    [[maybe_unused]] mesh_impulse<typename Context::scalar> const& given) {
  using S = typename Context::scalar;
  if constexpr (Context::effects_type::keeps_support) {
    if (dot(given.change, given.change) == 0) return;
    vec3<S> const change = given.change * (1 / (S(steps_in_mean(p[slow_steps{}])) * context.dt));
    auto const surface = static_cast<std::uint8_t>(given.body == no_id ? 1 : given.body + 2);
    bool is_known = false;
    for_each_support(p, [&](vec3<S>& of, std::uint8_t& by) {
      if (is_known || (by != 0 && by != surface)) return;
      of += change;
      by = surface;
      is_known = true;
    });
    if constexpr (contains<typename Particle::list, third_support>) {
      if (!is_known) p[third_support{}] += change;
    }
  }
}

/// Tells the effects what the mesh gives to a particle, and keeps the mean.
template <class Context, class Particle>
COLLIDE_HD_INLINE void record_impulse(Context const& context, Particle& p,
                                      mesh_impulse<typename Context::scalar> const& given) {
  context.effects.on_mesh_impulse(p, given, context.dt);
  keep_support(context, p, given);
}

/// Tells the effects what holds a particle that sleeps against what would accelerate or turn it for a part of the step:
/// it does not move. The surfaces that have supported it give that: what they gave on the mean, and of the difference,
/// and of what would turn it, each has a part as large as what it gave. What lies on others that sleep is held by these
/// except for a rest, which goes to what rests, unless effects may hold it that know no mesh. Of clumps see
/// clump_motion.hpp.
template <class Context, class Particle>
COLLIDE_HD_INLINE void record_sleeping(Context const& context, Particle& p, typename Context::scalar fraction) {
  using S = typename Context::scalar;
  if (fraction == 0 || is_of_clump(p)) return;
  vec3<S> const none(S(0), S(0), S(0));
  S const time = fraction * context.dt;
  Particle next = p;
  context.effects.accelerate(next, time);
  vec3<S> const change = p[velocity{}] - next[velocity{}];
  vec3<S> turned = none;
  if constexpr (contains<typename Particle::list, pair_angular_acceleration>)
    turned = p[angular_velocity{}] - next[angular_velocity{}];
  auto const tell = [&](vec3<S> const& of_it, S share, id body) {
    mesh_impulse<S> const given{of_it, turned * share, p[position{}], none, p[velocity{}], no_id, body};
    context.effects.on_mesh_impulse(p, given, context.dt);
  };
  int surfaces = 0;
  S sizes = 0;
  vec3<S> rest = change;
  for_each_support(p, [&](vec3<S> const& of, std::uint8_t by) {
    if (by == 0) return;
    ++surfaces;
    sizes += sqrt_rn(dot(of, of));
    rest -= of * time;
  });
  if (surfaces == 0) {
    if constexpr (!Context::effects_type::holds_without_mesh) tell(change, S(1), no_id);
    return;
  }
  for_each_support(p, [&](vec3<S> const& of, std::uint8_t by) {
    if (by == 0) return;
    S const share = sizes > 0 ? sqrt_rn(dot(of, of)) / sizes : 1 / S(surfaces);
    tell(surfaces == 1 ? change : vec3<S>(of * time + rest * share), share, body_of_frame(by - 1));
  });
}

/// The frame of the body that a particle sticks to; 0 if it is free, or sticks to what rests. See `adhesion`.
template <class Particle>
COLLIDE_HD_INLINE int frame_ridden([[maybe_unused]] Particle const& p) {
  if constexpr (contains<typename Particle::list, adhered>) {
    int const stuck_to = p[adhered{}];
    return stuck_to > 1 && is_stuck(p[adhered{}]) ? stuck_to - 1 : 0;
  } else {
    return 0;
  }
}

/// The place to which a body takes a point of space in the step that it has at the beginning.
template <class S>
COLLIDE_HD_INLINE vec3<double> carried(body_frame<S> const& f, vec3<double> const& x) {
  return f.now.to_world(f.before.to_local(x));
}

struct ridden_surface {
  vec3<double> before, after;  ///< its velocity when the step begins, and ends
  vec3<double> drift;          ///< velocity on the straight line on which it takes the particle in the step
  vec3<double> to;             ///< where it takes the particle
};
template <class Context>
COLLIDE_HD_INLINE ridden_surface surface_ridden([[maybe_unused]] Context const& context,
                                                [[maybe_unused]] vec3<typename Context::scalar> const& position,
                                                [[maybe_unused]] int frame) {
  vec3<double> const none(0, 0, 0);
  ridden_surface s{none, none, none, position.template cast<double>()};
  if constexpr (Context::has_bodies) {
    if (frame == 0) return s;
    auto const& f = context.triangles.mesh.frames[frame];
    vec3<double> const x = position.template cast<double>(), to = carried(f, x);
    s = {velocity_at(f.moved, f.before, x), velocity_at(f.moving, f.now, to), none, to};
    double const dt = static_cast<double>(context.dt);
    s.drift = !Context::is_swept
                  ? s.after
                  : vec3<double>(div_rn(to.x() - x.x(), dt), div_rn(to.y() - x.y(), dt), div_rn(to.z() - x.z(), dt));
  }
  return s;
}

/// Tells the effects what the mesh gives to a particle that sticks to it; `path`: on which it is carried, where that is
/// not along its velocity.
template <class Context, class Particle>
COLLIDE_HD_INLINE void record_stuck(Context const& context, Particle& p, vec3<typename Context::scalar> const& change,
                                    vec3<typename Context::scalar> const& path) {
  using S = typename Context::scalar;
  vec3<S> const none(S(0), S(0), S(0));
  record_impulse(context, p, {change, none, p[position{}], path, p[velocity{}], no_id, body_of_frame(frame_ridden(p))});
}
template <class Context, class Particle>
COLLIDE_HD_INLINE void record_stuck(Context const& context, Particle& p, vec3<typename Context::scalar> const& change) {
  using S = typename Context::scalar;
  record_stuck(context, p, change, vec3<S>(S(0), S(0), S(0)));
}

/// Lets the mesh hold a particle that sticks to it, against what would change its velocity in the step, of which it
/// gets a part at first. False if that pulls it off: then it is free.
template <class Context, class Particle>
COLLIDE_HD_INLINE bool carry_stuck(Context const& context, Particle& p, typename Context::scalar first_fraction) {
  using S = typename Context::scalar;
  auto& v = p[velocity{}];
  ridden_surface const surface = surface_ridden(context, p[position{}], frame_ridden(p));
  Particle next = p;
  context.effects.accelerate(next, context.dt);
  vec3<double> const own = v.template cast<double>(), by = vec3<S>(next[velocity{}] - v).template cast<double>();
  vec3<S> const pull = rounded_to<S>(vec3<double>(own + by - surface.after));
  if (!context.effects.holds(p, pull, context.dt)) {
    p[adhered{}] = 0;
    return false;
  }
  vec3<double> const given = surface.drift - own - scaled(by, static_cast<double>(first_fraction));
  v = rounded_to<S>(surface.drift);
  if constexpr (contains<typename Particle::list, pair_angular_acceleration>)
    p[angular_velocity{}] += p[pair_angular_acceleration{}] * (first_fraction * context.dt);
  vec3<S> path(S(0), S(0), S(0));
  if constexpr (!Context::is_swept) path = rounded_to<S>(surface.to) - p[position{}];
  mark_contact(p);
  if (p.number < context.state.size) record_stuck(context, p, rounded_to<S>(given), path);  // behind are places of none
  if constexpr (contains<typename Particle::list, held>) p[held{}] = stuck_all_along;
  return true;
}

}  // namespace collide::detail
