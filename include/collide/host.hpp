/// \file
/// The execution space of the CPU.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <exception>
#include <limits>
#include <thread>

#include <collide/core/error.hpp>
#include <collide/core/memory.hpp>
#include <collide/spaces/detail/atomic.hpp>
#include <collide/spaces/detail/block.hpp>
#include <collide/spaces/detail/tuning.hpp>

#if defined(_OPENMP)
#include <omp.h>
#endif

namespace collide {

/// Execution space: this computer's CPU, with OpenMP threads where the program is compiled with OpenMP, else one
/// thread. Views point to host memory; every call has finished its work when it returns. A small value that is copied
/// into detectors. Called from within an OpenMP parallel region it uses the threads that OpenMP gives a nested one:
/// one, unless nesting is on. An exception of any thread is passed on to the caller.
class host {
 public:
  /// `threads`: how many; 0 is as many as OpenMP offers where that pays: after a loop in which waiting for others took
  /// longer than doing their part, the thread that called works alone for eight times what it has lost. `resource`:
  /// where the library's memory comes from; null is std::pmr::get_default_resource(). The resource must outlive
  /// everything that was made with the space.
  /// Throws `error` if `threads` is negative, or above 1 where the program is compiled without OpenMP.
  explicit host(int threads = 0, std::pmr::memory_resource* resource = nullptr)
      : threads_{threads}, resource_{resource != nullptr ? resource : std::pmr::get_default_resource()} {
    if (threads < 0) throw error("collide: host: the number of threads must not be negative");
#if !defined(_OPENMP)
    if (threads > 1) {
      throw error(
          "collide: host: several threads need OpenMP: compile and link with -fopenmp (nvcc: -Xcompiler -fopenmp); "
          "with CMake, collide::collide does so where OpenMP is found, unless COLLIDE_OPENMP is OFF");
    }
#endif
  }

  /// How many threads work, at most.
  int threads() const {
#if defined(_OPENMP)
    return threads_ > 0 ? threads_ : omp_get_max_threads();
#else
    return 1;
#endif
  }

  /// Has the thread that makes a call look around while it works, thousands of times a second; null: not. If
  /// `look` throws, all threads stop, and the call throws that. A simulation is then between two states: not for steps.
  void watch(void (*look)()) { look_ = look; }

  /// The name of the space, for messages.
  static constexpr char const* name() { return "host"; }
  /// The resource of memory.
  std::pmr::memory_resource* resource() const { return resource_; }
  /// Does nothing: all work is done when a call returns.
  void synchronize() const {}

  // What the library's algorithms need of a space:

  template <class Kernel>
  using block = detail::serial_block<64, 256>;

  /// True if the host reads this memory without waiting for anything.
  static constexpr bool host_accessible = true;

  /// False if the memory at `p` is known not to be this space's.
  static bool reads(void const* p) { return detail::in_device_memory == nullptr || !detail::in_device_memory(p); }

  /// Runs `kernel` once for each of `blocks` blocks.
  template <class Kernel>
  void launch(std::size_t blocks, Kernel const& kernel) const {
    share_out(blocks, {&kernel, blocks, run_blocks<Kernel>});
  }

  /// Calls f(i) for all i < n, from all threads; returns when all are done, and throws what f has thrown.
  template <class F>
  void for_each(std::size_t n, F const& f) const {
    share_out((n + 1023) / 1024, {&f, n, call_for_each<F>});
  }

  /// How many blocks keep all threads busy.
  std::size_t saturating_blocks() const { return threads() == 1 ? 1 : 4 * static_cast<std::size_t>(threads()); }

  /// How many blocks of a kernel can be at work at a time; here that does not matter.
  template <class Kernel>
  std::size_t max_resident_blocks() const {
    return std::numeric_limits<std::size_t>::max();
  }

  /// Sets `bytes` bytes.
  void fill(void* to, unsigned char byte, std::size_t bytes) const {
    if (bytes != 0) std::memset(to, byte, bytes);
  }

  /// The value at `from`.
  template <class T>
  T read(T const* from) const {
    return *from;
  }

  /// Copies `n` values; the two arrays do not overlap.
  template <class T>
  void copy_to_host(T* to, T const* from, std::size_t n) const {
    if (n != 0) std::memcpy(static_cast<void*>(to), from, n * sizeof(T));
  }

