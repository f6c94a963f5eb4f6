/// \file
/// Exact sums of products of floating-point numbers: their sign, and their value to nearly all digits of a double.
///
/// Any finite numbers, whatever their exponents: no rounding, overflow or underflow, and no memory but a window of a
/// few words that moves from the lowest digit of the sum to the highest. Integers only, so nothing depends on the
/// compiler's flags.
#pragma once

#include <collide/exact/detail/numeric/exact_number.hpp>
#include <collide/exact/detail/numeric/exact_products.hpp>

namespace collide::detail {

/// A double with an exponent of its own: value * 2^exponent, where |value| is 0 or between 2^63 and 2^64.
struct scaled_double {
  double value = 0;
  int exponent = 0;
  double rest = 0;  ///< value + rest has an error below 2^-63
};

/// Sums products into a window of the digits of the sum.
class exact_sum {
 public:
  /// The sum; -1 for one that is negative, if only the sign is wanted. With all combinations of the components of
  /// factors, at most 2^20 products.
  template <class Products = exact_products>
  COLLIDE_HD_NOINLINE static scaled_double of(exact_numbers const& numbers, Products const& products,
                                              bool with_value = true) {
    exact_sum sum(numbers);
    for (auto const& product : products) sum.extend_exponent_range(product);
    bool negative = false;
    while (sum.accumulate(products, negative ? -1 : 1)) {
      if (!with_value) return {-1, 0};
      negative = true;
    }
    if (sum.top_ == 0) return {};
    int const zeros = leading_zeros(sum.top_) - 32;
    std::uint64_t const leading = (std::uint64_t{sum.top_} << 32 | sum.below_top_[0]) << zeros |
                                  static_cast<std::uint32_t>((std::uint64_t{sum.below_top_[1]} << zeros) >> 32);
    constexpr std::uint64_t below_double = 0x7ff;
    auto const high = static_cast<double>(leading & ~below_double), low = static_cast<double>(leading & below_double);
    double const value = opaque_value(high + low), of_low = opaque_value(value - high), rest = low - of_low;
    return {negative ? -value : value, sum.top_exponent_ - 32 - zeros, negative ? -rest : rest};
  }

  /// -1, 0 or 1.
  template <class Products = exact_products>
  static COLLIDE_HD int sign_of(exact_numbers const& numbers, Products const& products) {
    double const sum = of(numbers, products, false).value;
    return sum < 0 ? -1 : (sum > 0 ? 1 : 0);
  }

 private:
  static constexpr int window_digits = 24;  ///< digits of 32 bits
  // guard: spare
  static constexpr int carry_bits = 24;  ///< bits for the sum of many products, and its sign

  exact_numbers const& numbers_;
  int lowest_ = 1 << 30, highest_ = -(1 << 30);  ///< exponents of the lowest bit, and above the highest, of any product
  int begin_;                                    ///< number of the window's first digit
  std::int64_t digits_[window_digits];           ///< not yet carried: may be negative, or longer than 32 bits
  std::uint32_t top_, below_top_[2];             ///< the highest digit that is not 0, and the two below it
  int top_exponent_;

  COLLIDE_HD explicit exact_sum(exact_numbers const& numbers) : numbers_(numbers) {}

  template <class Product>
  COLLIDE_HD void extend_exponent_range(Product const& product) {
    int low = 0, high = 2;  // for a weight of 4
    for (int i = 0; i < product.count; ++i) {
      components_view const f = numbers_[product.factors[i]];
      if (f.count == 0) return;
      int from = f[0].exponent, to = from + f[0].length();
      for (int k = 1; k < f.count; ++k) {
        from = min(from, f[k].exponent);
        to = max(to, f[k].exponent + f[k].length());
      }
      low += from;
      high += to;
    }
    lowest_ = min(lowest_, low);
    highest_ = max(highest_, high);
  }

  /// Adds all up, times `sign`. Returns true if the sum is negative; if not, its highest digits are known.
  template <class Products>
  COLLIDE_HD bool accumulate(Products const& products, int sign) {
    int const count = highest_ < lowest_ ? 0 : (highest_ - lowest_ + carry_bits) / 32 + 1;
    std::int64_t carry = 0;
    std::uint32_t below[2] = {0, 0};
    top_ = 0;
    // guard: window-carry
    for (begin_ = 0; begin_ < count; begin_ += window_digits) {
      for (int i = 0; i < window_digits; ++i) digits_[i] = 0;
      for (auto const& product : products) add(product, sign * product.weight);
      for (int i = 0; i < window_digits; ++i) {
        // guard: carry
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

  /// Adds the products of all combinations of the components of the factors.
  template <class Product>
  COLLIDE_HD void add(Product const& of, int weight) {
    // guard: four-fold
    int const magnitude = weight < 0 ? -weight : weight, magnitude_exponent = magnitude / 2;  // 0, 1, 2 of 1, 2, 4
    int combinations = 1;
    for (int i = 0; i < of.count; ++i) combinations *= numbers_[of.factors[i]].count;
    for (int c = 0; c < combinations; ++c) {
      // guard: twice
      int rest = c, exponent = -lowest_ + magnitude_exponent, words = 1;
      bool negative = weight < 0;
      // guard: product-room
      std::uint32_t product[2 * Product::most_factors + 1] = {1};
      for (int i = 0; i < of.count; ++i) {
        components_view const components = numbers_[of.factors[i]];
        dyadic const f = components[rest % components.count];
        rest /= components.count;
        exponent += f.exponent;
        // guard: sign
        negative = negative != (f.mantissa < 0);
        words = multiply(product, words, f.magnitude());
      }
      add_shifted(product, words, exponent, negative);
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
      // guard: product-carry
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
  COLLIDE_HD void add_shifted(std::uint32_t const* x, int words, int exponent, bool negative) {
    int const first = exponent / 32 - begin_, shift = exponent % 32;
    // guard: first-digit
    if (first >= window_digits || first + words < 0) return;
    std::uint32_t below = 0;
    // guard: last-digit
    for (int i = 0; i <= words; ++i) {
      std::uint32_t const word = i < words ? x[i] : 0;
      auto const digit = static_cast<std::uint32_t>((std::uint64_t{word} << 32 | below) >> (32 - shift));
      below = word;
      // guard: window
      if (first + i >= 0 && first + i < window_digits) digits_[first + i] += negative ? -std::int64_t{digit} : digit;
    }
  }
};

}  // namespace collide::detail
