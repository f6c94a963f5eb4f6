/// \file
/// Kernel bodies that look whether what a source makes overlaps something, before particles meet.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/simulation/detail/neighbours/particle_order.hpp>
#include <collide/spaces/detail/atomic.hpp>

namespace collide::detail {

/// How many places of a state are the rank's own.
template <class State>
COLLIDE_HD_INLINE std::size_t own_places(State const& state) {
  if constexpr (contains<typename State::list, global_number>) return state.own;
  return state.size;
}

/// Kernel functor of `for_each` over places in the order: marks newborns that overlap what was there before, or of
/// those of this step one with a smaller number. A thread writes the mark of its own particle alone.
template <class S, class Effects>
struct find_crowded_births {
  particle_state<S, typename Effects::all> state;
  sorted_particles<S, Effects> order;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (state.time[clock_made_now] == 0 || i >= order.header->count) return;
    std::uint8_t* const marks = state.at(alive{});
    id const number = order.numbers[i];
    if (number >= own_places(state) || !is_newborn(load_relaxed(marks + number))) return;
    auto const place = static_cast<std::uint32_t>(i);
    bool is_crowded = false;
    order.for_each_overlapping(place, S(0), [&](std::uint32_t k, int) {
      is_crowded = is_crowded || !is_newborn(load_relaxed(marks + order.numbers[k])) ||
                   order.number_at(k) < order.number_at(place);
    });
    if (is_crowded) store_relaxed(marks + number, crowded_newborn);
  }
};

/// Kernel functor of `for_each` over particles: counts the newborns that are marked, and takes the marks off; if
/// `refuse`, those that are marked are not born.
template <class S, class Effects>
struct settle_births {
  particle_state<S, typename Effects::all> state;
  list_state* header;
  bool refuse;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (i == 0) header->rebuild = 0;  // lists are complete
    if (state.time[clock_made_now] == 0 || i >= own_places(state)) return;
    std::uint8_t& mark = state.at(alive{})[i];
    if (!is_newborn(mark)) return;
    bool const is_crowded = mark == crowded_newborn;
    if (is_crowded) fetch_add(state.time + clock_overlapping, 1.0);
    if (is_crowded && refuse) fetch_add(state.time + clock_not_born, 1.0);
    mark = is_crowded && refuse ? 0 : 1;
  }
};

/// Kernel functor of `for_each` over places in the order: nobody meets what was not born.
template <class S, class Effects>
struct leave_out_unborn {
  particle_state<S, typename Effects::all> state;
  sorted_particles<S, Effects> order;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (state.time[clock_made_now] == 0 || i >= order.header->count) return;
    if (state.at(alive{})[order.numbers[i]] == 0) order.deactivate(i);
  }
};

}  // namespace collide::detail
