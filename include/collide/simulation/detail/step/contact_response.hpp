/// \file
/// Resolves the contacts of active particles: the effects respond to each, and the particle's step ends after the last.
///
/// The search finds each particle's next contact, and one thread lets the effects respond. This is repeated until no
/// contact counts, each time from where the particle then is. A contact counts only if its point lies above the tangent
/// planes of those before: in a corner both walls count; on a plane that is divided into triangles one does, and no
/// inner edge is felt. A swept particle spends what is left of the step after each contact.
#pragma once

#include <cstdint>

#include <collide/simulation/detail/step/contact_search.hpp>
#include <collide/simulation/detail/step/integrate.hpp>

namespace collide::detail {

/// A swept particle of radius `r` is taken to be at least so large that rounding its centre leaves it in front of what
/// it touches: 4 units in the last place of its coordinates, but no more than `largest`, for which the index is
/// prepared.
template <class S>
COLLIDE_HD_INLINE S swept_radius(S r, vec3<S> const& centre, vec3<S> const& displacement, S largest) {
  S const reach =
      collide::detail::max_component<S>(absolute(centre)) + collide::detail::max_component<S>(absolute(displacement));
  S const smallest = 4 * std::numeric_limits<S>::epsilon() * reach;
  return r >= 0 && r < largest ? max(r, min(smallest, largest)) : r;
}

/// Contact response: the work of a block for particles that may touch the mesh.
template <class Context>
struct contact_response {
  using S = typename Context::scalar;
  using effects_type = typename Context::effects_type;
  using search_type = contact_search<S, typename Context::narrow_phase, typename Context::triangles_type>;
  using active = typename search_type::active;
  template <class Block>
  using scratch = typename search_type::template scratch<Block>;

  static constexpr bool is_swept = Context::is_swept;
  static constexpr bool spins = contains<typename effects_type::all, angular_velocity>;
  static constexpr int max_contacts_per_step = is_swept ? 8 : 4;  ///< of a particle

  Context const& context;
  search_type const search;

  /// `context` must outlive this.
  COLLIDE_HD_INLINE explicit contact_response(Context const& c) : context{c}, search{c.triangles.opened()} {}

  /// Resolves the contacts of `n` particles, at most the scratch memory's `batch_size`: key_of(j) for all j < n says
  /// which they are.
  template <class Block, class NumberOf>
  COLLIDE_HD void resolve(Block& block, scratch<Block>& s, std::uint32_t n, NumberOf const& number_of) const {
    auto const for_each_particle = [&](auto const& f) {
      block.for_each_thread([&](int thread_rank) {
        for (auto j = static_cast<std::uint32_t>(thread_rank); j < n; j += Block::num_threads) f(s.particles[j], j);
      });
    };
    for_each_particle([&](active& a, std::uint32_t j) {
      begin(a, number_of(j));
      if (j != 0) return;
      search.reset(s);
      s.active_count = 0;
    });
    span_counts seen{0, 0};
    for (std::uint32_t active_before = 0;;) {
      find_contacts(search, block, s, n, seen);
      for_each_particle([&](active& a, std::uint32_t) {
        if (!a.is_active) return;
        respond(a);
        if (!a.is_active) return;
        search.start(a);
        block.add(s.active_count, 1);
      });
      std::uint32_t const active_now = block.broadcast(s.active_count);
      if (active_now == active_before) break;
      active_before = active_now;
    }
  }

 private:
  using colliding = particle<S, typename effects_type::contact>;

  COLLIDE_HD_INLINE void begin(active& a, id number) const {
    colliding p;
    context.state.load(p, number);
    a.number = number;
    a.radius = p.the_radius;
    a.place(p[position{}], p[velocity{}] * context.dt);
    if constexpr (is_swept) {
      a.radius = swept_radius(p.the_radius, p[position{}], a.motion(), context.min_radius);
      a.remaining_time = context.dt;
    }
    a.contact_count = a.contacts_here = 0;
    a.is_active = true;
    search.start(a);
  }

  /// Lets the effects respond to the next contact of a particle. If there is none, or it was the last, its step ends.
  COLLIDE_HD_INLINE void respond(active& a) const {
    bool const has_contact = a.best_key != no_contact;
    if constexpr (!is_swept && (!effects_type::any_end_step && Context::kick_after == 0)) {
      if (!has_contact) {
        a.is_active = false;  // nothing is left to do
        return;
      }
    }
    colliding p;
    context.state.load(p, a.number);
    if (has_contact) {
      apply_contact(p, a);
    } else {
      if constexpr (is_swept) p[position{}] += p[velocity{}] * a.remaining_time;
      a.is_active = false;
    }
    if (!a.is_active) end_step(p, a);
    context.state.store(p, a.number, typename effects_type::contact_writes{});
  }

