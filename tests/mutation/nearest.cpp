/// nearest FOLDER: fails at a row that has another nearest triangle, distance, feature or side than it should, or one
/// that depends on the order; subnormal numbers as they are and flushed to zero.
#include <cmath>
#include <limits>

#include <collide/narrow/detail/nearest_search.hpp>
#include <collide/sinks/contains.hpp>

#include "../flush_to_zero.hpp"
#include "rows.hpp"

namespace detail = collide::detail;

template <class S>
using row = tests::nearest_row<S>;

template <class S>
collide::nearest_triangle<S> search(row<S> const& r, bool forwards) {
  detail::nearest_search<S, collide::exact> found(r.point(), std::numeric_limits<S>::infinity());
  for (std::size_t k = 0; k < r.count; ++k) {
    std::size_t const i = forwards ? k : r.count - 1 - k;
    found.consider(r.triangle(i), static_cast<collide::id>(i));
  }
  return found.result();
}

template <class S>
bool measures_right(row<S> const& r) {
  auto const found = search(r, true);
  auto const expected = static_cast<S>(r.distance);
  bool const near = found.distance == expected || std::nextafter(found.distance, expected) == expected;
  unsigned const kind = found.feature == collide::feature::face   ? 1u
                        : found.feature == collide::feature::edge ? 2u << found.feature_index
                                                                  : 16u << found.feature_index;
  return near && (r.features & kind) != 0;
}

/// Every triangle compared with the nearest one, by every way that there is.
template <class S>
bool compares_right(row<S> const& r) {
  auto const nearest = static_cast<std::size_t>(r.nearest);
  auto const best = detail::widened(r.triangle(nearest));
  auto const point = detail::widened(r.point());
  for (std::size_t i = 0; i < r.count; ++i) {
    auto const other = detail::widened(r.triangle(i));
    int const in_stages = detail::compare_distances(best, other, point);
    if (in_stages != detail::compare_distances_in_integers(best, other, point)) return false;
    if (in_stages > 0 || (in_stages == 0 && i < nearest)) return false;
  }
  return true;
}

template <class S>
bool is_on_its_side(row<S> const& r) {
  if (r.side == r.none) return true;
  detail::ray_parity<S> parity(r.point());
  detail::ray_parity_in_lanes<S> in_lanes(r.point());
  for (std::size_t i = 0; i < r.count; ++i) {
    parity.consider(r.triangle(i));
    in_lanes.consider(r.triangle(i));
  }
  bool const is_inside = r.side == r.inside;
  return parity.inside() == is_inside && in_lanes.result().inside() == is_inside;
}

/// A distance of exactly the reach.
template <class S>
bool reaches_right(tests::row<S> const& r) {
  detail::nearest_search<S, collide::exact> found(r.sphere().centre, r.sphere().radius);
  found.consider(r.triangle(), 0);
  return (found.result().triangle == 0) == (r.hit != 0);
}

template <class S>
bool all_right(char const* folder, bool flushed) {
  auto const is_right = [&](row<S> const& r) {
    return search(r, true).triangle == static_cast<collide::id>(r.nearest) &&
           search(r, false).triangle == static_cast<collide::id>(r.nearest) && is_on_its_side(r) &&
           (flushed || (measures_right(r) && compares_right(r)));
  };
  return tests::all_right(tests::read_rows<S>(folder), reaches_right<S>) &&
         tests::all_right(tests::read_nearest_rows<S>(folder), is_right);
}

int main(int, char** argv) {
  bool right = all_right<float>(argv[1], false) && all_right<double>(argv[1], false);
  tests::flush_to_zero const flushes;
  right = right && all_right<float>(argv[1], true) && all_right<double>(argv[1], true);
  return !right;
}
