/// \file
/// Floating-point numbers and their differences without rounding: a number is an integer times a power of two, or a sum
/// of a few of these, in integers of a few words. Decided on bits, so nothing depends on the compiler's flags.
#pragma once

#include <cstdint>

#include <collide/core/config.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>

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

COLLIDE_HD inline int trailing_zeros(std::uint64_t x) {  // x != 0
  return COLLIDE_ON_DEVICE(__ffsll(static_cast<long long>(x)) - 1, __builtin_ctzll(x));
}

/// A float as a double, also if it is subnormal and the hardware flushes such to zero.
COLLIDE_HD_RARE double widened(float x) {
  using f = ieee_traits<float>;
  std::uint32_t const u = to_bits(x), magnitude = u & ~f::sign_mask;
  // guard: widened
  if (magnitude >> f::mantissa_bits != 0) return static_cast<double>(x);
  double const subnormal = mul_rn(static_cast<double>(magnitude), 0x1p-149);
  return (u & f::sign_mask) != 0 ? -subnormal : subnormal;
}
COLLIDE_HD inline double widened(double x) { return x; }

template <class S>
COLLIDE_HD inline vec3<double> widened(vec3<S> const& v) {
  return {widened(v.x()), widened(v.y()), widened(v.z())};
}
template <class S>
COLLIDE_HD inline triangle<double> widened(triangle<S> const& t) {
  return {widened(t.a), widened(t.b), widened(t.c)};
}
/// Widened where the numbers are normal; subnormal numbers may be flushed to zero.
template <class S>
COLLIDE_HD_INLINE vec3<double> difference_in_double(vec3<S> const& to, vec3<S> const& from) {
  vec3<double> d;
  COLLIDE_UNROLL
  for (int k = 0; k < 3; ++k) d[k] = opaque_value(static_cast<double>(to[k]) - static_cast<double>(from[k]));
  return d;
}

template <class S>
COLLIDE_HD inline sphere<double> widened(sphere<S> const& s) {
  return {widened(s.centre), widened(s.radius)};
}
template <class S>
COLLIDE_HD inline moving_sphere<double> widened(moving_sphere<S> const& s) {
  return {widened(static_cast<sphere<S> const&>(s)), widened(s.displacement)};
}

/// The number mantissa * 2^exponent.
struct dyadic {
  std::int64_t mantissa;
  int exponent;

  COLLIDE_HD std::uint64_t magnitude() const { return static_cast<std::uint64_t>(mantissa < 0 ? -mantissa : mantissa); }
  /// How many bits the mantissa has; it is not 0.
  COLLIDE_HD int length() const { return 64 - leading_zeros(magnitude()); }
};

/// The number mantissa * 2^exponent with an odd mantissa, or 0.
COLLIDE_HD inline dyadic reduced(std::int64_t mantissa, int exponent) {
  if (mantissa == 0) return {0, 0};
  int const zeros = trailing_zeros(static_cast<std::uint64_t>(mantissa));
  return {mantissa >> zeros, exponent + zeros};
}

/// The finite number `x`, from its bits: subnormal numbers are as good as others.
COLLIDE_HD inline dyadic decoded(double x) {
  using f = ieee_traits<double>;
  std::uint64_t const u = to_bits(x);
  auto const biased = static_cast<int>((u & f::exponent_mask) >> f::mantissa_bits);
  auto const fraction = static_cast<std::int64_t>(u & ((std::uint64_t{1} << f::mantissa_bits) - 1));
  // guard: hidden-bit
  std::int64_t const m = biased == 0 ? fraction : fraction | std::int64_t{1} << f::mantissa_bits;
  // guard: subnormal
  dyadic const d = reduced(m, max(biased, 1) - f::bias - f::mantissa_bits);
  return {(u & f::sign_mask) != 0 ? -d.mantissa : d.mantissa, d.exponent};
}

