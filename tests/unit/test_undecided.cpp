/// Pairs that a quick attempt leaves open: the list of them, and what happens when it is full.
#include <doctest/doctest.h>

#include "checks.hpp"

namespace {

/// Spheres that touch `layers` triangles each, all in the same place, at exactly their radius: no certificate decides.
template <class S>
tests::scene<S> touching_scene(int layers, int spheres) {
  tests::scene<S> made;
  for (int i = 0; i < layers; ++i) made.mesh.add({{0, 0, 0}, {64, 0, 0}, {0, 64, 0}});
  for (int i = 0; i < spheres; ++i) made.spheres.add({1.0 + i % 5, 1.0 + i % 7, i % 2 == 0 ? 1.5 : -1.5}, 1.5);
  return made;
}

}  // namespace

TEST_CASE_TEMPLATE("undecided: a few open pairs", S, float, double) {
  CHECK(tests::check_all(touching_scene<S>(3, 50), {}).size() == 150);
}

TEST_CASE_TEMPLATE("undecided: more open pairs than their list has room for", S, float, double) {
  // the list has room for 1024 pairs and one per sphere
  CHECK(tests::check_all(touching_scene<S>(40, 60), {}).size() == 2400);
}