  /// Lets the effects respond to a contact, and says in `a` whether to look for another one.
  COLLIDE_HD_INLINE void apply_contact(colliding& p, active& a) const {
    constexpr bool turns = spins || contains<typename effects_type::all, adhered>;
    auto const& mesh = context.triangles.mesh;
    S const time = time_of_key<S>(a.best_key);
    auto [here, surface, seen] = touch_at<turns>(mesh, a, a.best_contact(), time);
    vec3<S> const velocity_before = p[velocity{}];
    [[maybe_unused]] vec3<S> spin_before;
    if constexpr (spins) spin_before = p[angular_velocity{}];
    // a body that turns sees a swept particle a little beside its straight way
    [[maybe_unused]] vec3<S> from = here.centre;
    if constexpr (is_swept && effects_type::any_mesh_impulse)
      from = p[position{}] + velocity_before * (a.remaining_time * time);
    a.begin_contact_place(time, velocity_before,
                          is_swept ? here.centre : vec3<S>(here.centre - velocity_before * context.dt), seen);
    if constexpr (is_swept) {
      p[position{}] = here.centre;
      a.remaining_time -= a.remaining_time * time;
    }
    mesh_contact<S> c = contact_for_effects(p, a, surface);
    surface.to_surface_frame(p);
    // how deep when the step began: what is pushed out farther than it came in may then touch what it did not before
    S const depth_at_start = c.depth + dot(c.normal, vec3<S>(here.centre - c.start)), depth = c.depth;
    seen.velocity = c.velocity_before;
    project_onto_contacts(a, c, velocity_before, seen);
    context.effects.on_mesh_contact(p, c, context.dt);
    a.offset_start(c, min(depth_at_start, S(depth - c.depth)));
    surface.record_contact(a, c);
    a.is_at_rest = p[velocity{}] == vec3<S>(S(0), S(0), S(0));
    surface.to_world_frame(p);
    if constexpr (effects_type::any_mesh_impulse) {
      vec3<S> const& v = p[velocity{}];
      vec3<S> const none(S(0), S(0), S(0)), shift = p[position{}] - from;
      mesh_impulse<S> given{v - velocity_before, none, from, shift, v, c.triangle, c.body};
      if constexpr (spins) given.spin_change = p[angular_velocity{}] - spin_before;
      record_impulse(context, p, given);
    }
    mark_contact(p);
    if constexpr (contains<typename effects_type::all, slow_steps>) {
      if (surface.is_of_moving_body(mesh)) p[slow_steps{}] = carried_by_moving;
    }
    a.is_active = a.contact_count < max_contacts_per_step;
    if constexpr (is_swept) {
      a.place(p[position{}], p[velocity{}] * a.remaining_time);
      bool const is_repelled = dot(c.normal, vec3<S>(p[velocity{}] - velocity_before)) > 0;
      if (!is_repelled && is_approaching_still(a, c)) {  // it goes through
        p[position{}] += p[velocity{}] * a.remaining_time;
        a.is_active = false;
      } else if (!a.is_active) {
        surface.carry(mesh, p, a);
      }
    } else {
      a.place(p[position{}], p[velocity{}]);
      a.is_active = a.is_active && (a.candidate_count > 1 || a.overlaps(depth_at_start));
    }
    if constexpr (effects_type::any_inactive) a.is_active = a.is_active && !context.effects.is_inactive(p);
  }

  /// True if a swept particle approaches a surface in the rest of the step.
  COLLIDE_HD_INLINE bool is_approaching_still(active const& a, mesh_contact<S> const& c) const {
    auto const& mesh = context.triangles.mesh;
    auto const frame = frame_of(mesh, c.triangle);
    return a.is_approaching(c.normal, motion_seen(mesh, a, frame, shape_seen(mesh, a, frame)));
  }

  /// A particle's next contact as effects see it.
  template <class Surface>
  COLLIDE_HD_INLINE mesh_contact<S> contact_for_effects(colliding const& p, active const& a,
                                                        Surface const& surface) const {
    vec3<S> const arrival = surface.velocity_seen(a.arrival_velocity.get());
    mesh_contact<S> c{};
    static_cast<contact<S>&>(c) = a.best_contact();
    c.sphere = number_of(p);
    c.start = surface.start_seen(a.start.get());
    if constexpr (!is_swept) {
      c.elapsed = context.dt;
      face_against(c, arrival);
    }
    if constexpr (is_swept) c.remaining = a.remaining_time;
    c.velocity_before = surface.velocity_seen(p[velocity{}]);
    c.approach_speed = -dot(arrival, c.normal);
    colliding next = p;
    context.effects.accelerate(next, context.dt);
    c.force_dv = surface.acceleration_seen(vec3<S>(next[velocity{}] - p[velocity{}]));
    surface.set_surface(c);
    return c;
  }

  COLLIDE_HD_INLINE void end_step(colliding& p, active const& a) const {
    end_motion(context, p, a.contact_count > 0 && a.is_at_rest);
    if constexpr (!effects_type::ends_after_meeting) end_particle(context, p);
  }
};

}  // namespace collide::detail
