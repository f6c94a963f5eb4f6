/// \file
/// The shape of a clump: its spheres, volume, centre of mass and principal axes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <collide/effects/bodies.hpp>
#include <collide/effects/effect.hpp>

namespace collide {

/// Spheres that move as one, of one density.
struct clump_shape {
  std::vector<sphere<double>> spheres;  ///< in the frame of the principal axes, around the centre of mass
  double volume = 0;                    ///< of the union; its mass is that times the density
  double inertia[3] = {0, 0, 0};        ///< principal moments over the mass, length squared
  pose frame;                           ///< of that frame in the one in which the spheres were given

  /// Throws `error` unless there are spheres with radii above 0, a volume, and moments of a solid.
  void check() const {
    bool is_right = !spheres.empty() && detail::is_positive(volume);
    for (auto const& s : spheres)
      is_right = is_right && detail::is_positive(s.radius) && detail::is_finite(s.centre.squaredNorm());
    for (int k = 0; k < 3; ++k) {
      double const a = inertia[k], b = inertia[(k + 1) % 3], c = inertia[(k + 2) % 3];
      is_right = is_right && detail::is_positive(a) && a <= (b + c) * (1 + 1e-9);
    }
    detail::check_parameter(is_right,
                            "clump_shape: a clump has spheres of radii above 0 at finite places, a volume above 0, and "
                            "moments of inertia above 0 of which none is above the sum of the others");
  }
  /// The largest distance of a sphere's surface from the centre of mass.
  double reach() const {
    double farthest = 0;
    for (auto const& s : spheres) farthest = std::max(farthest, s.centre.norm() + s.radius);
    return farthest;
  }
};

namespace detail {

/// Integrals over a solid: of 1, of the coordinates, and of their products.
struct solid_moments {
  double volume = 0, first[3] = {0, 0, 0}, second[3][3] = {};

  void add(double dv, vec3<double> const& x) {
    volume += dv;
    for (int i = 0; i < 3; ++i) {
      first[i] += dv * x[i];
      for (int k = 0; k < 3; ++k) second[i][k] += dv * x[i] * x[k];
    }
  }
};

inline bool are_disjoint(std::vector<sphere<double>> const& spheres) {
  for (auto const& a : spheres)
    for (auto const& b : spheres)
      if (&a != &b && (a.centre - b.centre).norm() < a.radius + b.radius) return false;
  return true;
}

/// The integrals over spheres that do not overlap.
inline solid_moments moments_of_disjoint(std::vector<sphere<double>> const& spheres) {
  solid_moments m;
  for (auto const& s : spheres) {
    double const volume = sphere_mass(1.0, s.radius);
    m.add(volume, s.centre);
    for (int k = 0; k < 3; ++k) m.second[k][k] += volume * s.radius * s.radius / 5;
  }
  return m;
}

/// The integrals over a union of spheres: exact along each of `lines` times `lines` lines in the direction of x, by the
/// midpoint rule across.
inline solid_moments moments_of_union(std::vector<sphere<double>> const& spheres, int lines) {
  double low[3], high[3];
  for (int k = 1; k < 3; ++k) {
    low[k] = spheres[0].centre[k], high[k] = low[k];
    for (auto const& s : spheres) {
      low[k] = std::min(low[k], s.centre[k] - s.radius);
      high[k] = std::max(high[k], s.centre[k] + s.radius);
    }
  }
  double const dy = (high[1] - low[1]) / lines, dz = (high[2] - low[2]) / lines;
  solid_moments m;
  std::vector<std::pair<double, double>> pieces;
  for (int i = 0; i < lines; ++i) {
    for (int k = 0; k < lines; ++k) {
      double const y = low[1] + (i + 0.5) * dy, z = low[2] + (k + 0.5) * dz;
      pieces.clear();
      for (auto const& s : spheres) {
        double const u = y - s.centre[1], v = z - s.centre[2], squared = s.radius * s.radius - u * u - v * v;
        if (squared > 0) pieces.emplace_back(s.centre[0] - std::sqrt(squared), s.centre[0] + std::sqrt(squared));
      }
      std::sort(pieces.begin(), pieces.end());
      for (std::size_t n = 0; n < pieces.size();) {
        double const from = pieces[n].first;
        double to = pieces[n].second;
        for (++n; n < pieces.size() && pieces[n].first <= to; ++n) to = std::max(to, pieces[n].second);
        double const long_ = to - from, volume = long_ * dy * dz;
        m.add(volume, {(from + to) / 2, y, z});
        m.second[0][0] += volume * long_ * long_ / 12;
      }
    }
  }
  return m;
}

/// Turns a symmetric matrix until it is diagonal (C. G. J. Jacobi, 1846); the columns of `axes` are then the axes.
inline void find_axes(double (&m)[3][3], double (&axes)[3][3]) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) axes[i][k] = i == k;
  double const tolerance = 1e-10 * (m[0][0] + m[1][1] + m[2][2]);  // below it, integration errs
  for (int turn = 0; turn < 60; ++turn) {
    int const p = turn % 3, q = (p + 1) % 3;
    if (std::abs(m[p][q]) <= tolerance) continue;
    double const ratio = (m[q][q] - m[p][p]) / (2 * m[p][q]);
    double const t = (ratio < 0 ? -1 : 1) / (std::abs(ratio) + std::sqrt(ratio * ratio + 1));
    double const c = 1 / std::sqrt(t * t + 1), s = t * c;
    auto const mix = [&](double& a, double& b) {
      double const before = a;
      a = c * before - s * b;
      b = s * before + c * b;
    };
    for (int k = 0; k < 3; ++k) mix(m[k][p], m[k][q]);
    for (int k = 0; k < 3; ++k) mix(m[p][k], m[q][k]);
    for (int k = 0; k < 3; ++k) mix(axes[k][p], axes[k][q]);
  }
}

