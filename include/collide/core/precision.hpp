/// \file
/// Precision policies: how sure a verdict and how accurate a contact must be, and so what arithmetic a narrow phase
/// uses.
#pragma once

#include <type_traits>

namespace collide {

/// The textbook test: float, in world coordinates, without error analysis. Results are wrong near contact, for slivers
/// and degenerate triangles, and more often with the distance from the origin; they may depend on compiler flags. A
/// baseline for comparisons, not for use.
struct baseline {
  using scalar = float;  ///< of the arithmetic
};

/// Arithmetic in float, in coordinates local to the sphere. Results may be wrong next to contact; tests find none wrong
/// where distance and radius differ by more than 2^-16 of the larger of the radius and the farthest coordinate of the
/// triangle as seen from the centre. Distances of contacts are within 2^-13 of the triangle's size as seen from there.
struct single_precision {
  using scalar = float;  ///< of the arithmetic
};

/// Arithmetic in double, in coordinates local to the sphere. Results may be wrong next to contact, far more seldom than
/// those of `single_precision`. Distances of contacts are within 2^-42 of the triangle's size as seen from the sphere's
/// centre.
struct double_precision {
  using scalar = double;  ///< of the arithmetic
};

/// Exact predicates: every result equals that of real arithmetic on the coordinates as given. A floating-point filter
/// in float decides nearly all pairs, one in double most of the rest, and integers what both leave uncertain (J. R.
/// Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997).
struct exact {
  using scalar = float;  ///< of the first filter
};

namespace detail {

template <class P, class = void>
struct is_precision : std::false_type {};
template <class P>
struct is_precision<P, std::void_t<typename P::scalar>> : std::is_floating_point<typename P::scalar> {};

}  // namespace detail
}  // namespace collide
