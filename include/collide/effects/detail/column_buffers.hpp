/// \file
/// The memory of columns.
#pragma once

#include <algorithm>

#include <collide/core/memory.hpp>
#include <collide/effects/detail/particle.hpp>

namespace collide::detail {

/// The memory of a column.
template <class C, class S>
struct buffer_of {
  buffer<column_element<C, S>> memory;
};

/// The memory of all columns.
template <class S, class List>
struct column_buffers;
template <class S, class... C>
struct column_buffers<S, columns<C...>> : buffer_of<C, S>... {
  static constexpr std::size_t bytes_per_particle = (column_bytes<C, S> + ... + std::size_t{0});
  static constexpr std::size_t widest = std::max({std::size_t{0}, column_bytes<C, S>...});

  void reserve([[maybe_unused]] std::pmr::memory_resource* resource, [[maybe_unused]] std::size_t n) {
    (static_cast<buffer_of<C, S>&>(*this).memory.reserve(resource, n * std::size_t(column_layout<C, S>::width)), ...);
  }

  std::size_t bytes() const {
    return (static_cast<buffer_of<C, S> const&>(*this).memory.bytes() + ... + std::size_t{0});
  }

  particle_state<S, columns<C...>> state(std::size_t size, std::size_t placed, S radius) const {
    return {pointer_of<C, S>{static_cast<buffer_of<C, S> const&>(*this).memory.data()}...,
            {},
            size,
            placed,
            radius,
            nullptr,
            nullptr};
  }
};

}  // namespace collide::detail
