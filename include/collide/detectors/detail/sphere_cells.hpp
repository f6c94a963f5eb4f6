/// \file
/// Spheres in the order of the cells of grids, a grid for each size, and which of them touch.
///
/// A sphere counts as of the size R = max(radius, 2^-24 of its largest coordinate, 2^-100). All with R of one binary
/// exponent are a level, and are in cells as wide as 2 R of the largest of them, and a little more: what touches a
/// sphere is at most one cell away from it in each level (C. Ericson, "Real-Time Collision Detection", 2005, 7.2). So
/// large spheres beside small ones do not make the cells of these wide, and a sphere is at most 2^23 cells from the
/// origin of its own level and of those above: cells are computed in double, and no rounding separates by more than one
/// what touches. Levels share one table, over which blocks of cells are spread by a hash function.
///
/// A sphere looks into its own level and those above it. So two of one level find each other, and of others only the
/// smaller one finds the larger.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/core/memory.hpp>
#include <collide/exact/detail/numeric/exact_sum.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>
#include <collide/simulation/detail/neighbours/spatial_hash.hpp>
#include <collide/spaces/detail/atomic.hpp>
#include <collide/spheres.hpp>

namespace collide::detail {

/// True if |a - b| <= r + s, of finite coordinates and valid finite radii: (a - b)^2 - (r + s)^2 as a sum of products
/// in integers.
COLLIDE_HD_NOINLINE inline bool spheres_touch_in_integers(sphere<double> const& a, sphere<double> const& b) {
  exact_memory<4 * 2, 4> memory;
  exact_numbers numbers = memory.table();
  exact_products sum;
  for (int k = 0; k < 3; ++k) {
    numbers.begin_number();
    numbers.add(decoded(a.centre[k]));
    numbers.subtract(decoded(b.centre[k]));
    sum.add(1, k, k);
  }
  numbers.begin_number();
  numbers.add(decoded(a.radius));
  numbers.add(decoded(b.radius));
  sum.add(-1, 3, 3);
  return exact_sum::sign_of(numbers, sum) <= 0;
}

/// True if two spheres with their surfaces have a point in common. Finite coordinates; valid radii, of which those that
/// are infinite reach everything. Seven sums and products in double decide nearly all: a sum of squares has a relative
/// error below 2^-50, and is off by less than 2^-140 where it is so small that something vanishes or is flushed to 0.
template <class S>
COLLIDE_HD_INLINE bool spheres_touch(sphere<S> const& a, sphere<S> const& b) {
  auto const wide = [](S x) { return static_cast<double>(x); };
  vec3<double> const between(wide(a.centre.x()) - wide(b.centre.x()), wide(a.centre.y()) - wide(b.centre.y()),
                             wide(a.centre.z()) - wide(b.centre.z()));
  double const reach = wide(a.radius) + wide(b.radius);
  double const distance_squared = dot(between, between), reach_squared = mul_rn(reach, reach);
  double const error = mul_rn(distance_squared + reach_squared, 0x1p-49) + 0x1p-140;
  if (distance_squared - reach_squared > error) return false;
  if (reach_squared - distance_squared > error) return true;
  if (is_infinite(a.radius) || is_infinite(b.radius)) return true;
  return spheres_touch_in_integers(widened(a), widened(b));
}

/// The number of a sphere's level, from 0, and its size; of what touches nothing the size is negative.
struct sphere_size {
  static constexpr int levels = 1126;  ///< exponents of doubles from 2^-100 on, and infinity

  double size = -1;

  template <class S>
  COLLIDE_HD_INLINE explicit sphere_size(sphere<S> const& s) {
    if (!is_valid_radius(s.radius) || !is_finite(s.centre)) return;
    double const far = static_cast<double>(max_component<S>(absolute(s.centre)));
    size = max(max(static_cast<double>(s.radius), mul_rn(far, 0x1p-24)), 0x1p-100);
  }

  COLLIDE_HD bool is_valid() const { return size > 0; }
  COLLIDE_HD std::uint32_t level() const {
    return static_cast<std::uint32_t>(to_bits(size) >> ieee_traits<double>::mantissa_bits) - (1023 - 100);
  }
};

struct sphere_level {
  std::uint32_t number;
  double inverse_width;  ///< of its cells
};

/// The spheres in the order of cells, for kernels.
template <class S>
struct sphere_cells {
  std::uint64_t* largest;  ///< size of each level, as bits; 0 if it has no spheres
  sphere_level* levels;    ///< those that have some, in any order
  std::uint32_t* counts;   ///< how many levels, and how many spheres there are in the order
  std::uint32_t mask;      ///< number of blocks of cells - 1
  std::uint32_t* ends;     ///< of the cell at place c: ends[c] .. ends[c + 1]
  id* numbers;             ///< of the spheres at the places of the order
  sphere<S>* spheres;

  using table = spatial_hash<double>;
  using cell = table::cell;

  COLLIDE_HD_INLINE static double inverse_width_of(std::uint64_t largest_size) {
    return div_rn(1.0, mul_rn(2 + 0x1p-18, from_bits<double>(largest_size)));
  }
  COLLIDE_HD_INLINE cell cell_of(double inverse_width, vec3<S> const& x) const {
    return table{inverse_width, mask}.of(static_cast<double>(x.x()), static_cast<double>(x.y()),
                                         static_cast<double>(x.z()));
  }
  COLLIDE_HD_INLINE std::uint32_t place_of(std::uint32_t level, cell c) const {
    return table{0, mask}.number({c.x, c.y, c.z + static_cast<std::int32_t>(level * 2654435u & 0xfffffeu)});
  }