/// A number as a double, exactly: of at most 53 bits, and with an exponent of at least -1022.
COLLIDE_HD inline double value_of(dyadic const& x) {
  return mul_rn(static_cast<double>(x.mantissa),
                from_bits<double>(static_cast<std::uint64_t>(x.exponent + 1023) << 52));
}

/// The components whose sum a number is, wherever they are stored. No components are the number zero.
struct components_view {
  std::int64_t const* mantissas;
  std::int16_t const* exponents;
  int count;

  COLLIDE_HD dyadic operator[](int i) const { return {mantissas[i], exponents[i]}; }
};

/// A table of numbers, each the exact sum of a few floating-point numbers: one component if that has room for it, else
/// as many as it takes. It is filled from the first number to the last, and kept in `exact_memory`.
class exact_numbers {
 public:
  COLLIDE_HD exact_numbers(std::int64_t* mantissas, std::int16_t* exponents, std::uint8_t* ends)
      : mantissas_(mantissas), exponents_(exponents), ends_(ends) {
    ends_[0] = 0;
  }

  /// The next number, 0 until something is added to it.
  COLLIDE_HD void begin_number() {
    ++count_;
    ends_[count_] = ends_[count_ - 1];
  }

  /// Adds to the number that was begun last.
  COLLIDE_HD_NOINLINE void add(dyadic x) {
    if (x.mantissa == 0) return;
    std::uint8_t& end = ends_[count_];
    for (int i = ends_[count_ - 1]; i < end; ++i) {
      dyadic const y{mantissas_[i], exponents_[i]};
      bool const swapped = x.exponent < y.exponent;
      dyadic const& high = swapped ? y : x;
      dyadic const& low = swapped ? x : y;
      int const shift = high.exponent - low.exponent;
      // guard: difference
      if (high.length() + shift > 61 || low.length() > 61) continue;
      x = reduced(high.mantissa * (std::int64_t{1} << shift) + low.mantissa, low.exponent);
      --end;
      mantissas_[i] = mantissas_[end];
      exponents_[i] = exponents_[end];
      break;
    }
    if (x.mantissa == 0) return;
    mantissas_[end] = x.mantissa;
    exponents_[end] = static_cast<std::int16_t>(x.exponent);
    ++end;
  }

  COLLIDE_HD void subtract(dyadic const& x) { add({-x.mantissa, x.exponent}); }

  /// Adds x * y, where neither has more than 53 bits: in two components if need be.
  COLLIDE_HD void add_product(dyadic const& x, dyadic const& y) {
    uint128 const product = uint128{x.magnitude()} * y.magnitude();
    constexpr int half = 61;
    auto const low = static_cast<std::int64_t>(product & ((uint128{1} << half) - 1));
    auto const high = static_cast<std::int64_t>(product >> half);
    std::int64_t const sign = (x.mantissa < 0) != (y.mantissa < 0) ? -1 : 1;
    add(reduced(sign * low, x.exponent + y.exponent));
    add(reduced(sign * high, x.exponent + y.exponent + half));
  }

  COLLIDE_HD components_view operator[](int number) const {
    int const begin = ends_[number];
    return {mantissas_ + begin, exponents_ + begin, ends_[number + 1] - begin};
  }

 private:
  std::int64_t* mantissas_;
  std::int16_t* exponents_;
  std::uint8_t* ends_;  ///< number i has the components from ends_[i] until ends_[i + 1]
  int count_ = 0;
};

/// Memory for a table of `Numbers` numbers of `Components` components in all.
template <int Components, int Numbers>
class exact_memory {
 public:
  COLLIDE_HD exact_numbers table() { return {mantissas_, exponents_, ends_}; }

 private:
  std::int64_t mantissas_[std::size_t(Components)];
  std::int16_t exponents_[std::size_t(Components)];
  std::uint8_t ends_[std::size_t(Numbers + 1)];
};

}  // namespace collide::detail
