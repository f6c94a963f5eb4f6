/// \file
/// A block of CUDA threads that share memory; what a block is stands in block.hpp. Needs nvcc.
#pragma once

#if !defined(__CUDACC__)
#error "collide/spaces/detail/cuda_block.cuh needs nvcc; without CUDA include the headers of the host space alone"
#endif

#include <cstddef>
#include <cstdint>

#include <cub/block/block_reduce.cuh>
#include <cub/block/block_scan.cuh>

namespace collide::detail {

inline constexpr int threads_per_block = 256;  ///< threads of a block, in every kernel
inline constexpr int cuda_warp = 32;           ///< threads that run together

template <int Items>
class cuda_block {
 public:
  static constexpr int num_threads = threads_per_block, items = Items;
  static constexpr int hit_capacity = 2 * threads_per_block, warp_size = cuda_warp;

  template <class T>
  struct thread_private {
    T value;
    __device__ __forceinline__ T& operator[](int) { return value; }
  };
  template <class T, int N>
  struct staging {
    T values[N];
  };
  template <class T, int N>
  struct warp_exchange_storage {
    T values[num_threads * N];
  };
  using block_scan = cub::BlockScan<std::uint32_t, num_threads, cub::BLOCK_SCAN_WARP_SCANS>;  // waits least
  using scan_storage = typename block_scan::TempStorage;
  using balance_storage = scan_storage;
  template <class T>
  using reduce_storage = typename cub::BlockReduce<T, num_threads>::TempStorage;

  __device__ explicit cuda_block(std::size_t index) : index_{index} {}

  __device__ __forceinline__ std::size_t index() const { return index_; }

  template <class F>
  __device__ __forceinline__ void for_each_thread(F const& f) {
    f(thread_rank());
    sync();
  }

  template <class T>
  __device__ __forceinline__ T broadcast(T const& value) {
    T const copy = value;
    sync();
    return copy;
  }

  __device__ __forceinline__ std::uint32_t add(std::uint32_t& counter, std::uint32_t n) {
    return atomicAdd(&counter, n);
  }

  template <class T, int N>
  __device__ __forceinline__ T const* stage(staging<T, N>& to, T const* from, int n) {
    for (int i = thread_rank(); i < n; i += num_threads) to.values[i] = from[i];
    sync();
    return to.values;
  }

  /// Reads a row of each thread of a warp: adjacent threads read adjacent values.
  template <class T, int N>
  __device__ __forceinline__ void load_striped(T const* from, std::uint32_t row, T (&side)[N]) {
    from += striped_offset<N>(row);
    for (int k = 0; k < N; ++k) side[k] = from[k * cuda_warp];
  }

  /// Exchanges what a warp has read with `load_striped`, so that each thread has its own row.
  template <class Scratch, class T, int N>
  __device__ __forceinline__ void striped_to_blocked(Scratch& s, T (&values)[N]) {
    if constexpr (N > 1) {
      T* const line = warp_slice<N>(s.values);
      std::uint32_t const lane = threadIdx.x % cuda_warp;
      for (std::uint32_t k = 0; k < N; ++k) line[k * cuda_warp + lane] = values[k];
      __syncwarp();
      for (std::uint32_t k = 0; k < N; ++k) values[k] = line[lane * N + k];
      __syncwarp();
    }
  }

  template <class Scratch, class T, int N>
  __device__ __forceinline__ void store_transposed(Scratch& s, T* to, std::uint32_t row, T const (&from)[N]) {
    if constexpr (N == 1) {
      to[row] = from[0];
    } else {
      T* const line = warp_slice<N>(s.values);
      std::uint32_t const lane = threadIdx.x % cuda_warp;
      for (int k = 0; k < N; ++k) line[lane * N + k] = from[k];
      __syncwarp();
      to += striped_offset<N>(row);
      for (int k = 0; k < N; ++k) to[k * cuda_warp] = line[lane + k * cuda_warp];
      __syncwarp();
    }
  }

  /// Exclusive scan of at most as many values in shared memory as there are threads; returns their sum.
  __device__ std::uint32_t scan(scan_storage& s, std::uint32_t* values, std::uint32_t n) {
    auto const i = static_cast<std::uint32_t>(thread_rank());
    std::uint32_t value = i < n ? values[i] : 0, sum;
    block_scan(s).ExclusiveSum(value, value, sum);
    if (i < n) values[i] = value;
    sync();
    return sum;
  }

