/// \file
/// The execution spaces of an NVIDIA GPU: `cuda`, a thread per work item, and `cuda_shared`, blocks of threads that
/// work together through shared memory. Needs nvcc.
#pragma once

#if !defined(__CUDACC__)
#error "collide/cuda.cuh needs nvcc; without CUDA include the headers of the host space alone"
#endif

#include <limits>
#include <new>
#include <string>

#include <cub/block/block_reduce.cuh>
#include <cub/block/block_scan.cuh>
#include <cub/device/device_merge_sort.cuh>
#include <cub/device/device_radix_sort.cuh>
#include <cuda_runtime.h>

#include <collide/contact.hpp>
#include <collide/detail/block.hpp>
#include <collide/detail/costs.hpp>
#include <collide/error.hpp>
#include <collide/memory.hpp>

namespace collide {

/// A CUDA call that failed. `what()` names the call, the file and the line; `code()` is CUDA's error.
class cuda_error : public error {
 public:
  cuda_error(cudaError_t code, char const* call, char const* file, int line)
      : error(std::string("collide: ") + call + " failed: " + cudaGetErrorName(code) + " (" + cudaGetErrorString(code) +
              ") at " + file + ":" + std::to_string(line)),
        code_{code} {}

  cudaError_t code() const { return code_; }

 private:
  cudaError_t code_;
};

/// Throws `cuda_error` unless `code` is cudaSuccess. `call` is the text of the call.
inline void cuda_check(cudaError_t code, char const* call, char const* file = __builtin_FILE(),
                       int line = __builtin_LINE()) {
  if (code == cudaSuccess) return;
  cudaGetLastError();  // a failed call must not be reported again by the next one
  throw cuda_error(code, call, file, line);
}

/// Number of CUDA devices that can be used; 0 also where there is no driver.
inline int cuda_device_count() {
  int n = 0;
  if (cudaGetDeviceCount(&n) != cudaSuccess) {
    cudaGetLastError();
    return 0;
  }
  return n;
}

/// Device memory by cudaMalloc and cudaFree, which wait for the device: the default of the CUDA spaces, which allocate
/// only when something grows.
class cuda_memory final : public std::pmr::memory_resource {
 public:
  /// The one instance.
  static cuda_memory* get() {
    static cuda_memory instance;
    return &instance;
  }

 private:
  void* do_allocate(std::size_t n, std::size_t) override {
    void* p = nullptr;
    cuda_check(cudaMalloc(&p, n), "cudaMalloc");
    return p;
  }
  void do_deallocate(void* p, std::size_t, std::size_t) override {
    if (cudaFree(p) != cudaSuccess) cudaGetLastError();
  }
  bool do_is_equal(std::pmr::memory_resource const& other) const noexcept override { return this == &other; }
};

/// Device memory by cudaMallocAsync and cudaFreeAsync, in the order of a stream; never waits.
class cuda_async_memory final : public std::pmr::memory_resource {
 public:
  explicit cuda_async_memory(cudaStream_t stream) : stream_{stream} {}

 private:
  void* do_allocate(std::size_t n, std::size_t) override {
    void* p = nullptr;
    cuda_check(cudaMallocAsync(&p, n, stream_), "cudaMallocAsync");
    return p;
  }
  void do_deallocate(void* p, std::size_t, std::size_t) override {
    if (cudaFreeAsync(p, stream_) != cudaSuccess) cudaGetLastError();
  }
  bool do_is_equal(std::pmr::memory_resource const& other) const noexcept override { return this == &other; }

  cudaStream_t stream_;
};

/// Pinned host memory by cudaMallocHost and cudaFreeHost: what `streamed` copies from it takes the full bandwidth, and
/// nothing waits meanwhile. Slow to allocate; no other program can have it.
class cuda_pinned_memory final : public std::pmr::memory_resource {
 public:
  /// The one instance.
  static cuda_pinned_memory* get() {
    static cuda_pinned_memory instance;
    return &instance;
  }

