/// \file
/// The interface that kernel functors are written against: a block of threads that work together.
///
/// A kernel is a function object `kernel(block, scratch)`. It runs once per block, on any execution space:
///   - `block.for_each_thread(f)` calls f(thread) for every thread, then waits for all of them;
///   - `Block::thread_private<T>` is a value per thread (a register on CUDA);
///   - `block.broadcast(x)` reads a value of the scratch memory, alike for all threads, that later code may overwrite;
///   - `block.add(counter, n)` is an atomic add on scratch memory that returns the value before;
///   - `block.stage(s, from, n)` gives fast access to n values: a copy in shared memory, or just `from`;
///   - `block.load_striped(from, row, to)`, `striped_to_blocked(s, to)`, `store_transposed(s, to, row, from)`: for rows
///     of a few values, one row for each thread, that follow each other: `warp_size` threads call them at a time and
///     read and write what lies side by side together, so all of these rows must exist; what a thread has read is its
///     own row after the exchange, and not before;
///   - `block.for_each_balanced<ItemsPerThread>(...)` spreads work evenly over the threads. For all k < counts[i],
///     where counts are at least 1: x = load(item(i), k), and if filter(item(i), x), then consume(item(i), x). `load`
///     and `filter` only read, and a thread calls them for up to `ItemsPerThread` work items before it consumes, so
///     that the loads overlap if they do not branch. After each round the whole block calls `end_round(is_last)`;
///   - `block.scan(...)` makes of at most as many values as threads the sums of those before each;
///   - `block.reduce(...)` combines a value per thread.
/// `scratch` is the kernel's scratch memory of the block (shared memory on CUDA); it is not initialised.
/// Here is the block of plain C++: `serial_block`, a single thread that does everything itself (the host's block, and a
/// CUDA thread without shared memory). That of CUDA threads that work together is in cuda_block.cuh.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/core/config.hpp>

namespace collide::detail {

/// Number of blocks that cover `n` items of a kernel functor on the space.
template <class Space, class Kernel>
std::size_t grid_size(std::size_t n, Kernel const&) {
  using block = typename Space::template block<Kernel>;
  constexpr std::size_t per_block = static_cast<std::size_t>(block::num_threads) * block::items;
  return (n + per_block - 1) / per_block;
}

/// A block of one thread with `Items` items; `HitCapacity` hits are gathered before they go to the sink.
template <int Items, int HitCapacity>
class serial_block {
 public:
  static constexpr int num_threads = 1, items = Items, hit_capacity = HitCapacity, warp_size = 1;

  template <class T>
  struct thread_private {
    T value;
    COLLIDE_HD_INLINE T& operator[](int) { return value; }
  };
  template <class T, unsigned N>
  struct staging {};
  template <class T, unsigned N>
  struct warp_exchange_storage {};
  struct scan_storage {};
  struct balance_storage {};
  template <class T>
  struct reduce_storage {};

  COLLIDE_HD explicit serial_block(std::size_t index) : index_{index} {}

  COLLIDE_HD_INLINE std::size_t index() const { return index_; }

  template <class F>
  COLLIDE_HD_INLINE void for_each_thread(F const& f) {
    f(0);
  }

  template <class T>
  COLLIDE_HD_INLINE T broadcast(T const& value) {
    return value;
  }

  COLLIDE_HD_INLINE std::uint32_t add(std::uint32_t& counter, std::uint32_t n) {
    std::uint32_t const before = counter;
    counter += n;
    return before;
  }

  template <class T, unsigned N>
  COLLIDE_HD_INLINE T const* stage(staging<T, N>&, T const* from, int) {
    return from;
  }

  template <class T, unsigned N>
  COLLIDE_HD_INLINE void load_striped(T const* from, std::uint32_t row, T (&to)[N]) {
    COLLIDE_UNROLL
    for (unsigned k = 0; k < N; ++k) to[k] = from[std::size_t{row} * N + static_cast<std::size_t>(k)];
  }

  template <class Scratch, class T, unsigned N>
  COLLIDE_HD_INLINE void striped_to_blocked(Scratch&, T (&)[N]) {}

  template <class Scratch, class T, unsigned N>
  COLLIDE_HD_INLINE void store_transposed(Scratch&, T* to, std::uint32_t row, T const (&from)[N]) {
    COLLIDE_UNROLL
    for (unsigned k = 0; k < N; ++k) to[std::size_t{row} * N + static_cast<std::size_t>(k)] = from[k];
  }

  COLLIDE_HD_INLINE std::uint32_t scan(scan_storage&, std::uint32_t* values, std::uint32_t) {
    std::uint32_t const sum = values[0];
    values[0] = 0;
    return sum;
  }

  template <int ItemsPerThread, class Item, class Load, class Filter, class Consume, class EndRound>
  COLLIDE_HD_INLINE void for_each_balanced(balance_storage&, std::uint32_t const* counts, std::uint32_t n,
                                           Item const& item, Load const& load, Filter const& filter,
                                           Consume const& consume, EndRound const& end_round) {
    for (std::uint32_t i = 0; i < n; ++i) {
      auto const one = item(i);
      for (std::uint32_t k = 0; k < counts[i]; ++k) {
        auto const found = load(one, k);
        if (filter(one, found)) consume(one, found);
      }
      end_round(i + 1 == n);
    }
  }

  template <class T, class Combine>
  COLLIDE_HD_INLINE T reduce(reduce_storage<T>&, thread_private<T>& values, Combine const&) {
    return values.value;
  }

 private:
  std::size_t index_;
};

}  // namespace collide::detail
