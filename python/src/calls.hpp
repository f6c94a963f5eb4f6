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

inline std::thread::id ending_thread;  ///< that ends the interpreter

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
      if (std::this_thread::get_id() == ending_thread) throw collide::error("collide: the interpreter is about to end");
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

/// What one thread uses at a time, in the order in which they come: a mutex for std::lock_guard.
class turns {
 public:
  /// Waits for other threads. Refuses a call from within another one of this thread, which would wait for itself.
  void lock() {
    if (is_lost())
      throw collide::error(
          "collide: this process was forked while another thread used this object, which is in the middle of that "
          "call for ever: make another one");
    auto const me = std::this_thread::get_id();
    std::unique_lock<std::mutex> lock(mutex_);
    if (std::find(queue_.begin(), queue_.end(), me) != queue_.end())
      throw collide::error(
          "collide: a call from within another one to the same object: from a signal's handler, __del__ or __dlpack__");
    queue_.push_back(me);
    while (queue_.front() != me) {
      lock.unlock();  // before this thread takes the GIL again
      {
        without_gil const others_run;
        lock.lock();
        changed_.wait_for(lock, std::chrono::milliseconds(100), [&] { return queue_.front() == me; });
        lock.unlock();
      }
      bool const is_interrupted = PyErr_CheckSignals() != 0;
      lock.lock();
      if (!is_interrupted) continue;
      leave(me);
      throw nb::python_error();
    }
  }
  void unlock() {
    std::lock_guard<std::mutex> const lock(mutex_);
    leave(std::this_thread::get_id());
  }

  /// Whether a thread that a fork has left behind is in the middle of its turn.
  bool is_lost() {
    if (forks_ == forks) return false;
    std::unique_lock<std::mutex> const lock(mutex_, std::try_to_lock);
    if (!lock || (!queue_.empty() && queue_.front() != std::this_thread::get_id())) return true;
    if (!queue_.empty()) queue_.resize(1);  // the others are not in this process
    forks_ = forks;
    return false;
  }

 private:
  void leave(std::thread::id of) {
    queue_.erase(std::find(queue_.begin(), queue_.end(), of));
    changed_.notify_all();
  }

  std::mutex mutex_;  ///< of what follows
  std::condition_variable changed_;
  std::deque<std::thread::id> queue_;  ///< first the thread whose turn it is
  int forks_ = forks;
};

/// For `atexit`: waits for the calls of other threads, which would not come back to an interpreter that is gone.
inline void wait_for_calls() {
  ending_thread = std::this_thread::get_id();
  interpreter_ends = true;
  without_gil const others_run;
  while (!is_forked() && calls_under_way > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace collide_python