 private:
  void* do_allocate(std::size_t n, std::size_t) override {
    void* p = nullptr;
    cuda_check(cudaMallocHost(&p, n), "cudaMallocHost");
    return p;
  }
  void do_deallocate(void* p, std::size_t, std::size_t) override {
    if (cudaFreeHost(p) != cudaSuccess) cudaGetLastError();
  }
  bool do_is_equal(std::pmr::memory_resource const& other) const noexcept override { return this == &other; }
};

namespace detail {

/// Tells the host which memory it cannot read, in all of a program of which nvcc has compiled some part.
inline bool const host_is_told = [] {
  in_device_memory = [](void const* p) {
    cudaPointerAttributes memory{};
    if (cudaPointerGetAttributes(&memory, p) == cudaSuccess) return memory.type == cudaMemoryTypeDevice;
    cudaGetLastError();  // there is no device, and so no memory of one
    return false;
  };
  return true;
}();

inline constexpr int cuda_lanes = 256;  ///< threads of a block, in every kernel
inline constexpr int cuda_warp = 32;    ///< threads that run together

/// A block of CUDA threads that share memory.
template <int Items>
class cuda_block {
 public:
  static constexpr int lanes = cuda_lanes, items = Items;
  static constexpr int pending = 2 * cuda_lanes, row_lanes = cuda_warp;

  template <class T>
  struct per_lane {
    T value;
    __device__ __forceinline__ T& operator[](int) { return value; }
  };
  template <class T, int N>
  struct staging {
    T values[N];
  };
  template <class T>
  struct single {
    T value;
  };
  template <class T, int N>
  struct row_scratch {
    T values[lanes * N];
  };
  using block_scan = cub::BlockScan<std::uint32_t, lanes, cub::BLOCK_SCAN_WARP_SCANS>;  // waits least
  using scan_scratch = typename block_scan::TempStorage;
  using balance_scratch = scan_scratch;
  template <class T>
  using reduce_scratch = typename cub::BlockReduce<T, lanes>::TempStorage;

  __device__ explicit cuda_block(std::size_t index) : index_{index} {}

  __device__ __forceinline__ std::size_t index() const { return index_; }

  template <class F>
  __device__ __forceinline__ void each(F const& f) {
    f(lane());
    sync();
  }

  template <class T>
  __device__ __forceinline__ T shared(T const& value) {
    T const copy = value;
    sync();
    return copy;
  }

  __device__ __forceinline__ std::uint32_t add(std::uint32_t& counter, std::uint32_t n) {
    return atomicAdd(&counter, n);
  }

  template <class T, int N>
  __device__ __forceinline__ T const* stage(staging<T, N>& to, T const* from, int n) {
    for (int i = lane(); i < n; i += lanes) to.values[i] = from[i];
    sync();
    return to.values;
  }

  /// Each lane copies some pieces, all of which it reads before it writes one.
  template <class T>
  __device__ __forceinline__ T const& near(single<T>& to, T const& from) {
    static_assert(alignof(T) % sizeof(uint4) == 0);
    constexpr int pieces = sizeof(T) / sizeof(uint4), of_lane = (pieces + lanes - 1) / lanes;
    uint4 read[of_lane];
    for (int k = 0; k < of_lane; ++k) {
      int const i = k * lanes + lane();
      if (i < pieces) read[k] = reinterpret_cast<uint4 const*>(&from)[i];
    }
    for (int k = 0; k < of_lane; ++k) {
      int const i = k * lanes + lane();
      if (i < pieces) reinterpret_cast<uint4*>(&to.value)[i] = read[k];
    }
    sync();
    return to.value;
  }

  /// A warp reads what lies side by side,
  template <class T, int N>
  __device__ __forceinline__ void load_row(T const* from, std::uint32_t row, T (&side)[N]) {
    from += first_beside<N>(row);
    for (int k = 0; k < N; ++k) side[k] = from[k * cuda_warp];
  }

