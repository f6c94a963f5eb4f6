/// \file
/// Effect: granular contact between particles, and of particles with the mesh, by laws that are put together at compile
/// time.
#pragma once

#include <type_traits>

#include <collide/effects/detail/particle_access.hpp>
#include <collide/effects/detail/sphere_action.hpp>
#include <collide/effects/granular/cohesion.hpp>
#include <collide/effects/granular/cundall_strack.hpp>
#include <collide/effects/granular/dashpot.hpp>
#include <collide/effects/granular/hertz.hpp>
#include <collide/effects/granular/linear.hpp>
#include <collide/effects/granular/mindlin.hpp>
#include <collide/effects/granular/rolling.hpp>
#include <collide/effects/granular/torsion.hpp>

namespace collide {

/// The discrete element method's contact: of spheres with each other, and with the mesh, which is solid then. Laws are
/// in effects/granular/; one of your own has the members of law.hpp.
///
/// Forces are those where particles are when they meet; use `velocity_verlet`, with which dashpots see the velocity of
/// half the step. Particles turn, if the tangential or the rolling law is not `none`. Of the mesh, a contact is each
/// point that is nearest to the centre among all points of the surface near it: one on a flat wall, whatever its
/// triangles, two in an edge between walls. A contact goes on as the sphere goes from triangle to triangle. A surface
/// has two sides. A wall has no mass and no radius: 1/R* = 1/R.
///
/// \tparam Normal      `linear` or `hertz`
/// \tparam Tangential  `none`, `dashpot`, `cundall_strack`, `mindlin`, `mindlin_rescale` or `mindlin_force`
/// \tparam Rolling     `none`, `constant_torque`, `epsd` or `epsd2`, or one of them within `marshall` or `torsion`
/// \tparam Cohesion    `none`, `sjkr`, `jkr` or `dmt`
/// \tparam Materials   `one_material`, or `materials<N>` with a column `material`
template <class Normal, class Tangential = none, class Rolling = none, class Cohesion = none,
          class Materials = one_material>
struct granular_contact {
  static_assert(Normal::is_hertzian ||
                    !(detail::needs_hertz<Tangential> || detail::needs_hertz<Rolling> || detail::needs_hertz<Cohesion>),
                "collide: mindlin, epsd2, jkr and dmt are made for spheres that touch as hertz says: name hertz as the "
                "normal law, or cundall_strack, dashpot, epsd and sjkr with linear");

  /// Particles have an angular velocity.
  static constexpr bool turns = !std::is_same<Tangential, none>::value || !std::is_same<Rolling, none>::value;
  static constexpr bool repels = true;                             ///< the mesh is solid
  static constexpr double farther = detail::farther_of<Cohesion>;  ///< than its radius a sphere sees the mesh, in radii

  static constexpr double farthest_saddle = detail::farthest_saddle_of<Cohesion>;  ///< from the centre, less the radius

  using reads = detail::union_of<columns<position>, typename Materials::reads>;
  using optional_reads = columns<clump_mass>;
  using writes = std::conditional_t<turns, columns<velocity, angular_velocity>, columns<velocity>>;
  using optional_writes = std::conditional_t<turns, columns<detail::slide_push, detail::slide_turn>, columns<>>;
  using remembers = typename detail::contact_columns_of<
      detail::union_of<columns<>, detail::remembers_of<Tangential>, detail::remembers_of<Rolling>,
                       detail::remembers_of<Cohesion>>>::type;

  static constexpr bool is_memoryless = remembers::list::size == 0;  ///< contacts remember nothing

  Materials made_of{};      ///< Young's moduli, densities, coefficients
  Normal normal{};          ///< parameters of the normal law
  Tangential tangential{};  ///< parameters of the tangential law
  Rolling rolling{};        ///< parameters of the rolling law
  Cohesion cohesion{};      ///< parameters of the law of cohesion
  /// Torques have the arm radius - arm_shortening overlap: 0.5 in LIGGGHTS and MercuryDPM, 0 in MUSEN, and in LAMMPS at
  /// walls.
  double arm_shortening = 0.5;
  /// Slip is the velocity of the surface at radius - slip_shortening overlap from the centre: 0.5 in LIGGGHTS and
  /// MercuryDPM, 0 in LAMMPS and MUSEN. If both are the same, friction takes from the motion what `tangential` gets.
  double slip_shortening = 0.5;

  void check_parameters() const {
    made_of.check_parameters();
    detail::check_parameter(arm_shortening >= 0 && arm_shortening <= 1,
                            "granular_contact: arm_shortening is from 0 to 1");
    detail::check_parameter(slip_shortening >= 0 && slip_shortening <= 1,
                            "granular_contact: slip_shortening is from 0 to 1");
    detail::check_part(normal);
    detail::check_part(tangential);
    detail::check_part(rolling);
    detail::check_part(cohesion);
  }

