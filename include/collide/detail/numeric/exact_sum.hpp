/// \file
/// Exact sums of products of floating-point numbers: their sign, and their value to nearly all digits of a double.
///
/// Any finite numbers, whatever their exponents: no rounding, overflow or underflow, and no memory but a window of a
/// few words that moves from the lowest digit of the sum to the highest. Integers only, so nothing depends on the
/// compiler's flags.
#pragma once

#include <collide/detail/numeric/float_bits.hpp>
#include <collide/detail/numeric/rounding.hpp>

namespace collide::detail {

COLLIDE_HD_INLINE int trailing_zeros(std::uint64_t x) {  // x != 0
#if defined(__CUDA_ARCH__)
  return __ffsll(static_cast<long long>(x)) - 1;
#else
  return __builtin_ctzll(x);
#endif
}

COLLIDE_HD_INLINE int leading_zeros(std::uint64_t x) {  // x != 0
#if defined(__CUDA_ARCH__)
  return __clzll(static_cast<long long>(x));
#else
  return __builtin_clzll(x);
#endif
}

/// The number mantissa * 2^exponent.
struct dyadic {
  std::int64_t mantissa;
  int exponent;

  COLLIDE_HD std::uint64_t magnitude() const { return static_cast<std::uint64_t>(mantissa < 0 ? -mantissa : mantissa); }
  /// How many bits the mantissa has; it is not 0.
  COLLIDE_HD int length() const { return 64 - leading_zeros(magnitude()); }
};

/// The same number with an odd mantissa, or 0.
COLLIDE_HD inline dyadic reduced(std::int64_t mantissa, int exponent) {
  if (mantissa == 0) return {0, 0};
  int const zeros = trailing_zeros(static_cast<std::uint64_t>(mantissa));
  return {mantissa >> zeros, exponent + zeros};
}

/// The finite number `x`, from its bits: subnormal numbers are as good as others.
template <class S>
COLLIDE_HD dyadic decoded(S x) {
  using f = format<S>;
  auto const u = bits(x);
  auto const biased = static_cast<int>((u & f::exponent_mask) >> f::mantissa_bits);
  auto const fraction = static_cast<std::int64_t>(u & ((bits_of<S>{1} << f::mantissa_bits) - 1));
  std::int64_t const m = biased == 0 ? fraction : fraction | std::int64_t{1} << f::mantissa_bits;
  dyadic const d = reduced(m, larger(biased, 1) - f::bias - f::mantissa_bits);
  return {(u & f::sign_mask) != 0 ? -d.mantissa : d.mantissa, d.exponent};
}

/// As a double. Of no more than 53 bits, which it has, and an exponent from -1022.
COLLIDE_HD inline double value_of(dyadic const& x) {
  return mul(static_cast<double>(x.mantissa), from_bits<double>(static_cast<std::uint64_t>(x.exponent + 1023) << 52));
}

/// The parts whose sum a number is, wherever they are stored.
struct parts_view {
  std::int64_t const* mantissas;
  std::int16_t const* exponents;
  std::int32_t count;

  COLLIDE_HD dyadic operator[](int i) const { return {mantissas[i], exponents[i]}; }
};

/// An exact sum of a few floating-point numbers: as one number if that has room for it, else as up to `Room`.
template <int Room>
class exact_number {
 public:
  exact_number() = default;

  COLLIDE_HD explicit exact_number(dyadic const& x) { add(x); }

  /// x - y
  COLLIDE_HD exact_number(dyadic const& x, dyadic const& y) {
    add(x);
    subtract(y);
  }

  COLLIDE_HD void subtract(dyadic const& x) { add({-x.mantissa, x.exponent}); }

  COLLIDE_HD void add(dyadic x) {
    if (x.mantissa == 0) return;
    for (int i = 0; i < count_; ++i) {
      dyadic const y = parts()[i];
      bool const swapped = x.exponent < y.exponent;
      dyadic const& high = swapped ? y : x;
      dyadic const& low = swapped ? x : y;
      int const shift = high.exponent - low.exponent;
      if (high.length() + shift > 61 || low.length() > 61) continue;
      x = reduced(high.mantissa * (std::int64_t{1} << shift) + low.mantissa, low.exponent);
      mantissas_[i] = mantissas_[--count_];
      exponents_[i] = exponents_[count_];
      break;
    }
    if (x.mantissa == 0) return;
    mantissas_[count_] = x.mantissa;
    exponents_[count_++] = static_cast<std::int16_t>(x.exponent);
  }

