/// \file
/// Precision policies: how sure a verdict must be, and so what arithmetic a narrow phase uses.
#pragma once

#include <type_traits>

namespace collide {

/// The test as textbooks have it: float, in the coordinates of the world, no care taken. Verdicts go wrong near
/// contact, for slivers and degenerate triangles, and the farther from the origin the more; they may depend on the
/// compiler's flags. It is there to be compared with.
struct baseline {
  using scalar = float;
};

/// Arithmetic in float, in coordinates local to the sphere. Verdicts within a few units in the last place of contact
/// may be wrong.
struct single_precision {
  using scalar = float;
};

/// Arithmetic in double, in coordinates local to the sphere. Verdicts within a few units in the last place (of double)
/// of contact may be wrong.
struct double_precision {
  using scalar = double;
};

/// No verdict is wrong: each equals that of exact real arithmetic on the coordinates as given, whatever they are. A
/// verdict is certified in float where an error bound allows it, else in double, else computed in integers.
struct exact {
  using scalar = float;  ///< of the first attempt
};

namespace detail {

template <class P, class = void>
struct is_precision : std::false_type {};
template <class P>
struct is_precision<P, std::void_t<typename P::scalar>> : std::is_floating_point<typename P::scalar> {};

}  // namespace detail
}  // namespace collide