  /// and its lanes exchange it.
  template <class Scratch, class T, int N>
  __device__ __forceinline__ void exchange_row(Scratch& s, T (&values)[N]) {
    if constexpr (N > 1) {
      T* const line = line_of_warp<N>(s.values);
      std::uint32_t const own = threadIdx.x % cuda_warp;
      for (std::uint32_t k = 0; k < N; ++k) line[k * cuda_warp + own] = values[k];
      __syncwarp();
      for (std::uint32_t k = 0; k < N; ++k) values[k] = line[own * N + k];
      __syncwarp();
    }
  }

  template <class Scratch, class T, int N>
  __device__ __forceinline__ void store_row(Scratch& s, T* to, std::uint32_t row, T const (&from)[N]) {
    if constexpr (N == 1) {
      to[row] = from[0];
    } else {
      T* const line = line_of_warp<N>(s.values);
      std::uint32_t const own = threadIdx.x % cuda_warp;
      for (int k = 0; k < N; ++k) line[own * N + k] = from[k];
      __syncwarp();
      to += first_beside<N>(row);
      for (int k = 0; k < N; ++k) to[k * cuda_warp] = line[own + k * cuda_warp];
      __syncwarp();
    }
  }

  /// Exclusive scan of at most as many values in shared memory as there are lanes; returns their sum.
  __device__ std::uint32_t scan(scan_scratch& s, std::uint32_t* values, std::uint32_t n) {
    auto const i = static_cast<std::uint32_t>(lane());
    std::uint32_t own = i < n ? values[i] : 0, sum;
    block_scan(s).ExclusiveSum(own, own, sum);
    if (i < n) values[i] = own;
    sync();
    return sum;
  }

  /// Each warp takes a stretch of the work at a time. Whose work its first piece is, it searches for; from there on, a
  /// word of bits tells all its lanes which of the next pieces are the first ones of others. A lane finds and looks at
  /// all its pieces without a branch between them, so that what it reads for them comes together; where there is no
  /// more work, at the last piece again.
  template <int Ahead, class Item, class Find, class Look, class Take, class Round>
  __device__ __forceinline__ void balanced(scan_scratch& s, std::uint32_t* counts, std::uint32_t n, Item const& item,
                                           Find const& find, Look const& look, Take const& take,
                                           Round const& after_round) {
    constexpr std::uint32_t stretch = Ahead * cuda_warp;
    std::uint32_t const total = scan(s, counts, n);  // `counts` are begins now
    auto const own = static_cast<std::uint32_t>(threadIdx.x) % cuda_warp;
    for (std::uint32_t base = 0; base < total; base += Ahead * lanes) {
      std::uint32_t const first = base + static_cast<std::uint32_t>(lane()) / cuda_warp * stretch;
      if (first < total) {
        std::uint32_t before = last_begun(counts, n, first), i[Ahead], k[Ahead];
        for (std::uint32_t a = 0; a < Ahead; ++a) {
          std::uint32_t const piece = first + a * cuda_warp, next = before + 1 + own;
          std::uint32_t const to_begin = next < n ? counts[next] - piece : cuda_warp;
          unsigned const begun = all_bits(to_begin < cuda_warp ? 1u << to_begin : 0u);
          i[a] = before + static_cast<std::uint32_t>(__popc(begun & ((2u << own) - 1)));
          k[a] = (piece + own < total ? piece + own : total - 1) - counts[i[a]];
          before += static_cast<std::uint32_t>(__popc(begun));
        }
        decltype(find(item(0), 0)) found[Ahead];
        bool taken[Ahead];
        for (int a = 0; a < Ahead; ++a) found[a] = find(item(i[a]), k[a]);
        for (int a = 0; a < Ahead; ++a) taken[a] = look(item(i[a]), found[a]);
        for (std::uint32_t a = 0; a < Ahead; ++a) {
          if (taken[a] && first + a * cuda_warp + own < total) take(item(i[a]), found[a]);
        }
      }
      sync();
      after_round();
    }
  }

