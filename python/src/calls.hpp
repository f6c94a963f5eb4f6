/// \file
/// What a call does while other threads of Python run, and what happens at Ctrl-C, at the end of the interpreter and
/// after a fork.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <stdexcept>
#include <thread>

#include <nanobind/nanobind.h>
#include <pthread.h>
#include <time.h>

#include <collide/core/error.hpp>

namespace collide_python {

namespace nb = nanobind;

inline std::atomic<int> calls_under_way{0};
inline std::atomic<bool> interpreter_ends{false};
inline std::atomic<int> forks{0};  ///< that lead to this process

/// The thread that ends the interpreter.
inline std::thread::id& ending_thread() {
  static std::thread::id id;
  return id;
}

/// Counts forks from now on.
inline void watch_forks() {
  pthread_atfork(nullptr, nullptr, [] { ++forks; });
}
inline bool is_forked() { return forks != 0; }

/// A call of Python, from its beginning to its end. Once the interpreter ends none begins.
class call_under_way {
 public:
  call_under_way() {
    if (interpreter_ends) {
      if (std::this_thread::get_id() == ending_thread())
        throw collide::error("collide: the interpreter is about to end");
      PyEval_SaveThread();
      while (true) std::this_thread::sleep_for(std::chrono::hours(1));  // as Python's own calls do by then
    }
    ++calls_under_way;
  }
  ~call_under_way() { --calls_under_way; }
  call_under_way(call_under_way const&) = delete;
  call_under_way& operator=(call_under_way const&) = delete;
};

using without_gil = nb::gil_scoped_release;  ///< other threads run while it is there

/// Lets signals reach Python, such as Ctrl-C: throws what their handlers raise.
inline void check_signals() {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

/// For host::watch: the same a few times a second, from a call without the GIL.
inline void look_for_signals() {
  static thread_local std::int64_t last = 0;
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC_COARSE, &now);  // the cheapest clock, of some milliseconds
  std::int64_t const tenths = now.tv_sec * 10 + now.tv_nsec / 100'000'000;
  if (tenths - last < 2) return;
  last = tenths;
  nb::gil_scoped_acquire const here;
  check_signals();
}

/// What one thread uses at a time, in the order in which they come.
class turns {
 public:
  /// Waits for other threads. Refuses a call from within another one of this thread, which would wait for itself.
  void begin() {
    if (is_lost())
      throw collide::error(
          "collide: this process was forked while another thread used this object, which is in the middle of that "
          "call for ever: make another one");
    if (holder_ == std::this_thread::get_id())
      throw collide::error(
          "collide: a call from within another one to the same object: from a signal's handler, __del__ or __dlpack__");
    std::uint64_t const ticket = next_++;
    auto const is_next = [&] { return holder_ == std::thread::id() && queue_.front() == ticket; };
    std::unique_lock<std::mutex> lock(mutex_);
    queue_.push_back(ticket);
    while (!is_next()) {
      lock.unlock();  // before this thread takes the GIL again
      {
        without_gil const others_run;
        lock.lock();
        changed_.wait_for(lock, std::chrono::milliseconds(100), is_next);
        if (!is_next()) queue_.erase(std::find(queue_.begin(), queue_.end(), ticket));  // for a handler's own calls
        lock.unlock();
      }
      lock.lock();
      if (!queue_.empty() && queue_.front() == ticket) continue;
      lock.unlock();
      check_signals();
      lock.lock();
      queue_.push_front(ticket);
    }
    queue_.pop_front();
    holder_ = std::this_thread::get_id();
  }
  void end() {
    std::lock_guard<std::mutex> const lock(mutex_);
    holder_ = std::thread::id();
    changed_.notify_all();
  }

  /// Whether a thread that a fork has left behind is in the middle of its turn.
  bool is_lost() {
    if (forks_ == forks || holder_ == std::this_thread::get_id()) return false;
    std::unique_lock<std::mutex> const lock(mutex_, std::try_to_lock);
    if (!lock || holder_ != std::thread::id() || !queue_.empty()) return true;
    forks_ = forks;
    return false;
  }

 private:
  std::mutex mutex_;  ///< of what follows
  std::condition_variable changed_;
  std::atomic<std::thread::id> holder_{};
  std::deque<std::uint64_t> queue_;  ///< tickets of those that wait
  std::uint64_t next_ = 0;
  int forks_ = forks;
};

/// A turn.
class one_at_a_time {
 public:
  explicit one_at_a_time(turns& of) : of_{of} { of_.begin(); }
  ~one_at_a_time() { of_.end(); }
  one_at_a_time(one_at_a_time const&) = delete;
  one_at_a_time& operator=(one_at_a_time const&) = delete;

 private:
  turns& of_;
};

/// For `atexit`: waits for the calls of other threads, which would not come back to an interpreter that is gone.
inline void wait_for_calls() {
  ending_thread() = std::this_thread::get_id();
  interpreter_ends = true;
  without_gil const others_run;
  while (!is_forked() && calls_under_way > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace collide_python
