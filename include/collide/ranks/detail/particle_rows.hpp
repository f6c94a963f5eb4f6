/// \file
/// Particles as ranks send them to each other: all that is sent of one in a row.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include <collide/core/contact.hpp>
#include <collide/core/memory.hpp>
#include <collide/effects/detail/contact_memory.hpp>
#include <collide/effects/detail/particle.hpp>
#include <collide/ranks/detail/device_exchange_buffer.hpp>
#include <collide/ranks/detail/send_plan.hpp>
#include <collide/spaces/detail/host_array.hpp>

namespace collide::detail {

template <class S, class List>
struct particle_row;
template <class S, class... C>
struct particle_row<S, columns<C...>> {
  static constexpr std::size_t size = (column_bytes<C, S> + ... + std::size_t{0});
  unsigned char bytes[size];
};

struct listed_places {
  std::uint32_t const* list;
  COLLIDE_HD_INLINE std::size_t operator[](std::size_t i) const { return list[i]; }
};
struct places_from {
  std::size_t first;
  COLLIDE_HD_INLINE std::size_t operator[](std::size_t i) const { return first + i; }
};
/// Places of particles that go to ranks.
struct routed_places {
  pair const* routes;
  COLLIDE_HD_INLINE std::size_t operator[](std::size_t i) const { return item_of(routes[i]); }
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

template <class Space, class State, class Places, class Row>
void pack_particles(Space const& space, State const& state, Places const& places, std::size_t n, Row* rows) {
  space.for_each(n, pack_rows<State, Places, Row>{state, places, rows});
}
template <class Space, class State, class Places, class Row>
void unpack_particles(Space const& space, State const& state, Places const& places, std::size_t n, Row const* rows) {
  space.for_each(n, unpack_rows<State, Places, Row>{state, places, rows});
}

/// Rows of the host, from places of memory of a space. Waits.
template <class Space, class State, class Places, class Row>
void pack_on_host(Space const& space, State const& state, Places const& places, std::size_t n, std::vector<Row>& to) {
  to.resize(n);
  if constexpr (Space::host_accessible) {
    pack_particles(space, state, places, n, to.data());
  } else {
    buffer<Row> memory;
    Row* const rows = memory.reserve(space.resource(), n);
    pack_particles(space, state, places, n, rows);
    space.copy_to_host(to.data(), rows, n);
  }
}

/// Puts rows of the host into places of memory of a space. Waits.
template <class Space, class State, class Places, class Row>
void unpack_from_host(Space const& space, State const& state, Places const& places, std::vector<Row> const& from) {
  buffer<Row> memory;
  unpack_particles(space, state, places, from.size(), in_space(space, from, memory));
  space.synchronize();  // the memory goes
}

/// A contact of a particle: with another, or with a body.
template <class S, std::size_t Width>
struct contact_row {
  id of, other;
  S values[Width];
};

/// The contacts of some particles: the particle at place i is number `numbers[i]`. Those of a particle follow each
/// other as they did.
template <class Row, class S>
std::vector<Row> rows_of(saved_contacts<S> const& saved, std::vector<id> const& numbers) {
  std::vector<Row> rows;
  std::size_t at = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::uint32_t k = 0; k < saved.counts[i]; ++k, ++at) {
      Row row{numbers[i], saved.others[at], {}};
      constexpr std::size_t width = sizeof row.values / sizeof(S);
      std::copy_n(saved.values.data() + width * at, width, row.values);
      rows.push_back(row);
    }
  }
  return rows;
}

/// The contacts that rows tell of, for particles at places: the opposite of `rows_of`. Rows of particles that are not
/// there are left out.
template <class S, std::size_t Width>
saved_contacts<S> contacts_of(std::vector<contact_row<S, Width>> const& rows, std::vector<id> const& numbers) {
  std::vector<std::pair<id, std::size_t>> places;
  for (std::size_t i = 0; i < numbers.size(); ++i) places.emplace_back(numbers[i], i);
  std::sort(places.begin(), places.end());
  std::vector<std::pair<std::size_t, std::size_t>> order;  // places, and rows
  for (std::size_t k = 0; k < rows.size(); ++k) {
    auto const found = std::lower_bound(places.begin(), places.end(), std::pair(rows[k].of, std::size_t{0}));
    if (found != places.end() && found->first == rows[k].of) order.emplace_back(found->second, k);
  }
  std::sort(order.begin(), order.end());
  saved_contacts<S> saved;
  saved.counts.assign(numbers.size(), 0);
  for (auto const& [place, k] : order) {
    ++saved.counts[place];
    saved.others.push_back(rows[k].other);
    saved.values.insert(saved.values.end(), rows[k].values, rows[k].values + Width);
  }
  return saved;
}

