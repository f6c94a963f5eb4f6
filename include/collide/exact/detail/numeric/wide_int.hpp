/// \file
/// Integers of a few words: in registers, where a compiler unrolls and inlines.
#pragma once

#include <cstdint>

#include <collide/core/config.hpp>

namespace collide::detail {

__extension__ typedef unsigned __int128 uint128;

/// An integer of `N` words, in two's complement: sums are modulo 2^(64 N), and products have room for all bits.
template <int N>
struct int_words {
  std::uint64_t word[std::size_t(N)];  ///< the lowest first

  COLLIDE_HD bool negative() const { return word[N - 1] >> 63 != 0; }
  COLLIDE_HD bool positive() const {
    std::uint64_t some = 0;
    for (auto const w : word) some |= w;
    return some != 0 && !negative();
  }
};

/// Adds the `n` words of y to those of x.
COLLIDE_HD_RARE void add_words(std::uint64_t* x, std::uint64_t const* y, int n) {
  std::uint64_t carry = 0;
  for (int i = 0; i < n; ++i) {
    // guard: fixed-carry
    uint128 const s = uint128{x[i]} + y[i] + carry;
    x[i] = static_cast<std::uint64_t>(s);
    carry = static_cast<std::uint64_t>(s >> 64);
  }
}

/// Subtracts the `n` words of y from those of x, if so wanted.
COLLIDE_HD_RARE void subtract_words(std::uint64_t* x, std::uint64_t const* y, int n, bool wanted) {
  std::uint64_t const mask = wanted ? ~std::uint64_t{0} : 0;
  std::uint64_t borrow = 0;
  for (int i = 0; i < n; ++i) {
    // guard: fixed-borrow
    uint128 const d = uint128{x[i]} - (y[i] & mask) - borrow;
    x[i] = static_cast<std::uint64_t>(d);
    borrow = static_cast<std::uint64_t>(d >> 127);
  }
}

/// Multiplies n words by m words, as integers that are not negative.
COLLIDE_HD_RARE void multiply_words(std::uint64_t* product, std::uint64_t const* x, int n, std::uint64_t const* y,
                                    int m) {
  for (int i = 0; i < n + m; ++i) product[i] = 0;
  for (int i = 0; i < n; ++i) {
    std::uint64_t carry = 0;
    for (int k = 0; k < m; ++k) {
      // guard: fixed-product-carry
      uint128 const p = uint128{x[i]} * y[k] + product[i + k] + carry;
      product[i + k] = static_cast<std::uint64_t>(p);
      carry = static_cast<std::uint64_t>(p >> 64);
    }
    // guard: fixed-product-top
    product[i + m] = carry;
  }
}

template <int N>
COLLIDE_HD_RARE int_words<N> operator+(int_words<N> x, int_words<N> const& y) {
  add_words(x.word, y.word, N);
  return x;
}

template <int N>
COLLIDE_HD_RARE int_words<N> operator-(int_words<N> x, int_words<N> const& y) {
  subtract_words(x.word, y.word, N, true);
  return x;
}

template <int N, int M>
COLLIDE_HD_RARE int_words<N + M> operator*(int_words<N> const& x, int_words<M> const& y) {
  int_words<N + M> product;
  multiply_words(product.word, x.word, N, y.word, M);
  // a negative x has been taken for x + 2^(64 N), a negative y for y + 2^(64 M)
  // guard: fixed-sign
  subtract_words(product.word + N, y.word, M, x.negative());
  // guard: fixed-second-sign
  subtract_words(product.word + M, x.word, N, y.negative());
  return product;
}

}  // namespace collide::detail
