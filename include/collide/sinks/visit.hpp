/// \file
/// Sink: a function of the caller's own, called for every hit.
#pragma once

#include <type_traits>

#include <collide/query/concepts.hpp>
#include <collide/query/hit.hpp>
#include <collide/sinks/detail/output.hpp>

namespace collide {

namespace detail {

/// True if F is a lambda that is __device__, or __host__ __device__, of nvcc --extended-lambda. On the host its class
/// is another: that of the former cannot be called, that of the latter is no plain value.
#if defined(__CUDACC_EXTENDED_LAMBDA__)
template <class F>
inline constexpr bool is_device_lambda = __nv_is_extended_device_lambda_closure_type(F);
template <class F>
inline constexpr bool is_host_device_lambda = __nv_is_extended_host_device_lambda_closure_type(F);
#else
template <class F>
inline constexpr bool is_device_lambda = false;
template <class F>
inline constexpr bool is_host_device_lambda = false;
#endif

template <class F>
struct call {
  F f;
  COLLIDE_HD_INLINE std::uint64_t allocate(std::uint64_t) const { return 0; }
#if defined(__CUDACC__)
#pragma nv_exec_check_disable
#endif
  template <class Hit>
  COLLIDE_HD_INLINE void store(std::uint64_t, Hit const& h) const {
    f(h);
  }
};

template <class F>
inline constexpr bool is_plain<call<F>> = std::is_trivially_destructible<F>::value || is_host_device_lambda<F>;

}  // namespace detail

/// Calls `f(hit)` once for every colliding pair and stores nothing; see `hit` for what f gets. On the host it is called
/// from all threads of the space at once, in the CUDA spaces from many threads of the device: what it adds up is added
/// with `atomic_add` (atomic_add.hpp).
///
/// In the CUDA spaces f is copied to the device, and so is trivially copyable with a `__device__` operator(): an object
/// of a class, or with `nvcc --extended-lambda` a lambda, `[=] __device__ (auto const& hit) { ... }`. `query` does not
/// wait there. On the host f may throw: `query` passes on the first exception.
template <class F>
class visit {
 public:
  /// A sink that calls `f`, of which it keeps a copy. Pointers in it must be valid where it is called.
  explicit visit(F f) : f_{f} {}

  /// Does nothing: queries never allocate here.
  template <class Space>
  void reserve(Space const&, std::size_t /*spheres*/, std::size_t /*pairs*/) {}

  template <class Space, class Query>
  void run(Space&, Query const& query) {
    using hit_type = hit<typename Query::narrow_phase, typename Query::scalar>;
    static_assert(!(detail::is_device_lambda<F> && Space::host_accessible),
                  "collide: a __device__ lambda is for the CUDA spaces: on the host visit takes any other");
    static_assert(
        detail::is_device_lambda<F> || std::is_invocable<F const&, hit_type const&>::value,
        "collide: visit(f) calls f(hit): f must be a function object with a const operator() that takes a hit");
    query(detail::call<F>{f_});
  }

 private:
  F f_;
};

}  // namespace collide
