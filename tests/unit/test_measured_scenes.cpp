/// The scenes that libraries are compared on, small.
#include <algorithm>

#include <doctest/doctest.h>
#include <io/scenes.hpp>

#include <collide/mesh.hpp>
#include <collide/spheres.hpp>

#include "../../bench/textbook.hpp"
#include "checks.hpp"
#include "rounded_scene.hpp"

namespace {

/// The scene, small, with at least 50 pairs: so many spheres are made, and those that touch nothing are left out but
/// for as many as those that do.
template <class S>
tests::scene<S> small(io::scene_kind const& kind) {
  constexpr std::size_t triangles = 400;
  for (std::size_t n = 1000;; n *= 8) {
    auto const all = tests::rounded<S>(kind.make(n, triangles, 1));
    auto const expected = all.expect(0);
    if (expected.exact.size() >= 50) return tests::touching(all, expected);
  }
}

}  // namespace

TEST_CASE_TEMPLATE("measured scenes: every broad phase finds the exact pairs, by one radius and by many", S, float,
                   double) {
  for (auto const& kind : io::measured_scenes) {
    CAPTURE(std::string(kind.name));
    auto const made = small<S>(kind);
    auto const expected = made.expect(0);
    auto const& radii = made.spheres.radii;
    bool const one_radius = std::equal(radii.begin() + 1, radii.end(), radii.begin());
    CHECK(one_radius != (kind.name.substr(0, 5) == "radii"));
    for (auto const& c : tests::compositions<S>("exact")) {
      CAPTURE(c.name());
      auto const detector = c.make({});
      if (one_radius) {
        detector->build(made.mesh, tests::mesh_form::indexed, radii[0]);
        detector->place(made.spheres, tests::sphere_form::xyz_one);
        tests::check_pairs(*detector, expected);
      }
      detector->build(made.mesh, tests::mesh_form::indexed);
      detector->place(made.spheres, tests::sphere_form::xyz);
      tests::check_pairs(*detector, expected);
    }
  }
}

TEST_CASE_TEMPLATE("long slivers: the textbook's test loses a third of the pairs, exact none", S, float, double) {
  auto const from = io::long_slivers_scene(1500, 400, 1);
  auto const made = tests::rounded<S>(from);
  auto const expected = made.expect(0);
  CHECK(expected.exact.size() >= made.spheres.size());

  auto const mesh = collide::indexed_mesh(made.mesh.vertices.data(), made.mesh.vertices.size() / 3,
                                          made.mesh.corners.data(), made.mesh.size());
  auto const balls = collide::spheres_xyz(made.spheres.centres.data(), made.spheres.size(), made.spheres.radii.data());
  std::size_t lost = 0;
  for (auto const& p : expected.exact) lost += bench::textbook::intersects(mesh[p.triangle], balls[p.sphere]) ? 0 : 1;
  CHECK(lost > expected.exact.size() / 4);
  CHECK(lost < expected.exact.size() / 2);

  for (auto const& c : tests::compositions<S>("exact")) {
    CAPTURE(c.name());
    auto const detector = c.make({});
    detector->build(made.mesh, tests::mesh_form::indexed, static_cast<S>(from.radius));
    detector->place(made.spheres, tests::sphere_form::xyz_one);
    tests::check_pairs(*detector, expected);
  }
}
