/// \file
/// Exact sums of products of floating-point numbers: their sign, and their value to nearly all digits of a double.
///
/// Any finite numbers, whatever their exponents: no rounding, overflow or underflow, and no memory but a window of a
/// few words that moves from the lowest digit of the sum to the highest. Integers only, so nothing depends on the
/// compiler's flags.
#pragma once

#include <cstdint>

#include <collide/core/config.hpp>
#include <collide/exact/detail/numeric/exact_number.hpp>

namespace collide::detail {

/// A weight times at most `Factors` numbers.
template <std::size_t Factors>
struct weighted_product {
  static constexpr int max_factors = static_cast<int>(Factors);

  std::int8_t weight;  ///< -4, -2, -1, 1, 2 or 4
  std::uint8_t count;
  std::uint8_t factors[Factors];
};
using exact_product = weighted_product<6>;

class exact_products {
 public:
  template <class... Places>
  COLLIDE_HD void add(int weight, Places... factors) {
    static_assert(sizeof...(factors) <= exact_product::max_factors, "collide: no formula has that many factors");
    products_[count_++] = {static_cast<std::int8_t>(weight),
                           static_cast<std::uint8_t>(sizeof...(factors)),
                           {static_cast<std::uint8_t>(factors)...}};
  }

  /// Multiplies all that has been added so far.
  COLLIDE_HD void multiply_by(int factor) {
    for (int i = 0; i < count_; ++i) products_[i].factors[products_[i].count++] = static_cast<std::uint8_t>(factor);
  }

  COLLIDE_HD exact_product const* begin() const { return products_; }
  COLLIDE_HD exact_product const* end() const { return products_ + count_; }

 private:
  exact_product products_[30];
  int count_ = 0;
};

/// a * b - c * d, where each is a sum of products: a list of products that are made as they are asked for.
class difference_of_products {
 public:
  COLLIDE_HD difference_of_products(exact_products const& a, exact_products const& b, exact_products const& c,
                                    exact_products const& d)
      : factors_{{a.begin(), a.end()}, {b.begin(), b.end()}, {c.begin(), c.end()}, {d.begin(), d.end()}} {}

  class iterator {
   public:
    COLLIDE_HD iterator(difference_of_products const* of, int side)
        : of_(of), side_(side), first_(of->factors_[side].begin), second_(of->factors_[side + 1].begin) {}

    COLLIDE_HD weighted_product<10> operator*() const {
      int const weight = first_->weight * (side_ == 0 ? second_->weight : -second_->weight);
      weighted_product<10> both{static_cast<std::int8_t>(weight), 0, {}};
      for (int i = 0; i < first_->count; ++i) both.factors[both.count++] = first_->factors[i];
      for (int i = 0; i < second_->count; ++i) both.factors[both.count++] = second_->factors[i];
      return both;
    }

    COLLIDE_HD iterator& operator++() {
      if (++second_ != of_->factors_[side_ + 1].end) return *this;
      second_ = of_->factors_[side_ + 1].begin;
      if (++first_ == of_->factors_[side_].end && side_ == 0) *this = iterator(of_, 2);
      return *this;
    }
    COLLIDE_HD bool operator!=(exact_product const* end) const { return first_ != end; }

   private:
    difference_of_products const* of_;
    int side_;  ///< 0 in a * b, 2 in c * d
    exact_product const *first_, *second_;
  };

  COLLIDE_HD iterator begin() const { return {this, 0}; }
  COLLIDE_HD exact_product const* end() const { return factors_[2].end; }

 private:
  struct range {
    exact_product const *begin, *end;
  };
  range factors_[4];  ///< none is empty
};

/// p.q
COLLIDE_HD inline void add_dot(exact_products& sum, int weight, int p, int q) {
  for (int k = 0; k < 3; ++k) sum.add(weight, p + k, q + k);
}

/// Component k of p x q.
COLLIDE_HD inline void add_cross(exact_products& sum, int weight, int k, int p, int q) {
  int const i = (k + 1) % 3, j = (k + 2) % 3;
  sum.add(weight, p + i, q + j);
  sum.add(-weight, p + j, q + i);
}

/// |p x q|^2
COLLIDE_HD_NOINLINE inline void add_cross_squared(exact_products& sum, int weight, int p, int q) {
  for (int k = 0; k < 3; ++k) {
    int const l = (k + 1) % 3;
    sum.add(weight, p + k, p + k, q + l, q + l);
    sum.add(weight, p + l, p + l, q + k, q + k);
    sum.add(-2 * weight, p + k, p + l, q + k, q + l);
  }
}

/// (v x e).(p x q)
COLLIDE_HD_NOINLINE inline void add_cross_dot_cross(exact_products& sum, int v, int e, int p, int q) {
  for (int k = 0; k < 3; ++k) {
    int const l = (k + 1) % 3;
    sum.add(1, v + k, e + l, p + k, q + l);
    sum.add(-1, v + k, e + l, p + l, q + k);
    sum.add(-1, v + l, e + k, p + k, q + l);
    sum.add(1, v + l, e + k, p + l, q + k);
  }
}

/// v . (p x q): six products, every other one negative.
COLLIDE_HD_NOINLINE inline void add_determinant(exact_products& sum, int weight, int v, int p, int q) {
  for (int s = 0; s < 6; ++s) {
    int const i = s / 2, j = (i + 1 + s % 2) % 3, k = 3 - i - j;
    sum.add(s % 2 == 0 ? weight : -weight, v + i, p + j, q + k);
  }
}

/// (v . (p x q))^2
COLLIDE_HD_NOINLINE inline void add_determinant_squared(exact_products& sum, int weight, int v, int p, int q) {
  for (int s = 0; s < 6; ++s) {
    int const i = s / 2, j = (i + 1 + s % 2) % 3, k = 3 - i - j;
    for (int t = 0; t <= s; ++t) {
      int const l = t / 2, m = (l + 1 + t % 2) % 3, n = 3 - l - m;
      int const sign = (s + t) % 2 == 0 ? 1 : -1, both = s == t ? 1 : 2;
      sum.add(sign * both * weight, v + i, p + j, q + k, v + l, p + m, q + n);
    }
  }
}

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
      std::uint32_t product[2 * Product::max_factors + 1] = {1};
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
