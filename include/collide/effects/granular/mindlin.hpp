/// \file
/// Tangential force of a spring that remembers.
#pragma once

#include <collide/effects/granular/law.hpp>

namespace collide {

/// By how much the surfaces of a contact have moved against each other since they touched, a length: the tangential
/// spring.
struct tangential_displacement : detail::vector_column {};

/// Which of the dashpot's forms codes have.
enum class tangential_damping {
  none,        ///< MercuryDPM's benchmark
  of_tangent,  ///< 2 sqrt(5/6) beta sqrt(k_t m*): LIGGGHTS, MUSEN
  of_normal    ///< that of the normal force: LAMMPS
};

/// The force that is compared with Coulomb's limit.
enum class slip_test {
  spring,             ///< the spring alone; what slides has no dashpot: LIGGGHTS, MUSEN
  spring_and_dashpot  ///< S. Luding, Granular Matter 10, 2008, equation 20: LAMMPS
};

namespace detail {

/// Turns a spring into the plane of contact, and, if it `turns_about_normal`, about the normal by the mean spin of the
/// two, by half the angle's tangent, so that it keeps its length.
template <class Law, class S>
COLLIDE_HD_INLINE void turn_spring(Law const& law, vec3<S>& spring, granular_pair<S> const& p, S elapsed) {
  S const before = law.keeps_length ? dot(spring, spring) : S(0);
  spring -= p.normal * dot(spring, p.normal);
  if (law.turns_about_normal) turn_about_normal(spring, p, elapsed);
  if (!law.keeps_length) return;
  S const after = dot(spring, spring);
  spring = either(after > 0, vec3<S>(spring * sqrt_rn(before / after)), spring);
}

/// The force of a spring that grows with slip and slides at Coulomb's limit, and of its dashpot.
template <class Law, class S, class Memory>
COLLIDE_HD_INLINE vec3<S> spring_force(Law const& law, granular_pair<S> const& p, contact_material const& m,
                                       normal_force<S> const& n, Memory const& memory, S stiffness, S dash) {
  vec3<S>& spring = memory[tangential_displacement{}];
  turn_spring(law, spring, p, memory.elapsed());
  spring += p.slip * memory.elapsed();
  S const limit = friction_limit(p, m, n);
  vec3<S> const damped = p.slip * dash, pull = spring * stiffness + damped;
  bool const with_dashpot = law.test == slip_test::spring_and_dashpot;
  vec3<S> const tested = with_dashpot ? pull : vec3<S>(spring * stiffness);
  S const squared = dot(tested, tested);
  auto const slides = squared > limit * limit;
  if (!any(slides)) return -pull;
  vec3<S> const sliding = tested * (limit / sqrt_rn(squared));
  vec3<S> const left = (with_dashpot ? vec3<S>(sliding - damped) : sliding) * (1 / stiffness);
  spring = either(slides && stiffness > 0, left, spring);
  return either(slides, vec3<S>(-sliding), vec3<S>(-pull));
}

}  // namespace detail

/// A spring of stiffness 8 G* a that grows with slip, turns with the contact, and slides at Coulomb's limit: R. D.
/// Mindlin, Journal of Applied Mechanics 16, 1949; A. Di Renzo and F. P. Di Maio, Chemical Engineering Science 59,
/// 2004. As it is by default, it is that of LIGGGHTS; the members are where other codes differ.
struct mindlin {
  static constexpr bool is_mutual = true;  ///< see law.hpp
  using remembers = contact_columns<tangential_displacement>;
  static constexpr bool needs_hertz = true;  ///< the normal law must be `hertz`

  double stiffness_factor = 1;  ///< of 8 G* a, above 0; 2/3 in A. Di Renzo and F. P. Di Maio, 2005, equation 37
  tangential_damping damping = tangential_damping::of_tangent;  ///< the dashpot
  slip_test test = slip_test::spring;                           ///< what slides
  bool keeps_length = false;  ///< the spring does not become shorter where it turns with the contact: LAMMPS, MUSEN
  bool turns_about_normal = false;  ///< the spring turns with the spins of the two about the normal, too, as no code
                                    ///< above does: grains that turn as one keep their forces

