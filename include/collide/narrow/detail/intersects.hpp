/// \file
/// The exact predicate for a sphere and a triangle: floating-point filters of increasing precision, then integers. Each
/// stage decides the pairs that its error bound allows, and leaves the others to the next one.
#pragma once

#include <type_traits>

#include <collide/exact/detail/predicates/exact.hpp>
#include <collide/exact/detail/predicates/filter.hpp>
#include <collide/exact/detail/predicates/fixed_width.hpp>

namespace collide::detail {

enum class stage { box, single_filter, double_filter, exact_integers };

struct decision {
  bool hit;
  stage decided_by;
};

/// Result of a filter, which may be uncertain, and the stage that gave it.
struct filter_result {
  detail::verdict verdict;
  stage decided_by;
};

/// The stages after the first filter, out of line and once for all scalars: floats are widened.
COLLIDE_HD_NOINLINE inline decision intersects_exact_slow(triangle<double> const& t, sphere<double> const& s) {
  // guard: bad-radius, bad-centre, bad-corner
  if (!is_valid_radius(s.radius) || !is_finite(s.centre) || !is_finite(t)) return {false, stage::exact_integers};
  // guard: infinite-radius
  if (is_infinite(s.radius)) return {true, stage::exact_integers};
  local_triangle<double> l = to_local<double>(t, s);
  double size;
  // guard: size-in-double
  if (rescale_to_filter_range<double>(l, size)) {
    verdict const v = filtered_test(l, size);
    if (v != verdict::uncertain) return {v == verdict::hit, stage::double_filter};
  }
  fixed_width_predicate const fixed(t, s);
  return {fixed.fits() ? fixed.intersects() : intersects_in_integers(t, s), stage::exact_integers};
}

template <class S>
COLLIDE_HD_NOINLINE decision intersects_exact_slow(triangle<S> const& t, sphere<S> const& s) {
  return intersects_exact_slow(widened(t), widened(s));
}

/// False if the triangle's box is farther away than the radius.
template <class S>
COLLIDE_HD_INLINE bool box_is_near(local_triangle<S> const& l) {
  // guard: box
  return aabb_within(l, max(l.radius, ieee_traits<S>::min_sum_under_ftz));
}

/// The box test and the filter in float. What they leave `uncertain` is for `resolve_exact`.
template <class S>
COLLIDE_HD_INLINE filter_result filter_exact(triangle<S> const& t, sphere<S> const& s) {
  local_triangle<S> l = to_local<S>(t, s);
  if (!box_is_near(l)) return {verdict::miss, stage::box};
  S size;
  // guard: size-in-float
  if (!rescale_to_filter_range<S>(l, size)) return {verdict::uncertain, stage::single_filter};
  return {filtered_test(narrow_to<float>(l), static_cast<float>(size)), stage::single_filter};
}

/// `filter_exact` without branches, so that a compiler makes vector code of a loop over several pairs. All are scaled
/// by `scale`, a power of two of at most 2^50; those that are too large or small then are `out_of_range`.
template <class S>
COLLIDE_HD_INLINE verdict filter_branchless(triangle<S> const& t, sphere<S> const& s, S scale = S(1)) {
  using bounds = filter_bounds<float>;
  local_triangle<S> const unscaled = to_local<S>(t, s), l = scaled(unscaled, scale);
  bool const near = box_is_near(unscaled);
  S const size = max_norm(l);
  bool const sized = (size >= S(bounds::smallest)) & (size <= S(bounds::largest));
  int const sure = static_cast<int>(filtered_test<true>(narrow_to<float>(l), static_cast<float>(size)));
  int const then = (sure & -static_cast<int>(sized)) | static_cast<int>(!sized) * 3;
  return static_cast<verdict>(then & -static_cast<int>(near));
}

/// The stages after the first filter, for any pair.
template <class S>
COLLIDE_HD_INLINE decision resolve_exact(triangle<S> const& t, sphere<S> const& s) {
  triangle<S> const far_triangle = t;  // copies, so that the call does not force the originals into memory
  sphere<S> const far_sphere = s;
  return intersects_exact_slow(far_triangle, far_sphere);
}

/// True if sphere and triangle touch, in real arithmetic on the numbers as given.
template <class S>
COLLIDE_HD_INLINE decision intersects_exact(triangle<S> const& t, sphere<S> const& s) {
  filter_result const quick = filter_exact(t, s);
  if (quick.verdict != verdict::uncertain) return {quick.verdict == verdict::hit, quick.decided_by};
  return resolve_exact(t, s);
}

/// A filtered predicate: true for narrow phases with a fast test that may be uncertain, and a slow one for those pairs.
/// A specialisation has static members `filter(triangle, sphere)`, which returns a `verdict`, and
/// `resolve(triangle, sphere)`, which returns bool. On the device `filter_exact` must give one result wherever it is
/// inlined. A class that derives from such a narrow phase is not filtered itself: it may have another `intersects`.
template <class NarrowPhase>
struct filtered_predicate : std::false_type {};

/// The filtered predicate of a narrow phase that decides as `intersects_exact` does.
struct exact_predicate : std::true_type {
  template <class S>
  static COLLIDE_HD_INLINE verdict filter(triangle<S> const& t, sphere<S> const& s) {
    return filter_exact(t, s).verdict;
  }
  template <class S>
  static COLLIDE_HD_INLINE verdict filter_branchless(triangle<S> const& t, sphere<S> const& s, S scale = S(1)) {
    return detail::filter_branchless(t, s, scale);
  }
  template <class S>
  static COLLIDE_HD_INLINE bool resolve(triangle<S> const& t, sphere<S> const& s) {
    return resolve_exact(t, s).hit;
  }
};

/// Tells if a sphere touches a triangle, where the narrow phase is quick to tell. `uncertain` is left to `resolve`,
/// which takes long: where threads run together, as few of them as possible should go through it.
template <class NarrowPhase, class S, class Sphere>
COLLIDE_HD_INLINE verdict filter(triangle<S> const& t, Sphere const& s) {
  if constexpr (filtered_predicate<NarrowPhase>::value) {
    return filtered_predicate<NarrowPhase>::filter(t, s);
  } else {
    return NarrowPhase::intersects(t, s) ? verdict::hit : verdict::miss;
  }
}

/// True if a sphere touches a triangle of which `filter` is unsure.
template <class NarrowPhase, class S, class Sphere>
COLLIDE_HD_INLINE bool resolve([[maybe_unused]] triangle<S> const& t, [[maybe_unused]] Sphere const& s) {
  if constexpr (filtered_predicate<NarrowPhase>::value) {
    return filtered_predicate<NarrowPhase>::resolve(t, s);
  } else {
    return false;  // it never is
  }
}

}  // namespace collide::detail
