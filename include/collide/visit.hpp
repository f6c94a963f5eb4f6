/// \file
/// Sink: a function of the caller's own, called for every hit.
#pragma once

#include <collide/detail/sinks/output.hpp>

namespace collide {

namespace detail {

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

}  // namespace detail

/// Calls `f(hit)` once for every colliding pair and stores nothing; see `hit` for what f gets. In the CUDA spaces f is
/// copied to the device and called there, from many threads at once, and so is trivially copyable with a __device__
/// operator(); on the host it is called from all threads of the space. `query` does not wait in the CUDA spaces.
template <class F>
class visit {
 public:
  explicit visit(F f) : f_{f} {}

  /// Does nothing: queries never allocate here.
  template <class Space>
  void reserve(Space const&, std::size_t /*spheres*/, std::size_t /*pairs*/) {}

  template <class Space, class Query>
  void run(Space&, Query const& query) {
    static_assert(
        std::is_invocable<F const&, hit<typename Query::narrow_phase, typename Query::scalar> const&>::value,
        "collide: visit(f) calls f(hit): f must be a function object with a const operator() that takes a hit");
    query(detail::call<F>{f_});
  }

 private:
  F f_;
};

}  // namespace collide
