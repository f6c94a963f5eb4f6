/// \file
/// Distributions of the radii of spheres.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/effects/effect.hpp>
#include <collide/exact/detail/numeric/random.hpp>

namespace collide {

/// How many spheres have which radii: up to 64 classes, in each of which radii are equally frequent. All lengths are
/// above 0 and finite; each function throws `error` if one is not, or numbers do not rise.
class size_distribution {
 public:
  /// All have the same radius.
  static size_distribution one(double radius) { return uniform(radius, radius); }
  /// All radii from `least` to `most` are equally frequent.
  static size_distribution uniform(double least, double most) {
    size_distribution d;
    d.begin(least);
    d.add(most, 1);
    d.end();
    return d;
  }
  /// The normal distribution, without what is outside of `least` to `most`.
  static size_distribution normal(double mean, double deviation, double least, double most) {
    detail::check_parameter(detail::is_positive(deviation), "size_distribution: a deviation is above 0, and finite");
    return of(least, most, [&](double r) { return std::erf((r - mean) / (deviation * std::sqrt(2.0))); });
  }
  /// Logarithms of radii have the normal distribution, about that of `median`, without what is outside.
  static size_distribution lognormal(double median, double log_deviation, double least, double most) {
    detail::check_parameter(detail::is_positive(log_deviation) && detail::is_positive(median),
                            "size_distribution: median and deviation are above 0, and finite");
    return of(least, most, [&](double r) { return std::erf(std::log(r / median) / (log_deviation * std::sqrt(2.0))); });
  }
  /// A sieve curve: what part of the mass passes sieves of these openings, which are diameters; both rise, and the
  /// parts go from 0 to 1. Between two sieves the curve is straight. 2 to 33 sieves.
  static size_distribution sieve(std::vector<double> const& openings, std::vector<double> const& passing) {
    std::size_t const n = openings.size();
    detail::check_parameter(n >= 2 && n <= 33 && passing.size() == n && passing.front() == 0 && passing.back() == 1,
                            "size_distribution: a sieve curve has 2 to 33 sieves, and goes from 0 to 1");
    size_distribution d;
    d.begin(openings.front() / 2);
    int const parts = static_cast<int>(most_classes / (n - 1));
    for (std::size_t k = 1; k < n; ++k) {
      detail::check_parameter(passing[k] >= passing[k - 1], "size_distribution: what passes sieves does not fall");
      for (int j = 1; j <= parts; ++j) {
        double const from = d.radius_[d.classes_];
        d.add((openings[k - 1] + (openings[k] - openings[k - 1]) * j / parts) / 2, 0);
        d.below_[d.classes_] = d.below_[d.classes_ - 1] + (passing[k] - passing[k - 1]) / parts / cube(from, d.most());
      }
    }
    d.end();
    return d;
  }

  double least() const { return radius_[0]; }        ///< the smallest radius
  double most() const { return radius_[classes_]; }  ///< the largest radius
  /// The mean volume of a sphere.
  double mean_volume() const {
    double sum = 0;
    for (int k = 0; k < classes_; ++k) sum += (below_[k + 1] - below_[k]) * cube(radius_[k], radius_[k + 1]);
    return 4.18879020478639 * sum;
  }
  /// The radius that a part of all spheres, from 0 to 1, does not reach.
  double radius_below(double part) const {
    int k = 0;
    while (k + 1 < classes_ && below_[k + 1] <= part) ++k;
    double const width = below_[k + 1] - below_[k];
    return width > 0 ? radius_[k] + (radius_[k + 1] - radius_[k]) * ((part - below_[k]) / width) : radius_[k];
  }
  /// Radii of `n` spheres at random, always the same for a seed: of the places of a source, by `assign<radius>`.
  template <class S = double>
  std::vector<S> sample(std::size_t n, std::uint64_t seed) const {
    std::vector<S> radii(n);
    for (std::size_t i = 0; i < n; ++i) radii[i] = static_cast<S>(radius_below(detail::random_part((seed << 40) + i)));
    return radii;
  }
  /// Spheres per time of a flow of mass per time: the `rate` of a source.
  double rate_of(double mass_flow, double density) const { return mass_flow / (density * mean_volume()); }

 private:
  static constexpr int most_classes = 64;

  template <class F>
  static size_distribution of(double least, double most, F const& part) {
    size_distribution d;
    d.begin(least);
    for (int k = 1; k <= most_classes; ++k) {
      double const from = d.most(), to = least + (most - least) * k / most_classes;
      d.add(to, part(to) - part(from));
    }
    d.end();
    return d;
  }
  /// The mean of the cubes of numbers from one to another.
  static double cube(double a, double b) { return (a + b) * (a * a + b * b) / 4; }

  void begin(double least) {
    detail::check_parameter(detail::is_positive(least), "size_distribution: radii are above 0, and finite");
    radius_[0] = least;
  }
  void add(double to, double part) {
    detail::check_parameter(to >= most() && detail::is_positive(to), "size_distribution: radii rise, and are finite");
    ++classes_;
    radius_[classes_] = to;
    below_[classes_] = below_[classes_ - 1] + part;
  }
  void end() {
    double const sum = below_[classes_];
    detail::check_parameter(sum > 0, "size_distribution: no sphere is from the least to the largest radius");
    for (double& part : below_) part /= sum;
  }

  int classes_ = 0;
  double radius_[most_classes + 1] = {};
  double below_[most_classes + 1] = {};  ///< which part of the spheres is smaller
};

}  // namespace collide
