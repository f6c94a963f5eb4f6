/// \file
/// The exact predicate for a sphere and a triangle: floating-point filters of increasing precision, then integers. Each
/// stage decides the pairs that its error bound allows, and leaves the others to the next one.
#pragma once

#include <type_traits>

#include <collide/detail/predicates/exact.hpp>
#include <collide/detail/predicates/filter.hpp>
#include <collide/detail/predicates/fixed_width.hpp>

namespace collide::detail {

/// The stage that decided a pair.
enum class stage { box, single_certificate, double_certificate, integers };

/// A decided pair, and the stage that decided it.
struct decision {
  bool hit;
  stage by;
};

/// Result of a filter, which may be uncertain, and the stage that gave it.
struct attempted {
  detail::verdict verdict;
  stage by;
};

/// The stages after the first filter, out of line and once for all scalars: floats are widened.
COLLIDE_HD_NOINLINE inline decision decide_closely(triangle<double> const& t, sphere<double> const& s) {
  if (!valid_radius(s.radius) || !finite(s.centre) || !finite(t)) return {false, stage::integers};
  if (infinite(s.radius)) return {true, stage::integers};
  local_triangle<double> l = relative<double>(t, s);
  double size;
  if (brought_to_size<double>(l, size)) {
    verdict const v = certify(l, size);
    if (v != verdict::unsure) return {v == verdict::hit, stage::double_certificate};
  }
  fixed_triangle const fixed(t, s);
  return {fixed.holds() ? fixed.in_reach() : in_reach_exactly(t, s), stage::integers};
}

template <class S>
COLLIDE_HD_NOINLINE decision decide_closely(triangle<S> const& t, sphere<S> const& s) {
  return decide_closely(widened(t), widened(s));
}

/// False if the triangle's box is farther away than the radius.
template <class S>
COLLIDE_HD_INLINE bool box_is_near(local_triangle<S> const& l) {
  return box_in_reach(l, larger(l.radius, format<S>::unflushed));
}

/// The box test and the filter in float. What they leave `unsure` is for `finish`.
template <class S>
COLLIDE_HD_INLINE attempted attempt(triangle<S> const& t, sphere<S> const& s) {
  local_triangle<S> l = relative<S>(t, s);
  if (!box_is_near(l)) return {verdict::miss, stage::box};
  S size;
  if (!brought_to_size<S>(l, size)) return {verdict::unsure, stage::single_certificate};
  return {certify(rounded<float>(l), static_cast<float>(size)), stage::single_certificate};
}

/// `attempt` without branches, so that a compiler makes vector code of a loop over several pairs. Pairs whose
/// coordinates would have to be rescaled are also left uncertain.
template <class S>
COLLIDE_HD_INLINE verdict attempt_straight(triangle<S> const& t, sphere<S> const& s) {
  using bounds = certificate_bounds<float>;
  local_triangle<S> const l = relative<S>(t, s);
  bool const near = box_is_near(l);
  S const size = size_of(l);
  bool const sized = (size >= S(bounds::smallest)) & (size <= S(bounds::largest));
  int const sure = static_cast<int>(certify<true>(rounded<float>(l), static_cast<float>(size)));
  int const then = (sure & -static_cast<int>(sized)) | static_cast<int>(!sized) << 1;
  return static_cast<verdict>(then & -static_cast<int>(near));
}

/// The stages after the first filter, for any pair.
template <class S>
COLLIDE_HD_INLINE decision finish(triangle<S> const& t, sphere<S> const& s) {
  triangle<S> const far_triangle = t;  // copies, so that the call does not force the originals into memory
  sphere<S> const far_sphere = s;
  return decide_closely(far_triangle, far_sphere);
}

/// True if sphere and triangle touch, in real arithmetic on the numbers as given.
template <class S>
COLLIDE_HD_INLINE decision decide(triangle<S> const& t, sphere<S> const& s) {
  attempted const quick = attempt(t, s);
  if (quick.verdict != verdict::unsure) return {quick.verdict == verdict::hit, quick.by};
  return finish(t, s);
}

/// A filtered predicate: true for narrow phases with a fast test that may be uncertain, and a slow one for those pairs.
/// A specialisation has static members `attempt(triangle, sphere)`, which returns a `verdict`, and
/// `finish(triangle, sphere)`, which returns bool. On the device `attempt` must give one result wherever it is inlined.
/// A class that derives from such a narrow phase is not filtered itself: it may have another `intersects`.
template <class NarrowPhase>
struct in_stages : std::false_type {};

}  // namespace collide::detail
