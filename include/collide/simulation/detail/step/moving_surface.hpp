/// \file
/// A surface that moves, and how a particle moves as it sees that, where the mesh has parts that move.
///
/// Effects get velocities relative to the surface, and so need not know that it moves: the frame shifts with the
/// surface at the point, and, where particles have an angular velocity or stick, turns with the body. Of what rests
/// surface_at_rest.hpp says the same.
#pragma once

#include <collide/effects/detail/column_list.hpp>
#include <collide/simulation/detail/bodies/moving_mesh.hpp>
#include <collide/simulation/detail/step/surface_at_rest.hpp>

namespace collide::detail {

template <class S>
COLLIDE_HD_INLINE S sum_of_sizes(vec3<S> const& x) {
  vec3<S> const sizes = absolute(x);
  return sizes.x() + sizes.y() + sizes.z();
}

/// The motion of a particle relative to the surface of a body.
template <class S, bool IsSwept>
struct motion_on_body {
  vec3<S> own_displacement;  ///< in the rest of the step, in the frame of the body
  vec3<S> displacement;      ///< rotated to the world, as the body lies at a part of the step
  vec3<S> velocity;          ///< in the world
  vec3<S> own_point;         ///< where the two may touch, in the frame of the body
  vec3<S> drift;             ///< in the world, of what moves with the body, since the particle's last contact
  int frame;
  S turn;  ///< about the angle by which the body turns in the step

  /// The rounding of a particle that goes with the body: of its velocity, and of its centre, times the rotation.
  template <class History>
  COLLIDE_HD_INLINE S rounding(History const& h) const {
    vec3<S> const here = h.centre.get(), motion = h.motion();
    return 4 * std::numeric_limits<S>::epsilon() * (sum_of_sizes(motion) + turn * sum_of_sizes(here));
  }
  /// The body of a contact may have turned since.
  template <class History>
  COLLIDE_HD_INLINE relative_displacement<S> relative_to(recorded_contact<S, true> const& c, History const& h) const {
    vec3<S> const normal = (c.frame == frame ? c.own_normal : c.normal).get();
    vec3<S> const by =
        c.frame == frame ? own_displacement : vec3<S>(h.motion() - c.surface_velocity.get() * h.remaining_time);
    return {by, normal, rounding(h)};
  }
  COLLIDE_HD_INLINE vec3<S> velocity_relative_to(recorded_contact<S, true> const& c, vec3<S> const& in_world) const {
    return c.frame == frame ? velocity : vec3<S>(in_world - c.surface_velocity.get());
  }
  COLLIDE_HD_INLINE bool is_other_surface(recorded_contact<S, true> const& c) const { return c.frame != frame; }
  COLLIDE_HD_INLINE S height_above(recorded_contact<S, true> const& c, vec3<S> const& point) const {
    if (IsSwept && c.frame == frame) return detail::height_above(c.own_point, c.own_normal, own_point);
    return detail::height_above(c.point, c.normal, point);
  }
  COLLIDE_HD_INLINE void advect(stored_vec3<S>& place) const { place.set(place.get() + drift); }
};

/// The part of the step that is over for a particle, and that which is over at a time of the rest.
template <class S, class Active>
COLLIDE_HD_INLINE double fraction_done(moving_mesh<S> const& mesh, Active const& a, S time = 0) {
  if constexpr (Active::is_swept) {
    S const left = a.remaining_time - mul_rn(a.remaining_time, time);
    return mesh.dt != 0 ? 1 - div_rn(static_cast<double>(left), static_cast<double>(mesh.dt)) : 0.0;
  } else {
    return 1;
  }
}

template <class S>
COLLIDE_HD_INLINE int frame_of(moving_mesh<S> const& mesh, id triangle) {
  return mesh.frame_of(triangle);
}
template <class S, class Active>
COLLIDE_HD_INLINE auto shape_seen(moving_mesh<S> const& mesh, Active const& a, int frame) {
  return mesh.seen_from(frame, a.shape(), fraction_done(mesh, a));
}
/// As the body lies at a part of the step.
template <class S, class Active, class Shape>
COLLIDE_HD_INLINE auto motion_seen([[maybe_unused]] moving_mesh<S> const& mesh, Active const&, int frame,
                                   [[maybe_unused]] Shape const& whole, [[maybe_unused]] double fraction) {
  vec3<S> const none(S(0), S(0), S(0));
  motion_on_body<S, Active::is_swept> m{none, none, none, none, none, frame, S(0)};
  if constexpr (Active::is_swept) {
    m.own_displacement = m.displacement = whole.displacement;
    if (frame == 0) return m;
    vec3<double> const d = whole.displacement.template cast<double>();
    m.turn = sum_of_sizes(rounded_to<S>(vector_of(mesh.frames[frame].moving.angular))) * mesh.dt;
    m.displacement = rounded_to<S>(mesh.pose_at(frame, fraction).rotated(d));
  }
  return m;
}
template <class S, class Active, class Shape>
COLLIDE_HD_INLINE auto motion_seen(moving_mesh<S> const& mesh, Active const& a, int frame, Shape const& whole) {
  return motion_seen(mesh, a, frame, whole, fraction_done(mesh, a));
}
template <class S, class Active, class Shape>
COLLIDE_HD_INLINE auto contact_in_world(moving_mesh<S> const& mesh, Active const& a, Shape const& whole, S time,
                                        contact<S>& c) {
  int const frame = mesh.frame_of(c.triangle);
  double const fraction = fraction_done(mesh, a, time);
  auto m = motion_seen(mesh, a, frame, whole, fraction);
  m.own_point = c.point;
  mesh.to_world(c, frame, fraction);
  return m;
}

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
  /// The start of a discrete step, carried with the surface.
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
    vec3<S> point = c.point, normal = c.normal;
    if (frame != 0) {
      point = rounded_to<S>(at.to_local(c.point.template cast<double>()));
      normal = rounded_to<S>(at.rotated_back(c.normal.template cast<double>()));
    }
    recorded_contact<S, true>& recorded = a.record_contact(c);
    recorded.surface_velocity.set(c.surface_velocity);
    recorded.own_point.set(point);
    recorded.own_normal.set(normal);
    recorded.frame = frame;
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

