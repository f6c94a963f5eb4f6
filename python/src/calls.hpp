/// \file
/// What a call does while other threads of Python run, and what happens at the end of the interpreter and after a fork.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <stdexcept>
#include <thread>

#include <nanobind/nanobind.h>
#include <pthread.h>

#include <collide/error.hpp>

namespace collide_python {

namespace nb = nanobind;

inline std::atomic<int> calls_under_way{0};
inline std::atomic<bool> interpreter_ends{false};
inline std::atomic<bool> is_forked{false};

/// The thread that ends the interpreter.
inline std::thread::id& ending_thread() {
  static std::thread::id id;
  return id;
}

/// Sets `is_forked` in processes that are forked from now on.
inline void watch_forks() {
  pthread_atfork(nullptr, nullptr, [] { is_forked = true; });
}

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

/// Holds a mutex. While another thread has it, other threads of Python run, so that this one can finish.
class one_at_a_time {
 public:
  explicit one_at_a_time(std::mutex& mutex) : lock_(mutex, std::try_to_lock) {
    if (lock_) return;
    without_gil const others_run;
    lock_.lock();
  }

 private:
  std::unique_lock<std::mutex> lock_;
};

/// For `atexit`: waits for the calls of other threads, which would not come back to an interpreter that is gone.
inline void wait_for_calls() {
  ending_thread() = std::this_thread::get_id();
  interpreter_ends = true;
  without_gil const others_run;
  while (!is_forked && calls_under_way > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace collide_python
