/// \file
/// Effect: a source of particles.
#pragma once

#include <type_traits>

#include <collide/effects/clumps.hpp>
#include <collide/effects/detail/particle.hpp>
#include <collide/effects/effect.hpp>
#include <collide/exact/detail/numeric/elementary.hpp>
#include <collide/spaces/detail/atomic.hpp>

namespace collide {

/// A nozzle: particles begin in a cube around a place, with about the same velocity.
struct nozzle {
  double position[3] = {0, 0, 0};  ///< the middle of the cube
  double half_width = 0;           ///< half the length of the cube's edges
  double velocity[3] = {0, 0, 0};  ///< the mean velocity, in length per time
  double velocity_spread = 0;      ///< how much the coordinates of the velocity differ from the mean at most

  void check_parameters() const {
    using detail::is_finite;
    detail::check_parameter(
        is_finite(position) && is_finite(half_width) && is_finite(velocity) && is_finite(velocity_spread),
        "nozzle: position, half_width, velocity and velocity_spread are finite");
  }

  /// Says how particle `number` begins: sets its centre `x` and its velocity `v`. A number always gives the same.
  template <class S>
  COLLIDE_HD void operator()(std::uint64_t number, vec3<S>& x, vec3<S>& v) const {
    for (int k = 0; k < 3; ++k) {
      x[k] = S(position[k] + half_width * random(6 * number + static_cast<std::uint64_t>(k)));
      v[k] = S(velocity[k] + velocity_spread * random(6 * number + 3 + static_cast<std::uint64_t>(k)));
    }
  }

 private:
  /// Between -1 and 1, always the same for a number.
  static COLLIDE_HD double random(std::uint64_t number) { return 2 * detail::random_fraction(number) - 1; }
};

namespace detail {

/// Kernel functor of `for_each` over the particles of a step, the latest first.
template <class S, class State, class Source>
struct emit_particles {
  State state;
  Source source;
  double due;         ///< particles in the step
  std::uint8_t mark;  ///< what `alive` is of those that are new
  bool only_free;     ///< none makes room

  COLLIDE_HD void operator()(std::size_t i) const {
    std::uint64_t const begin = begun(), n = begin_in_step(state.time, due);
    std::size_t const spheres = spheres_of_clump(state, state.placed), capacity = (state.size - state.placed) / spheres;
    if (i >= n || i >= capacity) return;
    std::uint64_t const number = only_free ? begin + i : begin + n - 1 - i;
    store_at(state.placed + spheres * static_cast<std::size_t>(number % capacity), number, (n - 1 - i) / capacity);
  }

 protected:
  COLLIDE_HD_INLINE std::uint64_t begun() const { return static_cast<std::uint64_t>(state.time[clock_made]); }
  /// Chooses among the particles of a step for a place, of which there are `others`: the latest stays, or the first is
  /// born.
  COLLIDE_HD_INLINE void store_at(std::size_t place, std::uint64_t number, std::uint64_t others) const {
    if (only_free) {
      bool const is_taken = state.at(alive{})[place] != 0;
      if (is_taken || others != 0)
        fetch_add(state.time + clock_not_born, static_cast<double>(others + (is_taken ? 1 : 0)));
      if (is_taken) return;
    }
    if (begins_as_clump(place, number)) return;
    particle<S, typename State::list> p;
    set_initial_values(p);
    p[alive{}] = mark;
    if constexpr (contains<typename State::list, radius>) p[radius{}] = state.at(radius{})[place];
    source(number, p[position{}], p[velocity{}]);
    if constexpr (contains<typename State::list, global_number>) p[global_number{}] = state.at(global_number{})[place];
    state.store(p, place, typename State::list{});
  }