  /// 0 parts is the number zero.
  COLLIDE_HD parts_view parts() const { return {mantissas_, exponents_, count_}; }

 private:
  std::int64_t mantissas_[Room] = {};
  std::int16_t exponents_[Room] = {};
  std::int32_t count_ = 0;
};

using exact_difference = exact_number<2>;

/// x - y
template <int Room, int More>
COLLIDE_HD exact_number<Room + More> minus(exact_number<Room> const& x, exact_number<More> const& y) {
  exact_number<Room + More> difference;
  for (int i = 0; i < x.parts().count; ++i) difference.add(x.parts()[i]);
  for (int i = 0; i < y.parts().count; ++i) difference.subtract(y.parts()[i]);
  return difference;
}

/// x * y, where neither has more than 53 bits, and both together at most 61 if there is room for one part only.
template <int Room>
COLLIDE_HD exact_number<Room> product(dyadic const& x, dyadic const& y) {
  static_assert(Room == 1 || Room == 4);
  exact_number<Room> p;
  if (x.mantissa == 0 || y.mantissa == 0) return p;
  if (Room == 1 || x.length() + y.length() <= 61) {
    p.add(reduced(x.mantissa * y.mantissa, x.exponent + y.exponent));
    return p;
  }
  constexpr int half_bits = 27;
  constexpr std::int64_t half = std::int64_t{1} << half_bits;
  std::int64_t const xs[] = {x.mantissa % half, x.mantissa / half}, ys[] = {y.mantissa % half, y.mantissa / half};
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 2; ++k) p.add(reduced(xs[i] * ys[k], x.exponent + y.exponent + half_bits * (i + k)));
  }
  return p;
}

/// A number of any size: value * 2^exponent, where |value| is 0 or between 2^63 and 2^64.
struct wide_number {
  double value = 0;
  int exponent = 0;
};

/// Sums products into a window of the digits of the sum.
class exact_sum {
 public:
  /// Calls `terms(add)` as often as needed, and always for the same sum: terms calls `add(weight, factors...)` for each
  /// product, with a weight of -2, -1, 1 or 2 and at most 6 factors of type `exact_number`. With all combinations of
  /// their parts, at most 2^20 products.
  template <class Terms>
  COLLIDE_HD_NOINLINE static wide_number of(Terms const& terms) {
    exact_sum sum(terms);
    bool const negative = sum.add_up(terms, 1);
    if (negative) sum.add_up(terms, -1);
    if (sum.top_ == 0) return {};
    int const zeros = leading_zeros(sum.top_) - 32;
    std::uint64_t const leading = (std::uint64_t{sum.top_} << 32 | sum.below_top_[0]) << zeros |
                                  static_cast<std::uint32_t>((std::uint64_t{sum.below_top_[1]} << zeros) >> 32);
    auto const value = static_cast<double>(leading);
    return {negative ? -value : value, sum.top_exponent_ - 32 - zeros};
  }

  /// -1, 0 or 1.
  template <class Terms>
  COLLIDE_HD_NOINLINE static int sign_of(Terms const& terms) {
    exact_sum sum(terms);
    return sum.add_up(terms, 1) ? -1 : (sum.top_ == 0 ? 0 : 1);
  }

 private:
  static constexpr int window = 24;  ///< digits of 32 bits
  static constexpr int spare = 24;   ///< bits for the sum of many products, and its sign
  static constexpr int most_factors = 6;

  int lowest_ = 1 << 30, highest_ = -(1 << 30);  ///< exponents of the lowest bit, and above the highest, of any product
  int begin_;                                    ///< number of the window's first digit
  std::int64_t digits_[window];                  ///< not yet carried: may be negative, or longer than 32 bits
  std::uint32_t top_, below_top_[2];             ///< the highest digit that is not 0, and the two below it
  int top_exponent_;

  template <class Terms>
  COLLIDE_HD explicit exact_sum(Terms const& terms) {
    terms([&](int, auto const&... factors) { extend(factors.parts()...); });
  }

