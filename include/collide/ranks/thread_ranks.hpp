/// \file
/// Ranks that are threads of one process: for machines with several devices, and for tests.
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <collide/host.hpp>
#include <collide/ranks/ranks.hpp>

namespace collide {

namespace detail {

/// A barrier at which threads wait for each other, and see what the others have laid out. It throws if one has left.
class exchange_barrier {
 public:
  static constexpr std::size_t max_values = 8;  ///< numbers that a rank can lay out here

  explicit exchange_barrier(int size) : places_(static_cast<std::size_t>(size)) {}

  /// The data of a rank that the others see.
  struct place {
    void const* data = nullptr;
    std::uint64_t const* counts = nullptr;
    std::uint64_t numbers[2][max_values] = {};  ///< in even and in odd rounds
    std::shared_ptr<void> laid_out, taken;  ///< marks of its space: the data is there; that of others is no more needed
  };

  int size() const { return static_cast<int>(places_.size()); }
  place& slot(int rank) { return places_[static_cast<std::size_t>(rank)]; }

  /// The number of completed rounds: how often all ranks have waited.
  std::uint64_t round() const { return round_.load(std::memory_order_relaxed); }

  /// Returns when all have called it. Throws `rank_error` if one has left. Others mostly come soon, and to wake a
  /// thread takes some 15 microseconds, so it looks for a while before it sleeps.
  void wait() {
    std::uint64_t const before = round();
    std::unique_lock<std::mutex> lock(mutex_);
    if (!failed_rank_.empty()) throw rank_error(failed_rank_);
    if (++waiting_ == places_.size()) {
      waiting_ = 0;
      round_.store(before + 1, std::memory_order_release);
      changed_.notify_all();
      return;
    }
    lock.unlock();
    for (int looks = 0; looks < 200; ++looks) {
      if (round_.load(std::memory_order_acquire) != before) return;
      std::this_thread::yield();
    }
    lock.lock();
    changed_.wait(lock, [&] { return round() != before || !failed_rank_.empty(); });
    if (round() == before) throw rank_error(failed_rank_);
  }

  /// A rank will not come again, because of `failure` or, if that is null, because it has ended.
  void leave(int rank, std::exception_ptr const& failure) {
    std::lock_guard<std::mutex> const lock(mutex_);
    bool const is_first = failed_rank_.empty();
    if (is_first) {
      failed_rank_ = "collide: rank " + std::to_string(rank) + " of " + std::to_string(size()) +
                     (failure ? " failed: " + message_of(failure) : " has ended, and others wait for it");
    }
    if (failure && (!failure_ || (is_of_another(failure_) && !is_of_another(failure)))) failure_ = failure;
    changed_.notify_all();
  }

  /// The first failure, rather than those that follow from it on other ranks; null if there was none.
  std::exception_ptr failure() const { return failure_; }

 private:
  static bool is_of_another(std::exception_ptr const& failure) {
    try {
      std::rethrow_exception(failure);
    } catch (rank_error const&) {
      return true;
    } catch (...) {
      return false;
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<place> places_;
  std::size_t waiting_ = 0;
  std::atomic<std::uint64_t> round_{0};
  std::string failed_rank_;
  std::exception_ptr failure_;
};

}  // namespace detail

/// Ranks: threads of one process, made by `run`. What they exchange is copied once, from thread to thread. With several
/// devices each thread takes its own, with cudaSetDevice(ranks.rank()) before it makes a CUDA space; on the host they
/// share the threads that OpenMP offers: a space `host()` has an n-th of them on each rank, and at least one.
class thread_ranks {
 public:
  /// Calls f(ranks) on `n` threads, and returns when all have ended. If one throws, those that wait for it throw
  /// `rank_error`, and so does `run` in the end what the first has thrown. Throws `error` if n is not positive.
  template <class F>
  static void run(int n, F const& f) {
    if (n < 1) throw error("collide: thread_ranks: there must be at least one rank");
    detail::exchange_barrier barrier(n);
    std::vector<std::thread> threads;
    int started = 0;
    try {
      threads.reserve(static_cast<std::size_t>(n));
      for (; started < n; ++started) threads.emplace_back([&barrier, &f, started] { work(barrier, started, f); });
    } catch (...) {
      barrier.leave(started, std::current_exception());
    }
    for (auto& thread : threads) thread.join();
    if (barrier.failure()) std::rethrow_exception(barrier.failure());
  }

  /// The number of this rank, from 0.
  int rank() const { return rank_; }
  /// How many ranks there are.
  int size() const { return barrier_->size(); }

  void all_gather(void const* mine, std::size_t bytes, void* all) const {
    show(mine, nullptr, [&] {
      for (int r = 0; r < size(); ++r) copy(barrier_->slot(r).data, bytes, all, static_cast<std::size_t>(r) * bytes);
    });
  }

  void reduce(std::uint64_t const* mine, std::uint64_t* all, std::size_t n, reduction how) const {
    if (n > detail::exchange_barrier::max_values) {
      return show(mine, nullptr, [&] {
        combine(all, n, how, [&](int r) { return static_cast<std::uint64_t const*>(barrier_->slot(r).data); });
      });
    }
    // few numbers stay where they are until all have waited once more, and so have read them
    std::uint64_t const parity = barrier_->round() % 2;
    copy(mine, n * sizeof *mine, barrier_->slot(rank_).numbers[parity], 0);
    barrier_->wait();
    combine(all, n, how, [&](int r) { return barrier_->slot(r).numbers[parity]; });
  }

