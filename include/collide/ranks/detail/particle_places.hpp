/// \file
/// The places of a rank's particles, their numbers among all, and whether they have moved.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/effects/clumps.hpp>
#include <collide/effects/detail/effect_list.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>
#include <collide/ranks/detail/bisection.hpp>
#include <collide/ranks/detail/send_plan.hpp>
#include <collide/spaces/detail/atomic.hpp>
#include <collide/spheres.hpp>

namespace collide::detail {

/// Effect: particles know their numbers among those of all ranks.
struct with_global_numbers {
  using reads = columns<global_number>;
};

/// Refuses an effect that would do something else on ranks than on one.
template <class E, class Space, class State, class S>
constexpr bool check_on_ranks() {
  static_assert(!has_begin_step<E, Space, State, S> || begins_on_ranks<E>,
                "collide: an effect's begin_step sees the places of one rank alone: if it does the same to particles "
                "wherever they are, the effect says static constexpr bool begins_on_ranks = true");
  return true;
}

/// Numbers of the particles of all ranks when these are set.
struct global_counts {
  std::uint64_t first;                  ///< number of this rank's first particle
  std::uint64_t placed, size;           ///< particles, and places for them, on all ranks
  std::uint64_t first_free, free_size;  ///< the free places that this rank begins with
};

/// Kernel functor of `for_each` over spheres: their radii.
template <class S>
struct copy_radii {
  sphere_view<S> spheres;
  S* to;
  COLLIDE_HD void operator()(std::size_t i) const { to[i] = spheres.radius(i); }
};

/// Kernel functor of `for_each` over places: numbers them.
template <class S, class State>
struct number_places {
  State state;
  std::size_t placed;
  std::uint64_t first, first_free;
  decltype(State::common_radius) free_radius;  ///< of what a source makes; not above 0: the common one

  COLLIDE_HD void operator()(std::size_t i) const {
    bool const is_free = i >= placed;
    state.at(global_number{})[i] = static_cast<id>(is_free ? first_free + (i - placed) : first + i);
    if constexpr (contains<typename State::list, radius>) {
      if (is_free) state.at(radius{})[i] = free_radius > 0 ? free_radius : state.common_radius;
    }
  }
};

/// The position of a particle, in the box if space repeats.
template <class S>
COLLIDE_HD_INLINE vec3<S> inside(open_space, S const* x) {
  return {x[0], x[1], x[2]};
}
template <class S>
COLLIDE_HD_INLINE vec3<S> inside(repeating_box<S> const& space, S const* x) {
  return space.inside(vec3<S>(x[0], x[1], x[2]));
}
template <class S>
COLLIDE_HD_INLINE void bring_together(open_space, vec3<S>&, vec3<S>&) {}
template <class S>
COLLIDE_HD_INLINE void bring_together(repeating_box<S> const& space, vec3<S>& a, vec3<S>& b) {
  space.bring_together(a, b);
}

/// Positions of particles, and whether they were there, when ranks last exchanged some.
template <class S>
struct last_places {
  S* centres;
  std::uint8_t* there;
};

/// Kernel functor of `for_each` over particles: keeps where they are.
template <class S, class State>
struct keep_places {
  State state;
  last_places<S> last;

  COLLIDE_HD void operator()(std::size_t i) const {
    for (std::size_t k = 0; k < 3; ++k) last.centres[3 * i + k] = state.at(position{})[3 * i + k];
    if constexpr (contains<typename State::list, alive>) last.there[i] = state.at(alive{})[i];
  }
};

/// Kernel functor of `for_each` over particles: sets a flag if one has come, or moved too far.
template <class S, class State, class Space>
struct find_moved {
  State state;
  Space space;
  last_places<S> last;
  S limit;
  std::uint32_t* flag;

  COLLIDE_HD void operator()(std::size_t i) const {
    if constexpr (contains<typename State::list, alive>) {
      if (state.at(alive{})[i] == 0) return;
      if (last.there[i] == 0) return store_relaxed(flag, 1u);
    }
    S const *const x = state.at(position{}) + 3 * i, *const before = last.centres + 3 * i;
    vec3<S> now = inside(space, x), then = inside(space, before);
    if (!is_finite(now)) return;
    bring_together(space, now, then);
    vec3<S> const moved = now - then;
    bool const stayed = is_finite(moved) && dot(moved, moved) <= mul_rn(limit, limit);
    if (!stayed) store_relaxed(flag, 1u);
  }
};

/// True if there is a particle at a place.
template <class State>
COLLIDE_HD_INLINE bool is_there([[maybe_unused]] State const& state, [[maybe_unused]] std::size_t i) {
  if constexpr (contains<typename State::list, alive>) return state.at(alive{})[i] != 0;
  return true;
}
/// True if there is a particle, at a point that is finite.
template <class State>
COLLIDE_HD_INLINE bool is_somewhere(State const& state, std::size_t i) {
  auto const* const x = state.at(position{}) + 3 * i;
  return is_there(state, i) && is_finite(x[0]) && is_finite(x[1]) && is_finite(x[2]);
}

/// How many particles one call of `count_somewhere` looks at.
inline constexpr std::size_t count_group = 64;

/// Kernel functor of `for_each` over groups of particles: counts those that are somewhere.
template <class S, class State>
struct count_somewhere {
  State state;
  std::uint64_t* sum;

  COLLIDE_HD void operator()(std::size_t group) const {
    std::size_t const groups = (state.own + count_group - 1) / count_group;
    std::uint64_t n = 0;
    for (std::size_t i = group; i < state.own; i += groups) {
      if (is_somewhere(state, i)) ++n;
    }
    if (n != 0) fetch_add(sum, n);
  }
};

/// The centre of the grain that begins at a place: of a particle, or of a clump.
template <class State>
COLLIDE_HD_INLINE auto const* centre_of_grain(State const& state, std::size_t place) {
  if constexpr (contains<typename State::list, in_clump>) {
    if (state.at(in_clump{})[place] != no_id) return state.at(clump_centre{}) + 3 * place;
  }
  return state.at(position{}) + 3 * place;
}

/// Kernel functor of `for_each` over particles: lists those that are to be on other ranks, where all of a clump go with
/// its centre. Free places are on all ranks alike; what is nowhere stays.
template <class S, class State, class Space>
struct find_leaving {
  State state;
  Space space;
  subdomain_lookup subdomains;
  int self, ranks;
  output to;

  COLLIDE_HD void operator()(std::size_t i) const {
    int rank = self;
    std::size_t const first = first_of_grain(state, i);
    S const* const x = centre_of_grain(state, first);
    if (is_there(state, first)) {
      if (is_finite(vec3<S>(x[0], x[1], x[2]))) rank = subdomains.rank_at(inside(space, x).data());
    } else {
      std::uint64_t const number = state.at(global_number{})[first];
      rank = static_cast<int>(number * static_cast<std::uint64_t>(ranks) / state.all_size);
    }
    if (rank != self) add_send(to, rank, i);
  }
};

/// Kernel functor of `for_each` over particles: lists those that are near the subdomains of other ranks.
template <class S, class State, class Space>
struct find_copied {
  State state;
  Space space;
  subdomain_lookup subdomains;
  double reach;
  int self;
  output to;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (!is_somewhere(state, i)) return;
    for_each_rank_near(subdomains, space, state.at(position{}) + 3 * i, reach, [&](int rank) {
      if (rank != self) add_send(to, rank, i);
    });
  }
};

}  // namespace collide::detail
