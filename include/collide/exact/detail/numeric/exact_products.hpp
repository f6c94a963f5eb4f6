/// \file
/// Sums of products of exact numbers, as lists of what is to be multiplied: what `exact_sum` evaluates.
///
/// A number is known by its place in a table (`exact_numbers`), a vector by the place of its first component. Each
/// function adds some products to a list; `weight` multiplies all of them.
#pragma once

#include <cstdint>

#include <collide/core/config.hpp>

namespace collide::detail {

/// A weight times at most `Factors` numbers.
template <std::size_t Factors>
struct weighted_product {
  static constexpr int most_factors = static_cast<int>(Factors);

  std::int8_t weight;  ///< -4, -2, -1, 1, 2 or 4
  std::uint8_t count;
  std::uint8_t factors[Factors];
};
using exact_product = weighted_product<6>;

class exact_products {
 public:
  template <class... Places>
  COLLIDE_HD void add(int weight, Places... factors) {
    static_assert(sizeof...(factors) <= exact_product::most_factors, "collide: no formula has that many factors");
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

}  // namespace collide::detail
