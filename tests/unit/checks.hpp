/// Comparing answers of the library with each other and with the oracle.
#pragma once

#include <string>
#include <vector>

#include <collide/core/contact.hpp>

#include "type_erased_detector.hpp"

namespace tests {

/// How a scene is laid out, and how sure its verdicts are.
struct conditions {
  mesh_form mesh = mesh_form::indexed;
  sphere_form spheres = sphere_form::xyz;
  options policy;
  double band = 0;  ///< see oracle::expect; 0: every verdict of every precision must be exact
};

/// Runs every composition of `S` through every sink on the scene, and checks that
///   - the pairs are those of the oracle (with `exact` all of them, whatever the band), each once and in canonical
///   order
///     where that was asked for,
///   - no broad phase changes a verdict of the narrow phase,
///   - all sinks agree with each other,
///   - all compositions of one precision return the same bits,
///   - contacts are as exact as they promise.
/// Returns the pairs that the oracle allows.
template <class S>
std::vector<oracle::id_pair> check_all(scene<S> const& made, conditions const& how);

/// The same for one composition, without the comparison with others; for tests that prepare the subject in their own
/// way. Returns what it found, to be compared.
template <class S>
struct findings {
  std::vector<collide::pair> pairs;
  std::vector<collide::contact<S>> contacts;
  std::vector<collide::contact<S>> closest;
};
template <class S>
findings<S> check_sinks(subject<S>& detector, scene<S> const& made, oracle::expectation const& expected);

/// Checks only the pairs, in canonical order; returns them.
template <class S>
std::vector<collide::pair> check_pairs(subject<S>& detector, oracle::expectation const& expected);

/// Checks a contact against the exact closest point: distance and depth within 4 units in the last place, the point on
/// the triangle, the normal of length 1 and from there to the centre. `strict`: the feature must be exact, too.
template <class S>
void check_contact(collide::contact<S> const& c, oracle::triangle const& t, oracle::sphere const& s, bool strict);

/// Checks a contact of a precision other than `exact`: distance, depth and point within 2^11 roundings of the
/// triangle's size as seen from the centre, the normal of length 1.
template <class S>
void check_plain_contact(collide::contact<S> const& c, oracle::triangle const& t, oracle::sphere const& s,
                         double roundoff);

/// Bitwise equality of all members (padding apart).
template <class S>
bool same(collide::contact<S> const& a, collide::contact<S> const& b);
template <class S>
bool same(std::vector<collide::contact<S>> const& a, std::vector<collide::contact<S>> const& b);

}  // namespace tests
