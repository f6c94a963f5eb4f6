/// \file
/// The contiguous memory ranges that a view of spheres reads: what has to be copied to read it elsewhere.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

namespace collide::detail {

/// The memory that a view of spheres reads, as few contiguous ranges: one if the centres are packed or the spheres are
/// quadruples, and one more for radii in an array of their own, three if the coordinates are. Arrays of one stride that
/// are interleaved form one range. It is copied with the gaps between its elements: the copy has the strides of the
/// original.
template <class Spheres>
class contiguous_ranges {
  using S = typename Spheres::scalar;

 public:
  explicit contiguous_ranges(Spheres const& spheres) : spheres_{spheres} {
    spheres_.for_each_array([this](S const* array, std::size_t stride) { add(array, stride); });
    for (std::size_t k = 0; k < count_; ++k) {
      ranges_[k].begin = size_;
      size_ += (length(ranges_[k]) + alignment - 1) / alignment * alignment;
    }
  }

  /// Number of elements of all copies, each range at a multiple of 64 elements.
  std::size_t size() const { return size_; }

  /// Calls copy(to, from, n) for each range; returns a view of the copies.
  template <class Copy>
  Spheres copy(S* to, Copy const& copy) const {
    for (std::size_t k = 0; k < count_; ++k) copy(to + ranges_[k].begin, ranges_[k].from, length(ranges_[k]));
    Spheres copied = spheres_;
    copied.for_each_array([&](S const*& array, std::size_t stride) {
      auto const has_it = [&](range const& p) {
        return p.stride == stride && !std::less<>{}(array, p.from) && std::less<>{}(array, p.from + p.width);
      };
      range const& p = *std::find_if(ranges_, ranges_ + count_, has_it);
      array = to + p.begin + (array - p.from);
    });
    return copied;
  }

 private:
  static constexpr std::size_t max_ranges = 7;  ///< three coordinates, a radius and a displacement
  static constexpr std::size_t alignment = 64;

  /// `width` elements from `from` on, and again after every `stride`.
  struct range {
    S const* from;
    std::size_t width, stride;
    std::size_t begin;  ///< of the copy
  };

  void add(S const* array, std::size_t stride) {
    for (std::size_t k = 0; k < count_; ++k) {
      range& p = ranges_[k];
      S const* const from = std::min(p.from, array, std::less<>{});
      S const* const end = std::max(p.from + p.width, array + 1, std::less<>{});
      auto const width = static_cast<std::size_t>(end - from);
      if (p.stride != stride || width > stride) continue;
      p.from = from;
      p.width = width;
      return;
    }
    ranges_[count_++] = {array, 1, stride, 0};
  }

  std::size_t length(range const& p) const {
    return spheres_.size() == 0 ? 0 : (spheres_.size() - 1) * p.stride + p.width;
  }

  Spheres spheres_;
  range ranges_[max_ranges] = {};
  std::size_t count_ = 0;
  std::size_t size_ = 0;
};

}  // namespace collide::detail
