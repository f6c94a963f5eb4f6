/// Sizes one either side of every warp, block, tile and buffer.
#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "checks.hpp"

using tests::mesh_form;
using tests::sphere_form;

namespace {

constexpr int sizes[] = {1, 31, 32, 33, 63, 64, 65, 127, 128, 129, 255, 256, 257, 511, 512, 513, 1023, 1024, 1025};

/// Triangle i and sphere i touch in one point and nothing else does.
template <class S>
tests::scene<S> chain(int triangles, int spheres) {
  tests::scene<S> made;
  for (int i = 0; i < triangles; ++i) made.mesh.add({{2.0 * i, 0, 0}, {2.0 * i + 1, 0, 0}, {2.0 * i, 1, 0}});
  for (int i = 0; i < spheres; ++i) made.spheres.add({2.0 * i, 0, 0.5}, 0.5);
  return made;
}

oracle::expectation first_with_first(unsigned n) {
  oracle::expectation expected;
  for (unsigned i = 0; i < n; ++i) expected.exact.push_back({i, i});
  expected.certain = expected.possible = expected.exact;
  return expected;
}

}  // namespace

TEST_CASE_TEMPLATE("sizes: a chain of every length against a chain of any other", S, float, double) {
  for (auto const& c : tests::compositions<S>()) {
    CAPTURE(c.name());
    auto const detector = c.make({});
    for (int triangles : {1, 32, 33, 257, 512, 513, 1025}) {
      detector->build(chain<S>(triangles, 0).mesh, mesh_form::indexed);
      for (int spheres : sizes) {
        CAPTURE(triangles);
        CAPTURE(spheres);
        auto const made = chain<S>(triangles, spheres);
        auto const expected = first_with_first(static_cast<unsigned>(std::min(triangles, spheres)));
        detector->place(made.spheres, spheres % 2 ? sphere_form::xyz_one : sphere_form::soa);
        if (spheres == triangles)
          tests::check_sinks(*detector, made, expected);
        else
          tests::check_pairs(*detector, expected);
      }
    }
  }
}

TEST_CASE_TEMPLATE("sizes: everything touches everything, and no hit is lost in a full buffer", S, float, double) {
  for (auto const& c : tests::compositions<S>()) {
    CAPTURE(c.name());
    auto const detector = c.make({});
    for (int n : {1, 31, 33, 64, 129, 257, 513, 2017}) {  // the last: more pairs than are merged
      tests::scene<S> made;
      for (int i = 0; i < n; ++i) made.mesh.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
      for (int i = 0; i < 131; ++i) made.spheres.add({0, 0, 0}, 1);
      detector->build(made.mesh, mesh_form::soup);
      detector->place(made.spheres, sphere_form::xyz_one);
      CAPTURE(n);
      CHECK(detector->count() == 131u * static_cast<unsigned>(n));
      auto const pairs = detector->pairs(collide::order::canonical);
      REQUIRE(pairs.size() == 131u * static_cast<unsigned>(n));
      bool each_once = true;
      for (std::size_t i = 0; i < pairs.size(); ++i)
        each_once = each_once && pairs[i].sphere == i / static_cast<unsigned>(n) &&
                    pairs[i].triangle == i % static_cast<unsigned>(n);
      CHECK(each_once);
    }
  }
}

TEST_CASE_TEMPLATE("sizes: more pairs at exactly the radius than a list of undecided pairs holds", S, float, double) {
  // half of the triangles lie in the plane z = 0, which 200 spheres touch, except for a third that misses by a unit
  tests::scene<S> made;
  for (int i = 0; i < 60; ++i) made.mesh.add({{-4, -4, 0}, {4, -4, 0}, {0, 4, i % 2 ? 0x1p-20 * i : 0}});
  for (int i = 0; i < 200; ++i) {
    S const distance = S(0.75) + S(i) / 256;
    S const radius = i % 3 == 0 ? std::nextafter(distance, S(0)) : distance;
    made.spheres.add({(i % 7 - 3) / 8.0, -1, i % 2 ? distance : -distance}, radius);
  }
  auto const expected = made.expect(0);
  CHECK(expected.exact.size() > 4000);
  CHECK(expected.exact.size() < 9000);
  for (auto const& c : tests::compositions<S>("exact")) {
    CAPTURE(c.name());
    auto const detector = c.make({});
    detector->build(made.mesh, mesh_form::indexed);
    detector->place(made.spheres, sphere_form::xyzr);
    tests::check_sinks(*detector, made, expected);
  }
}
