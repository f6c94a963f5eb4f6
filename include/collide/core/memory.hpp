/// \file
/// Memory of an execution space: buffers over a std::pmr::memory_resource, and an adaptor for Thrust-style allocators.
#pragma once

#include <cstddef>
#include <memory>
#include <memory_resource>
#include <type_traits>
#include <utility>

#include <collide/core/config.hpp>

namespace collide {

namespace detail {

/// Says whether `p` is in memory of a CUDA device that the host cannot read. Set where nvcc has compiled some part of
/// the program, see cuda.cuh, and then used by all of it; else null.
inline bool (*in_device_memory)(void const* p) = nullptr;

}  // namespace detail

/// Presents an allocator (of the standard's or of Thrust's form: `allocate(n)`, `deallocate(p, n)`, raw or fancy
/// pointers) as the memory resource that an execution space takes. The allocator must return memory aligned to 256
/// bytes or to what it serves (cudaMalloc and Thrust's device allocators do).
template <class Allocator>
class allocator_resource final : public std::pmr::memory_resource {
  using bytes = typename std::allocator_traits<Allocator>::template rebind_alloc<unsigned char>;
  using pointer = typename std::allocator_traits<bytes>::pointer;

 public:
  /// A resource that takes memory from a copy of `allocator`.
  explicit allocator_resource(Allocator const& allocator = Allocator()) : allocator_(allocator) {}

 private:
  void* do_allocate(std::size_t n, std::size_t) override { return raw(allocator_.allocate(n)); }
  void do_deallocate(void* p, std::size_t n, std::size_t) override {
    allocator_.deallocate(pointer(static_cast<unsigned char*>(p)), n);
  }
  bool do_is_equal(std::pmr::memory_resource const& other) const noexcept override { return this == &other; }

  template <class P>
  static void* raw(P const& p) {
    if constexpr (std::is_pointer<P>::value) {
      return p;
    } else {
      return p.get();
    }
  }

  bytes allocator_;
};

/// An array of plain `T` in memory of a resource: grows, never shrinks, does not initialise, move-only.
/// The resource must outlive the buffer.
template <class T>
class buffer {
  static_assert(std::is_trivially_destructible<T>::value, "collide: a buffer holds plain values");

 public:
  /// An array without memory.
  buffer() = default;
  /// Takes the memory of `other`, which then has none.
  buffer(buffer&& other) noexcept
      : resource_{std::exchange(other.resource_, nullptr)},
        data_{std::exchange(other.data_, nullptr)},
        capacity_{std::exchange(other.capacity_, 0)} {}
  /// Swaps the memory of the two.
  buffer& operator=(buffer&& other) noexcept {
    std::swap(resource_, other.resource_);
    std::swap(data_, other.data_);
    std::swap(capacity_, other.capacity_);
    return *this;
  }
  /// Returns the memory to its resource.
  ~buffer() { release(); }

  /// Makes room for `n` values and returns their address. Allocates only if it must grow, and loses the old values
  /// then.
  T* reserve(std::pmr::memory_resource* resource, std::size_t n) {
    if (n > capacity_ || (resource_ != nullptr && resource_ != resource)) {
      release();
      data_ = static_cast<T*>(resource->allocate(n * sizeof(T), alignment));
      resource_ = resource;
      capacity_ = n;
    }
    return data_;
  }

  /// Returns the memory to its resource.
  COLLIDE_COLD void release() noexcept {
    if (data_ != nullptr) resource_->deallocate(data_, capacity_ * sizeof(T), alignment);
    data_ = nullptr;
    capacity_ = 0;
    resource_ = nullptr;
  }

  /// The address of the array; null if it has no memory.
  T* data() const { return data_; }
  /// For how many values there is room.
  std::size_t capacity() const { return capacity_; }
  /// Memory taken from the resource.
  std::size_t bytes() const { return capacity_ * sizeof(T); }

 private:
  static constexpr std::size_t alignment = 256;

  std::pmr::memory_resource* resource_ = nullptr;
  T* data_ = nullptr;
  std::size_t capacity_ = 0;
};

namespace detail {

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

/// Memory that some arrays have in one phase of a step, and others in the next: as much as the largest phase takes.
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

}  // namespace detail

}  // namespace collide
