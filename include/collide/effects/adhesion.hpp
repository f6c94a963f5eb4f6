/// \file
/// Effect: particles stick to the mesh.
#pragma once

#include <limits>

#include <collide/effects/bounce.hpp>

namespace collide {

/// Adhesion, as of snow and mud: a particle that touches the mesh no faster than `capture_speed` stays where it is. One
/// that came faster, and rests on it then, has to leave it and come again. It stays until forces of more than
/// `max_acceleration`, per unit of mass, pull it off: those of all effects, and of other particles. What sticks to a
/// body that moves (bodies.hpp) moves with it, and is shaken off by its acceleration. Where the mesh is set again, what
/// it no longer touches is free.
struct adhesion {
  using writes = columns<position, velocity, adhered>;
  static constexpr bool needs_solid_mesh = true;  ///< an effect that `repels` is before it, such as `bounce`

  double max_acceleration =
      20;  ///< length per time squared, not negative, finite: what pulls harder tears the particle off
  double capture_speed = std::numeric_limits<double>::infinity();  ///< length per time, not negative

  void check_parameters() const {
    detail::check_parameter(detail::is_amount(max_acceleration) && capture_speed >= 0,
                            "adhesion: max_acceleration and capture_speed are not negative, and the first is finite");
  }

  template <class Particle, class S>
  COLLIDE_HD_INLINE bool holds(Particle const&, vec3<S> const& pull, S dt) const {
    S const limit = S(max_acceleration) * dt;
    return detail::dot(pull, pull) <= limit * limit;
  }
  template <class Particle, class S>
  COLLIDE_HD_INLINE void on_mesh_contact(Particle& p, mesh_contact<S>& t, S dt) const {
    auto& v = p[velocity{}];
    if (!(touching_speed(t) <= S(capture_speed))) {
      p[adhered{}] = detail::came_too_fast;
      return;
    }
    if (p[adhered{}] == detail::came_too_fast && !comes(p, t, dt)) return;
    S const pressed = detail::min(detail::dot(t.force_dv, t.normal), S(0)), limit = S(max_acceleration) * dt;
    vec3<S> const pull = t.force_dv - t.normal * pressed;
    if (!(detail::dot(pull, pull) <= limit * limit)) return;
    if (t.is_resting) p[position{}] -= v * t.elapsed;  // it was held all the time
    v = vec3<S>(S(0), S(0), S(0));
    if (t.depth > 0) p[position{}] += t.normal * t.depth;
    t.depth = detail::min(t.depth, S(0));
    p[adhered{}] = t.body == no_id ? std::uint8_t{1} : static_cast<std::uint8_t>(t.body + 2);
  }

 private:
  /// How fast a particle touches the mesh, except for what the forces of the step have given it: 0 of what rests.
  template <class S>
  COLLIDE_HD_INLINE static S touching_speed(mesh_contact<S> const& t) {
    S const force = detail::dot(t.force_dv, t.force_dv), with = detail::dot(t.velocity_before, t.force_dv);
    S const fraction = with > 0 ? detail::min(with / force, S(1)) : S(0);
    vec3<S> const own = t.velocity_before - t.force_dv * fraction;
    S const approach = t.approach_speed + detail::min(detail::dot(t.force_dv, t.normal), S(0));
    return detail::max(detail::sqrt_rn(detail::dot(own, own)), approach);
  }
  /// True if a particle was off the surface when the step began.
  template <class Particle, class S>
  COLLIDE_HD_INLINE static bool comes(Particle const& p, mesh_contact<S> const& t, S dt) {
    S const depth = t.depth + detail::dot(t.normal, vec3<S>(p[position{}] - t.start));
    S const travel = -detail::dot(t.velocity_before, t.normal) * (dt - t.remaining - t.elapsed);
    return travel - depth > detail::contact_tolerance<S> * p.radius() + detail::rounding_at(t.start);
  }
};

}  // namespace collide
