/// \file
/// Where a mesh of Python lives: the space of its calls, and how results get back. That of a GPU is in
/// runtime_cuda.cuh.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include <collide/host.hpp>

#include "arrays.hpp"
#include "calls.hpp"
#include "simulation_base.hpp"

namespace collide_python {

/// On a GPU, the stream that a call puts its work on, and what DLPack's exporters are told. In Python two numbers.
using stream_of_call = std::pair<std::uintptr_t, std::int64_t>;

/// What differs from space to space.
template <class Space>
class runtime;

template <>
class runtime<collide::host> {
 public:
  static constexpr bool is_cuda = false;

  /// `threads` as for collide::host. The number of a device and a stream mean nothing here.
  runtime(int threads, int /*device*/) : threads_{threads} {}

  place at() const { return {}; }
  /// The space of the next call. In a forked process one thread works: OpenMP's threads stayed in the parent.
  collide::host space() const {
    collide::host made(where().threads);
    made.watch(look_for_signals);
    return made;
  }
  void follow(runtime const&) {}  ///< work is done when a call returns
  void settle() {}

  /// What a call is done in: on a GPU with its device current, on a stream of the caller.
  struct scope {
    scope(runtime&, stream_of_call) {}
  };

  whereabouts where() const { return {is_forked() ? 1 : threads_, nullptr, nullptr}; }

  /// Keeps an array of the caller until the work of the call is done.
  array const& keep(array const& a) { return a; }

  /// Keeps memory of results usable until they are gone.
  std::shared_ptr<void> memory() const { return {}; }

 private:
  int threads_;
};

/// An array of a shape whose memory `owner` keeps. For numpy it is a numpy array, else an object with __dlpack__.
inline nb::object give(void const* data, nb::dlpack::dtype type, std::vector<std::size_t> const& shape,
                       nb::handle owner, place const& at, bool numpy) {
  static double nothing = 0;
  void* const to = data != nullptr ? const_cast<void*>(data) : &nothing;
  if (numpy) return nb::cast(nb::ndarray<nb::numpy>(to, shape.size(), shape.data(), owner, nullptr, type));
  return nb::cast(
      nb::ndarray<nb::array_api>(to, shape.size(), shape.data(), owner, nullptr, type, at.device_type, at.device));
}

/// A Python object that owns `owned`.
template <class T>
nb::object owner_of(std::unique_ptr<T> owned) {
  nb::object const o = nb::capsule(owned.get(), [](void* p) noexcept { delete static_cast<T*>(p); });
  owned.release();
  return o;
}

/// What is called from Python, in its own place, by one thread at a time.
template <class Space>
class called {
 public:
  called(int threads, int device) : runtime_(threads, device) {}

  bool is_lost() { return turns_.is_lost(); }
  runtime<Space> const& its_runtime() const { return runtime_; }

  struct call {
    call_under_way under_way;
    std::lock_guard<turns> alone;
    typename runtime<Space>::scope here;
    call(called& of, stream_of_call const& stream) : alone(of.turns_), here(of.runtime_, stream) {}
  };

 protected:
  runtime<Space> runtime_;

 private:
  turns turns_;
};

/// An object of Python. In a forked process it stays for ever where its destructor would free what is in use.
template <class Called>
struct held {
  template <class... Argument>
  explicit held(Argument const&... of) : one(std::make_unique<Called>(of...)) {}
  ~held() {
    if (one->is_lost()) static_cast<void>(one.release());
  }
  held(held const&) = delete;
  held& operator=(held const&) = delete;

  std::unique_ptr<Called> one;
};

}  // namespace collide_python
