/// \file
/// Spheres that are dropped one after the other, and roll down the others until three hold them: W. M. Visscher and M.
/// Bolsterli, "Random packing of equal and unequal spheres in two and three dimensions", Nature 239, 1972. On the host,
/// in double, with nothing but correctly rounded operations.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <collide/core/geometry.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>

namespace collide::detail {

/// A bed in a box, whose sides are spheres a thousand times as large.
class dropped_spheres {
 public:
  using vector = vec3<double>;
  struct ball {
    vector centre = {0, 0, 0};
    double radius = 0;
  };

  /// Spheres of radii up to `largest`, most of them near `usual`.
  dropped_spheres(vector const& lower, vector const& upper, double usual, double largest)
      : lower_{lower}, upper_{upper}, largest_{largest}, cell_{2 * usual} {
    for (int k = 0; k < 2; ++k) count_[k] = std::max(1, static_cast<int>((upper[k] - lower[k]) / cell_));
    columns_.resize(std::size_t(count_[0]) * std::size_t(count_[1]));
    vector const middle = (lower + upper) / 2, half = (upper - lower) / 2;
    double const far = 1e3 * std::max({half.x(), half.y(), half.z()});
    for (int k = 0; k < 2; ++k) {
      for (double side : {-1.0, 1.0}) {
        ball wall{middle, far};
        double const across = half[1 - k] * half[1 - k] + half.z() * half.z();
        wall.centre[k] += side * (half[k] + far - across / (2 * far));  // so that its edges are in the box
        walls_.push_back(wall);
      }
    }
  }

  /// Finds where a sphere comes to rest that is dropped above a point. False if that is above the box, or it finds no
  /// rest.
  bool drop(double x, double y, double radius, vector& at) {
    radius_ = radius;
    at_ = {x, y, upper_.z() + 4 * largest_};
    support_count_ = 0;
    left_ = {};
    gathered_at_ = vector(0, 0, 1e300);
    for (int step = 0; step < 200; ++step) {
      if (!move()) {
        at = at_;
        return at.z() <= upper_.z() - radius && !overlaps();
      }
    }
    return false;
  }
  /// A sphere stays where it is.
  void add(vector const& at, double radius) {
    auto& column = columns_[place(cell_of(at.x(), 0), cell_of(at.y(), 1))];
    auto const above =
        std::find_if(column.rbegin(), column.rend(), [&](ball const& b) { return b.centre.z() <= at.z(); });
    column.insert(above.base(), {at, radius});
  }
  std::size_t columns() const { return columns_.size(); }
  double column_side(std::size_t column, int k, double fraction) const {
    std::size_t const n = std::size_t(count_[0]), number = k == 0 ? column % n : column / n;
    return lower_[k] + (upper_[k] - lower_[k]) * (static_cast<double>(number) + fraction) / count_[k];
  }

 private:
  /// A circle on which the sphere moves: centre + radius (cos first + sin second), from cos 1 on.
  struct arc {
    vector centre;
    double radius;
    vector first, second;
    vector at(double cosine, double sine) const { return centre + (first * cosine + second * sine) * radius; }
  };
  /// The first event on an arc.
  struct event {
    double cosine, sine;
    int left = -1;              ///< which of those that hold it does so no more
    ball const* hit = nullptr;  ///< that it touches from then on
    bool at_floor = false;
    bool falls = false;
  };

  int cell_of(double x, int k) const {
    int const c = static_cast<int>((x - lower_[k]) / (upper_[k] - lower_[k]) * count_[k]);
    return std::min(std::max(c, 0), count_[k] - 1);
  }
  std::size_t place(int i, int k) const { return std::size_t(k) * std::size_t(count_[0]) + std::size_t(i); }
  double reach(ball const& b) const { return b.radius + radius_; }
  vector normal(int i) const { return (at_ - supports_[i].centre) / reach(supports_[i]); }