  /// The combination of all lanes' values; valid in lane 0.
  template <class T, class Combine>
  __device__ __forceinline__ T reduce(reduce_scratch<T>& s, per_lane<T>& values, Combine const& combine) {
    T const result = cub::BlockReduce<T, lanes>(s).Reduce(values.value, combine);
    sync();
    return result;
  }

 private:
  /// The last of `n` rising numbers that is not above `x`, as the first is not; asked by a whole warp.
  static __device__ __forceinline__ std::uint32_t last_begun(std::uint32_t const* begins, std::uint32_t n,
                                                             std::uint32_t x) {
    static_assert(lanes <= cuda_warp * cuda_warp);
    constexpr std::uint32_t apart = lanes / cuda_warp;
    std::uint32_t const own = threadIdx.x % cuda_warp;
    auto const not_above = [&](std::uint32_t i) { return __ballot_sync(~0u, i < n && begins[i] <= x); };
    std::uint32_t const i = static_cast<std::uint32_t>(__popc(not_above(own * apart)) - 1) * apart;
    return i + static_cast<std::uint32_t>(__popc(not_above(i + own) & ((1u << apart) - 1))) - 1;
  }

  /// The bits of all lanes of a warp.
  static __device__ __forceinline__ unsigned all_bits(unsigned own) {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 800
    return __reduce_or_sync(~0u, own);
#else
    for (int apart = 1; apart < cuda_warp; apart *= 2) own |= __shfl_xor_sync(~0u, own, apart);
    return own;
#endif
  }

  /// What a warp's rows of `N` values pass through.
  template <int N, class T>
  static __device__ __forceinline__ T* line_of_warp(T* values) {
    return values + threadIdx.x / cuda_warp * (cuda_warp * N);
  }

  /// The first of a lane's values of its warp's rows, side by side: the others are `cuda_warp` apart.
  template <int N>
  static __device__ __forceinline__ std::uint32_t first_beside(std::uint32_t row) {
    std::uint32_t const own = threadIdx.x % cuda_warp;
    return (row - own) * N + own;
  }

  static __device__ __forceinline__ int lane() { return static_cast<int>(threadIdx.x); }

  /// Waits for all lanes. A warp comes together first: ptxas 13.0 keeps loop counters in registers of the warp, but
  /// lets its threads reach the barrier one after another where what was before it has called a function.
  __device__ __forceinline__ void sync() {
    __syncwarp();
    __syncthreads();
  }

  std::size_t index_;
};

/// How many blocks of a body a processor should hold at a time, which limits the registers of a thread: its member
/// `residency<Block>`, or 1.
template <class Body, class Block, class = void>
inline constexpr int residency = 1;
template <class Body, class Block>
inline constexpr int residency<Body, Block, std::enable_if_t<(Body::template residency<Block> > 0)>> =
    Body::template residency<Block>;

/// A kernel begins with these two. It lets the next kernel of the stream start, which then waits for its turn: so a
/// launch takes its time while the kernel before is at work. Where it was compiled for compute capability 9.0 or more,
/// and with `cuda_space::launch_kernel`.
__device__ __forceinline__ void let_next_start() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  cudaTriggerProgrammaticLaunchCompletion();
#endif
}
__device__ __forceinline__ void wait_for_turn() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  cudaGridDependencySynchronize();
#endif
}

/// Runs a body in one thread per block.
template <class Block, class Body>
__global__ void __launch_bounds__(cuda_lanes, (residency<Body, Block>)) run_threads(std::size_t blocks, Body body) {
  let_next_start();
  wait_for_turn();
  std::size_t const i = std::size_t{blockIdx.x} * cuda_lanes + threadIdx.x;
  if (i >= blocks) return;
  typename Body::template scratch<Block> scratch;
  Block here(i);
  body(here, scratch);
}

