/// \file
/// Effect: spheres that overlap repel each other.
#pragma once

#include <cmath>
#include <limits>

#include <collide/effects/effect.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide {

/// The soft-sphere model of the discrete element method, with a linear spring and dashpot along the normal and a
/// dashpot limited by Coulomb friction along the tangent: P. A. Cundall and O. D. L. Strack, "A discrete numerical
/// model for granular assemblies", Geotechnique 29(1), 1979; S. Luding, "Introduction to discrete element methods",
/// European Journal of Environmental and Civil Engineering 12(7-8), 2008. There is no tangential spring, which would
/// need memory for each contact: a pile creeps instead of standing for ever.
///
/// With `spin` in the scene, friction turns the spheres. Both of a pair feel the same force, so momentum is conserved
/// to rounding. A step should be at most a twentieth of the time that a collision takes: see `from_restitution`.
struct sphere_contact {
  using reads = columns<position>;
  using writes = columns<velocity>;
  using optional_writes = columns<angular_velocity, detail::slide_push, detail::slide_turn>;

  double stiffness = 1000;        ///< force per overlap, not negative
  double damping = 0;             ///< force per speed along the normal, not negative
  double friction = 0;            ///< coefficient of Coulomb friction, not negative
  double tangential_damping = 0;  ///< force per speed along the tangent, up to that limit; not negative
  double density = 1;             ///< mass per volume, above 0: a particle has the mass of a solid sphere

  void check_parameters() const {
    using detail::is_amount;
    detail::check_parameter(
        is_amount(stiffness) && is_amount(damping) && is_amount(friction) && is_amount(tangential_damping),
        "sphere_contact: stiffness, dampings and friction are not negative, and finite");
    detail::check_parameter(detail::is_positive(density), "sphere_contact: density is above 0, and finite");
  }

  /// The longest step that `simulation::step` takes, a fifth of the time in which the two smallest spheres collide
  /// without damping: pi sqrt(m / (2 stiffness)) / 5. Infinite without stiffness. `smallest_radius` is above 0.
  double longest_step(double smallest_radius) const {
    double const mass = detail::sphere_mass(density, smallest_radius);
    return stiffness > 0 ? 0.628318530717959 * std::sqrt(mass / (2 * stiffness))
                         : std::numeric_limits<double>::infinity();
  }

  /// The parameters of equal spheres that collide for a given time, and part with a given part of their speed. They
  /// part when they no longer push each other: T. Schwager and T. Poeschel, "Coefficient of restitution and
  /// linear-dashpot model revisited", Granular Matter 9, 2007, of whose formula sin(a) is the damping ratio.
  ///
  /// \param restitution  speed after over speed before, 0 to 1; below 0.14 the model has not enough
  ///                     damping, and 0.14 is what comes out
  /// \param duration     of a collision, above 0; a step should be a twentieth of it at most
  /// \param radius       of the spheres, above 0
  /// \param density      mass per volume, above 0
  /// \param friction     coefficient of Coulomb friction, not negative
  /// \throws error  if one is out of its range, or infinite
  static sphere_contact from_restitution(double restitution, double duration, double radius, double density,
                                         double friction = 0) {
    using detail::is_positive;
    detail::check_parameter(restitution >= 0 && restitution <= 1 && is_positive(duration) && is_positive(radius) &&
                                is_positive(density) && detail::is_amount(friction),
                            "from_restitution: restitution is from 0 to 1, duration, radius and density are above 0, "
                            "friction is not negative, and all are finite");
    double const pi = 3.14159265358979323846, reduced_mass = density * pi * radius * radius * radius * 2 / 3;
    double a = 0, high = pi / 2;
    for (int i = 0; i < 60; ++i) {
      double const middle = (a + high) / 2;
      (std::exp(-std::tan(middle) * (pi - 2 * middle)) > restitution ? a : high) = middle;
    }
    if (restitution >= 1) a = 0;
    a = a < 1.5 ? a : 1.5;
    double const natural_frequency = (pi - 2 * a) / (duration * std::cos(a));  // frequency without damping
    double const stiffness = reduced_mass * natural_frequency * natural_frequency;
    return {stiffness, 2 * reduced_mass * natural_frequency * std::sin(a), friction,
            friction > 0 ? 0.5 * std::sqrt(stiffness * reduced_mass) : 0, density};
  }

  template <class Particle, class Seen, class S>
  COLLIDE_HD_INLINE void on_pair_contact(Particle& p, Seen const& self, Seen const& other, S dt) const {
    constexpr bool spins = Particle::template has<angular_velocity>;
    vec3<S> const between = self[position{}] - other[position{}];
    S const distance = detail::sqrt_rn(detail::dot(between, between)), r = self.radius();
    S const overlap = (self.radius() + other.radius()) - distance;
    vec3<S> const n = distance > 0 ? vec3<S>(between * (1 / distance))
                                   : vec3<S>(S(0), S(0), self.number() < other.number() ? S(-1) : S(1));
    vec3<S> approach = self[velocity{}] - other[velocity{}];
    S const along = detail::dot(approach, n);
    S const normal_force = detail::max(S(stiffness) * overlap - S(damping) * along, S(0));
    S const inverse_mass = S(0.238732414637843) / (S(density) * r * r * r);  // 3 / (4 pi)
    vec3<S> force = n * normal_force;
    if (friction > 0) {
      // the point of contact divides the distance as the radii are: the arms of both torques are the whole of it
      [[maybe_unused]] S const fraction = distance / (self.radius() + other.radius());
      if constexpr (spins) {
        approach -=
            detail::cross(vec3<S>(self[angular_velocity{}] * r + other[angular_velocity{}] * other.radius()), n) *
            fraction;
      }
      vec3<S> const slip = approach - n * along;
      S const speed = detail::sqrt_rn(detail::dot(slip, slip));
      if (speed > 0) {
        S const tangential_force = detail::min(S(tangential_damping) * speed, S(friction) * normal_force);
        vec3<S> const drag = slip * (tangential_force / speed);
        force -= drag;
        if constexpr (spins) {
          vec3<S> const turn = detail::cross(n, drag) * (S(2.5) * inverse_mass / r * fraction * dt);
          p[angular_velocity{}] += turn;
          if constexpr (Particle::template has<detail::slide_push>) {
            p[detail::slide_push{}] -= drag * (inverse_mass * dt);
            p[detail::slide_turn{}] += turn;
          }
        }
      }
    }
    p[velocity{}] += force * (inverse_mass * dt);
  }
};

}  // namespace collide
