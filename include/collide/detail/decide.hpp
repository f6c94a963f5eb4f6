/// \file
/// The exact verdict, in stages: each decides what it is sure of, and leaves the rest to the next.
#pragma once

#include <collide/detail/certificate.hpp>
#include <collide/detail/exact_triangle.hpp>

namespace collide::detail {

/// What decided a verdict.
enum class stage { box, single_certificate, double_certificate, integers };

/// A verdict, and what decided it.
struct decision {
  bool hit;
  stage by;
};

/// A verdict that may be open.
struct attempted {
  detail::verdict verdict;
  stage by;
};

/// The later stages of `decide`.
template <class S>
COLLIDE_HD_NOINLINE decision decide_closely(triangle<S> const& t, sphere<S> const& s) {
  if (!valid_radius(s.radius) || !finite(s.centre) || !finite(t)) return {false, stage::integers};
  if (infinite(s.radius)) return {true, stage::integers};
  local_triangle<double> l = relative<double>(t, s);
  double size;
  if (brought_to_size<S>(l, size)) {
    verdict const v = certify(l, size);
    if (v != verdict::unsure) return {v == verdict::hit, stage::double_certificate};
  }
  return {exact_triangle<>(t, s).in_reach(), stage::integers};
}

/// The first stages: `unsure` is left to `decide_closely`.
template <class S>
COLLIDE_HD_INLINE attempted attempt(triangle<S> const& t, sphere<S> const& s) {
  local_triangle<S> l = relative<S>(t, s);
  if (!box_in_reach(l, larger(l.radius, format<S>::unflushed))) return {verdict::miss, stage::box};
  S size;
  if (!brought_to_size<S>(l, size)) return {verdict::unsure, stage::single_certificate};
  return {certify(rounded<float>(l), static_cast<float>(size)), stage::single_certificate};
}

/// Whether the closed ball touches the closed triangle, in exact real arithmetic on the numbers as they are.
template <class S>
COLLIDE_HD_INLINE decision decide(triangle<S> const& t, sphere<S> const& s) {
  attempted const quick = attempt(t, s);
  if (quick.verdict != verdict::unsure) return {quick.verdict == verdict::hit, quick.by};
  triangle<S> const far_triangle = t;  // copies, so that the call does not force the originals into memory
  sphere<S> const far_sphere = s;
  return decide_closely(far_triangle, far_sphere);
}

}  // namespace collide::detail
