/// \file
/// The energy of a simulation's particles.
#pragma once

#include <collide/effects/gravity.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/simulation.cuh>

namespace collide {

/// What `energy` finds, in mass times length squared per time squared.
struct energy_sums {
  double kinetic = 0;     ///< of the motion of centres
  double rotational = 0;  ///< of solid spheres that turn; 0 without `spin` in the scene
  double elastic = 0;     ///< of the springs of `sphere_contact` between spheres that overlap
  double potential = 0;   ///< in `gravity`, 0 at the origin

  double total() const { return kinetic + rotational + elastic + potential; }  ///< the sum of all
};

/// The energy of all particles that are alive, those that sleep included; NaN if one is nowhere. With
/// `semi_implicit_euler` velocities are those of half a step before the positions, and the sum goes up and down with
/// them. `density` is the mass per volume, 0 that of `sphere_contact`; `error` if there is none, or it is not above 0
/// and finite. Waits, and copies columns to the host. O(particles), O(particles^2) with `sphere_contact` in the scene.
template <class Detector, class... Effect>
energy_sums energy(simulation<Detector, Effect...> const& of, double density = 0) {
  using S = typename Detector::scalar;
  using list = typename simulation<Detector, Effect...>::columns;
  gravity field{0, 0, 0};
  sphere_contact springs{0, 0, 0, 0, density};
  if constexpr ((std::is_same<Effect, gravity>::value || ...)) field = of.template effect<gravity>();
  if constexpr ((std::is_same<Effect, sphere_contact>::value || ...)) springs = of.template effect<sphere_contact>();
  if (density == 0) density = springs.density;
  detail::check_parameter(detail::is_positive(density), "energy: density is above 0: give it, or name sphere_contact");
  std::vector<S> const x = of.template to_host<position>(), v = of.template to_host<velocity>();
  std::vector<S> r(of.size(), of.state().common_radius), w(x.size());
  std::vector<std::uint8_t> is_there(of.size(), 1);
  if constexpr (detail::contains<list, radius>) r = of.template to_host<radius>();
  if constexpr (detail::contains<list, angular_velocity>) w = of.template to_host<angular_velocity>();
  if constexpr (detail::contains<list, alive>) is_there = of.template to_host<alive>();
  auto const at = [](auto const& all, std::size_t i) -> vec3<double> {
    return vec3<S>(all[i], all[i + 1], all[i + 2]).template cast<double>();
  };
  energy_sums sum;
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (is_there[i] == 0) continue;
    vec3<double> const xi = at(x, 3 * i), vi = at(v, 3 * i), wi = at(w, 3 * i);
    double const ri = static_cast<double>(r[i]), m = detail::sphere_mass(density, ri);
    sum.kinetic += 0.5 * m * vi.squaredNorm();
    sum.rotational += 0.2 * m * ri * ri * wi.squaredNorm();
    sum.potential -= m * vec3<double>(field.x, field.y, field.z).dot(xi);
    for (std::size_t k = 0; k < i && springs.stiffness > 0; ++k) {
      double const overlap = ri + static_cast<double>(r[k]) - (xi - at(x, 3 * k)).norm();
      if (is_there[k] != 0 && overlap > 0) sum.elastic += 0.5 * springs.stiffness * overlap * overlap;
    }
  }
  return sum;
}

}  // namespace collide
