/// \file
/// Particles as ranks send them to each other: all that is sent of one in a row.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include <collide/detail/execution/host_array.hpp>
#include <collide/detail/simulation/particle.hpp>
#include <collide/memory.hpp>

namespace collide::detail {

/// The columns of a list, of one particle.
template <class S, class List>
struct particle_row;
template <class S, class... C>
struct particle_row<S, columns<C...>> {
  static constexpr std::size_t size = (column_bytes<C, S> + ... + std::size_t{0});
  unsigned char bytes[size];
};

/// Kernel body of `for_each` over rows: copies particles from their places. `places` null: from `first` on.
template <class State, class S, class List>
struct pack_rows;
template <class State, class S, class... C>
struct pack_rows<State, S, columns<C...>> {
  State state;
  std::uint32_t const* places;
  std::size_t first;
  particle_row<S, columns<C...>>* rows;

  COLLIDE_HD void operator()(std::size_t i) const {
    std::size_t const place = places != nullptr ? places[i] : first + i;
    unsigned char* to = rows[i].bytes;
    ((std::memcpy(to, state.at(C{}) + place * std::size_t(column_layout<C, S>::width), column_bytes<C, S>),
      to += column_bytes<C, S>),
     ...);
  }
};

/// Kernel body of `for_each` over rows: copies particles to their places. `places` null: from `first` on.
template <class State, class S, class List>
struct unpack_rows;
template <class State, class S, class... C>
struct unpack_rows<State, S, columns<C...>> {
  State state;
  std::uint32_t const* places;
  std::size_t first;
  particle_row<S, columns<C...>> const* rows;

  COLLIDE_HD void operator()(std::size_t i) const {
    std::size_t const place = places != nullptr ? places[i] : first + i;
    unsigned char const* from = rows[i].bytes;
    ((std::memcpy(state.at(C{}) + place * std::size_t(column_layout<C, S>::width), from, column_bytes<C, S>),
      from += column_bytes<C, S>),
     ...);
  }
};

/// Rows on the host, and memory of a space through which they go.
template <class S, class List>
class row_carrier {
 public:
  using row = particle_row<S, List>;

  /// The rows of `n` particles, in a vector or a `host_array`. `places`, in memory of the space: where they are; null:
  /// from `first` on. Waits.
  template <class Space, class State, class Rows>
  void pack(Space const& space, State const& state, std::uint32_t const* places, std::size_t first, std::size_t n,
            Rows& to) {
    resize(space, to, n);
    if constexpr (Space::host_accessible) {
      space.for_each(n, pack_rows<State, S, List>{state, places, first, to.data()});
    } else {
      row* const rows = memory_.reserve(space.resource(), n);
      space.for_each(n, pack_rows<State, S, List>{state, places, first, rows});
      space.copy_to_host(to.data(), rows, n);
    }
  }

  /// Puts rows into their places.
  template <class Space, class State, class Rows>
  void unpack(Space const& space, State const& state, std::uint32_t const* places, std::size_t first,
              Rows const& from) {
    if constexpr (Space::host_accessible) {
      space.for_each(from.size(), unpack_rows<State, S, List>{state, places, first, from.data()});
    } else {
      row* const rows = memory_.reserve(space.resource(), from.size());
      space.copy_from_host(rows, from.data(), from.size());
      space.for_each(from.size(), unpack_rows<State, S, List>{state, places, first, rows});
    }
  }

 private:
  buffer<row> memory_;
};

}  // namespace collide::detail
