/// \file
/// Particles on the host in the order of the cells of their lists of neighbours: what a step reads and writes one after
/// the other lies so in memory.
#pragma once

#include <algorithm>
#include <cstddef>

#include <collide/core/memory.hpp>
#include <collide/effects/detail/particle.hpp>
#include <collide/spaces/detail/algorithms.hpp>

namespace collide::detail {

/// The order in which a simulation's particles lie: that of their numbers, or another one.
struct cell_order {
  buffer<id> names;  ///< the number of each

  /// Puts the particle that lies at from[i] at i. `surfaces` is what they remember of the mesh; `room` is for any
  /// column.
  template <class Space, class State, class Surfaces>
  void take(Space const& space, State& state, Surfaces const& surfaces, id const* from, std::byte* room) {
    std::size_t const n = state.size;
    if (state.names == nullptr) space.for_each(n, [&](std::size_t i) { names.data()[i] = static_cast<id>(i); });
    state.names = names.data();
    move(space, names.data(), from, n, room);
    move_all(space, state, surfaces, from, room);
  }
  /// Puts all back in the order of numbers.
  template <class Space, class State, class Surfaces>
  void put_back(Space const& space, State& state, Surfaces const& surfaces, std::byte* room) {
    std::size_t const n = state.size;
    id* const place_of = reinterpret_cast<id*>(room);  // of each number
    space.for_each(n, [&](std::size_t i) { place_of[names.data()[i]] = static_cast<id>(i); });
    std::copy_n(place_of, n, names.data());
    move_all(space, state, surfaces, names.data(), room);
    state.names = nullptr;
  }

 private:
  template <class Space, class S, class... C, class Surfaces>
  void move_all(Space const& space, particle_state<S, columns<C...>> const& state, Surfaces const& surfaces,
                id const* from, std::byte* room) const {
    (move(space, reinterpret_cast<value_of<C, S>*>(state.at(C{})), from, state.size, room), ...);
    surfaces.for_each_array([&](auto* values) { move(space, values, from, state.size, room); });
  }
  template <class C, class S>
  struct value_of {
    column_element<C, S> numbers[std::size_t(column_layout<C, S>::width)];
  };
  template <class Space, class T>
  void move(Space const& space, T* values, id const* from, std::size_t n, std::byte* room) const {
    T* const copy = reinterpret_cast<T*>(room);
    space.for_each(n, [=](std::size_t i) { copy[i] = values[from[i]]; });
    space.for_each(n, [=](std::size_t i) { values[i] = copy[i]; });
  }
};

}  // namespace collide::detail
