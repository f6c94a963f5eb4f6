/// \file
/// Integers of a few words, in registers.
#pragma once

#include <cstdint>

#include <collide/config.hpp>

namespace collide::detail {

__extension__ typedef unsigned __int128 two_words;

/// An integer of `N` words, in two's complement: sums are modulo 2^(64 N), and products have room for all bits.
template <int N>
struct wide {
  std::uint64_t word[N];  ///< the lowest first

  COLLIDE_HD_INLINE bool negative() const { return word[N - 1] >> 63 != 0; }
  COLLIDE_HD_INLINE bool positive() const {
    std::uint64_t some = 0;
    for (auto const w : word) some |= w;
    return some != 0 && !negative();
  }
};

template <int N>
COLLIDE_HD_INLINE wide<N> operator+(wide<N> const& x, wide<N> const& y) {
  wide<N> sum;
  std::uint64_t carry = 0;
  for (int i = 0; i < N; ++i) {
    two_words const s = two_words{x.word[i]} + y.word[i] + carry;
    sum.word[i] = static_cast<std::uint64_t>(s);
    carry = static_cast<std::uint64_t>(s >> 64);
  }
  return sum;
}

/// Subtracts `y` from the upper M words of `x`, if so wanted.
template <int N, int M>
COLLIDE_HD_INLINE void subtract_from_top(wide<N>& x, wide<M> const& y, bool wanted) {
  std::uint64_t const mask = wanted ? ~std::uint64_t{0} : 0;
  std::uint64_t borrow = 0;
  for (int i = 0; i < M; ++i) {
    two_words const d = two_words{x.word[N - M + i]} - (y.word[i] & mask) - borrow;
    x.word[N - M + i] = static_cast<std::uint64_t>(d);
    borrow = static_cast<std::uint64_t>(d >> 127);
  }
}

template <int N>
COLLIDE_HD_INLINE wide<N> operator-(wide<N> x, wide<N> const& y) {
  subtract_from_top(x, y, true);
  return x;
}

template <int N, int M>
COLLIDE_HD_INLINE wide<N + M> operator*(wide<N> const& x, wide<M> const& y) {
  wide<N + M> product{};
  for (int i = 0; i < N; ++i) {
    std::uint64_t carry = 0;
    for (int k = 0; k < M; ++k) {
      two_words const p = two_words{x.word[i]} * y.word[k] + product.word[i + k] + carry;
      product.word[i + k] = static_cast<std::uint64_t>(p);
      carry = static_cast<std::uint64_t>(p >> 64);
    }
    product.word[i + M] = carry;
  }
  // a negative x has been taken for x + 2^(64 N), a negative y for y + 2^(64 M)
  subtract_from_top(product, y, x.negative());
  subtract_from_top(product, x, y.negative());
  return product;
}

}  // namespace collide::detail