  void check_parameters() const {
    detail::check_parameter(detail::is_positive(stiffness_factor), "mindlin: stiffness_factor is above 0, and finite");
  }

  /// f(parameter) for each, for checkpoints: there is padding between them.
  template <class F>
  void for_each_part(F const& f) {
    f(stiffness_factor);
    f(damping);
    f(test);
    f(keeps_length);
    f(turns_about_normal);
  }

  template <class S, class Memory>
  COLLIDE_HD_INLINE vec3<S> force(granular_pair<S> const& p, detail::contact_material const& m,
                                  normal_force<S> const& n, Memory const& memory) const {
    S const stiffness = S(8 * stiffness_factor * m.shear) * n.contact_radius;
    S dash = 0;
    if (damping == tangential_damping::of_tangent)
      dash = S(1.8257418583505538 * m.damping) * detail::sqrt_rn(stiffness * p.mass);
    if (damping == tangential_damping::of_normal) dash = n.damping;
    return detail::spring_force(*this, p, m, n, memory, stiffness, dash);
  }

  /// The energy of the spring: stiffness times the square of its length, over 2.
  template <class S, class Memory>
  COLLIDE_HD_INLINE S energy(granular_pair<S> const&, detail::contact_material const& m, normal_force<S> const& n,
                             Memory const& memory) const {
    vec3<S> const& spring = memory[tangential_displacement{}];
    return S(4 * stiffness_factor * m.shear) * n.contact_radius * detail::dot(spring, spring);
  }
};

/// `mindlin`, whose spring becomes shorter where the area of contact does: LAMMPS' `mindlin_rescale`. Where the area
/// grows the spring keeps its length, so that the force grows: a cycle of load and slip may make energy, as of
/// `mindlin`.
struct mindlin_rescale : mindlin {
  using remembers = contact_columns<tangential_displacement, contact_radius>;

  template <class S, class Memory>
  COLLIDE_HD_INLINE vec3<S> force(granular_pair<S> const& p, detail::contact_material const& m,
                                  normal_force<S> const& n, Memory const& memory) const {
    S& before = memory[contact_radius{}];
    vec3<S>& spring = memory[tangential_displacement{}];
    spring = detail::either(n.contact_radius < before, vec3<S>(spring * (n.contact_radius / before)), spring);
    before = n.contact_radius;
    return mindlin::force(p, m, n, memory);
  }
};

/// `mindlin`, whose force grows by increments -8 G* a slip dt: a growing area of contact leaves it as it is, a
/// shrinking one makes it smaller by as much: C. Thornton, S. J. Cummins and P. W. Cleary, Powder Technology 233, 2013,
/// equation 18; LAMMPS' `mindlin_rescale/force`. Of all springs here only this one makes no energy in any cycle of load
/// and slip, if `rescales` and with `slip_test::spring`. It is remembered as a length, force over stiffness.
struct mindlin_force : mindlin {
  using remembers = contact_columns<tangential_displacement, contact_radius>;

  bool rescales = true;  ///< false: a shrinking area leaves the force as it is, too, and may make energy: LAMMPS'
                         ///< `mindlin/force`

  template <class F>
  void for_each_part(F const& f) {
    mindlin::for_each_part(f);
    f(rescales);
  }

  template <class S, class Memory>
  COLLIDE_HD_INLINE vec3<S> force(granular_pair<S> const& p, detail::contact_material const& m,
                                  normal_force<S> const& n, Memory const& memory) const {
    S const a = n.contact_radius, before = memory[contact_radius{}];
    vec3<S>& spring = memory[tangential_displacement{}];
    spring = detail::either(a > before || (a > 0 && !rescales), vec3<S>(spring * (before / a)), spring);
    memory[contact_radius{}] = a;
    return mindlin::force(p, m, n, memory);
  }
};

}  // namespace collide