  void exchange_counts(std::uint64_t const* to_each, std::uint64_t* of_each) const {
    show(nullptr, to_each, [&] {
      for (int r = 0; r < size(); ++r) of_each[r] = barrier_->slot(r).counts[rank_];
    });
  }

  void exchange(void const* from, std::uint64_t const* to_each, void* to, std::uint64_t const* of_each,
                std::size_t bytes) const {
    exchange_by([](int, void* at, void const* theirs, std::size_t n) { std::memcpy(at, theirs, n); }, [] {}, from,
                to_each, to, of_each, bytes);
  }

  /// As `exchange`, of memory of the ranks' spaces, which are of devices: from one to the other, not by way of the
  /// host. It happens in the order of each space's work: what is sent may be overwritten, and what comes be read, by
  /// work that is put there afterwards. No rank waits for its device. If a copy cannot be begun on a rank, that one
  /// throws.
  template <class Space>
  auto exchange_in_space(Space const& space, void const* from, std::uint64_t const* to_each, void* to,
                         std::uint64_t const* of_each, std::size_t bytes) const
      -> decltype(space.copy_from_any_device(to, from, bytes)) {
    detail::first_failure failure;
    detail::exchange_barrier::place& mine = barrier_->slot(rank_);
    failure.attempt([&] { mine.laid_out = space.mark(); });
    auto const take = [&](int r, void* at, void const* theirs, std::size_t n) {
      if (failure.get()) return;
      failure.attempt([&] {
        if (r != rank_) space.after(barrier_->slot(r).laid_out);
        space.copy_from_any_device(at, theirs, n);
      });
    };
    // also if a copy failed: others may be under way
    auto const finish = [&] {
      mine.taken.reset();
      failure.attempt([&] { mine.taken = space.mark(); });
      if (!mine.taken) failure.attempt([&] { space.synchronize(); });
    };
    exchange_by(take, finish, from, to_each, to, of_each, bytes);
    for (int r = 0; r < size(); ++r) {
      if (r != rank_ && to_each[r] != 0) failure.attempt([&] { space.after(barrier_->slot(r).taken); });
    }
    failure.rethrow();
  }

 private:
  thread_ranks(detail::exchange_barrier& barrier, int rank) : barrier_{&barrier}, rank_{rank} {}

  template <class F>
  static void work(detail::exchange_barrier& barrier, int rank, F const& f) {
#if defined(_OPENMP)
    omp_set_num_threads(std::max(1, omp_get_max_threads() / barrier.size()));  // of this thread
#endif
    std::exception_ptr failure;
    try {
      f(thread_ranks(barrier, rank));
    } catch (...) {
      failure = std::current_exception();
    }
    barrier.leave(rank, failure);
  }

  /// Calls copy(rank, to, from, bytes) for what comes from each rank, and finish() before others may change what they
  /// sent.
  template <class Copy, class Finish>
  void exchange_by(Copy const& copy_bytes, Finish const& finish, void const* from, std::uint64_t const* to_each,
                   void* to, std::uint64_t const* of_each, std::size_t bytes) const {
    show(from, to_each, [&] {
      std::size_t filled = 0;
      for (int r = 0; r < size(); ++r) {
        detail::exchange_barrier::place const& theirs = barrier_->slot(r);
        std::size_t before = 0;
        for (int q = 0; q < rank_; ++q) before += static_cast<std::size_t>(theirs.counts[q]) * bytes;
        std::size_t const n = static_cast<std::size_t>(of_each[r]) * bytes;
        if (n != 0) {
          copy_bytes(r, static_cast<unsigned char*>(to) + filled,
                     static_cast<unsigned char const*>(theirs.data) + before, n);
        }
        filled += n;
      }
      finish();
    });
  }

  /// The sums or maxima of n numbers of each rank.
  template <class Numbers>
  void combine(std::uint64_t* all, std::size_t n, reduction how, Numbers const& numbers_of) const {
    for (int r = 0; r < size(); ++r) {
      std::uint64_t const* const theirs = numbers_of(r);
      for (std::size_t i = 0; i < n; ++i) {
        std::uint64_t const before = r == 0 ? 0 : all[i];
        all[i] = how == reduction::sum ? before + theirs[i] : (before < theirs[i] ? theirs[i] : before);
      }
    }
  }

  static void copy(void const* from, std::size_t bytes, void* to, std::size_t at) {
    if (bytes != 0) std::memcpy(static_cast<unsigned char*>(to) + at, from, bytes);
  }

  /// Shows something to the others, calls take(), which looks at what they show, and waits until all have.
  template <class Take>
  void show(void const* data, std::uint64_t const* counts, Take const& take) const {
    barrier_->slot(rank_).data = data;
    barrier_->slot(rank_).counts = counts;
    barrier_->wait();
    take();
    barrier_->wait();
  }

  detail::exchange_barrier* barrier_;
  int rank_;
};

}  // namespace collide
