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
  buffer<id> names;         ///< the number of each
  buffer<std::byte> moved;  ///< room for any column

  /// Puts the particle that lies at from[i] at i. `surfaces` is what they remember of the mesh.
  template <class Space, class State, class Surfaces>
  void take(Space const& space, State& state, Surfaces const& surfaces, id const* from) {
    std::size_t const n = state.size;
    if (state.names == nullptr) space.for_each(n, [&](std::size_t i) { names.data()[i] = static_cast<id>(i); });
    state.names = names.data();
    move(space, names.data(), from, n);
    move_all(space, state, surfaces, from);
  }
  /// Puts all back in the order of numbers.
  template <class Space, class State, class Surfaces>
  void put_back(Space const& space, State& state, Surfaces const& surfaces) {
    std::size_t const n = state.size;
    id* const place_of = reinterpret_cast<id*>(moved.data());  // of each number
    space.for_each(n, [&](std::size_t i) { place_of[names.data()[i]] = static_cast<id>(i); });
    std::copy_n(place_of, n, names.data());
    move_all(space, state, surfaces, names.data());
    state.names = nullptr;
  }

 private:
  template <class Space, class S, class... C, class Surfaces>
  void move_all(Space const& space, particle_state<S, columns<C...>> const& state, Surfaces const& surfaces,
                id const* from) const {
    (move(space, reinterpret_cast<value_of<C, S>*>(state.at(C{})), from, state.size), ...);
    surfaces.for_each_array(state.size, [&](auto* values) { move(space, values, from, state.size); });
  }
  template <class C, class S>
  struct value_of {
    column_element<C, S> numbers[std::size_t(column_layout<C, S>::width)];
  };
  template <class Space, class T>
  void move(Space const& space, T* values, id const* from, std::size_t n) const {
    T* const copy = reinterpret_cast<T*>(moved.data());
    space.for_each(n, [=](std::size_t i) { copy[i] = values[from[i]]; });
    space.for_each(n, [=](std::size_t i) { values[i] = copy[i]; });
  }
};

}  // namespace collide::detail