 private:
  /// Lets a clump begin whose spheres are at a place, turned at random; false if it is a sphere's.
  COLLIDE_HD_INLINE bool begins_as_clump([[maybe_unused]] std::size_t place,
                                         [[maybe_unused]] std::uint64_t number) const {
    if constexpr (contains<typename State::list, in_clump>) {
      if (state.at(in_clump{})[place] == no_id) return false;
      using kept = columns<radius, material, global_number, in_clump, clump_mass, clump_offset, clump_inertia>;
      using begun_anew = difference_of<typename State::list, kept>;
      particle<S, begun_anew> p;
      set_initial_values(p);
      p[alive{}] = mark;
      source(number, p[clump_centre{}], p[clump_velocity{}]);
      double turn[4];
      turn_at_random(turn, number);
      for (int k = 0; k < 4; ++k) p[clump_rotation{}].of[k] = S(turn[k]);
      turned_axes<S> const axes(p[clump_rotation{}]);
      p[velocity{}] = p[clump_velocity{}];
      for (std::size_t n = spheres_of_clump(state, place); n-- > 0;) {
        S const* const offset = state.at(clump_offset{}) + 3 * (place + n);
        p[position{}] = p[clump_centre{}] + axes.to_space({offset[0], offset[1], offset[2]});
        state.store(p, place + n, begun_anew{});
      }
      return true;
    }
    return false;
  }
};

/// Kernel functor of `for_each` over the places of a rank: particles of a step that begin there.
template <class S, class State, class Source>
struct emit_at_places : emit_particles<S, State, Source> {
  COLLIDE_HD void operator()(std::size_t i) const {
    State const& here = this->state;
    std::uint64_t const begin = this->begun(), n = begin_in_step(here.time, this->due);
    std::uint64_t const number = here.at(global_number{})[i];
    if (n == 0 || number < here.all_placed || first_of_grain(here, i) != i) return;
    std::uint64_t const spheres = spheres_of_clump(here, i), capacity = (here.all_size - here.all_placed) / spheres,
                        place = (number - here.all_placed) / spheres;
    std::uint64_t const first = (place + capacity - begin % capacity) % capacity;  // of the step for this place
    if (first >= n) return;
    std::uint64_t const others = (n - 1 - first) / capacity;
    this->store_at(i, begin + first + (this->only_free ? 0 : others * capacity), others);
  }
};

}  // namespace detail

/// A source: `rate` particles per unit of time, in the places that `simulation::set` got as capacity beyond the
/// particles that it placed. Where all are taken, the oldest make room. `simulation::births` says how many have come
/// due, and how many of them overlapped others where particles meet each other. With `only_where_free` those are not
/// born, nor one for which another would have to make room: it is dropped, and the next one has a place of its own.
/// They are looked for when particles meet for the first time in the step, so no other is pushed; with
/// `velocity_verlet` that is at its end. A scene has one source at most. `Source` is a copyable function object:
/// COLLIDE_HD source(number, position&, velocity&) const says how particle number 0, 1, ... begins. Clumps wait for it
/// in `set_clumps`.
template <class Source = nozzle>
struct emit_from {
  using writes = columns<position, velocity, alive>;
  static constexpr bool saves_parameters = detail::saves_parameters<Source>;
  static constexpr bool begins_on_ranks = true;  ///< `begin_step` does its work whatever rank a particle is on
  static constexpr bool makes_particles = true;

  double rate = 0;           ///< particles per time, not negative; may change between steps
  Source source = Source();  ///< how they begin
  double radius = 0;         ///< theirs, with `polydisperse`, as it is when `set` is called; 0: that of all in `set`
  bool only_where_free = false;  ///< one that would overlap another, or whose place in memory is taken, is not born

  template <class F>
  void for_each_part(F const& f) {
    f(rate);
    detail::for_each_part_of(source, f);
    f(radius);
    f(only_where_free);
  }
  void check_parameters() const {
    detail::check_parameter(detail::is_amount(rate), "emit: rate is not negative, and finite");
    detail::check_parameter(detail::is_amount(radius), "emit: radius is not negative, and finite");
    detail::check_part(source);
  }

  template <class Particle>
  COLLIDE_HD_INLINE bool is_inactive(Particle const& p) const {
    return p[alive{}] == 0;
  }
  template <class Space, class State, class S>
  void begin_step(Space& space, State const& state, S dt, std::uint8_t mark = 1) const {
    static_assert(std::is_invocable<Source const&, std::uint64_t, vec3<S>&, vec3<S>&>::value,
                  "collide: a source of emit_from is called as source(number, position&, velocity&) const");
    double const due = rate * static_cast<double>(dt);
    if (!(due > 0)) return;
    if constexpr (detail::contains<typename State::list, collide::global_number>) {
      using places = detail::emit_at_places<S, State, Source>;
      if (state.all_size != state.all_placed)
        space.for_each(state.size, places{{state, source, due, mark, only_where_free}});
    } else {
      std::size_t const capacity = state.size - state.placed;
      std::size_t const max_count = due < static_cast<double>(capacity) ? static_cast<std::size_t>(due) + 2 : capacity;
      space.for_each(detail::min(max_count, capacity),
                     detail::emit_particles<S, State, Source>{state, source, due, mark, only_where_free});
    }
  }
};

/// A source that is a nozzle.
using emit = emit_from<>;

}  // namespace collide