  /// All work items are numbered: those of counts[0], then those of counts[1], and so on: each count is a segment. A
  /// warp takes a tile of consecutive work items at a time. It finds the segment of the first by a search; the segments
  /// of the others follow from a word with a bit for each item that is the first of a segment. A thread loads and
  /// filters all its items without a branch between them, so that their memory accesses overlap; behind the end, the
  /// last item again.
  template <int ItemsPerThread, class Item, class Load, class Filter, class Consume, class EndRound>
  __device__ __forceinline__ void for_each_balanced(scan_storage& s, std::uint32_t* counts, std::uint32_t n,
                                                    Item const& item, Load const& load, Filter const& filter,
                                                    Consume const& consume, EndRound const& end_round) {
    constexpr std::uint32_t warp_tile = ItemsPerThread * cuda_warp;
    std::uint32_t const total = scan(s, counts, n);  // `counts` are begins now
    auto const lane = static_cast<std::uint32_t>(threadIdx.x) % cuda_warp;
    for (std::uint32_t base = 0; base < total; base += ItemsPerThread * num_threads) {
      std::uint32_t const first = base + static_cast<std::uint32_t>(thread_rank()) / cuda_warp * warp_tile;
      if (first < total) {
        std::uint32_t segment = warp_upper_bound(counts, n, first), i[ItemsPerThread], k[ItemsPerThread];
        for (std::uint32_t a = 0; a < ItemsPerThread; ++a) {
          std::uint32_t const work_item = first + a * cuda_warp, next = segment + 1 + lane;
          std::uint32_t const head_offset = next < n ? counts[next] - work_item : cuda_warp;
          unsigned const segment_heads = warp_or(head_offset < cuda_warp ? 1u << head_offset : 0u);
          i[a] = segment + static_cast<std::uint32_t>(__popc(segment_heads & ((2u << lane) - 1)));
          k[a] = (work_item + lane < total ? work_item + lane : total - 1) - counts[i[a]];
          segment += static_cast<std::uint32_t>(__popc(segment_heads));
        }
        decltype(load(item(0), 0)) found[ItemsPerThread];
        bool taken[ItemsPerThread];
        for (int a = 0; a < ItemsPerThread; ++a) found[a] = load(item(i[a]), k[a]);
        for (int a = 0; a < ItemsPerThread; ++a) taken[a] = filter(item(i[a]), found[a]);
        for (std::uint32_t a = 0; a < ItemsPerThread; ++a) {
          if (taken[a] && first + a * cuda_warp + lane < total) consume(item(i[a]), found[a]);
        }
      }
      sync();
      end_round(base + ItemsPerThread * num_threads >= total);
    }
  }

  /// The combination of all threads' values; valid in thread 0.
  template <class T, class Combine>
  __device__ __forceinline__ T reduce(reduce_storage<T>& s, thread_private<T>& values, Combine const& combine) {
    T const result = cub::BlockReduce<T, num_threads>(s).Reduce(values.value, combine);
    sync();
    return result;
  }

 private:
  /// The last of `n` rising numbers that is not above `x`, as the first is not; asked by a whole warp.
  static __device__ __forceinline__ std::uint32_t warp_upper_bound(std::uint32_t const* begins, std::uint32_t n,
                                                                   std::uint32_t x) {
    static_assert(num_threads <= cuda_warp * cuda_warp);
    constexpr std::uint32_t apart = num_threads / cuda_warp;
    std::uint32_t const lane = threadIdx.x % cuda_warp;
    auto const not_above = [&](std::uint32_t i) { return __ballot_sync(~0u, i < n && begins[i] <= x); };
    std::uint32_t const i = static_cast<std::uint32_t>(__popc(not_above(lane * apart)) - 1) * apart;
    return i + static_cast<std::uint32_t>(__popc(not_above(i + lane) & ((1u << apart) - 1))) - 1;
  }

  /// The bits of all lanes of a warp.
  static __device__ __forceinline__ unsigned warp_or(unsigned bits) {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 800
    return __reduce_or_sync(~0u, bits);
#else
    for (int apart = 1; apart < cuda_warp; apart *= 2) bits |= __shfl_xor_sync(~0u, bits, apart);
    return bits;
#endif
  }

  /// The part of shared memory through which a warp exchanges its rows of `N` values.
  template <int N, class T>
  static __device__ __forceinline__ T* warp_slice(T* values) {
    return values + threadIdx.x / cuda_warp * (cuda_warp * N);
  }

  /// The first of a lane's values of its warp's rows, side by side: the others are `cuda_warp` apart.
  template <int N>
  static __device__ __forceinline__ std::uint32_t striped_offset(std::uint32_t row) {
    std::uint32_t const lane = threadIdx.x % cuda_warp;
    return (row - lane) * N + lane;
  }

  static __device__ __forceinline__ int thread_rank() { return static_cast<int>(threadIdx.x); }

  /// Waits for all threads. A warp comes together first: ptxas 13.0 keeps loop counters in registers of the warp, but
  /// lets its threads reach the barrier one after another where what was before it has called a function.
  __device__ __forceinline__ void sync() {
    __syncwarp();
    __syncthreads();
  }

  std::size_t index_;
};

}  // namespace collide::detail
