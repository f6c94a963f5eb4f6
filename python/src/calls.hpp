/// \file
/// What a call does while other threads of Python run, and what happens at Ctrl-C, at the end of the interpreter and
/// after a fork.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <stdexcept>
#include <thread>

#include <nanobind/nanobind.h>
#include <pthread.h>
#include <time.h>

#include <collide/error.hpp>

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

/// What one thread uses at a time.
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
    while (!mutex_.try_lock()) {
      {
        without_gil const others_run;  // so that the other thread can finish
        if (mutex_.try_lock_for(std::chrono::milliseconds(100))) break;
      }
      check_signals();
    }
    holder_ = std::this_thread::get_id();
  }
  void end() {
    holder_ = std::thread::id();
    mutex_.unlock();
  }

  /// Whether a thread that a fork has left behind is in the middle of its turn.
  bool is_lost() {
    if (forks_ == forks || holder_ == std::this_thread::get_id()) return false;
    if (!mutex_.try_lock()) return true;
    mutex_.unlock();
    forks_ = forks;
    return false;
  }

 private:
  std::timed_mutex mutex_;
  std::atomic<std::thread::id> holder_{};
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
