/// \file
/// Effect: the work that contacts take from the motion of particles, and that walls give.
#pragma once

#include <collide/effects/detail/column_list.hpp>
#include <collide/effects/effect.hpp>
#include <collide/effects/granular/materials.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide {

namespace detail {

/// Column of a sum of many small numbers.
using sum_column = column_of<double>;

// changes of a particle's velocity and spin in a step by walls
struct walls_push : vector_column {};
struct walls_turn : vector_column {};
// work over mass: of forces along normals, of tangential ones, of other torques
struct walls_give : vector_column {};
struct next_kick_takes : vector_column {};  ///< the kick with which the next step begins
struct next_kick_gives : number_column {};  ///< of walls, all three

}  // namespace detail

/// Work that forces along normals have taken from a particle: what springs hold, and what damping has lost; see
/// `contact_work`.
struct normal_work : detail::sum_column {};

/// Work that tangential forces have taken from a particle: what springs hold, and what sliding has lost; see
/// `contact_work`.
struct sliding_work : detail::sum_column {};

/// Work that torques against rolling and torsion have taken from a particle; see `contact_work`.
struct rolling_work : detail::sum_column {};

/// Work that walls have given to a particle: minus the force and the torque on a body, as `reaction` sums them up,
/// times its motion; see `contact_work`.
struct wall_work : detail::sum_column {};

/// Sums up the work of each particle's contacts, of `granular_contact` or `sphere_contact` before it in the list;
/// `energy` makes of it what was lost. Forces of other effects between particles count as along normals. A half kick of
/// contacts has their force times the mean of the velocities before and after it, and is next to the way of the step.
/// So with `velocity_verlet` energies of motion and in `gravity`, and the work taken, less that given, stay the same to
/// rounding, whatever dt is. What is taken from a particle that presses on a wall is what it loses against the wall.
/// After `set` the first half kick is not counted, after `assign` of places it is that of the old ones. 25 scalars and
/// 32 bytes a particle, and on a GPU 6 scalars in the lists of neighbours.
///
/// \tparam Materials  whose masses: `one_density`, or that of `granular_contact`
template <class Materials = one_density>
struct contact_work {
  using reads = detail::union_of<columns<position, velocity, angular_velocity>, typename Materials::reads>;
  using optional_reads = columns<radius, in_clump, clump_push, clump_turn>;
  using writes = columns<detail::pairs_push, detail::pairs_turn, detail::walls_push, detail::walls_turn,
                         detail::slide_push, detail::slide_turn, detail::walls_give, detail::next_kick_takes,
                         detail::next_kick_gives, normal_work, sliding_work, rolling_work, wall_work>;
  static constexpr bool follows_pair_contacts = true;  ///< in a list it comes behind what acts between particles
  static constexpr bool begins_on_ranks = true;        ///< `begin_step` does its work whatever rank a particle is on
  static constexpr bool asks_forces = true;
  static constexpr bool saves_parameters = detail::saves_parameters<Materials>;

  Materials made_of{};          ///< densities
  double arm_shortening = 0.5;  ///< as of `granular_contact`: which torques of walls are those of tangential forces

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
  COLLIDE_HD_INLINE void on_mesh_overlap(Particle& p, Seen const& self, mesh_overlap<S> const& wall, S) const {
    using namespace detail;
    S const r = self.radius(), inertia = S(0.4) * r * r;  // over mass
    vec3<S> const all = p[velocity{}] - self[velocity{}], all_turn = p[angular_velocity{}] - self[angular_velocity{}],
                  push = all - p[walls_push{}], turn = all_turn - p[walls_turn{}],  // by this wall
        slide = push - wall.normal * dot(push, wall.normal);
    S const arm = r - S(arm_shortening) * wall.overlap, times = dot(turn, turn) > 0 ? S(2.5) * arm / (r * r) : S(0);
    vec3<S> const slide_by = cross(slide, wall.normal) * times;
    p[walls_push{}] = all, p[walls_turn{}] = all_turn;
    p[slide_push{}] += slide, p[slide_turn{}] += slide_by;
    vec3<S> const w = wall.surface_turning;
    vec3<S> const v = wall.surface_velocity + cross(w, vec3<S>(wall.normal * (r - wall.overlap)));  // at the centre
    p[walls_give{}] +=
        vec3<S>(dot(push - slide, v), dot(slide, v) + dot(slide_by, w) * inertia, dot(turn - slide_by, w) * inertia);
  }
  template <class Particle, class Forces, class S>
  COLLIDE_HD_INLINE void end_step(Particle& p, Forces const& forces, [[maybe_unused]] S dt) const {
    using namespace detail;
    constexpr bool has_half_kicks = Forces::kick_after != 0;
    constexpr double kick = has_half_kicks ? double(Forces::kick_after) : 1;
    vec3<S> kicked = p[velocity{}];  // by contacts, and by nothing after them
    if constexpr (!has_half_kicks) kicked -= forces.change(dt);
    vec3<double> const push = exact<S>(p[pairs_push{}]) + exact<S>(p[walls_push{}]),
                       turn = exact<S>(p[pairs_turn{}]) + exact<S>(p[walls_turn{}]), slide = exact<S>(p[slide_push{}]),
                       roll = turn - exact<S>(p[slide_turn{}]), give = exact<S>(p[walls_give{}]);
    if constexpr (!has_half_kicks && Forces::have_contacts) kicked += rounded_to<S>(push);
    double const r = static_cast<double>(p.radius()),
                 mass = sphere_mass(1.0, r) * made_of.template density_of<double>(p);
    vec3<double> half_push = push * (kick / 2), half_turn = turn * (kick / 2);  // of the kick
    if constexpr (Particle::template has<clump_push>) {
      if (p[in_clump{}] != no_id) half_push = exact<S>(p[clump_push{}]) / 2, half_turn = exact<S>(p[clump_turn{}]) / 2;
    }
    auto const taken_by_kick = [&](double side) {  // -1: before `kicked`, 1: after it
      vec3<double> const v = exact<S>(kicked) + half_push * side,
                         w = (exact<S>(p[angular_velocity{}]) + half_turn * side) * (0.4 * r * r);
      return vec3<double>(
          (give - vec3<double>(dot(push - slide, v), dot(slide, v) + dot(turn - roll, w), dot(roll, w))) * kick);
    };
    vec3<double> const taken = exact<S>(p[next_kick_takes{}]) + taken_by_kick(-1);
    double const given = (give[0] + give[1] + give[2]) * kick;
    p[normal_work{}] += mass * taken[0];
    p[sliding_work{}] += mass * taken[1];
    p[rolling_work{}] += mass * taken[2];
    p[wall_work{}] += mass * (static_cast<double>(p[next_kick_gives{}]) + given);
    if constexpr (has_half_kicks) {
      p[next_kick_takes{}] = rounded_to<S>(taken_by_kick(1));
      p[next_kick_gives{}] = static_cast<S>(given);
    }
  }

 private:
  template <class S>
  static COLLIDE_HD_INLINE vec3<double> exact(vec3<S> const& x) {
    return x.template cast<double>();
  }
};

}  // namespace collide