  /// Calls f(place) for each sphere of the order that the one at place i touches and has to find.
  template <class F>
  COLLIDE_HD_INLINE void for_each_touching(std::uint32_t i, F const& f) const {
    sphere<S> const own = spheres[i];
    std::uint32_t const level = sphere_size(own).level(), count = counts[0];
    COLLIDE_NO_UNROLL
    for (std::uint32_t l = 0; l < count; ++l) {
      sphere_level const other = levels[l];
      if (other.number < level) continue;
      cell const here = cell_of(other.inverse_width, own.centre);
      COLLIDE_NO_UNROLL
      for (int row = 0; row < 9; ++row) {
        cell const from{here.x - 1, here.y + row % 3 - 1, here.z + row / 3 - 1};
        std::int32_t const together = min(3, 16 - (from.x & 15));  // those in the same block follow each other
        for_each_touching_in(i, own, other, from, together, f);
        if (together < 3) for_each_touching_in(i, own, other, {from.x + together, from.y, from.z}, 3 - together, f);
      }
    }
  }

 private:
  /// The part of `for_each_touching` in `n` cells of a block that follow each other from `first` on.
  template <class F>
  COLLIDE_HD_INLINE void for_each_touching_in(std::uint32_t i, sphere<S> const& own, sphere_level const& level,
                                              cell first, std::int32_t n, F const& f) const {
    std::uint32_t const place = place_of(level.number, first), end = ends[place + static_cast<std::uint32_t>(n)];
    COLLIDE_NO_UNROLL
    for (std::uint32_t k = ends[place]; k < end; ++k) {
      if (k != i && spheres_touch(own, spheres[k]) && is_in_row(k, level, first, n)) f(k);
    }
  }

  /// True if the sphere at place k is in one of `n` cells of a level, and not in others at their places of the table.
  COLLIDE_HD_INLINE bool is_in_row(std::uint32_t k, sphere_level const& level, cell first, std::int32_t n) const {
    if (sphere_size(spheres[k]).level() != level.number) return false;
    cell const c = cell_of(level.inverse_width, spheres[k].centre);
    return c.y == first.y && c.z == first.z && c.x >= first.x && c.x < first.x + n;
  }
};

/// Kernel functor of `for_each` over spheres: finds the largest of each level.
template <class S>
struct measure_levels {
  sphere_view<S> from;
  std::uint64_t* largest;

  COLLIDE_HD void operator()(std::size_t i) const {
    sphere_size const s(from[i]);
    if (!s.is_valid()) return;
    std::uint64_t* const largest_of_level = largest + s.level();
    if (load_relaxed(largest_of_level) < to_bits(s.size)) fetch_max(largest_of_level, to_bits(s.size));
  }
};

/// Kernel functor of `for_each` over levels: lists those that have spheres.
template <class S>
struct list_levels {
  sphere_cells<S> cells;

  COLLIDE_HD void operator()(std::size_t number) const {
    std::uint64_t const largest = cells.largest[number];
    if (largest == 0) return;
    cells.levels[fetch_add(cells.counts, 1u)] = {static_cast<std::uint32_t>(number), cells.inverse_width_of(largest)};
  }
};

/// Kernel functor of `for_each` over spheres: counts them into cells, or, once blocks have their share of the order,
/// puts them there.
template <class S, bool Fill>
struct order_spheres {
  sphere_view<S> from;
  sphere_cells<S> cells;

  COLLIDE_HD void operator()(std::size_t i) const {
    sphere<S> const own = from[i];
    sphere_size const size(own);
    if (!size.is_valid()) return;
    double const inverse_width = cells.inverse_width_of(cells.largest[size.level()]);
    std::uint32_t const place = cells.place_of(size.level(), cells.cell_of(inverse_width, own.centre));
    std::uint32_t const slot = fetch_add(cells.ends + place + 1, 1u);
    if (!Fill) return;
    cells.numbers[slot] = static_cast<id>(i);
    cells.spheres[slot] = own;
  }
};

template <class S>
class sphere_cell_lists {
  using table = spatial_hash<double>;

 public:
  /// Takes what up to `n` spheres need.
  void reserve(std::pmr::memory_resource* resource, std::size_t n) {
    largest_.reserve(resource, sphere_size::levels);
    levels_.reserve(resource, sphere_size::levels);
    counts_.reserve(resource, 2);
    ends_.reserve(resource, blocks_for(n) * table::stride);
    numbers_.reserve(resource, n);
    spheres_.reserve(resource, n);
  }

  /// Puts the work on the space's stream. O(n).
  template <class Space>
  sphere_cells<S> build(Space const& space, sphere_view<S> const& from) {
    std::size_t const n = from.size(), blocks = blocks_for(n);
    reserve(space.resource(), n);
    sphere_cells<S> const cells{
        largest_.data(), levels_.data(),  counts_.data(), static_cast<std::uint32_t>(blocks - 1),
        ends_.data(),    numbers_.data(), spheres_.data()};
    space.fill(cells.largest, 0, sphere_size::levels * sizeof *cells.largest);
    space.fill(cells.counts, 0, 2 * sizeof *cells.counts);
    space.fill(cells.ends, 0, blocks * table::stride * sizeof *cells.ends);
    space.for_each(n, measure_levels<S>{from, cells.largest});
    space.for_each(sphere_size::levels, list_levels<S>{cells});
    space.for_each(n, order_spheres<S, false>{from, cells});
    space.for_each(blocks, scan_cells{cells.ends, cells.counts + 1});
    space.for_each(n, order_spheres<S, true>{from, cells});
    return cells;
  }

 private:
  static std::size_t blocks_for(std::size_t n) { return table::blocks_for(n); }

  buffer<std::uint64_t> largest_;
  buffer<sphere_level> levels_;
  buffer<std::uint32_t> counts_, ends_;
  buffer<id> numbers_;
  buffer<sphere<S>> spheres_;
};

}  // namespace collide::detail