  template <class F>
  void for_each_part(F const& f) {
    detail::for_each_part_of(made_of, f);
    detail::for_each_part_of(normal, f);
    detail::for_each_part_of(tangential, f);
    detail::for_each_part_of(rolling, f);
    detail::for_each_part_of(cohesion, f);
    f(arm_shortening);
    f(slip_shortening);
  }

  /// The longest step that `simulation::step` takes, the shortest of all solids that particles are of. With `hertz` the
  /// time in which a wave crosses the smallest sphere (Lord Rayleigh): pi r sqrt(density / G) / (0.1631 nu + 0.8766);
  /// with `linear` a fifth of a collision of two such; with `cundall_strack` that over the root of its
  /// `stiffness_ratio` if that is above 1.
  double longest_step(smallest_radii const& radii) const {
    double const stiffer = std::sqrt(std::max(1.0, detail::stiffness_ratio_of(tangential)));
    return made_of.min_of(radii, [&](solid const& s, double r) {
      if constexpr (Normal::is_hertzian) {
        double const shear = s.young / (2 * (1 + s.poisson));
        return 3.14159265358979323846 * r * std::sqrt(s.density / shear) / (0.1631 * s.poisson + 0.8766) / stiffer;
      } else {
        return 0.628318530717959 * std::sqrt(detail::sphere_mass(s.density, r) / (2 * normal.stiffness)) / stiffer;
      }
    });
  }

  /// True if what it does to one of two spheres is the opposite of what it does to the other.
  static constexpr bool is_mutual = detail::is_mutual_law<Normal> && detail::is_mutual_law<Tangential> &&
                                    detail::is_mutual_law<Rolling> && detail::is_mutual_law<Cohesion>;

  /// Numbers that are kept of what two spheres do to each other.
  static constexpr unsigned action_width = !turns ? 4 : std::is_same<Rolling, none>::value ? 7 : 10;

  /// One of two spheres, or one each of some pairs; seen(k) is that of pair k.
  template <class P, class F>
  COLLIDE_HD_INLINE detail::meeting_sphere<P> see(F const& seen) const {
    using lanes = detail::from_lanes<P>;
    using S = decltype(seen(0).radius());
    detail::meeting_sphere<P> s;
    for (int c = 0; c < 3; ++c) {
      s.position[c] = lanes::of([&](int k) { return seen(k)[position{}][c]; });
      s.velocity[c] = lanes::of([&](int k) { return seen(k)[velocity{}][c]; });
      s.spin[c] = lanes::of([&](int k) {
        if constexpr (turns) return seen(k)[angular_velocity{}][c];
        return S(0);
      });
    }
    s.radius = lanes::of([&](int k) { return seen(k).radius(); });
    s.density = lanes::of([&](int k) { return made_of.template density_of<S>(seen(k)) * of_clump<S>(seen(k)); });
    return s;
  }
  /// The mass of a sphere's clump over its own.
  template <class S, class Seen>
  static COLLIDE_HD_INLINE S of_clump([[maybe_unused]] Seen const& p) {
    if constexpr (Seen::template has<clump_mass>) return p[clump_mass{}];
    return S(1);
  }
  /// The mass of a sphere, or of its clump.
  template <class P>
  static COLLIDE_HD_INLINE P mass_of(detail::meeting_sphere<P> const& s) {
    return detail::sphere_mass(1.0, s.radius) * s.density;
  }
  /// The action of the second spheres of some pairs of two solids on the first; `upwards` is 1 or -1, the direction
  /// where two centres coincide.
  template <class P, class Memory>
  COLLIDE_HD_INLINE detail::sphere_action<P> act(detail::meeting_sphere<P> const& a, detail::meeting_sphere<P> const& b,
                                                 P const& upwards, detail::contact_material const& of,
                                                 Memory const& memory) const {
    granular_pair<P> const c = pair_of(a, b, upwards);
    normal_force<P> n = normal.force(c, of);
    cohesion.pull(n, c, of, memory);
    detail::mask_of<P> const goes_on = c.overlap > 0 || n.goes_on;
    detail::sphere_action<P> action = act_with(n, c, of, memory);
    action.is_there = goes_on;
    return action;
  }
  /// Adds an action to a particle's velocity and spin, vectors or rows of numbers; `impulse` is the time over its mass.
  template <class V, class Action, class S>
  COLLIDE_HD_INLINE void give(V& v, [[maybe_unused]] V& spin, Action const& by, [[maybe_unused]] S radius,
                              S impulse) const {
    if constexpr (turns) {
      V const torque = by.twist * arm_of(by, radius) + by.torque;
      spin += torque * (S(2.5) * impulse / (radius * radius));
    }
    v += by.force * impulse;
  }
  /// The part of that by the tangential force `aside`.
  template <class V, class Action, class S>
  COLLIDE_HD_INLINE void give_aside(V& v, V& spin, V const& aside, Action const& by, S radius, S impulse) const {
    v += aside * impulse;
    spin += by.twist * arm_of(by, radius) * (S(2.5) * impulse / (radius * radius));
  }