inline std::vector<id> first_ids(std::size_t n) {
  std::vector<id> numbers(n);
  for (std::size_t i = 0; i < n; ++i) numbers[i] = static_cast<id>(i);
  return numbers;
}

/// Brings rows to the ranks on which their particles are to be: `rank_of(number)` is that of a particle. All ranks call
/// it.
template <class Ranks, class Row, class Rank>
void deliver_rows(Ranks const& ranks, std::vector<Row>& rows, Rank const& rank_of) {
  exchange_buffer<Row> out, in;
  together(ranks, [&] {
    fill_exchange_buffer(out, ranks.size(), [&](auto const& put) {
      for (Row const& row : rows) put(rank_of(row.of), row);
    });
  });
  deliver(ranks, out, in);
  rows = std::move(in.items);
}

/// A vector of plain values of any type, for their bytes.
class any_vector {
 public:
  template <class T>
  any_vector(std::vector<T>& of)
      : of_{&of}, resize_{[](void* vector, std::size_t bytes) {
          auto& values = *static_cast<std::vector<T>*>(vector);
          values.resize(bytes / sizeof(T));
          return reinterpret_cast<unsigned char*>(values.data());
        }} {}
  unsigned char* resize(std::size_t bytes) const { return resize_(of_, bytes); }

 private:
  void* of_;
  unsigned char* (*resize_)(void* vector, std::size_t bytes);
};

/// Brings rows of particles, so many bytes of each, to the ranks that have set these, in the order of their numbers: a
/// rank has set those from its start in `starts` on, and the last one has those, too, that effects make. All ranks call
/// it.
template <class Ranks>
void bring_home(Ranks const& ranks, std::vector<std::uint64_t> const& starts, std::vector<id> const& numbers,
                std::vector<unsigned char> const& rows, std::size_t bytes, any_vector const& to) {
  exchange_buffer<id> leaving, coming;
  exchange_buffer<unsigned char> sent, received;
  unsigned char* home = nullptr;
  together(ranks, [&] {
    exchange_buffer<std::uint32_t> places;
    fill_exchange_buffer(places, ranks.size(), [&](auto const& put) {
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        auto const after = std::upper_bound(starts.begin(), starts.end(), std::uint64_t{numbers[i]});
        put(std::min(static_cast<int>(after - starts.begin()), ranks.size()) - 1, static_cast<std::uint32_t>(i));
      }
    });
    for (std::uint32_t const place : places.items) {
      auto const row = rows.begin() + static_cast<std::ptrdiff_t>(place * bytes);
      leaving.items.push_back(numbers[place]);
      sent.items.insert(sent.items.end(), row, row + static_cast<std::ptrdiff_t>(bytes));
    }
    leaving.counts = sent.counts = places.counts;
    for (std::uint64_t& n : sent.counts) n *= bytes;
  });
  deliver(ranks, leaving, coming);
  deliver(ranks, sent, received);
  together(ranks, [&] { home = to.resize(received.items.size()); });
  std::uint64_t const first = starts[static_cast<std::size_t>(ranks.rank())];
  for (std::size_t i = 0; i < coming.items.size(); ++i)
    std::memcpy(home + bytes * (coming.items[i] - first), received.items.data() + bytes * i, bytes);
}

/// Brings values of all ranks to the first one: those of rank 0 come first. All ranks call it.
template <class Ranks>
void bring_to_first(Ranks const& ranks, std::vector<unsigned char>& values) {
  exchange_buffer<unsigned char> mine, all;
  together(ranks, [&] {
    mine.clear(ranks.size());
    mine.counts[0] = values.size();
    mine.items = std::move(values);
  });
  deliver(ranks, mine, all);
  values = std::move(all.items);
}

}  // namespace collide::detail
