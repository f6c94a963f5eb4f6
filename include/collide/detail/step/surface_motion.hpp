/// \file
/// How a particle moves as the surface that it touches sees it, where the mesh has parts that move.
///
/// Effects get velocities relative to the surface, and so need not know that it moves: the frame shifts with the
/// surface at the point, and, where particles have an angular velocity or stick, turns with the body.
#pragma once

#include <collide/detail/particles/attributes.hpp>
#include <collide/detail/step/active_particle.hpp>

namespace collide::detail {

/// The part of the step that is over for a particle, and that which is over at a time of the rest.
template <class S, class Active>
COLLIDE_HD_INLINE double part_done(moving_mesh<S> const& mesh, Active const& a, S time = 0) {
  if constexpr (Active::is_swept) {
    S const left = a.remaining_time - mul_rn(a.remaining_time, time);
    return mesh.dt != 0 ? 1 - div_rn(static_cast<double>(left), static_cast<double>(mesh.dt)) : 0.0;
  } else {
    return 1;
  }
}

/// How a particle moves for the rest of the step as a body sees it, `whole` in its frame; turned to the world as the
/// body lies at a part of the step.
template <class S, class Active, class Shape>
COLLIDE_HD_INLINE seen_from_body<S> seen_in_world([[maybe_unused]] moving_mesh<S> const& mesh, Active const&, int frame,
                                                  [[maybe_unused]] Shape const& whole, [[maybe_unused]] double part) {
  vec3<S> const none(S(0), S(0), S(0));
  seen_from_body<S> seen{none, none, none, none, none, frame};
  if constexpr (Active::is_swept) {
    seen.own_displacement = seen.displacement = whole.displacement;
    if (frame == 0) return seen;
    vec3<double> const d = whole.displacement.template cast<double>();
    seen.displacement = rounded_to<S>(mesh.pose_at(frame, part).rotated(d));
  }
  return seen;
}

/// A surface that rests, and sees what there is.
struct surface_at_rest {
  static constexpr int frame = 0;

  template <class S>
  COLLIDE_HD_INLINE vec3<S> const& velocity_seen(vec3<S> const& v) const {
    return v;
  }
  template <class S>
  COLLIDE_HD_INLINE vec3<S> const& start_seen(vec3<S> const& x) const {
    return x;
  }
  template <class S>
  COLLIDE_HD_INLINE vec3<S> const& acceleration_seen(vec3<S> const& dv) const {
    return dv;
  }
  template <class S>
  COLLIDE_HD_INLINE void set_surface(mesh_contact<S>& c) const {
    c.surface_velocity = vec3<S>(S(0), S(0), S(0));
    c.body = no_id;
  }
  template <class Active, class S>
  COLLIDE_HD_INLINE void record_contact(Active& a, mesh_contact<S> const& c) const {
    a.record_contact(c);
  }
  template <class Particle>
  COLLIDE_HD_INLINE void to_surface_frame(Particle&) const {}
  template <class Particle>
  COLLIDE_HD_INLINE void to_world_frame(Particle&) const {}
};

/// The surface of a body that moves, or of what deforms, where a particle touches it.
template <class S, bool IsSwept>
struct surface_of_body {
  int frame;
  frame_pose at, before, now;         ///< when they touch, and when the step begins and ends
  vec3<double> entrainment_velocity;  ///< velocity in the world of what has none relative to the surface
  vec3<double> frame_dv;              ///< of the surface's velocity in a step
  vec3<double> along;                 ///< velocity of what it carries besides that with which the body moves
  vec3<S> angular;                    ///< of the body
  vec3<S> velocity;                   ///< of the surface at the point
  S dt;
  bool rests;

  COLLIDE_HD_INLINE vec3<S> velocity_seen(vec3<S> const& v) const {
    return rounded_to<S>(turned_back(v.template cast<double>() - entrainment_velocity));
  }
  /// What it was at the beginning of a discrete step, if the surface carried it with it.
  COLLIDE_HD_INLINE vec3<S> start_seen(vec3<S> const& x) const {
    if constexpr (IsSwept) {
      return x;
    } else {
      vec3<double> const from = x.template cast<double>(), to = frame == 0 ? from : now.to_world(before.to_local(from));
      return rounded_to<S>(to + scaled(along, static_cast<double>(dt)));
    }
  }
  COLLIDE_HD_INLINE vec3<S> acceleration_seen(vec3<S> const& dv) const {
    return rounded_to<S>(turned_back(dv.template cast<double>()) - frame_dv);
  }
  COLLIDE_HD_INLINE void set_surface(mesh_contact<S>& c) const {
    c.surface_velocity = velocity;
    c.body = frame == 0 ? no_id : static_cast<id>(frame - 1);
  }

