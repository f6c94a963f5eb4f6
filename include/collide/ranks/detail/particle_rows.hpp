/// \file
/// Particles as ranks send them to each other: all that is sent of one in a row.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include <collide/core/contact.hpp>
#include <collide/core/memory.hpp>
#include <collide/effects/detail/particle.hpp>
#include <collide/spaces/detail/host_array.hpp>

namespace collide::detail {

/// The columns of a list, of one particle.
template <class S, class List>
struct particle_row;
template <class S, class... C>
struct particle_row<S, columns<C...>> {
  static constexpr std::size_t size = (column_bytes<C, S> + ... + std::size_t{0});
  unsigned char bytes[size];
};

/// Places of particles that are listed.
struct listed_places {
  std::uint32_t const* list;
  COLLIDE_HD_INLINE std::size_t operator[](std::size_t i) const { return list[i]; }
};
/// Places that follow each other.
struct places_from {
  std::size_t first;
  COLLIDE_HD_INLINE std::size_t operator[](std::size_t i) const { return first + i; }
};
/// Places of particles that go to ranks.
struct routed_places {
  pair const* routes;
  COLLIDE_HD_INLINE std::size_t operator[](std::size_t i) const { return routes[i].triangle; }
};

/// Kernel functor of `for_each` over rows: copies particles from their places.
template <class State, class Places, class Row>
struct pack_rows;
template <class State, class Places, class S, class... C>
struct pack_rows<State, Places, particle_row<S, columns<C...>>> {
  State state;
  Places places;
  particle_row<S, columns<C...>>* rows;

  COLLIDE_HD void operator()(std::size_t i) const {
    unsigned char* to = rows[i].bytes;
    ((std::memcpy(to, state.at(C{}) + places[i] * std::size_t(column_layout<C, S>::width), column_bytes<C, S>),
      to += column_bytes<C, S>),
     ...);
  }
};

/// Kernel functor of `for_each` over rows: copies particles to their places.
template <class State, class Places, class Row>
struct unpack_rows;
template <class State, class Places, class S, class... C>
struct unpack_rows<State, Places, particle_row<S, columns<C...>>> {
  State state;
  Places places;
  particle_row<S, columns<C...>> const* rows;

  COLLIDE_HD void operator()(std::size_t i) const {
    unsigned char const* from = rows[i].bytes;
    ((std::memcpy(state.at(C{}) + places[i] * std::size_t(column_layout<C, S>::width), from, column_bytes<C, S>),
      from += column_bytes<C, S>),
     ...);
  }
};

/// Copies the particles at some places to rows, all in memory of the space.
template <class Space, class State, class Places, class Row>
void pack(Space const& space, State const& state, Places const& places, std::size_t n, Row* rows) {
  space.for_each(n, pack_rows<State, Places, Row>{state, places, rows});
}
/// Copies rows to some places, all in memory of the space.
template <class Space, class State, class Places, class Row>
void unpack(Space const& space, State const& state, Places const& places, std::size_t n, Row const* rows) {
  space.for_each(n, unpack_rows<State, Places, Row>{state, places, rows});
}

/// Rows of the host, from places of memory of a space. Waits.
template <class Space, class State, class Places, class Row>
void pack_on_host(Space const& space, State const& state, Places const& places, std::size_t n, std::vector<Row>& to) {
  to.resize(n);
  if constexpr (Space::host_accessible) {
    pack(space, state, places, n, to.data());
  } else {
    buffer<Row> memory;
    Row* const rows = memory.reserve(space.resource(), n);
    pack(space, state, places, n, rows);
    space.copy_to_host(to.data(), rows, n);
  }
}

/// Puts rows of the host into places of memory of a space. Waits.
template <class Space, class State, class Places, class Row>
void unpack_from_host(Space const& space, State const& state, Places const& places, std::vector<Row> const& from) {
  buffer<Row> memory;
  unpack(space, state, places, from.size(), in_space(space, from, memory));
  space.synchronize();  // the memory goes
}

}  // namespace collide::detail
