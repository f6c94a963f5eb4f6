/// \file
/// Some numbers at a time, on a CPU's vector unit: what is a template on its scalar, such as a law of contact, computes
/// with a `pack` what it computes with a number, in each lane, to the bit.
///
/// Comparisons give a mask. `any(mask)` and `either(mask, a, b)` take the place of branches, and do the same for bool.
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide::detail {

COLLIDE_HD_INLINE bool any(bool condition) { return condition; }
template <class S>
COLLIDE_HD_INLINE S either(bool condition, S a, S b) {
  return condition ? a : b;
}
/// Number by number: a GPU keeps two vectors in memory to one of which an address points.
template <class S, std::enable_if_t<std::is_arithmetic<S>::value, int> = 0>
COLLIDE_HD_INLINE vec3<S> either(bool condition, vec3<S> const& a, vec3<S> const& b) {
  return {either(condition, a.x(), b.x()), either(condition, a.y(), b.y()), either(condition, a.z(), b.z())};
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
/// All bits are set where the condition of a lane holds, else none.
COLLIDE_HD_INLINE unsigned bits_of_lane(bool mask, int) { return 0u - unsigned(mask); }

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
COLLIDE_HD_INLINE unsigned bits_of_lane(mask<T, N> const& m, int k) {
  return static_cast<unsigned>(m.v[k]);
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
#if defined(__SSE2__)
  if constexpr (sizeof(T) == 8 && N == 4) {  // in registers
    __m128d const low = _mm_sqrt_pd(__m128d{a.v[0], a.v[1]}), high = _mm_sqrt_pd(__m128d{a.v[2], a.v[3]});
    return pack<T, N>(typename pack<T, N>::vector{low[0], low[1], high[0], high[1]});
  } else if constexpr (sizeof(T) == 4 && N == 8) {
    __m128 const low = _mm_sqrt_ps(__m128{a.v[0], a.v[1], a.v[2], a.v[3]}),
                 high = _mm_sqrt_ps(__m128{a.v[4], a.v[5], a.v[6], a.v[7]});
    return pack<T, N>(typename pack<T, N>::vector{low[0], low[1], low[2], low[3], high[0], high[1], high[2], high[3]});
  }
#endif
  pack<T, N> root;
  for (int k = 0; k < N; ++k) root.v[k] = sqrt_rn(a.v[k]);
  return root;
}

/// As many numbers as 32 bytes have.
template <class S>
using pack_of = pack<S, 32 / int(sizeof(S))>;

/// Four rows of four numbers become four columns.
COLLIDE_HD_INLINE void transpose(pack<double, 4>& a, pack<double, 4>& b, pack<double, 4>& c, pack<double, 4>& d) {
#if defined(__clang__)
#define COLLIDE_SHUFFLE(x, y, ...) __builtin_shufflevector(x, y, __VA_ARGS__)
#else
  typedef std::int64_t order __attribute__((vector_size(32)));
#define COLLIDE_SHUFFLE(x, y, ...) __builtin_shuffle(x, y, order{__VA_ARGS__})
#endif
  auto const ab = COLLIDE_SHUFFLE(a.v, b.v, 0, 4, 2, 6), ab_odd = COLLIDE_SHUFFLE(a.v, b.v, 1, 5, 3, 7),
             cd = COLLIDE_SHUFFLE(c.v, d.v, 0, 4, 2, 6), cd_odd = COLLIDE_SHUFFLE(c.v, d.v, 1, 5, 3, 7);
  a.v = COLLIDE_SHUFFLE(ab, cd, 0, 1, 4, 5), b.v = COLLIDE_SHUFFLE(ab_odd, cd_odd, 0, 1, 4, 5);
  c.v = COLLIDE_SHUFFLE(ab, cd, 2, 3, 6, 7), d.v = COLLIDE_SHUFFLE(ab_odd, cd_odd, 2, 3, 6, 7);
#undef COLLIDE_SHUFFLE
}
template <class T, int N>
struct numbers_in_memory {
  typedef T vector __attribute__((vector_size(N * sizeof(T)), aligned(sizeof(T)), may_alias));
};
/// A vector, and a fourth number.
template <class S>
using row_of = pack<S, 4>;
/// Four numbers in memory, and some of them.
template <class S>
COLLIDE_HD_INLINE pack<S, 4> load_row(S const* from) {
  return pack<S, 4>(
      typename pack<S, 4>::vector(*reinterpret_cast<typename numbers_in_memory<S, 4>::vector const*>(from)));
}
template <unsigned Used, class S>
COLLIDE_HD_INLINE void store_row(S* to, pack<S, 4> const& row) {
  if constexpr (Used >= 4) {
    *reinterpret_cast<typename numbers_in_memory<S, 4>::vector*>(to) = row.v;
  } else {
    for (unsigned k = 0; k < Used; ++k) to[k] = row.v[k];
  }
}
template <class S>
COLLIDE_HD_INLINE vec3<S> vector_of(pack<S, 4> const& row) {
  return {row.v[0], row.v[1], row.v[2]};
}
/// 0 - x, if so.
template <class S>
COLLIDE_HD_INLINE pack<S, 4> opposite_if(bool so, pack<S, 4> const& x) {
  return either(mask<S, 4>(so), 0 - x, x);
}

#else

template <class S>
using pack_of = S;
template <class S>
using row_of = vec3<S>;
template <class S>
COLLIDE_HD_INLINE vec3<S> load_row(S const* from) {
  return {from[0], from[1], from[2]};
}
template <class S>
COLLIDE_HD_INLINE vec3<S> vector_of(vec3<S> const& row) {
  return row;
}
template <class S>
COLLIDE_HD_INLINE vec3<S> opposite_if(bool so, vec3<S> const& x) {
  return so ? vec3<S>(0 - x.x(), 0 - x.y(), 0 - x.z()) : x;
}

#endif

/// Reads rows of numbers, one a lane: columns[c] becomes number c of each. row(k) is that of lane k.
template <unsigned Width, class P, class F>
COLLIDE_HD_INLINE void load_rows(P (&columns)[Width], F const& row) {
#if defined(__GNUC__) && !defined(__CUDACC__)
  if constexpr (std::is_same<P, pack<double, 4>>::value && Width % 4 == 0) {
    auto const *const a = row(0), *const b = row(1), *const c = row(2), *const d = row(3);
    COLLIDE_UNROLL
    for (unsigned k = 0; k < Width; k += 4) {
      P w = load_row(a + k), x = load_row(b + k), y = load_row(c + k), z = load_row(d + k);
      transpose(w, x, y, z);
      columns[k] = w, columns[k + 1] = x, columns[k + 2] = y, columns[k + 3] = z;
    }
    return;
  }
#endif
  for (unsigned c = 0; c < Width; ++c) columns[c] = from_lanes<P>::of([&](int k) { return row(k)[c]; });
}
#if defined(__GNUC__) && !defined(__CUDACC__)
template <unsigned First, unsigned Used, unsigned Width, class S>
COLLIDE_HD_INLINE void store_rows_from(pack<S, 4> const (&columns)[Width], S* a, S* b, S* c, S* d) {
  pack<S, 4> w = columns[First], x = columns[First + 1], y = columns[First + 2], z = columns[First + 3];
  transpose(w, x, y, z);
  store_row<Used - First>(a + First, w), store_row<Used - First>(b + First, x);
  store_row<Used - First>(c + First, y), store_row<Used - First>(d + First, z);
  if constexpr (First + 4 < Used) store_rows_from<First + 4, Used>(columns, a, b, c, d);
}
#endif
/// Writes the first `Used` numbers of such rows.
template <unsigned Used, unsigned Width, class P, class F>
COLLIDE_HD_INLINE void store_rows(P const (&columns)[Width], F const& row) {
  static_assert(Used <= Width, "there are as many columns as numbers of a row");
#if defined(__GNUC__) && !defined(__CUDACC__)
  if constexpr (std::is_same<P, pack<double, 4>>::value && Width % 4 == 0) {
    auto *const a = row(0), *const b = row(1), *const c = row(2), *const d = row(3);
    store_rows_from<0, Used>(columns, a, b, c, d);
    return;
  }
#endif
  for (unsigned c = 0; c < Used; ++c)
    for (int k = 0; k < lanes_of<P>; ++k) row(k)[c] = lane(columns[c], k);
}

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
