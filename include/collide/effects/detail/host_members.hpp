/// \file
/// The work of a simulation on the host with effects and columns.
#pragma once

#include <cstdint>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <collide/effects/bodies.hpp>
#include <collide/effects/detail/effect_list.hpp>
#include <collide/spheres.hpp>

namespace collide {

/// Counts of a source since `set`.
struct birth_counts {
  std::uint64_t due = 0;          ///< particles that have come due: time times rate
  std::uint64_t overlapping = 0;  ///< of these, in scenes in which particles meet: those that overlapped one that was
                                  ///< there before, or one of the same step whose place is before theirs
  std::uint64_t not_born = 0;     ///< with `only_where_free`: those, and those whose place in memory was taken
};

namespace detail {

inline birth_counts births_of(double const (&clock)[clock_size]) {
  auto const whole = [&](std::size_t k) { return static_cast<std::uint64_t>(clock[k]); };
  return {whole(clock_made), whole(clock_overlapping), whole(clock_not_born)};
}

/// Throws `error` if these are more places than a simulation may have.
inline void check_places(std::uint64_t places) {
  if (places >= no_id) throw error("collide: simulation: a simulation has at most 2^32 - 2 particles");
}

/// Throws `error` unless a simulation with these columns can have such particles, and places for them. `own` is the
/// radius of what a source makes: 0 for the common radius of all, -1 if there is none.
template <class Columns, class S>
void check_particles(bool one_radius, std::uint64_t particles, std::uint64_t places, S own, S common) {
  if (!one_radius && !contains<Columns, radius>) {
    throw error("collide: simulation: the radii differ: name the effect polydisperse in the scene");
  }
  if (own > 0 && !contains<Columns, radius>) {
    throw error("collide: emit: a source with a radius of its own needs polydisperse in the scene");
  }
  if (places > particles && !contains<Columns, alive>) {
    throw error("collide: simulation: there is room for more particles, but no effect in the scene that makes any");
  }
  if (places > particles && contains<Columns, radius> && own == 0 && !(common > 0)) {
    throw error("collide: emit: the radii differ: give the source a radius, before set");
  }
  check_places(places);
}

/// Calls `check_bodies` of an effect that keeps something for each body.
template <class E>
using check_bodies_call = decltype(std::declval<E const&>().check_bodies(std::size_t{}));
template <class E>
void check_bodies_of([[maybe_unused]] E const& effect, [[maybe_unused]] std::size_t bodies) {
  if constexpr (is_valid<check_bodies_call, E>) effect.check_bodies(bodies);
}

/// Calls `check_particles` and `check_walls` of the materials of an effect, if it has such.
template <class E>
using materials_call = decltype(std::declval<E const&>().made_of.check_particles(0));
template <class E>
void check_materials_of([[maybe_unused]] E const& effect, [[maybe_unused]] smallest_radii const& radii) {
  if constexpr (is_valid<materials_call, E>) effect.made_of.check_particles(radii.largest_material);
}
template <class E, class Space>
void check_walls_of([[maybe_unused]] E const& effect, [[maybe_unused]] Space const& space,
                    [[maybe_unused]] std::size_t triangles, [[maybe_unused]] std::size_t bodies) {
  if constexpr (is_valid<materials_call, E>) effect.made_of.check_walls(space, triangles, bodies);
}

template <class E, class Radius>
using longest_step_call = decltype(std::declval<E const&>().longest_step(std::declval<Radius>()));
inline std::string text_of(double x) {
  std::ostringstream text;
  text << x;
  return text.str();
}
/// The longest step that an effect allows, by the radii of each material, or by the smallest of all.
template <class E>
double longest_step_of([[maybe_unused]] E const& effect, [[maybe_unused]] smallest_radii const& radii) {
  if constexpr (is_valid<longest_step_call, E, smallest_radii const&>) {
    return effect.longest_step(radii);
  } else if constexpr (is_valid<longest_step_call, E, double>) {
    return effect.longest_step(radii.of_all);
  } else {
    return std::numeric_limits<double>::infinity();
  }
}
inline void check_time_step(double dt, double longest, smallest_radii const& radii) {
  if (!(radii.of_all > 0 && dt > longest)) return;
  throw error("collide: simulation: the time dt of a step, " + text_of(dt) +
              ", is longer than an effect allows with the smallest particles, " + text_of(longest) +
              ": take largest_time_step(simulation)");
}

/// In a scene without `moving_bodies`: nothing.
struct no_bodies {
  static constexpr bool exist = false;

  static std::size_t bytes() { return 0; }
  static std::size_t size() { return 0; }
  static int margin() { return 0; }
  static void mark() {}
  static double moved() { return 0; }
  static constexpr bool are_driven() { return false; }
  static constexpr bool are_placed() { return false; }
  static void place(bool) {}
  static void check(std::vector<body> const& bodies, std::size_t, void const* velocities) {
    if (!bodies.empty() || velocities != nullptr)
      throw error("collide: set_mesh: a scene with bodies names the effect moving_bodies");
  }
  template <class Space, class Mesh>
  void build(Space&, Mesh const&, std::vector<body> const&, void const*) {}
  template <class Triangles, class Mesh, class S>
  Triangles const& ref(Triangles const& whole, Mesh const&, S) const {
    return whole;
  }
};

/// The address of a container's elements.
template <class T>
T const* raw_pointer(T const* p) {
  return p;
}
template <class Pointer>
auto raw_pointer(Pointer const& p) -> decltype(p.get()) {
  return p.get();
}

/// Calls an effect's `begin_step`, if it has one. What a source makes is marked where particles meet, or contacts with
/// the mesh remember something.
template <class E, class Effects, class Space, class State, class S>
void begin_step_of(Effects& effects, Space& space, State const& state, S dt) {
  if constexpr (is_source<E>) {
    constexpr bool marks = Effects::any_pair_contact || Effects::remembers_surfaces;
    effects.template of<E>().begin_step(space, state, dt, marks ? newborn : std::uint8_t{1});
  } else if constexpr (has_begin_step<E, Space, State, S>) {
    effects.template of<E>().begin_step(space, state, dt);
  }
}

/// The radii of a simulation's particles.
template <class S>
struct radius_range {
  S smallest = 0;  ///< of those that are not negative; infinite if there are none
  S largest = 0;
  S small = 0;             ///< the largest of those up to twice the smallest; 0: not known
  std::size_t larger = 0;  ///< how many are larger than those, if these are known

  /// True if of `n` particles the small ones should have cells of their own: larger ones, which look into all that they
  /// reach, or at all particles, must be few.
  bool has_small_apart(std::size_t n, S skin) const {
    if (!(small > 0 && largest > 2 * small)) return false;
    double const across = static_cast<double>((largest + small + skin) / small) + 2, all = static_cast<double>(n);
    return static_cast<double>(larger) * min(all, across * across * across) <= 64 * all;
  }
  /// With those of what a source makes, if they have one of their own: of how many it makes nothing is known.
  radius_range with(S own) const {
    if (!(own > 0)) return *this;
    bool const is_small = small > 0 && own >= smallest && own <= 2 * smallest;
    return {min(smallest, own), max(largest, own), is_small ? max(small, own) : S(0), larger};
  }
};

}  // namespace detail
}  // namespace collide