  template <class Particle, class Seen, class S, std::enable_if_t<is_memoryless && sizeof(S) != 0, int> = 0>
  COLLIDE_HD_INLINE void on_pair_contact(Particle& p, Seen const& self, Seen const& other, S dt) const {
    meet(p, self, other, no_memory<S>{dt}, dt);
  }
  template <class Particle, class Seen, class Memory, class S>
  COLLIDE_HD_INLINE bool on_pair_contact(Particle& p, Seen const& self, Seen const& other, Memory const& memory,
                                         S dt) const {
    return meet(p, self, other, memory, dt);
  }
  template <class Particle, class Seen, class S, std::enable_if_t<is_memoryless && sizeof(S) != 0, int> = 0>
  COLLIDE_HD_INLINE void on_mesh_overlap(Particle& p, Seen const& self, mesh_overlap<S> const& wall, S dt) const {
    press(p, self, wall, no_memory<S>{dt}, dt);
  }
  template <class Particle, class Seen, class Memory, class S>
  COLLIDE_HD_INLINE bool on_mesh_overlap(Particle& p, Seen const& self, mesh_overlap<S> const& wall,
                                         Memory const& memory, S dt) const {
    return press(p, self, wall, memory, dt);
  }

 private:
  template <class Action, class S>
  COLLIDE_HD_INLINE S arm_of(Action const& by, S radius) const {
    return radius - S(arm_shortening) * by.overlap;
  }

  /// In place of the memory of a contact.
  template <class S>
  struct no_memory {
    S dt;
    COLLIDE_HD_INLINE S elapsed() const { return dt; }
    COLLIDE_HD_INLINE no_memory const& values() const { return *this; }
  };

  /// Two spheres. True if the contact goes on.
  template <class Particle, class Seen, class Memory, class S>
  COLLIDE_HD_INLINE bool meet(Particle& p, Seen const& self, Seen const& other, Memory const& memory, S dt) const {
    auto const a = see<S>([&](int) { return self; }), b = see<S>([&](int) { return other; });
    granular_pair<S> const c = pair_of(a, b, self.number() < other.number() ? S(-1) : S(1));
    return apply(p, c, made_of.between(self, other), memory, dt * of_clump<S>(self) / mass_of(a));
  }

  template <class P>
  COLLIDE_HD_INLINE granular_pair<P> pair_of(detail::meeting_sphere<P> const& a, detail::meeting_sphere<P> const& b,
                                             P const& upwards) const {
    vec3<P> const between = a.position - b.position;
    P const distance = detail::length_of(between);
    granular_pair<P> c;
    c.normal = detail::either(distance > 0, vec3<P>(between * (1 / distance)), vec3<P>(P(0), P(0), upwards));
    c.overlap = (a.radius + b.radius) - distance;
    c.radius = a.radius * b.radius / (a.radius + b.radius);
    c.own_radius = a.radius;
    P const m = mass_of(a), other_m = mass_of(b);
    c.mass = m * other_m / (m + other_m);
    vec3<P> turned(P(0), P(0), P(0));
    c.own_turning = c.turning = turned;
    c.rolling_inertia = 0;
    if constexpr (turns) {
      vec3<P> const &w = a.spin, &other_w = b.spin;
      turned = w * slip_arm(a.radius, c.overlap) + other_w * slip_arm(b.radius, c.overlap);
      c.own_turning = along_surface(w, c.normal);
      c.turning = along_surface(vec3<P>(w - other_w), c.normal);
      set_spins(c, w, other_w);
      P const inertia = m * a.radius * a.radius, other_inertia = other_m * b.radius * b.radius;
      c.rolling_inertia = P(1.4) * (inertia * other_inertia / (inertia + other_inertia));
    }
    set_velocity(c, vec3<P>(a.velocity - b.velocity), turned);
    return c;
  }

