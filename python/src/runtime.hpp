/// \file
/// Where a mesh of Python lives: the space of its calls, and how results get back. That of a GPU is in
/// runtime_cuda.cuh.
#pragma once

#include <memory>
#include <string>

#include <collide/host.hpp>

#include "arrays.hpp"
#include "calls.hpp"
#include "simulation_base.hpp"

namespace collide_python {

/// On a GPU, the stream that a call puts its work on, and what DLPack's exporters are told.
struct stream_of_call {
  std::uintptr_t stream;
  std::int64_t given;
};

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
  collide::host space() const { return collide::host(is_forked ? 1 : threads_); }

  /// What a call is done in: on a GPU with its device current, on a stream of the caller.
  struct scope {
    scope(runtime&, stream_of_call) {}
  };

  whereabouts where() const { return {is_forked ? 1 : threads_, nullptr, nullptr}; }
  stream_of_call current() const { return {0, -1}; }

  /// Keeps an array of the caller until the work of the call is done.
  array const& keep(array const& a) { return a; }

  /// Keeps memory of results usable until they are gone.
  std::shared_ptr<void> memory() const { return {}; }

 private:
  int threads_;
};

/// An array of a shape whose memory `owner` keeps. For numpy it is a numpy array, else an object with __dlpack__.
template <class T>
nb::object give(T const* data, std::vector<std::size_t> const& shape, nb::handle owner, place const& at, bool numpy) {
  static T nothing{};
  T* const to = data != nullptr ? const_cast<T*>(data) : &nothing;
  if (numpy) return nb::cast(nb::ndarray<nb::numpy, T>(to, shape.size(), shape.data(), owner));
  return nb::cast(nb::ndarray<nb::array_api, T>(to, shape.size(), shape.data(), owner, nullptr, nb::dtype<T>(),
                                                at.device_type, at.device));
}

/// A Python object that owns `owned`.
template <class T>
nb::object owner_of(std::unique_ptr<T> owned) {
  nb::object const o = nb::capsule(owned.get(), [](void* p) noexcept { delete static_cast<T*>(p); });
  owned.release();
  return o;
}

}  // namespace collide_python
