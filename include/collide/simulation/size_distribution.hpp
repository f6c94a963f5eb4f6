/// \file
/// Distributions of the radii of spheres.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/effects/effect.hpp>
#include <collide/exact/detail/numeric/elementary.hpp>

namespace collide {

/// How many spheres have which radii: up to 64 classes, in each of which radii are equally frequent. All lengths are
/// above 0 and finite; each function throws `error` if one is not, or numbers do not rise.
class size_distribution {
 public:
  /// All have the same radius.
  static size_distribution one(double radius) { return uniform(radius, radius); }
  /// All radii from `min_radius` to `max_radius` are equally frequent.
  static size_distribution uniform(double min_radius, double max_radius) {
    size_distribution d;
    d.begin(min_radius);
    d.add(max_radius, 1);
    d.end();
    return d;
  }
  /// The normal distribution, without what is outside of `min_radius` to `max_radius`.
  static size_distribution normal(double mean, double deviation, double min_radius, double max_radius) {
    detail::check_parameter(detail::is_positive(deviation), "size_distribution: a deviation is above 0, and finite");
    return of(std::max(min_radius, mean - 6 * deviation), std::min(max_radius, mean + 6 * deviation),
              [&](double r) { return std::erf((r - mean) / (deviation * std::sqrt(2.0))); });
  }
  /// Logarithms of radii have the normal distribution, about that of `median`, without what is outside.
  static size_distribution lognormal(double median, double log_deviation, double min_radius, double max_radius) {
    detail::check_parameter(detail::is_positive(log_deviation) && detail::is_positive(median),
                            "size_distribution: median and deviation are above 0, and finite");
    double const wide = std::exp(6 * log_deviation);
    return of(std::max(min_radius, median / wide), std::min(max_radius, median * wide),
              [&](double r) { return std::erf(std::log(r / median) / (log_deviation * std::sqrt(2.0))); });
  }
  /// A sieve curve: what part of the mass passes sieves of these openings, which are diameters; both rise, and the
  /// parts go from 0 to 1. Between two sieves the curve is straight. 2 to 33 sieves.
  static size_distribution sieve(std::vector<double> const& openings, std::vector<double> const& passing) {
    std::size_t const n = openings.size();
    detail::check_parameter(n >= 2 && n <= 33 && passing.size() == n && passing.front() == 0 && passing.back() == 1,
                            "size_distribution: a sieve curve has 2 to 33 sieves, and goes from 0 to 1");
    size_distribution d;
    d.begin(openings.front() / 2);
    int const parts = static_cast<int>(max_classes / (n - 1));
    for (std::size_t k = 1; k < n; ++k) {
      detail::check_parameter(passing[k] >= passing[k - 1], "size_distribution: what passes sieves does not fall");
      for (int j = 1; j <= parts; ++j) {
        double const from = d.radius_[d.classes_];
        d.add((openings[k - 1] + (openings[k] - openings[k - 1]) * j / parts) / 2, 0);
        d.below_[d.classes_] =
            d.below_[d.classes_ - 1] + (passing[k] - passing[k - 1]) / parts / cube(from, d.largest());
      }
    }
    d.end();
    return d;
  }

  double smallest() const { return radius_[0]; }        ///< the smallest radius
  double largest() const { return radius_[classes_]; }  ///< the largest radius
  /// The mean volume of a sphere.
  double mean_volume() const {
    double sum = 0;
    for (int k = 0; k < classes_; ++k) sum += (below_[k + 1] - below_[k]) * cube(radius_[k], radius_[k + 1]);
    return 4.18879020478639 * sum;
  }
  /// The radius that a part of all spheres, from 0 to 1, does not reach.
  double radius_below(double fraction) const {
    int k = 0;
    while (k + 1 < classes_ && below_[k + 1] <= fraction) ++k;
    double const width = below_[k + 1] - below_[k];
    return width > 0 ? radius_[k] + (radius_[k + 1] - radius_[k]) * ((fraction - below_[k]) / width) : radius_[k];
  }
  /// Radii of `n` spheres at random, always the same for a seed, which is below 2^24: of the places of a source, by
  /// `assign<radius>`.
  template <class S = double>
  std::vector<S> sample(std::size_t n, std::uint64_t seed) const {
    detail::check_parameter(seed < (1u << 24), "size_distribution: seed is below 2^24");
    std::vector<S> radii(n);
    for (std::size_t i = 0; i < n; ++i)
      radii[i] = static_cast<S>(radius_below(detail::random_fraction((seed << 40) + i)));
    return radii;
  }
  /// Spheres per time of a flow of mass per time: the `rate` of a source.
  double rate_of(double mass_flow, double density) const {
    detail::check_parameter(detail::is_amount(mass_flow) && detail::is_positive(density),
                            "size_distribution: a flow of mass is not negative, and density is above 0");
    return mass_flow / (density * mean_volume());
  }

 private:
  static constexpr int max_classes = 64;

  template <class F>
  static size_distribution of(double min_radius, double max_radius, F const& fraction) {
    size_distribution d;
    d.begin(min_radius);
    for (int k = 1; k <= max_classes; ++k) {
      double const from = d.largest(), to = min_radius + (max_radius - min_radius) * k / max_classes;
      d.add(to, fraction(to) - fraction(from));
    }
    d.end();
    return d;
  }
  /// The mean of the cubes of numbers from one to another.
  static double cube(double a, double b) { return (a + b) * (a * a + b * b) / 4; }

  void begin(double min_radius) {
    detail::check_parameter(detail::is_positive(min_radius), "size_distribution: radii are above 0, and finite");
    radius_[0] = min_radius;
  }
  void add(double to, double fraction) {
    detail::check_parameter(to >= largest() && detail::is_positive(to),
                            "size_distribution: radii rise, and are finite");
    ++classes_;
    radius_[classes_] = to;
    below_[classes_] = below_[classes_ - 1] + fraction;
  }
  void end() {
    double const sum = below_[classes_];
    detail::check_parameter(sum > 0, "size_distribution: no sphere is from the least to the largest radius");
    for (double& fraction : below_) fraction /= sum;
  }

  int classes_ = 0;
  double radius_[max_classes + 1] = {};
  double below_[max_classes + 1] = {};  ///< which part of the spheres is smaller
};

}  // namespace collide
