/// \file
/// Memory of the host that a space copies to and from, and copies of what is in the other.
#pragma once

#include <cstddef>
#include <memory_resource>
#include <vector>

#include <collide/core/memory.hpp>
#if defined(__CUDACC__)
#include <collide/spaces/cuda_memory.cuh>
#endif

namespace collide::detail {

/// The resource of host memory that a space copies to and from at full speed: pinned memory for a device.
template <class Space>
std::pmr::memory_resource* host_memory_of(Space const&) {
#if defined(__CUDACC__)
  if constexpr (!Space::host_accessible) return cuda_pinned_memory::get();
#endif
  return std::pmr::new_delete_resource();
}

/// Makes room for `n` values: for a quarter more if it must grow, since it may have to again. The old ones are lost.
template <class T>
T* ensure_capacity(buffer<T>& memory, std::pmr::memory_resource* resource, std::size_t n) {
  return memory.reserve(resource, n <= memory.capacity() ? n : n + n / 4);
}

/// An array on the host through which values go to a space, or come from it.
template <class T>
class host_array {
 public:
  /// Sets the size; the values are unspecified.
  template <class Space>
  void resize(Space const& space, std::size_t n) {
    ensure_capacity(memory_, host_memory_of(space), n);
    size_ = n;
  }

  T* data() { return memory_.data(); }
  T const* data() const { return memory_.data(); }
  std::size_t size() const { return size_; }

 private:
  buffer<T> memory_;
  std::size_t size_ = 0;
};

/// Copies `n` values that `pack(to)` writes in memory of the space to the host.
template <class S, class Space, class Pack>
std::vector<S> packed_on_host(Space const& space, std::size_t n, buffer<S>& memory, Pack const& pack) {
  std::vector<S> packed(n);
  if constexpr (Space::host_accessible) {
    pack(packed.data());
  } else {
    S* const to = memory.reserve(space.resource(), n);
    pack(to);
    space.copy_to_host(packed.data(), to, n);
  }
  return packed;
}

/// Values in memory of the space: a copy, unless the space reads the host's.
template <class T, class Space>
T const* in_space(Space const& space, std::vector<T> const& values, [[maybe_unused]] buffer<T>& memory) {
  if constexpr (Space::host_accessible) {
    return values.data();
  } else {
    T* const to = memory.reserve(space.resource(), values.size());
    space.copy_from_host(to, values.data(), values.size());
    return to;
  }
}

}  // namespace collide::detail