  /// f(ball) for balls of the columns within a distance from a place, from the top down, until it says false.
  template <class F>
  void for_each_near(vector const& from, double distance, F const& f) const {
    int const i1 = cell_of(from.x() + distance, 0), k1 = cell_of(from.y() + distance, 1);
    for (int k = cell_of(from.y() - distance, 1); k <= k1; ++k)
      for (int i = cell_of(from.x() - distance, 0); i <= i1; ++i) {
        auto const& column = columns_[place(i, k)];
        for (auto b = column.rbegin(); b != column.rend() && f(*b);) ++b;
      }
  }
  /// Finds what the sphere may touch while it goes no farther than `range`.
  void gather() {
    double const range = 1.6 * radius_;
    if ((at_ - gathered_at_).squaredNorm() < 0.8 * 0.8 * radius_ * radius_) return;
    gathered_at_ = at_;
    near_ = walls_;
    for_each_near(at_, range + radius_ + largest_, [&](ball const& b) {
      double const reached = range + reach(b);
      if ((b.centre - at_).squaredNorm() < reached * reached) near_.push_back(b);
      return b.centre.z() > at_.z() - range - radius_ - largest_;
    });
  }
  bool overlaps() {
    gather();
    return std::any_of(near_.begin(), near_.end(), [&](ball const& b) {
      double const lowest = reach(b) * (1 - 1e-9) - 1e-9 * radius_;
      return b.radius <= largest_ && (b.centre - at_).squaredNorm() < lowest * lowest;
    });
  }

  /// Goes on to the next event; false at rest.
  bool move() {
    if (at_.z() <= lower_.z() + radius_ * (1 + 1e-12)) return false;
    vector n[3];
    bool falls = true;
    for (int i = 0; i < support_count_; ++i) {
      n[i] = normal(i);
      falls = falls && n[i].z() <= 1e-12;
    }
    if (falls) return fall();
    for (int i = 0; i < support_count_; ++i) {
      vector down = n[i] * n[i].z() - vector(0, 0, 1);
      if (n[i].z() <= 0 || !leads_away(down, n, i, i)) continue;
      if (down.squaredNorm() < 1e-20) down = vector(1, 0, 0) - n[i] * n[i].x();  // from the very top anywhere
      ball const on = supports_[i];
      return follow({on.centre, reach(on), n[i], down.normalized()}, i, i);
    }
    for (int i = 0; i < support_count_; ++i)
      for (int k = i + 1; k < support_count_; ++k) {
        vector along = cross(n[i], n[k]);
        if (along.squaredNorm() < 1e-20) continue;
        along = along.normalized();
        if (along.z() > 0) along = -along;
        if (along.z() > -1e-9 || !leads_away(along, n, i, k)) continue;
        vector const axis = (supports_[k].centre - supports_[i].centre).normalized();
        vector const middle = supports_[i].centre + axis * (at_ - supports_[i].centre).dot(axis), arm = at_ - middle;
        vector const first = arm.normalized();
        vector second = cross(axis, first);
        if (second.z() > 0) second = -second;
        return follow({middle, arm.norm(), first, second}, i, k);
      }
    return false;
  }
  bool leads_away(vector const& direction, vector const* n, int i, int k) const {
    for (int j = 0; j < support_count_; ++j)
      if (j != i && j != k && direction.dot(n[j]) < -1e-12) return false;
    return true;
  }

  /// Falls onto the highest below.
  bool fall() {
    double const limit = at_.z() + 1e-9 * radius_;
    double best = lower_.z() + radius_;
    ball found{};
    bool hits = false;
    auto const consider = [&](ball const& b) {
      double const dx = at_.x() - b.centre.x(), dy = at_.y() - b.centre.y(),
                   square = reach(b) * reach(b) - dx * dx - dy * dy;
      if (square <= 0) return;
      double const z = b.centre.z() + std::sqrt(square);
      if (z > best && z <= limit) best = z, found = b, hits = true;
    };
    for (ball const& wall : walls_) consider(wall);
    for_each_near(at_, radius_ + largest_, [&](ball const& b) {
      consider(b);
      return b.centre.z() + largest_ + radius_ > best;
    });
    at_.z() = std::min(best, at_.z());
    support_count_ = 0;
    if (hits) supports_[support_count_++] = found;
    return hits;
  }

