/// \file
/// Some numbers at a time, on a CPU's vector unit: what is a template on its scalar, such as a law of contact, computes
/// with a `pack` what it computes with a number, in each lane, to the bit.
///
/// Comparisons give a mask. `any(mask)` and `either(mask, a, b)` take the place of branches, and do the same for bool.
#pragma once

#include <type_traits>
#include <utility>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide::detail {

COLLIDE_HD_INLINE bool any(bool condition) { return condition; }
template <class T>
COLLIDE_HD_INLINE T const& either(bool condition, T const& a, T const& b) {
  return condition ? a : b;
}

/// True of a type of numbers, and of some at a time.
template <class P>
inline constexpr bool is_number = std::is_arithmetic<P>::value;
/// The result of a comparison.
template <class P>
using mask_of = decltype(P() < P());

/// How many numbers a scalar type has, and one of them.
template <class P>
inline constexpr int lanes_of = 1;
template <class S>
COLLIDE_HD_INLINE S lane(S const& x, int) {
  return x;
}
template <class P>
struct from_lanes {
  /// f(k) in lane k.
  template <class F>
  static COLLIDE_HD_INLINE P of(F const& f) {
    return f(0);
  }
};
COLLIDE_HD_INLINE bool lane_of_mask(bool mask, int) { return mask; }

#if defined(__GNUC__) && !defined(__CUDACC__)

template <class T>
struct lane_traits;
template <>
struct lane_traits<float> {
  using integer = std::int32_t;
};
template <>
struct lane_traits<double> {
  using integer = std::int64_t;
};

/// The result of a comparison of packs.
template <class T, int N>
struct mask {
  typedef typename lane_traits<T>::integer vector __attribute__((vector_size(N * sizeof(T)), aligned(16)));
  vector v;

  mask() = default;
  COLLIDE_HD_INLINE mask(bool all) : v(vector{} - static_cast<typename lane_traits<T>::integer>(all)) {}
  COLLIDE_HD_INLINE explicit mask(vector const& x) : v(x) {}

  friend COLLIDE_HD_INLINE mask operator&&(mask const& a, mask const& b) { return mask(a.v & b.v); }
  friend COLLIDE_HD_INLINE mask operator||(mask const& a, mask const& b) { return mask(a.v | b.v); }
  friend COLLIDE_HD_INLINE mask operator!(mask const& a) { return mask(~a.v); }
};

/// `N` numbers.
template <class T, int N>
struct pack {
  typedef T vector __attribute__((vector_size(N * sizeof(T)), aligned(16)));
  using mask_type = mask<T, N>;
  vector v;

  pack() = default;
  template <class A, std::enable_if_t<std::is_arithmetic<A>::value, int> = 0>
  COLLIDE_HD_INLINE pack(A x) : v(vector{} + static_cast<T>(x)) {}
  COLLIDE_HD_INLINE explicit pack(vector const& x) : v(x) {}

  friend COLLIDE_HD_INLINE pack operator+(pack const& a, pack const& b) { return pack(a.v + b.v); }
  friend COLLIDE_HD_INLINE pack operator-(pack const& a, pack const& b) { return pack(a.v - b.v); }
  friend COLLIDE_HD_INLINE pack operator*(pack const& a, pack const& b) { return pack(a.v * b.v); }
  friend COLLIDE_HD_INLINE pack operator/(pack const& a, pack const& b) { return pack(a.v / b.v); }
  friend COLLIDE_HD_INLINE pack operator-(pack const& a) { return pack(-a.v); }
  COLLIDE_HD_INLINE pack& operator+=(pack const& b) { return *this = *this + b; }
  COLLIDE_HD_INLINE pack& operator-=(pack const& b) { return *this = *this - b; }
  COLLIDE_HD_INLINE pack& operator*=(pack const& b) { return *this = *this * b; }
  friend COLLIDE_HD_INLINE mask_type operator<(pack const& a, pack const& b) { return mask_type(a.v < b.v); }
  friend COLLIDE_HD_INLINE mask_type operator>(pack const& a, pack const& b) { return mask_type(a.v > b.v); }
};

