/// \file
/// Effect: the work that contacts take from the motion of particles, and that walls give.
#pragma once

#include <collide/effects/detail/column_list.hpp>
#include <collide/effects/effect.hpp>
#include <collide/effects/granular/materials.hpp>

namespace collide {

namespace detail {

/// Column of a sum of many small numbers.
struct sum_column {
  template <class S>
  using value = double;
};

// changes of a particle's velocity and spin in a step, by other particles and by walls
struct pairs_push : vector_column {};
struct pairs_turn : vector_column {};
struct walls_push : vector_column {};
struct walls_turn : vector_column {};
// the parts of them by tangential forces
struct slide_push : vector_column {};
struct slide_turn : vector_column {};
struct walls_give : vector_column {};  ///< work of walls over mass: along normals, of tangential forces, of torques
struct work_of_next_kick : vector_column {};  ///< over mass, of the same three
struct walls_work_of_next_kick : number_column {};

}  // namespace detail

/// Work that forces along normals have taken from a particle: the energy of springs, and what damping has lost; see
/// `contact_work`.
struct normal_work : detail::sum_column {};

/// Work that tangential forces have taken from a particle: the energy of springs, and what sliding has lost; see
/// `contact_work`.
struct sliding_work : detail::sum_column {};

/// Work that torques against rolling and torsion have taken from a particle; see `contact_work`.
struct rolling_work : detail::sum_column {};

/// Work that walls have given to a particle: minus the force and torque on a body, as `reaction` sums them up, times
/// its motion; see `contact_work`.
struct wall_work : detail::sum_column {};

/// Sums up the work of the contacts of each particle by forces, those of `granular_contact` or `sphere_contact`, of
/// which it is behind. `energy` makes of it what is lost. Work is force times the mean velocity of each kick, so that
/// without drag and other forces the energy of motion and in `gravity`, and the work taken, less that given, stay the
/// same to rounding, whatever dt is. A half kick that no step has seen is not counted: the first after `set` or
/// `set_mesh` of what is in contact then. 25 scalars and 32 bytes a particle, and as much in the lists of neighbours.
///
/// \tparam Materials  whose masses: `one_density`, or that of `granular_contact`
template <class Materials = one_density>
struct contact_work {
  using reads = detail::union_of<columns<position, velocity, angular_velocity>, typename Materials::reads>;
  using optional_reads = columns<radius>;
  using writes = columns<detail::pairs_push, detail::pairs_turn, detail::walls_push, detail::walls_turn,
                         detail::slide_push, detail::slide_turn, detail::walls_give, detail::work_of_next_kick,
                         detail::walls_work_of_next_kick, normal_work, sliding_work, rolling_work, wall_work>;
  static constexpr bool follows_pair_contacts = true;  ///< in a list it comes behind what acts between particles
  static constexpr bool begins_on_ranks = true;        ///< `begin_step` does its work whatever rank a particle is on
  static constexpr bool asks_forces = true;
  static constexpr bool saves_parameters = detail::saves_parameters<Materials>;

  Materials made_of{};          ///< densities
  double arm_shortening = 0.5;  ///< as of `granular_contact`, 0 to 1: which torques are those of tangential forces

  void check_parameters() const {
    made_of.check_parameters();
    detail::check_parameter(arm_shortening >= 0 && arm_shortening <= 1, "contact_work: arm_shortening is from 0 to 1");
  }
  template <class F>
  void for_each_part(F const& f) {
    detail::for_each_part_of(made_of, f);
    f(arm_shortening);
  }