/// The unit quaternion of a rotation, of which the columns are the turned axes.
inline void set_rotation(double (&q)[4], double const (&r)[3][3]) {
  double const squares[4] = {1 + r[0][0] + r[1][1] + r[2][2], 1 + r[0][0] - r[1][1] - r[2][2],
                             1 - r[0][0] + r[1][1] - r[2][2], 1 - r[0][0] - r[1][1] + r[2][2]};
  int const largest = static_cast<int>(std::max_element(squares, squares + 4) - squares);
  double const twice = std::sqrt(squares[largest]), s = 0.5 / twice;
  q[largest] = twice / 2;
  for (int i = 0; i < 3; ++i) {
    int const j = (i + 1) % 3, k = (i + 2) % 3;
    double const odd = (r[k][j] - r[j][k]) * s;
    if (largest == 0) q[i + 1] = odd;
    if (largest == i + 1) {
      q[0] = odd;
      q[j + 1] = (r[i][j] + r[j][i]) * s;
      q[k + 1] = (r[i][k] + r[k][i]) * s;
    }
  }
}

}  // namespace detail

/// The shape of spheres that are given in any frame. Volume and moments are those of the union, each point once: exact
/// where no two overlap; else by integration along 2,000 x 2,000 lines, exact along each, which takes 0.2 s: the same
/// bits on each machine of a kind, off by less than 1e-6. Throws `error` if there are none, or radii are not above 0.
inline clump_shape shape_of_clump(std::vector<sphere<double>> const& spheres) {
  for (auto const& s : spheres)
    detail::check_parameter(detail::is_positive(s.radius), "clump_shape: radii are above 0");
  detail::check_parameter(!spheres.empty(), "clump_shape: a clump has spheres");
  detail::solid_moments const all =
      detail::are_disjoint(spheres) ? detail::moments_of_disjoint(spheres) : detail::moments_of_union(spheres, 2000);
  vec3<double> const centre = vec3<double>(all.first[0], all.first[1], all.first[2]) / all.volume;
  double spread[3][3], axes[3][3];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) spread[i][k] = all.second[i][k] / all.volume - centre[i] * centre[k];
  detail::find_axes(spread, axes);
  clump_shape made;
  made.volume = all.volume;
  for (int k = 0; k < 3; ++k) {
    made.inertia[k] = spread[(k + 1) % 3][(k + 1) % 3] + spread[(k + 2) % 3][(k + 2) % 3];
    made.frame.position[k] = centre[k];
  }
  detail::set_rotation(made.frame.rotation, axes);
  for (auto const& s : spheres) {
    vec3<double> const from = s.centre - centre;
    sphere<double> own{{0, 0, 0}, s.radius};
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) own.centre[i] += axes[k][i] * from[k];
    made.spheres.push_back(own);
  }
  return made;
}

}  // namespace collide
