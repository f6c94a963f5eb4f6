/// \file
/// Polygons into triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace io {

/// Cuts one polygon into exactly size - 2 triangles, whatever its shape: a quadrangle along its shorter diagonal that
/// lies inside (as tinyobjloader does, which does not look whether it lies inside), a convex polygon into a fan around
/// its first corner, any other by cutting ears. What tinyobjloader's own triangulation loses or turns over with concave
/// and degenerate polygons stays.
template <class S>
class polygon_cutter {
  using point = std::array<double, 2>;

 public:
  /// Cuts the polygon of `size` >= 3 corners, which number vertices of three coordinates each; appends three vertex
  /// numbers per triangle to `out`.
  void cut(S const* vertices, std::uint32_t const* corners, std::size_t size, std::vector<std::uint32_t>& out) {
    corners_ = corners;
    out_ = &out;
    if (size == 3) return add(0, 1, 2);
    flatten(vertices, size);
    if (size == 4) return cut_quadrangle(vertices);
    rest_.resize(size);
    for (std::size_t i = 0; i < size; ++i) rest_[i] = i;
    if (!convex()) {
      for (int without = 0; rest_.size() > 3 && without < most_without_ear;) without += cut_ear() ? 0 : 1;
    }
    for (std::size_t i = 1; i + 1 < rest_.size(); ++i) add(rest_[0], rest_[i], rest_[i + 1]);
  }

 private:
  void add(std::size_t a, std::size_t b, std::size_t c) {
    out_->insert(out_->end(), {corners_[a], corners_[b], corners_[c]});
  }

  /// Projects the polygon along the axis that its normal is nearest to, such that it runs counter-clockwise.
  void flatten(S const* vertices, std::size_t size) {
    auto const at = [&](std::size_t i, std::size_t k) {
      return static_cast<double>(vertices[3 * std::size_t{corners_[i]} + k]);
    };
    double normal[3] = {};
    for (std::size_t i = 0; i < size; ++i) {
      auto const j = (i + 1) % size;
      for (std::size_t k = 0; k < 3; ++k) {
        auto const u = (k + 1) % 3, v = (k + 2) % 3;
        normal[k] += (at(i, u) - at(0, u)) * (at(j, v) - at(0, v)) - (at(i, v) - at(0, v)) * (at(j, u) - at(0, u));
      }
    }
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
    }
    auto const u = normal[axis] < 0 ? (axis + 2) % 3 : (axis + 1) % 3;
    auto const v = 3 - axis - u;
    flat_.resize(size);
    for (std::size_t i = 0; i < size; ++i) flat_[i] = {at(i, u) - at(0, u), at(i, v) - at(0, v)};
  }

  /// Twice the signed area of a flat triangle.
  double area(std::size_t a, std::size_t b, std::size_t c) const {
    auto const &p = flat_[a], &q = flat_[b], &r = flat_[c];
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
  }

  void cut_quadrangle(S const* vertices) {
    // In float, whatever S is: the ids of triangles do not depend on the scalar type.
    auto const length = [&](std::size_t a, std::size_t b) {
      float sum = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        float const d = static_cast<float>(vertices[3 * std::size_t{corners_[b]} + k]) -
                        static_cast<float>(vertices[3 * std::size_t{corners_[a]} + k]);
        sum += d * d;
      }
      return sum;
    };
    bool const inside_02 = area(0, 1, 2) >= 0 && area(0, 2, 3) >= 0;
    bool const inside_13 = area(0, 1, 3) >= 0 && area(1, 2, 3) >= 0;
    if (inside_02 && (!inside_13 || length(0, 2) < length(1, 3))) {
      add(0, 1, 2);
      add(0, 2, 3);
    } else {
      add(0, 1, 3);
      add(1, 2, 3);
    }
  }

  /// True if no corner turns right.
  bool convex() const {
    for (std::size_t i = 0; i < rest_.size(); ++i) {
      if (area(i, (i + 1) % rest_.size(), (i + 2) % rest_.size()) < 0) return false;
    }
    return true;
  }

  /// A polygon that has no ear so many times crosses itself all over: what is left becomes a fan, as looking for ears
  /// would take a time that is cubic in the number of corners.
  static constexpr int most_without_ear = 16;

  /// Cuts off the first ear of the rest; or, where a polygon that crosses itself has none, its second corner, and
  /// returns false.
  bool cut_ear() {
    auto const n = rest_.size();
    std::size_t middle = 1;
    bool found = false;
    for (std::size_t i = 0; i < n && !found; ++i) {
      middle = (i + 1) % n;
      found = ear(rest_[i], rest_[middle], rest_[(i + 2) % n]);
    }
    if (!found) middle = 1;
    add(rest_[(middle + n - 1) % n], rest_[middle], rest_[(middle + 1) % n]);
    rest_.erase(rest_.begin() + static_cast<std::ptrdiff_t>(middle));
    return found;
  }

  /// True if corner b turns left and no other corner lies in the triangle that it makes with its neighbours.
  bool ear(std::size_t a, std::size_t b, std::size_t c) const {
    if (area(a, b, c) <= 0) return false;
    return std::none_of(rest_.begin(), rest_.end(), [&](std::size_t p) {
      bool const corner = flat_[p] == flat_[a] || flat_[p] == flat_[b] || flat_[p] == flat_[c];
      return !corner && area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0;
    });
  }

  std::uint32_t const* corners_ = nullptr;
  std::vector<std::uint32_t>* out_ = nullptr;
  std::vector<point> flat_;
  std::vector<std::size_t> rest_;
};

}  // namespace io