  COLLIDE_HD_INLINE bool is_of_moving_body(moving_mesh<S> const& mesh) const { return mesh.frames[frame].moves; }
  template <class Particle, class Active>
  COLLIDE_HD_INLINE void carry(moving_mesh<S> const& mesh, Particle& p, Active const& a) const {
    p[position{}] = mesh.in_world(frame, shape_seen(mesh, a, frame).centre, 1);
  }

  /// A vector of the pose at the end of the step, rotated to the pose at the contact; and the inverse.
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
/// `fraction` of the step is over. `Turns`: the particle may turn with the body, as it
/// spins or sticks.
template <bool Turns, class Active, class S>
COLLIDE_HD_INLINE surface_of_body<S, Active::is_swept> surface_of(moving_mesh<S> const& mesh, contact<S> const& c,
                                                                  vec3<S> const& here, vec3<S> const& centre,
                                                                  double fraction) {
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
  s.at = mesh.pose_at(s.frame, fraction);
  vector const x = centre.template cast<double>(), point = c.point.template cast<double>();
  vector const lever_velocity = cross(vector_of(f.moving.angular), vector(point - x));
  vector const local = s.at.to_local(x);
  s.frame_dv = velocity_at(f.moving, f.now, x) - velocity_at(f.moved, f.before, f.before.to_world(local));
  for (int k = 0; k < 3; ++k) s.angular[k] = static_cast<S>(f.moving.angular[k]);
  if (Active::is_swept && mesh.dt != 0) {
    // of a short rest of the step, rounding would leave nothing
    double const from = min(fraction, 1 - 0x1p-10), time = mul_rn(1 - from, static_cast<double>(mesh.dt));
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

template <bool Turns, class S, class Active>
COLLIDE_HD_INLINE touch<S, surface_of_body<S, Active::is_swept>, motion_on_body<S, Active::is_swept>> touch_at(
    moving_mesh<S> const& mesh, Active const& a, contact<S> const& c, S time) {
  constexpr bool is_swept = Active::is_swept;
  int const frame = mesh.frame_of(c.triangle);
  double const fraction = fraction_done(mesh, a, time);
  auto const whole = shape_seen(mesh, a, frame);
  sphere<S> here = sphere_at(whole, time);
  vec3<S> const own = here.centre, centre = a.shape().centre;
  here.centre = is_swept ? mesh.in_world(frame, own, fraction) : centre;
  auto motion = motion_seen(mesh, a, frame, whole, fraction);
  if constexpr (is_swept) motion.drift = mesh.in_world(frame, whole.centre, fraction) - centre;
  return {here, surface_of<Turns, Active>(mesh, c, own, here.centre, fraction), motion};
}

}  // namespace collide::detail
