/// The scene of the study, at the origin and far from it, with exact verdicts.
#include <doctest/doctest.h>
#include <io/scenes/torus.hpp>

#include "checks.hpp"
#include "rounded_scene.hpp"

namespace {

template <class S>
tests::scene<S> study(int spheres, double offset) {
  auto made = io::study_scene(static_cast<std::size_t>(spheres));
  io::shift(made, {offset, offset, offset});
  return tests::rounded<S>(made);
}

}  // namespace

TEST_CASE_TEMPLATE("study: exact pairs at any distance from the origin", S, float, double) {
  for (double offset : {0., 1e3, 1e4, 1e5, 1e6}) {
    CAPTURE(offset);
    auto const all = study<S>(100'000, offset);
    auto const expected = all.expect(0);
    CHECK(expected.exact.size() > 500);
    auto const some = tests::touching(all, expected);
    auto const expected_of_some = some.expect(0);
    CHECK(expected_of_some.exact.size() == expected.exact.size());
    for (auto const& c : tests::compositions<S>("exact")) {
      CAPTURE(c.name());
      auto const detector = c.make({});
      auto const check = [&](tests::scene<S> const& made, oracle::expectation const& pairs) {
        detector->build(made.mesh, tests::mesh_form::indexed);
        detector->place(made.spheres, tests::sphere_form::xyz_one);
        tests::check_pairs(*detector, pairs);
      };
      if (c.broad == "bucket") check(all, expected);
      check(some, expected_of_some);
    }
  }
}