/// Runs a body in one CUDA block per block.
template <class Block, class Body>
__global__ void __launch_bounds__(cuda_lanes, (residency<Body, Block>)) run_blocks(Body body) {
  let_next_start();
  wait_for_turn();
  __shared__ typename Body::template scratch<Block> scratch;
  Block here(blockIdx.x);
  body(here, scratch);
}

template <class F>
__global__ void __launch_bounds__(cuda_lanes) run_for_each(std::size_t n, F f) {
  wait_for_turn();  // first: blocks of the next kernel would take the room of those that it waits for
  let_next_start();
  std::size_t const i = std::size_t{blockIdx.x} * cuda_lanes + threadIdx.x;
  if (i < n) f(i);
}

/// The same with fewer threads, each of which has several items, and only if something is not 0.
template <class F>
__global__ void __launch_bounds__(cuda_lanes) run_for_each_if(std::uint32_t const* condition, std::size_t n, F f) {
  wait_for_turn();
  let_next_start();
  if (*condition == 0) return;
  std::size_t const stride = std::size_t{gridDim.x} * cuda_lanes;
  for (std::size_t i = std::size_t{blockIdx.x} * cuda_lanes + threadIdx.x; i < n; i += stride) f(i);
}

/// Kernel body of `for_each` over bytes.
struct fill_bytes {
  unsigned char* to;
  unsigned char byte;
  __device__ void operator()(std::size_t i) const { to[i] = byte; }
};

/// The canonical order of pairs that are one number each, with the sphere in its lower half.
struct canonical_before {
  __device__ __forceinline__ bool operator()(std::uint64_t a, std::uint64_t b) const {
    return (a << 32 | a >> 32) < (b << 32 | b >> 32);
  }
};

/// What both CUDA spaces have in common: a stream and memory.
class cuda_space {
 public:
  /// `stream`: where all work is put. `resource`: where device memory comes from; null is `cuda_memory`. Both must
  /// outlive everything that was made with the space. The device that is current now must be current in every later
  /// call. Throws `cuda_error` if there is no usable device.
  explicit cuda_space(cudaStream_t stream = nullptr, std::pmr::memory_resource* resource = nullptr)
      : stream_{stream}, resource_{resource != nullptr ? resource : cuda_memory::get()} {
    int device = 0;
    cuda_check(cudaGetDevice(&device), "cudaGetDevice");
    cuda_check(cudaDeviceGetAttribute(&processors_, cudaDevAttrMultiProcessorCount, device), "cudaDeviceGetAttribute");
    cudaFuncAttributes compiled{};
    cuda_check(cudaFuncGetAttributes(&compiled, run_for_each<fill_bytes>), "cudaFuncGetAttributes");
    takes_turns_ = compiled.ptxVersion >= 90;
  }

  cudaStream_t stream() const { return stream_; }
  std::pmr::memory_resource* resource() const { return resource_; }

  /// Waits until all work on the stream is done.
  void synchronize() const { cuda_check(cudaStreamSynchronize(stream_), "cudaStreamSynchronize"); }

  static constexpr bool host_memory = false;

  /// False if the memory at `p` is known not to be this space's: pageable memory, where the device cannot read that.
  static bool reads(void const* p) {
    cudaPointerAttributes memory{};
    cuda_check(cudaPointerGetAttributes(&memory, p), "cudaPointerGetAttributes");
    if (memory.type != cudaMemoryTypeUnregistered) return true;
    int device = 0, reads_pageable = 0;
    cuda_check(cudaGetDevice(&device), "cudaGetDevice");
    cuda_check(cudaDeviceGetAttribute(&reads_pageable, cudaDevAttrPageableMemoryAccess, device),
               "cudaDeviceGetAttribute");
    return reads_pageable != 0;
  }

  static constexpr bool defers = true;
  static constexpr bool sorts_spheres = false;

  /// Tuning of `bucket`; see `host`.
  static constexpr int insertion_parts = 2;
  static constexpr double bucket_span = 1.75;
  static constexpr bool pairs_triangles = true;