  /// A sphere and a wall. Of a contact that joins a deeper one, all forces are less by those at the saddle, which has
  /// the memory of the contact: where the two become the same, they vanish.
  template <class Particle, class Seen, class Memory, class S>
  COLLIDE_HD_INLINE bool press(Particle& p, Seen const& self, mesh_overlap<S> const& wall, Memory const& memory,
                               S dt) const {
    S const r = self.radius(), m = detail::sphere_mass(S(1), r) * made_of.template density_of<S>(self);
    auto const& of = made_of.with_wall(self, wall.triangle, wall.body);
    vec3<S> const relative = self[velocity{}] - wall.surface_velocity;
    auto const before = memory.values();
    COLLIDE_NO_UNROLL
    for (bool at_saddle = wall.has_saddle();; at_saddle = false) {
      granular_pair<S> c;
      c.normal = at_saddle ? wall.saddle_normal : wall.normal;
      c.overlap = at_saddle ? wall.saddle_overlap : wall.overlap;
      c.radius = c.own_radius = r;
      S times = at_saddle ? S(-1) : S(1);
      if constexpr (farthest_saddle > 0) {
        if (at_saddle) times = -hold_saddle(c, of);
      }
      c.mass = m * of_clump<S>(self);
      c.is_wall = true;
      c.rolling_inertia = S(1.4) * c.mass * r * r;
      vec3<S> turned(S(0), S(0), S(0));
      c.own_turning = c.turning = turned;
      if constexpr (turns) {
        turned = self[angular_velocity{}] * slip_arm(r, c.overlap);
        c.own_turning = c.turning = along_surface(self[angular_velocity{}], c.normal);
        set_spins(c, self[angular_velocity{}], wall.surface_turning);
      }
      set_velocity(c, relative, turned);
      bool const goes_on = apply(p, c, of, memory, times * dt / m);
      if (!at_saddle) return goes_on;
      if constexpr (!is_memoryless) memory.values() = before;
    }
  }

  /// How much of a saddle counts: less and less where it is farther from the sphere than what holds; there it is as if
  /// it just held.
  template <class S>
  COLLIDE_HD_INLINE S hold_saddle(granular_pair<S>& c, detail::contact_material const& of) const {
    S const limit = cohesion.min_overlap(c, of);
    if (c.overlap >= limit) return 1;
    S const fraction = 1 - (limit - c.overlap) / (S(farthest_saddle - farther) * c.own_radius);
    c.overlap = limit;
    return detail::max(fraction, S(0));
  }

  template <class S>
  COLLIDE_HD_INLINE S slip_arm(S radius, S overlap) const {
    return radius - S(slip_shortening) * overlap;
  }
  template <class S>
  static COLLIDE_HD_INLINE vec3<S> along_surface(vec3<S> const& x, vec3<S> const& normal) {
    return x - normal * detail::dot(x, normal);
  }
  template <class S>
  static COLLIDE_HD_INLINE void set_spins(granular_pair<S>& c, vec3<S> const& w, vec3<S> const& other_w) {
    S const own = detail::dot(w, c.normal), other = detail::dot(other_w, c.normal);
    c.twist = own - other;
    c.spin = (own + other) / 2;
  }
  template <class S>
  static COLLIDE_HD_INLINE void set_velocity(granular_pair<S>& c, vec3<S> const& relative, vec3<S> const& turned) {
    S const apart = detail::dot(relative, c.normal);
    c.closing = -apart;
    c.slip = relative - c.normal * apart - detail::cross(turned, c.normal);
  }

  template <class Particle, class S, class Memory>
  COLLIDE_HD_INLINE bool apply(Particle& p, granular_pair<S> const& c, detail::contact_material const& of,
                               Memory const& memory, S impulse) const {
    normal_force<S> n = normal.force(c, of);
    cohesion.pull(n, c, of, memory);
    if (!(c.overlap > 0) && !n.goes_on) return false;
    auto const action = act_with(n, c, of, memory);
    if constexpr (turns) {
      give(p[velocity{}], p[angular_velocity{}], action, c.own_radius, impulse);
      if constexpr (Particle::template has<detail::slide_push>) {
        if (!c.is_wall)
          give_aside(p[detail::slide_push{}], p[detail::slide_turn{}], action.aside, action, c.own_radius, impulse);
      }
    } else {
      give(p[velocity{}], p[velocity{}], action, c.own_radius, impulse);
    }
    return true;
  }
  template <class P, class Memory>
  COLLIDE_HD_INLINE detail::sphere_action<P> act_with(normal_force<P>& n, granular_pair<P> const& c,
                                                      detail::contact_material const& of, Memory const& memory) const {
    n.secant = P(Normal::is_hertzian ? 2.0 / 3 : 1) * n.stiffness;
    n.damping = P(Normal::damping_factor * of.damping) * detail::sqrt_rn(P(n.stiffness * c.mass));
    detail::sphere_action<P> a;
    a.force = c.normal * n.total(c);
    a.overlap = c.overlap;
    if constexpr (turns) {
      a.aside = tangential.force(c, of, n, memory);
      a.torque = rolling.torque(c, of, n, memory);
      a.force += a.aside;
      a.twist = detail::cross(a.aside, c.normal);
    }
    return a;
  }
};

}  // namespace collide