  template <class Space, class State, class S>
  void begin_step(Space& space, State const& state, S) const {
    using namespace detail;
    for (S* const column :
         {state.at(pairs_push{}), state.at(pairs_turn{}), state.at(walls_push{}), state.at(walls_turn{}),
          state.at(slide_push{}), state.at(slide_turn{}), state.at(walls_give{})})
      space.fill(column, 0, 3 * state.size * sizeof(S));
  }
  template <class Particle, class Seen, class S>
  COLLIDE_HD_INLINE void on_pair_contact(Particle& p, Seen const& self, Seen const& other, S) const {
    using namespace detail;
    vec3<S> const between = self[position{}] - other[position{}];
    S const distance = sqrt_rn(dot(between, between));
    vec3<S> const normal = distance > 0 ? vec3<S>(between * (1 / distance))
                                        : vec3<S>(S(0), S(0), self.number() < other.number() ? S(-1) : S(1));
    part_of_contact(p, self, p[pairs_push{}], p[pairs_turn{}], normal, self.radius() + other.radius() - distance);
  }
  template <class Particle, class Seen, class S>
  COLLIDE_HD_INLINE void on_mesh_overlap(Particle& p, Seen const& self, mesh_overlap<S> const& wall, S) const {
    using namespace detail;
    S const r = self.radius(), inertia = S(0.4) * r * r;
    auto const by = part_of_contact(p, self, p[walls_push{}], p[walls_turn{}], wall.normal, wall.overlap);
    vec3<S> const w = wall.surface_turning;
    vec3<S> const v = wall.surface_velocity + cross(w, vec3<S>(wall.normal * (r - wall.overlap)));  // at the centre
    p[walls_give{}] += vec3<S>(dot(vec3<S>(by.push - by.slide), v), dot(by.slide, v) + inertia * dot(by.slide_turn, w),
                               inertia * dot(vec3<S>(by.turn - by.slide_turn), w));
  }
  template <class Particle, class Forces, class S>
  COLLIDE_HD_INLINE void end_step(Particle& p, Forces const& forces, [[maybe_unused]] S dt) const {
    using namespace detail;
    constexpr bool has_half_kicks = Forces::kick_after != 0;
    constexpr double kick = has_half_kicks ? double(Forces::kick_after) : 1;
    vec3<S> behind = p[velocity{}];  // the kick of contacts
    if constexpr (!has_half_kicks) behind -= forces.change(dt);
    double const r = static_cast<double>(p.radius()),
                 mass = sphere_mass(1.0, r) * made_of.template density_of<double>(p);
    vec3<S> const give = p[walls_give{}];
    auto const work_of_kick = [&](double sign) {  // before `behind`, or after it
      vec3<double> const push = exact<S>(p[pairs_push{}]) + exact<S>(p[walls_push{}]),
                         slide = exact<S>(p[slide_push{}]);
      vec3<double> const turn = exact<S>(p[pairs_turn{}]) + exact<S>(p[walls_turn{}]), roll = exact<S>(p[slide_turn{}]);
      vec3<double> const v = exact<S>(behind) + push * (sign * kick / 2);
      vec3<double> const spin = (exact<S>(p[angular_velocity{}]) + turn * (sign * kick / 2)) * (0.4 * r * r);
      vec3<double> const gained(dot(vec3<double>(push - slide), v), dot(slide, v) + dot(roll, spin),
                                dot(vec3<double>(turn - roll), spin));
      return vec3<double>((exact<S>(give) - gained) * kick);
    };
    vec3<double> const taken = exact<S>(p[work_of_next_kick{}]) + work_of_kick(-1);
    double const given =
        kick * (static_cast<double>(give[0]) + static_cast<double>(give[1]) + static_cast<double>(give[2]));
    p[normal_work{}] += mass * taken[0];
    p[sliding_work{}] += mass * taken[1];
    p[rolling_work{}] += mass * taken[2];
    p[wall_work{}] += mass * (static_cast<double>(p[walls_work_of_next_kick{}]) + given);
    if constexpr (has_half_kicks) {
      p[work_of_next_kick{}] = rounded_to<S>(work_of_kick(1));
      p[walls_work_of_next_kick{}] = static_cast<S>(given);
    }
  }

 private:
  template <class S>
  static COLLIDE_HD_INLINE vec3<double> exact(vec3<S> const& x) {
    return x.template cast<double>();
  }

  template <class S>
  struct part {
    vec3<S> push, turn, slide, slide_turn;
  };

  /// By how much a contact has changed velocity and spin since all before have changed them by `push` and `turn`.
  template <class Particle, class Seen, class S>
  COLLIDE_HD_INLINE part<S> part_of_contact(Particle& p, Seen const& self, vec3<S>& push, vec3<S>& turn,
                                            vec3<S> const& normal, S overlap) const {
    using namespace detail;
    S const r = self.radius();
    vec3<S> const all = p[velocity{}] - self[velocity{}], all_turn = p[angular_velocity{}] - self[angular_velocity{}];
    part<S> by;
    by.push = all - push, by.turn = all_turn - turn;
    push = all, turn = all_turn;
    by.slide = by.push - normal * dot(by.push, normal);
    bool const turns = dot(by.turn, by.turn) > 0;
    S const arm = turns ? S(2.5) * (r - S(arm_shortening) * overlap) / (r * r) : S(0);
    by.slide_turn = cross(by.slide, normal) * arm;
    p[slide_push{}] += by.slide;
    p[slide_turn{}] += by.slide_turn;
    return by;
  }
};

}  // namespace collide