  template <class... Factors>
  COLLIDE_HD void extend(Factors const&... factors) {
    if (((factors.count == 0) || ...)) return;
    int low = 0, high = 1;  // for a weight of 2
    auto const extend_by = [&](parts_view const& f) {
      int from = f[0].exponent, to = from + f[0].length();
      for (int i = 1; i < f.count; ++i) {
        from = smaller(from, f[i].exponent);
        to = larger(to, f[i].exponent + f[i].length());
      }
      low += from;
      high += to;
    };
    (extend_by(factors), ...);
    lowest_ = smaller(lowest_, low);
    highest_ = larger(highest_, high);
  }

  /// Adds all up, times `sign`. Returns true if the sum is negative; if not, its highest digits are known.
  template <class Terms>
  COLLIDE_HD bool add_up(Terms const& terms, int sign) {
    int const count = highest_ < lowest_ ? 0 : (highest_ - lowest_ + spare) / 32 + 1;
    std::int64_t carry = 0;
    std::uint32_t below[2] = {0, 0};
    top_ = 0;
    for (begin_ = 0; begin_ < count; begin_ += window) {
      for (int i = 0; i < window; ++i) digits_[i] = 0;
      terms([&](int weight, auto const&... factors) {
        parts_view const all[] = {factors.parts()...};
        add(sign * weight, all, static_cast<int>(sizeof...(factors)));
      });
      for (int i = 0; i < window; ++i) {
        std::int64_t const sum = digits_[i] + carry;
        carry = sum >> 32;
        auto const digit = static_cast<std::uint32_t>(sum);
        if (digit != 0) {
          top_ = digit;
          below_top_[0] = below[0];
          below_top_[1] = below[1];
          top_exponent_ = lowest_ + 32 * (begin_ + i);
        }
        below[1] = below[0];
        below[0] = digit;
      }
    }
    return carry < 0;
  }

  /// Adds a product of sums: of all combinations of their parts.
  COLLIDE_HD_NOINLINE void add(int weight, parts_view const* factors, int n) {
    int combinations = 1;
    for (int i = 0; i < n; ++i) combinations *= factors[i].count;
    for (int c = 0; c < combinations; ++c) {
      int rest = c, exponent = -lowest_ + (weight == 2 || weight == -2 ? 1 : 0), words = 1;
      bool negative = weight < 0;
      std::uint32_t product[2 * most_factors + 1] = {1};
      for (int i = 0; i < n; ++i) {
        dyadic const f = factors[i][rest % factors[i].count];
        rest /= factors[i].count;
        exponent += f.exponent;
        negative = negative != (f.mantissa < 0);
        words = multiply(product, words, f.magnitude());
      }
      put(product, words, exponent, negative);
    }
  }

  /// Multiplies a number of `words` words; returns how many the product has.
  COLLIDE_HD static int multiply(std::uint32_t* x, int words, std::uint64_t by) {
    auto const low = static_cast<std::uint32_t>(by), high = static_cast<std::uint32_t>(by >> 32);
    std::uint64_t carry = 0;
    std::uint32_t below = 0;  // the word before, unmultiplied, for the higher half
    for (int i = 0; i < words; ++i) {
      std::uint32_t const word = x[i];
      std::uint64_t const first = std::uint64_t{word} * low + static_cast<std::uint32_t>(carry);
      std::uint64_t const second = std::uint64_t{below} * high + static_cast<std::uint32_t>(first);
      x[i] = static_cast<std::uint32_t>(second);
      carry = (carry >> 32) + (first >> 32) + (second >> 32);
      below = word;
    }
    carry += std::uint64_t{below} * high;
    x[words] = static_cast<std::uint32_t>(carry);
    x[words + 1] = static_cast<std::uint32_t>(carry >> 32);
    words += 2;
    while (words > 1 && x[words - 1] == 0) --words;
    return words;
  }

  /// Adds a number, shifted by `exponent` bits from the lowest, as far as the window shows it.
  COLLIDE_HD void put(std::uint32_t const* x, int words, int exponent, bool negative) {
    int const first = exponent / 32 - begin_, shift = exponent % 32;
    if (first >= window || first + words < 0) return;
    std::uint32_t below = 0;
    for (int i = 0; i <= words; ++i) {
      std::uint32_t const word = i < words ? x[i] : 0;
      auto const digit = static_cast<std::uint32_t>((std::uint64_t{word} << 32 | below) >> (32 - shift));
      below = word;
      if (first + i >= 0 && first + i < window) digits_[first + i] += negative ? -std::int64_t{digit} : digit;
    }
  }
};

}  // namespace collide::detail
