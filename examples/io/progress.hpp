/// \file
/// A progress bar with an estimate of the time left, for people who watch.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include <unistd.h>

namespace io {

/// A bar on standard error for work of `total` units (of any kind). It appears only on a terminal, only once the work
/// is expected to take longer than `patience()`, and leaves nothing behind.
class progress {
  using clock = std::chrono::steady_clock;

 public:
  progress(std::string label, double total) : label_{std::move(label)}, total_{total}, visible_{watched()} {}
  progress(progress const&) = delete;
  progress& operator=(progress const&) = delete;
  ~progress() {
    if (drawn_) std::fputs("\r\033[K", stderr);
  }

  /// True if somebody may see it.
  static bool watched() { return ::isatty(STDERR_FILENO) == 1; }

  /// How many seconds of work need no bar: 1, or what COLLIDE_PATIENCE in the environment says.
  static double patience() {
    static char const* const said = std::getenv("COLLIDE_PATIENCE");
    static double const is = said == nullptr ? 1 : std::strtod(said, nullptr);
    return is;
  }

  /// Says that `done` units of the total are done. Cheap enough to be called thousands of times a second.
  void update(double done) {
    if (!visible_ || done <= 0) return;
    auto const now = clock::now();
    double const elapsed = seconds(now - start_);
    double const left = elapsed * std::max(0.0, total_ / done - 1);
    if (elapsed < 0.2 * patience() || elapsed + left < patience() || (drawn_ && seconds(now - last_) < 0.1)) return;
    draw(std::min(1.0, done / total_), left);
    last_ = now;
    drawn_ = true;
  }

 private:
  static double seconds(clock::duration d) { return std::chrono::duration<double>(d).count(); }

  void draw(double part, double left) const {
    constexpr int width = 30;
    auto const full = static_cast<std::size_t>(part * width);
    auto const whole = static_cast<long>(left + 0.5);
    std::fprintf(stderr, "\r%s [%s%s] %3.0f %%, %ld:%02ld left\033[K", label_.c_str(), std::string(full, '#').c_str(),
                 std::string(width - full, '.').c_str(), 100 * part, whole / 60, whole % 60);
    std::fflush(stderr);
  }

  std::string label_;
  double total_;
  bool visible_;
  bool drawn_ = false;
  clock::time_point start_ = clock::now();
  clock::time_point last_ = start_;
};

}  // namespace io
