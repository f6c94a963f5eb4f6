/// The scene of the study, at the origin and far from it, with exact verdicts.
#include <doctest/doctest.h>
#include <io/scenes.hpp>

#include "checks.hpp"

namespace {

template <class S>
tests::scene<S> study(int spheres, double offset) {
  auto made = io::study_scene(static_cast<std::size_t>(spheres));
  io::shift(made, {offset, offset, offset});
  tests::scene<S> rounded;
  rounded.mesh.corners = made.corners;
  for (double x : made.vertices) rounded.mesh.vertices.push_back(static_cast<S>(x));
  for (double x : made.centres) rounded.spheres.centres.push_back(static_cast<S>(x));
  rounded.spheres.radii.assign(made.sphere_count(), static_cast<S>(made.radius));
  return rounded;
}

/// The spheres that touch something, and as many others.
template <class S>
tests::scene<S> touching(tests::scene<S> const& all, oracle::expectation const& expected) {
  std::vector<bool> touches(all.spheres.size());
  for (auto p : expected.exact) touches[p.sphere] = touches[p.sphere ^ 1] = true;
  tests::scene<S> some{all.mesh, {}};
  for (std::size_t i = 0; i < all.spheres.size(); ++i)
    if (touches[i]) some.spheres.add(all.spheres[i].centre, all.spheres[i].radius);
  return some;
}

}  // namespace

TEST_CASE_TEMPLATE("study: exact pairs at any distance from the origin", S, float, double) {
  for (double offset : {0., 1e3, 1e4, 1e5, 1e6}) {
    CAPTURE(offset);
    auto const all = study<S>(100'000, offset);
    auto const expected = all.expect(0);
    CHECK(expected.exact.size() > 500);
    auto const some = touching(all, expected);
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
