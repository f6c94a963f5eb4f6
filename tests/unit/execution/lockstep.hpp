/// \file
/// An execution space for tests: the cooperative algorithms of a CUDA block, on the host.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <type_traits>

#include <collide/host.hpp>

namespace tests {

/// The cooperative algorithm behind `balanced`: scans the counts in scratch memory, then spreads all (i, k) with
/// k < counts[i] evenly over the lanes, each of which finds its i by binary search.
template <class Block>
struct balancing {
  typename Block::scan_storage scan;

  template <class Item, class Load, class Filter, class Consume, class EndRound>
  void run(Block& block, std::uint32_t* counts, std::uint32_t n, Item const& item, Load const& load,
           Filter const& filter, Consume const& consume, EndRound const& end_round) {
    std::uint32_t const total = block.scan(scan, counts, n);
    for (std::uint32_t base = 0; base < total; base += Block::num_threads) {
      block.for_each_thread([&](int thread_rank) {
        std::uint32_t const work = base + static_cast<std::uint32_t>(thread_rank);
        if (work >= total) return;
        std::uint32_t i = 0, end = n;  // the last i whose work begins at or before this
        while (end - i > 1) {
          std::uint32_t const middle = (i + end) / 2;
          if (counts[middle] <= work) {
            i = middle;
          } else {
            end = middle;
          }
        }
        auto const one = item(i);
        auto const found = load(one, work - counts[i]);
        if (filter(one, found)) consume(one, found);
      });
      end_round(base + Block::num_threads >= total);
    }
  }
};

/// A block of `Lanes` lanes that take turns, in order or in reverse: finds mistakes in the order of steps that a GPU
/// would only show now and then.
template <int Lanes, int Items, bool Reversed>
class lockstep_block {
 public:
  static constexpr int num_threads = Lanes, items = Items, hit_capacity = 2 * Lanes, warp_size = 1;

  template <class T>
  struct thread_private {
    T value[Lanes];
    T& operator[](int thread_rank) { return value[thread_rank]; }
  };
  template <class T, int N>
  struct staging {
    T values[N];
  };
  template <class T, int N>
  struct warp_exchange_storage {};
  struct scan_storage {};
  using balance_storage = balancing<lockstep_block>;
  template <class T>
  struct reduce_storage {};

  explicit lockstep_block(std::size_t index) : index_{index} {}

  std::size_t index() const { return index_; }

  template <class F>
  void for_each_thread(F const& f) {
    for (int i = 0; i < Lanes; ++i) f(Reversed ? Lanes - 1 - i : i);
  }

  template <class T>
  T broadcast(T const& value) {
    return value;
  }

  std::uint32_t add(std::uint32_t& counter, std::uint32_t n) {
    std::uint32_t const before = counter;
    counter += n;
    return before;
  }

  template <class T, int N>
  T const* stage(staging<T, N>& to, T const* from, int n) {
    for (int i = 0; i < n; ++i) to.values[i] = from[i];
    return to.values;
  }

  template <class T, int N>
  void load_striped(T const* from, std::uint32_t row, T (&to)[N]) {
    for (int k = 0; k < N; ++k) to[k] = from[std::size_t{row} * N + static_cast<std::size_t>(k)];
  }

  template <class Scratch, class T, int N>
  void striped_to_blocked(Scratch&, T (&)[N]) {}

  template <class Scratch, class T, int N>
  void store_transposed(Scratch&, T* to, std::uint32_t row, T const (&from)[N]) {
    for (int k = 0; k < N; ++k) to[std::size_t{row} * N + static_cast<std::size_t>(k)] = from[k];
  }

  std::uint32_t scan(scan_storage&, std::uint32_t* values, std::uint32_t n) {
    std::uint32_t sum = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      std::uint32_t const value = values[i];
      values[i] = sum;
      sum += value;
    }
    return sum;
  }

  template <int ItemsPerThread, class Item, class Load, class Filter, class Consume, class EndRound>
  void for_each_balanced(balance_storage& s, std::uint32_t* counts, std::uint32_t n, Item const& item, Load const& load,
                         Filter const& filter, Consume const& consume, EndRound const& end_round) {
    s.run(*this, counts, n, item, load, filter, consume, end_round);
  }

  template <class T, class Combine>
  T reduce(reduce_storage<T>&, thread_private<T>& values, Combine const& combine) {
    T result = values[0];
    for (int thread_rank = 1; thread_rank < Lanes; ++thread_rank) result = combine(result, values[thread_rank]);
    return result;
  }

 private:
  std::size_t index_;
};

/// The cooperative kernels of `cuda_shared` on the host: the lanes take turns, in order or in reverse, and the scratch
/// memory is full of garbage when a block begins.
template <int Lanes, bool Reversed>
class lockstep : public collide::host {
 public:
  using host::host;
  static constexpr char const* name() { return Reversed ? "lockstep_reversed" : "lockstep"; }

  template <class Kernel>
  using block = lockstep_block<Lanes, Kernel::items, Reversed>;

  template <class Kernel>
  std::size_t max_resident_blocks() const {
    return Reversed ? 1 : 3;
  }

  template <class Kernel>
  void launch(std::size_t blocks, Kernel const& kernel) const {
    using scratch_type = typename Kernel::template scratch<block<Kernel>>;
    static_assert(std::is_trivially_copyable<scratch_type>::value, "scratch memory is never constructed on CUDA");
    auto const memory = std::make_unique<storage<scratch_type>>();
    for (std::size_t i = 0; i < blocks; ++i) {
      std::memset(memory->bytes, Reversed ? 0x7f : 0xff, sizeof(scratch_type));
      block<Kernel> here(i);
      kernel(here, *reinterpret_cast<scratch_type*>(memory->bytes));
    }
  }

 private:
  template <class T>
  struct storage {
    alignas(T) unsigned char bytes[sizeof(T)];
  };
};

}  // namespace tests

namespace collide {

template <int Lanes, bool Reversed>
struct bucket_tuning<tests::lockstep<Lanes, Reversed>> : device_bucket_tuning {};
template <int Lanes, bool Reversed>
struct bvh_tuning<tests::lockstep<Lanes, Reversed>> {
  static constexpr bool divides_by_area = false;
  static constexpr std::size_t min_sorted_points = 1;
};
template <int Lanes, bool Reversed>
struct query_tuning<tests::lockstep<Lanes, Reversed>> {
  static constexpr bool defers_exact_tests = true;
};

}  // namespace collide
