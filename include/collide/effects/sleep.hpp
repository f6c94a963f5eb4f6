/// \file
/// Effect: what rests costs nothing.
#pragma once

#include <collide/effects/effect.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide {

/// A particle that has been slower than `speed`, and touched something, in `steps` steps (at most 127), and not been
/// faster in between, sleeps: it is left out until another particle that is awake and faster than that overlaps it, or
/// the mesh changes, and costs the byte that says so. Beside effects between particles it also reads that byte of each
/// neighbour; it goes through its neighbours as others do where one of them is awake, where they are more than 16, and
/// where an effect has `on_mesh_impulse`, as it then passes their weight on. What touches nothing does not fall asleep,
/// however slow it is: a step in which nothing is touched does not count. The mesh, other particles and `box_walls` are
/// touched; an effect of your own that holds particles in its `end_step` says so in the column `in_contact`. Name
/// `sleep` behind those, which stop particles only at the end of a step. One that vanishes in a sink while it is slow
/// wakes nothing. A clump sleeps as a whole, and wakes where one of its spheres does.
struct sleep {
  using reads = columns<velocity>;
  using optional_reads = columns<angular_velocity, radius>;
  using writes = columns<slow_steps, in_contact>;
  static constexpr bool sees_clumps = true;  ///< a clump as one sphere

  double speed = 0.01;  ///< length per time, not negative: what is slower is slow
  int steps = 50;       ///< 1 to 127: in how many steps a particle is slow before it sleeps
  int unused = 0;       ///< in place of padding, which would be bytes of a checkpoint that no one sets

  void check_parameters() const {
    detail::check_parameter(detail::is_amount(speed), "sleep: speed is not negative, and finite");
    detail::check_parameter(steps >= 1 && steps <= 127, "sleep: steps are from 1 to 127");
  }

  template <class Particle>
  COLLIDE_HD_INLINE bool is_inactive(Particle const& p) const {
    return detail::steps_slow(p[slow_steps{}]) >= steps;
  }
  template <class Particle, class S>
  COLLIDE_HD_INLINE void end_step(Particle& p, S) const {
    int const n = p[slow_steps{}];  // what lies on something that moves no longer is slow after all
    bool const counts = n >= detail::carried_by_moving || p[in_contact{}] == 1;
    p[slow_steps{}] = static_cast<std::uint8_t>(!is_slow(p) ? 0 : n == 255 ? 1 : counts ? n + 1 : n);
    p[in_contact{}] = 0;
  }
  template <class Particle, class Other>
  COLLIDE_HD_INLINE void try_wake(Particle& p, Other const& other) const {
    int const n = other[slow_steps{}];
    if (!is_slow(other)) {
      p[slow_steps{}] = 0;
    } else if (n >= detail::carried_by_moving && n < 255 &&
               !(p[slow_steps{}] >= detail::carried_by_moving && p[slow_steps{}] <= n + 1)) {
      p[slow_steps{}] = static_cast<std::uint8_t>(n + 1);
    }
  }

 private:
  template <class Particle>
  COLLIDE_HD_INLINE bool is_slow(Particle const& p) const {
    using S = typename Particle::scalar;
    S const limit = S(speed) * S(speed);
    bool slow = detail::dot(p[velocity{}], p[velocity{}]) < limit;
    if constexpr (Particle::template has<angular_velocity>) {
      auto const& w = p[angular_velocity{}];
      slow = slow && detail::dot(w, w) * p.radius() * p.radius() < limit;
    }
    return slow;
  }
};

}  // namespace collide
