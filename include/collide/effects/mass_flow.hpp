/// \file
/// Effect: the mass that flows through a surface.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include <collide/core/memory.hpp>
#include <collide/effects/detail/column_list.hpp>
#include <collide/effects/effect.hpp>
#include <collide/effects/granular/materials.hpp>
#include <collide/spaces/atomic_add.hpp>

namespace collide {

/// On which side of the surface of `mass_flow` the particle was at the end of the last step: 0 not known; else how far
/// it then came in a step, below 0 if it was behind; the largest number if the surface was farther away.
struct side_of_surface : detail::number_column {};

/// The result of `flow_sums::read`: what went through the surface, forwards minus backwards.
struct flow_counts {
  std::int64_t particles = 0;  ///< how many
  double mass = 0;             ///< their mass
};

/// Counts what goes through a plane, or a disc of it: each particle once whose centre comes from one side to the other,
/// as it is at the ends of steps, and -1 times if it comes back. On a disc what counts is where the centre then is. A
/// particle that comes to be in front has not come through; nor has one that leaps, as `periodic_box` makes it: one
/// that is farther from the plane than its speed and the forces take it in a step, and its radius: before the step with
/// the speed and the length of the step that ends there, after it with what takes it farther, these or those then. So
/// what the mesh stops dead behind the plane has come through; of steps that grow the first one may miss something.
/// It is made by `flow_sums`, which has its memory. A number a particle.
///
/// \tparam Materials  whose masses: `one_density`, or that of `granular_contact`
template <class Materials = one_density>
struct mass_flow {
  using reads = detail::union_of<columns<position, velocity>, typename Materials::reads>;
  using optional_reads = columns<radius>;
  using writes = columns<side_of_surface>;
  static constexpr bool asks_forces = true;
  static constexpr bool sees_clumps = true;        ///< a clump as one sphere
  static constexpr bool saves_parameters = false;  ///< they have a pointer

  Materials made_of{};                                    ///< densities
  double point[3] = {0, 0, 0};                            ///< of the plane: the centre of the disc
  double normal[3] = {0, 0, 1};                           ///< forwards; of any length from 1e-150 to 1e150
  double disc = std::numeric_limits<double>::infinity();  ///< radius of the disc, above 0; infinite for all the plane
  double unit = 0;                                        ///< of mass: each particle is rounded to a multiple
  std::int64_t* sums = nullptr;                           ///< memory of the space, of `flow_sums`

  void check_parameters() const {
    made_of.check_parameters();
    detail::check_parameter(detail::is_finite(point) && square(normal) >= 1e-300 && square(normal) <= 1e300,
                            "mass_flow: point and normal are finite, and the normal has a length");
    detail::check_parameter(disc > 0, "mass_flow: the radius of the disc is above 0");
    detail::check_parameter(detail::is_positive(unit) && sums != nullptr,
                            "mass_flow: unit is above 0, and finite, and flow_sums makes the effect");
  }

  template <class Particle, class Forces, class S>
  COLLIDE_HD_INLINE void end_step(Particle& p, Forces const& forces, S dt) const {
    vec3<double> const from(point[0], point[1], point[2]), n(normal[0], normal[1], normal[2]);
    vec3<double> const x = p[position{}].template cast<double>() - from;
    double const r = static_cast<double>(p.radius()), nn = detail::dot(n, n), height = detail::dot(x, n);
    double const travel = (speed(p[velocity{}]) + speed(forces.change(dt))) * static_cast<double>(dt) + r;
    bool const is_near = height * height <= travel * travel * nn, is_in_front = height >= 0;
    S& side = p[side_of_surface{}];
    double const before = detail::max(static_cast<double>(side), -static_cast<double>(side));
    bool const was_in_front = side > 0;
    bool const comes_so_far = is_near || height * height <= before * before * nn;
    constexpr double smallest = std::numeric_limits<S>::min(), largest = std::numeric_limits<S>::max();
    bool const was_near = before > 0 && before < largest;
    S const now = static_cast<S>(is_near ? detail::min(detail::max(travel, smallest), largest / 2) : largest);
    side = is_in_front ? now : -now;
    if (!(was_near && comes_so_far) || was_in_front == is_in_front) return;
    double const aside = detail::dot(x, x) - detail::div_rn(height * height, nn);
    if (!(aside <= disc * disc)) return;
    double const mass = detail::sphere_mass(1, r) * made_of.template density_of<double>(p);
    std::int64_t const sign = is_in_front ? 1 : -1;
    atomic_add(sums, sign);
    atomic_add(sums + 1, sign * static_cast<std::int64_t>(std::floor(detail::div_rn(mass, unit) + 0.5)));
  }

 private:
  template <class V>
  static COLLIDE_HD_INLINE double speed(V const& v) {
    vec3<double> const exact = v.template cast<double>();
    return detail::sqrt_rn(detail::dot(exact, exact));
  }
  static double square(double const (&x)[3]) { return x[0] * x[0] + x[1] * x[1] + x[2] * x[2]; }
};

/// The memory in which `mass_flow` sums up, as integers: the same in any order. It must outlive the steps of the
/// simulation that has its effect. Over the time since `clear` the mass is the mean flow, mass per time.
class flow_sums {
 public:
  /// `unit`: the mass to which each particle is rounded; sums hold 9e18 of it. Allocates 16 bytes in the space.
  template <class Space>
  flow_sums(Space const& space, double unit) : unit_{unit} {
    sums_.reserve(space.resource(), 2);
    clear(space);
  }

  /// The effect, for the plane through `point` across `normal`, for particles of a density, or of materials.
  template <class Materials = one_density>
  mass_flow<Materials> through(double const (&point)[3], double const (&normal)[3], Materials const& made_of,
                               double disc = std::numeric_limits<double>::infinity()) const {
    return {made_of, {point[0], point[1], point[2]}, {normal[0], normal[1], normal[2]}, disc, unit_, sums_.data()};
  }

  /// Begins anew, after the work that is on the stream of a space. Does not wait.
  template <class Space>
  void clear(Space const& space) {
    space.fill(sums_.data(), 0, 2 * sizeof(std::int64_t));
  }

  /// Counts since `clear`. On ranks each has its own, to be added. Waits.
  template <class Space>
  flow_counts read(Space const& space) const {
    std::int64_t found[2];
    space.copy_to_host(found, sums_.data(), 2);
    return {found[0], static_cast<double>(found[1]) * unit_};
  }

 private:
  double unit_;
  buffer<std::int64_t> sums_;
};

}  // namespace collide