  template <class F>
  void for_each(std::size_t n, F const& f) const {
    if (n == 0) return;
    launch_kernel("launch of run_for_each", run_for_each<F>, grid_of(n), n, f);
  }

  /// `for_each` if *condition, in memory of the space, is not 0 then; meant for what is seldom done.
  template <class F>
  void for_each_if(std::uint32_t const* condition, std::size_t n, F const& f) const {
    if (n == 0) return;
    unsigned const wave = static_cast<unsigned>(processors_) * (2048 / cuda_lanes), blocks = grid_of(n);
    launch_kernel("launch of run_for_each_if", run_for_each_if<F>, blocks < wave ? blocks : wave, condition, n, f);
  }

  /// A little is filled by a kernel: in a graph, between kernels, that takes half as long as a memory set.
  void fill(void* to, unsigned char byte, std::size_t bytes) const {
    constexpr std::size_t little = 16384;
    if (bytes <= little) {
      for_each(bytes, fill_bytes{static_cast<unsigned char*>(to), byte});
    } else {
      cuda_check(cudaMemsetAsync(to, byte, bytes, stream_), "cudaMemsetAsync");
    }
  }

  template <class T>
  T read(T const* from) const {
    T value;
    copy_to_host(&value, from, 1);
    return value;
  }

  /// Copies and waits.
  template <class T>
  void copy_to_host(T* to, T const* from, std::size_t n) const {
    if (n == 0) return;
    cuda_check(cudaMemcpyAsync(static_cast<void*>(to), from, n * sizeof(T), cudaMemcpyDeviceToHost, stream_),
               "cudaMemcpyAsync");
    synchronize();
  }

  /// Copies; the source may be changed as soon as the call returns.
  template <class T>
  void copy_from_host(T* to, T const* from, std::size_t n) const {
    if (n == 0) return;
    cuda_check(cudaMemcpyAsync(static_cast<void*>(to), from, n * sizeof(T), cudaMemcpyHostToDevice, stream_),
               "cudaMemcpyAsync");
    synchronize();
  }

  /// Sorts pairs into canonical order: not very many by merging; more by radix, by triangle, then (stably) by sphere,
  /// only the bits that ids below `spheres` and `triangles` have. Takes temporary memory for `room` pairs, at least
  /// `n`.
  void sort(buffer<pair>& other, pair* pairs, std::size_t n, std::size_t room, std::size_t spheres,
            std::size_t triangles, buffer<unsigned char>& scratch) const {
    static_assert(sizeof(pair) == sizeof(std::uint64_t), "a pair is one 64-bit key");
    if (n < 2) return;
    auto* const keys = reinterpret_cast<std::uint64_t*>(pairs);
    // where there is room for many, the memory for both ways is taken the first time
    bool const many = n > most_merged, first = room > most_merged && other.capacity() < room;
    std::size_t merging = 0, by_radix = 0;
    if (!many || first) {
      std::size_t const most = room < most_merged ? room : most_merged;
      cuda_check(cub::DeviceMergeSort::SortKeys(nullptr, merging, keys, most, canonical_before{}, stream_),
                 "cub::DeviceMergeSort::SortKeys");
    }
    if (many || first) {
      cuda_check(cub::DeviceRadixSort::SortKeys(nullptr, by_radix, keys, keys, room, 0, 64, stream_),
                 "cub::DeviceRadixSort::SortKeys");
    }
    void* const temporary = scratch.reserve(resource_, merging > by_radix ? merging : by_radix);
    auto* const sorted = reinterpret_cast<std::uint64_t*>(first ? other.reserve(resource_, room) : other.data());
    if (!many) {
      cuda_check(cub::DeviceMergeSort::SortKeys(temporary, merging, keys, n, canonical_before{}, stream_),
                 "cub::DeviceMergeSort::SortKeys");
      return;
    }
    cuda_check(
        cub::DeviceRadixSort::SortKeys(temporary, by_radix, keys, sorted, n, 32, 32 + bits_for(triangles), stream_),
        "cub::DeviceRadixSort::SortKeys");
    cuda_check(cub::DeviceRadixSort::SortKeys(temporary, by_radix, sorted, keys, n, 0, bits_for(spheres), stream_),
               "cub::DeviceRadixSort::SortKeys");
  }