  template <class Active>
  COLLIDE_HD_INLINE void record_contact(Active& a, mesh_contact<S> const& c) const {
    contact<S> own = c;
    if (frame != 0) {
      own.point = rounded_to<S>(at.to_local(c.point.template cast<double>()));
      own.normal = rounded_to<S>(at.rotated_back(c.normal.template cast<double>()));
    }
    a.record_contact(c, own, frame);
  }

  /// Gives a particle the velocities that the surface sees, and back those of the world.
  template <class Particle>
  COLLIDE_HD_INLINE void to_surface_frame(Particle& p) const {
    if (rests) return;
    p[collide::velocity{}] = velocity_seen(p[collide::velocity{}]);
    if constexpr (contains<typename Particle::list, angular_velocity>) p[angular_velocity{}] -= angular;
  }
  template <class Particle>
  COLLIDE_HD_INLINE void to_world_frame(Particle& p) const {
    if (rests) return;
    vec3<S>& v = p[collide::velocity{}];
    v = rounded_to<S>(entrainment_velocity + turned(v.template cast<double>()));
    if constexpr (contains<typename Particle::list, angular_velocity>) p[angular_velocity{}] += angular;
  }

  /// From the end of the step, where motion ends, to the time of contact, as the surface turns; and the other shift.
  COLLIDE_HD_INLINE vec3<double> turned_back(vec3<double> const& x) const {
    if (!IsSwept || frame == 0) return x;
    return at.rotated(now.rotated_back(x));
  }
  COLLIDE_HD_INLINE vec3<double> turned(vec3<double> const& x) const {
    if (!IsSwept || frame == 0) return x;
    return now.rotated(at.rotated_back(x));
  }
};

/// The surface of a contact of a particle, which is then at `here`: in the frame of the body where that is swept, and
/// `part` of the step is over. `Turns`: the particle may turn with the body, as it
/// spins or sticks.
template <bool Turns, class Active, class S>
COLLIDE_HD_INLINE surface_of_body<S, Active::is_swept> surface_of(moving_mesh<S> const& mesh, contact<S> const& c,
                                                                  vec3<S> const& here, vec3<S> const& centre,
                                                                  double part) {
  using vector = vec3<double>;
  vector const none(0, 0, 0);
  surface_of_body<S, Active::is_swept> s{};
  s.frame = mesh.frame_of(c.triangle);
  s.entrainment_velocity = s.frame_dv = s.along = none;
  s.angular = s.velocity = vec3<S>(S(0), S(0), S(0));
  s.dt = mesh.dt;
  s.rests = s.frame == 0 && mesh.vertex_velocities == nullptr;
  if (s.frame == 0) {
    if (!s.rests) s.entrainment_velocity = mesh.velocity_of(c.triangle, c.point);
    s.velocity = rounded_to<S>(s.entrainment_velocity);
    s.along = s.entrainment_velocity;
    return s;
  }
  body_frame<S> const& f = mesh.frames[s.frame];
  s.before = f.before;
  s.now = f.now;
  s.at = mesh.pose_at(s.frame, part);
  vector const x = centre.template cast<double>(), point = c.point.template cast<double>();
  vector const lever_velocity = cross(vector_of(f.moving.angular), vector(point - x));
  vector const local = s.at.to_local(x);
  s.frame_dv = velocity_at(f.moving, f.now, x) - velocity_at(f.moved, f.before, f.before.to_world(local));
  for (int k = 0; k < 3; ++k) s.angular[k] = static_cast<S>(f.moving.angular[k]);
  if (Active::is_swept && mesh.dt != 0) {
    // of a short rest of the step, rounding would leave nothing
    double const from = min(part, 1 - 0x1p-10), time = mul_rn(1 - from, static_cast<double>(mesh.dt));
    vector const own = here.template cast<double>();
    vector const shift = f.now.to_world(own) - mesh.pose_at(s.frame, from).to_world(own);
    s.entrainment_velocity = vector(div_rn(shift.x(), time), div_rn(shift.y(), time), div_rn(shift.z(), time));
  } else {
    s.entrainment_velocity = velocity_at(f.moving, f.now, x);
  }
  s.velocity = rounded_to<S>(s.entrainment_velocity + lever_velocity + f.conveyor_velocity);
  s.along = f.conveyor_velocity;
  if constexpr (!Turns) {  // it is dragged as the point is that it touches, and not turned with the body
    vector const n = c.normal.template cast<double>();
    s.along += lever_velocity - scaled(n, dot(lever_velocity, n));
  }
  s.entrainment_velocity += s.turned(s.along);
  return s;
}

}  // namespace collide::detail