template <class T, int N>
inline constexpr bool is_number<pack<T, N>> = true;
template <class T, int N>
inline constexpr int lanes_of<pack<T, N>> = N;
template <class T, int N>
COLLIDE_HD_INLINE T lane(pack<T, N> const& x, int k) {
  return x.v[k];
}
template <class T, int N>
struct from_lanes<pack<T, N>> {
  template <class F>
  static COLLIDE_HD_INLINE pack<T, N> of(F const& f) {
    return of(f, std::make_integer_sequence<int, N>());
  }

 private:
  template <class F, int... K>
  static COLLIDE_HD_INLINE pack<T, N> of(F const& f, std::integer_sequence<int, K...>) {
    typename pack<T, N>::vector const v = {f(K)...};
    return pack<T, N>(v);
  }
};
template <class T, int N>
COLLIDE_HD_INLINE bool lane_of_mask(mask<T, N> const& m, int k) {
  return m.v[k] != 0;
}

template <class T, int N>
COLLIDE_HD_INLINE bool any(mask<T, N> const& m) {
  typename lane_traits<T>::integer all = 0;
  for (int k = 0; k < N; ++k) all |= m.v[k];
  return all != 0;
}
template <class T, int N>
COLLIDE_HD_INLINE pack<T, N> either(mask<T, N> const& m, pack<T, N> const& a, pack<T, N> const& b) {
  using bits = typename mask<T, N>::vector;
  return pack<T, N>(reinterpret_cast<typename pack<T, N>::vector>((m.v & reinterpret_cast<bits>(a.v)) |
                                                                  (~m.v & reinterpret_cast<bits>(b.v))));
}
template <class T, int N>
COLLIDE_HD_INLINE vec3<pack<T, N>> either(mask<T, N> const& m, vec3<pack<T, N>> const& a, vec3<pack<T, N>> const& b) {
  return {either(m, a.x(), b.x()), either(m, a.y(), b.y()), either(m, a.z(), b.z())};
}
template <class T, int N>
COLLIDE_HD_INLINE pack<T, N> max(pack<T, N> const& a, pack<T, N> const& b) {
  return either(a < b, b, a);
}
template <class T, int N>
COLLIDE_HD_INLINE pack<T, N> min(pack<T, N> const& a, pack<T, N> const& b) {
  return either(b < a, b, a);
}
template <class T, int N>
COLLIDE_HD_INLINE pack<T, N> mul_rn(pack<T, N> const& a, pack<T, N> const& b) {
  return a * b;
}
template <class T, int N>
COLLIDE_HD_INLINE pack<T, N> sqrt_rn(pack<T, N> const& a) {
  pack<T, N> root;
#if defined(__SSE2__)
  constexpr int at_a_time = 16 / int(sizeof(T));
  for (int k = 0; k < N; k += at_a_time) {
    T const* const from = reinterpret_cast<T const*>(&a) + k;
    T* const to = reinterpret_cast<T*>(&root) + k;
    if constexpr (sizeof(T) == 8) {
      _mm_storeu_pd(to, _mm_sqrt_pd(_mm_loadu_pd(from)));
    } else {
      _mm_storeu_ps(to, _mm_sqrt_ps(_mm_loadu_ps(from)));
    }
  }
#else
  for (int k = 0; k < N; ++k) root.v[k] = sqrt_rn(a.v[k]);
#endif
  return root;
}

/// As many numbers as 32 bytes have.
template <class S>
using pack_of = pack<S, 32 / int(sizeof(S))>;

#else

template <class S>
using pack_of = S;

#endif

/// f(numbers of one lane) in each lane, where that takes a branch of its own.
template <class P, class F, class... Q>
COLLIDE_HD_INLINE P in_each_lane(F const& f, P const& x, Q const&... more) {
  return from_lanes<P>::of([&](int k) { return f(lane(x, k), lane(more, k)...); });
}

}  // namespace collide::detail

#if defined(__GNUC__) && !defined(__CUDACC__)
/// Traits by which Eigen knows a scalar type.
template <class T, int N>
struct Eigen::NumTraits<collide::detail::pack<T, N>> : Eigen::GenericNumTraits<T> {
  using Real = collide::detail::pack<T, N>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = T;
};
#endif