  /// Copies `n` values; the two arrays do not overlap.
  template <class T>
  void copy_from_host(T* to, T const* from, std::size_t n) const {
    if (n != 0) std::memcpy(static_cast<void*>(to), from, n * sizeof(T));
  }

 private:
#if defined(_OPENMP)
  using clock = std::chrono::steady_clock;

  /// For how long this thread still works alone, as it has waited for others longer than they spared it.
  inline static thread_local clock::duration alone_for_{};

  /// Works alone as long as that; returns how far it came.
  template <class Work>
  static std::size_t begin_alone(std::size_t n, Work const& work) {
    detail::single_threaded_scope const alone(true);
    clock::time_point const begin = clock::now();
    clock::duration passed{};
    std::size_t done = 0;
    for (std::size_t step = 1; done < n && passed < alone_for_; step *= 2) {
      std::size_t const last = std::min(n, done + step);
      work(done, last);
      done = last;
      passed = clock::now() - begin;
    }
    alone_for_ -= std::min(alone_for_, passed);
    return done;
  }
#endif

  template <class Kernel>
  static void run_blocks(void const* kernel, std::size_t first, std::size_t last, std::size_t) {
    typename Kernel::template scratch<block<Kernel>> scratch;
    for (std::size_t i = first; i < last; ++i) {
      block<Kernel> here(i);
      (*static_cast<Kernel const*>(kernel))(here, scratch);
    }
  }
  template <class F>
  COLLIDE_AS_O3 static void call_for_each(void const* f, std::size_t first, std::size_t last, std::size_t n) {
    for (std::size_t i = first * 1024; i < std::min(n, last * 1024); ++i) (*static_cast<F const*>(f))(i);
  }

  /// A loop of `size`, whatever the type of its body: what it does for a range.
  struct ranged_work {
    void const* of;
    std::size_t size;
    void (*call)(void const* of, std::size_t first, std::size_t last, std::size_t size);
  };

  /// Calls the work for ranges that cover 0 .. n, from all threads; the first exception is passed on. How ranges are
  /// shared out is compiled once for all loops. Each thread takes some `shares` ranges, as it gets free: enough that
  /// none waits long for the others, and few enough that memory is read in long stretches.
  void share_out(std::size_t n, ranged_work const& whole) const {
    std::atomic<bool> failed{false};
    std::thread::id const caller = look_ != nullptr ? std::this_thread::get_id() : std::thread::id();
    auto const work = [&](std::size_t first, std::size_t last) {
      std::size_t const part = look_ != nullptr ? 1 : last - first;
      for (; first < last && !failed; first += part) {
        if (look_ != nullptr && std::this_thread::get_id() == caller) look_();
        whole.call(whole.of, first, std::min(last, first + part), whole.size);
      }
    };
#if defined(_OPENMP)
    if (threads() > 1 && n > 1) {
      std::size_t const done = threads_ == 0 ? begin_alone(n, work) : 0;
      if (done == n) return;
      constexpr std::size_t shares = 8;
      std::size_t const range = (n - done - 1) / (shares * static_cast<std::size_t>(threads())) + 1;
      auto const ranges = static_cast<std::ptrdiff_t>((n - done - 1) / range + 1);
      clock::rep busy = 0;  // how long all threads work
      std::exception_ptr failure;
      clock::time_point const begin = clock::now();
#pragma omp parallel for schedule(dynamic) num_threads(threads()) reduction(+ : busy)
      for (std::ptrdiff_t r = 0; r < ranges; ++r) {
        detail::single_threaded_scope const together(false);
        clock::time_point const start = clock::now();
        try {
          auto const first = done + static_cast<std::size_t>(r) * range;
          work(first, std::min(n, first + range));
        } catch (...) {
          failed = true;
#pragma omp critical(collide_host_failure)
          if (!failure) failure = std::current_exception();
        }
        busy += (clock::now() - start).count();
      }
      clock::duration const lost = clock::now() - begin - clock::duration(busy);
      if (threads_ == 0) alone_for_ += 8 * std::max(lost, clock::duration{});
      if (failure) std::rethrow_exception(failure);
      return;
    }
#endif
    detail::single_threaded_scope const alone(true);
    work(0, n);
  }

  [[maybe_unused]] int threads_;
  std::pmr::memory_resource* resource_;
  void (*look_)() = nullptr;
};

}  // namespace collide