  /// Rolls on one sphere (i == k) or on two.
  bool follow(arc const& path, int i, int k) {
    gather();
    double const farthest = 0.8 * radius_;
    double const lowest = 1 - farthest * farthest / (2 * path.radius * path.radius);
    event next{lowest, 0};
    if (lowest <= -1) next = {-1, 0};
    next.sine = std::sqrt(std::max(0.0, 1 - next.cosine * next.cosine));
    if (i == k) {
      double const nz = path.first.z(), level = std::sqrt(std::max(0.0, 1 - nz * nz));  // the equator
      if (level > next.cosine) next = {level, nz, i}, next.falls = true;
    } else {
      consider_leaving(path, i, k, next);
      consider_leaving(path, k, i, next);
    }
    consider_height(path, lower_.z() + radius_ - path.centre.z(), [&](event e) {
      e.at_floor = true;
      if (e.cosine > next.cosine) next = e;
    });
    for (ball const& b : near_) {
      if (same(b, supports_[i]) || same(b, supports_[k])) continue;
      bool const touches = is_support(b) || same(b, left_);  // and is being left
      vector const q = b.centre - path.centre;
      double const x = path.first.dot(q), y = path.second.dot(q), square = x * x + y * y;
      double const at = (path.radius * path.radius + q.squaredNorm() - reach(b) * reach(b)) / (2 * path.radius);
      if (at * at >= square) continue;
      event e{1, 0};
      if (touches || !(y > 0 && x >= at - 1e-10 * radius_)) {
        double const root = std::sqrt(square - at * at);
        e = {(at * x + y * root) / square, (at * y - x * root) / square};
        if (e.sine <= (touches ? 1e-6 : 0)) continue;
      }
      e.hit = &b;
      if (e.cosine > next.cosine) next = e;
    }
    at_ = path.at(next.cosine, next.sine);
    ball const one = supports_[i], other = supports_[k];
    left_ = next.left < 0 ? ball{} : supports_[next.left];
    support_count_ = 0;
    if (next.left != i) supports_[support_count_++] = one;
    if (k != i && next.left != k) supports_[support_count_++] = other;
    if (next.hit != nullptr) supports_[support_count_++] = *next.hit;
    return !next.at_floor;
  }
  bool is_support(ball const& b) const {
    return std::any_of(supports_, supports_ + support_count_, [&](ball const& h) { return same(b, h); });
  }
  static bool same(ball const& a, ball const& b) { return a.centre == b.centre; }

  /// f(event) where the sphere on its way down comes to a height above the centre of the arc.
  template <class F>
  static void consider_height(arc const& path, double height, F const& f) {
    double const z = height / path.radius, x = path.first.z(), y = path.second.z(), square = x * x + y * y;
    if (z * z >= square) return;
    double const root = std::sqrt(square - z * z);
    event const e{(z * x - y * root) / square, (z * y + x * root) / square};
    if (e.sine > 0) f(e);
  }
  /// Sphere i holds it no more where it would roll down sphere k alone away from that.
  void consider_leaving(arc const& path, int i, int k, event& next) const {
    double const ri = reach(supports_[i]), rk = reach(supports_[k]), g = normal(i).dot(normal(k));
    double const slope = 1 / ri - g / rk;
    if (slope <= 0) return;
    double const zi = path.centre.z() - supports_[i].centre.z(), zk = path.centre.z() - supports_[k].centre.z();
    consider_height(path, (g * zk / rk - zi / ri) / slope, [&](event e) {
      e.left = i;
      if (e.cosine > next.cosine) next = e;
    });
  }

  vector lower_, upper_;
  double largest_, cell_;
  int count_[2];
  std::vector<std::vector<ball>> columns_;  ///< of cells of the ground: spheres by rising height
  std::vector<ball> walls_, near_;
  double radius_ = 0;  ///< of the one that moves
  vector at_, gathered_at_;
  ball supports_[3], left_{};  ///< those that hold it, and the one that it has just left
  int support_count_ = 0;
};

}  // namespace collide::detail
