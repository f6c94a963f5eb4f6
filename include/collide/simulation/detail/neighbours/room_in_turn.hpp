/// \file
/// Memory that some arrays have in one phase of a step, and others in the next.
#pragma once

#include <cstddef>

#include <collide/core/memory.hpp>

namespace collide::detail {

/// An array that gets its memory from a room.
template <class T>
struct array_in_room {
  T*& data;
  std::size_t size;

  static constexpr std::size_t alignment = 256;
  std::size_t bytes() const { return (size * sizeof(T) + alignment - 1) / alignment * alignment; }
};
template <class T>
array_in_room<T> in_room(T*& data, std::size_t size) {
  return {data, size};
}

/// The memory: as much as the largest phase takes.
class room_in_turn {
 public:
  /// Gives all of it to these arrays; those of the phase before have nothing any more. Allocates if it must grow.
  template <class... T>
  void give(std::pmr::memory_resource* resource, array_in_room<T> const&... arrays) {
    std::byte* next = all(resource, (arrays.bytes() + ... + std::size_t{0}));
    ((arrays.data = reinterpret_cast<T*>(next), next += arrays.bytes()), ...);
  }
  /// All of it, at least so many bytes.
  std::byte* all(std::pmr::memory_resource* resource, std::size_t bytes) { return memory_.reserve(resource, bytes); }

  std::size_t bytes() const { return memory_.bytes(); }

 private:
  buffer<std::byte> memory_;
};

}  // namespace collide::detail
