/// \file
/// Precision policies: how sure a verdict must be, and so the type that a narrow phase computes in.
#pragma once

#include <type_traits>

namespace collide {

/// Arithmetic in float. Verdicts within a few units in the last place of contact may be wrong.
struct single_precision {
  using scalar = float;
};

/// Arithmetic in double. Verdicts within a few units in the last place (of double) of contact may be wrong.
struct double_precision {
  using scalar = double;
};

namespace detail {

template <class P, class = void>
struct is_precision : std::false_type {};
template <class P>
struct is_precision<P, std::void_t<typename P::scalar>> : std::is_floating_point<typename P::scalar> {};

}  // namespace detail
}  // namespace collide
