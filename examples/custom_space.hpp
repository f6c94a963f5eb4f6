/// \file
/// The execution space of custom_space.cpp: a pool of threads. It has all that a space must have, and nothing else.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstring>
#include <limits>
#include <memory_resource>
#include <mutex>
#include <thread>
#include <vector>

#include <collide/broad/extend.hpp>

/// Threads that wait for work. What the work throws ends the program.
class thread_pool {
 public:
  explicit thread_pool(unsigned threads) {
    for (unsigned i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
  }
  ~thread_pool() {
    {
      std::lock_guard<std::mutex> const lock(mutex_);
      is_ending_ = true;
    }
    wake_.notify_all();
    for (auto& thread : threads_) thread.join();
  }

  std::size_t size() const { return threads_.size(); }

  /// Calls f(i) for all i < n, from all threads, and waits.
  template <class F>
  void run(std::size_t n, F const& f) {
    std::unique_lock<std::mutex> lock(mutex_);
    call_ = [](void const* function, std::size_t i) { (*static_cast<F const*>(function))(i); };
    function_ = &f;
    next_ = 0;
    count_ = unfinished_ = n;
    wake_.notify_all();
    done_.wait(lock, [this] { return unfinished_ == 0; });
  }

 private:
  void work() {
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;) {
      wake_.wait(lock, [this] { return is_ending_ || next_ < count_; });
      if (is_ending_) return;
      std::size_t const i = next_++;
      lock.unlock();
      call_(function_, i);
      lock.lock();
      if (--unfinished_ == 0) done_.notify_one();
    }
  }

  std::mutex mutex_;
  std::condition_variable wake_, done_;
  void (*call_)(void const*, std::size_t) = nullptr;
  void const* function_ = nullptr;
  std::size_t next_ = 0, count_ = 0, unfinished_ = 0;
  bool is_ending_ = false;
  std::vector<std::thread> threads_;
};

/// The execution space: a small value that refers to a pool.
class pool_space {
 public:
  explicit pool_space(thread_pool& pool) : pool_{&pool} {}

  static constexpr char const* name() { return "pool"; }
  static constexpr bool host_accessible = true;
  std::pmr::memory_resource* resource() const { return std::pmr::get_default_resource(); }
  void synchronize() const {}

  /// A kernel functor is run by blocks of one thread, with 64 items and room for 256 hits.
  template <class Kernel>
  using block = collide::serial_block<64, 256>;

  template <class Kernel>
  void launch(std::size_t blocks, Kernel const& kernel) const {
    run_ranges(blocks, [&](std::size_t first, std::size_t last) {
      typename Kernel::template scratch<block<Kernel>> scratch;
      for (; first < last; ++first) {
        block<Kernel> here(first);
        kernel(here, scratch);
      }
    });
  }

  template <class F>
  void for_each(std::size_t n, F const& f) const {
    run_ranges(n, [&](std::size_t first, std::size_t last) {
      for (; first < last; ++first) f(first);
    });
  }

  std::size_t saturating_blocks() const { return 4 * pool_->size(); }
  template <class Kernel>
  std::size_t max_resident_blocks() const {
    return std::numeric_limits<std::size_t>::max();
  }

  void fill(void* to, unsigned char byte, std::size_t bytes) const {
    if (bytes != 0) std::memset(to, byte, bytes);
  }
  template <class T>
  T read(T const* from) const {
    return *from;
  }
  template <class T>
  void copy_to_host(T* to, T const* from, std::size_t n) const {
    std::copy(from, from + n, to);
  }
  template <class T>
  void copy_from_host(T* to, T const* from, std::size_t n) const {
    std::copy(from, from + n, to);
  }

 private:
  /// Some ranges for each thread, so that none waits long for the others.
  template <class F>
  void run_ranges(std::size_t n, F const& f) const {
    std::size_t const ranges = std::min(n, 8 * pool_->size());
    pool_->run(ranges, [&](std::size_t r) { f(n * r / ranges, n * (r + 1) / ranges); });
  }

  thread_pool* pool_;
};