  /// Up to so many pairs it is faster to merge (docs/performance.md).
  static constexpr std::size_t most_merged = std::size_t{1} << 18;

 protected:
  /// Launches a kernel that begins with `wait_for_turn`.
  template <class... Parameters>
  void launch_kernel(char const* call, void (*kernel)(Parameters...), unsigned blocks,
                     Parameters const&... arguments) const {
    cudaLaunchAttribute early{};
    early.id = cudaLaunchAttributeProgrammaticStreamSerialization;
    early.val.programmaticStreamSerializationAllowed = 1;
    cudaLaunchConfig_t config{};
    config.gridDim = dim3(blocks);
    config.blockDim = dim3(cuda_lanes);
    config.stream = stream_;
    config.attrs = &early;
    config.numAttrs = takes_turns_ ? 1 : 0;
    cuda_check(cudaLaunchKernelEx(&config, kernel, arguments...), call);
  }

  static unsigned grid_of(std::size_t n) {
    std::size_t const blocks = (n + cuda_lanes - 1) / cuda_lanes;
    if (blocks > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw error("collide: too much work for one CUDA launch");
    }
    return static_cast<unsigned>(blocks);
  }

  /// Bits that ids below `n` take; at least one.
  static int bits_for(std::size_t n) {
    int b = 1;
    while (b < 32 && (std::size_t{1} << b) < n) ++b;
    return b;
  }

  cudaStream_t stream_;
  std::pmr::memory_resource* resource_;
  int processors_ = 1;
  bool takes_turns_ = false;  ///< see `wait_for_turn`
};

}  // namespace detail

/// Execution space: an NVIDIA GPU, each thread on its own. Views point to device memory; work is put on a stream.
class cuda : public detail::cuda_space {
 public:
  using cuda_space::cuda_space;
  static constexpr char const* name() { return "cuda"; }
  static constexpr detail::broad_phase_costs costs{0, 30, 0.08, 0.2, 30000};  ///< tuning of `automatic`

  template <class Body>
  using block = detail::serial_block<Body::items, 0>;

  template <class Body>
  void launch(std::size_t blocks, Body const& body) const {
    if (blocks == 0) return;
    launch_kernel("launch of run_threads", detail::run_threads<block<Body>, Body>, grid_of(blocks), blocks, body);
  }

  std::size_t concurrency() const { return static_cast<std::size_t>(processors_) * 2048; }

  template <class Body>
  std::size_t wave() const {
    return std::numeric_limits<std::size_t>::max();
  }
};

/// Execution space: an NVIDIA GPU, the threads of a block working together through shared memory. Views point to device
/// memory; work is put on a stream.
class cuda_shared : public detail::cuda_space {
 public:
  using cuda_space::cuda_space;
  static constexpr char const* name() { return "cuda_shared"; }
  static constexpr detail::broad_phase_costs costs{0, 1.9, 0.012, 0.1, 30000};  ///< tuning of `automatic`

  template <class Body>
  using block = detail::cuda_block<Body::items>;

  template <class Body>
  void launch(std::size_t blocks, Body const& body) const {
    if (blocks == 0) return;
    if (blocks > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw error("collide: too much work for one CUDA launch");
    }
    launch_kernel("launch of run_blocks", detail::run_blocks<block<Body>, Body>, static_cast<unsigned>(blocks), body);
  }

  std::size_t concurrency() const { return static_cast<std::size_t>(processors_) * 8; }

  /// How many blocks of a body are at work at a time.
  template <class Body>
  std::size_t wave() const {
    return static_cast<std::size_t>(processors_) * detail::residency<Body, block<Body>>;
  }
};

}  // namespace collide
