/// Bad values, degenerate triangles and extreme scales: the hard cases through every composition.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <doctest/doctest.h>

#include "checks.hpp"

namespace {

/// Runs rows as scenes of up to 100 triangles and spheres of which only those of the same row are looked at.
template <class S>
void check_rows(std::vector<oracle::hard_case> const& rows,
                std::function<bool(oracle::hard_case const&, bool)> const& right) {
  for (auto const& c : tests::compositions<S>()) {
    CAPTURE(c.name());
    auto const detector = c.make({});
    for (std::size_t first = 0; first < rows.size(); first += 100) {
      tests::scene<S> made;
      std::size_t const last = std::min(first + 100, rows.size());
      for (std::size_t i = first; i < last; ++i) {
        made.mesh.add(rows[i].shape);
        made.spheres.add(rows[i].ball.centre, rows[i].ball.radius);
      }
      detector->build(made.mesh, tests::mesh_form::soup);
      detector->place(made.spheres, tests::sphere_form::xyzr);
      auto const pairs = detector->pairs(collide::order::canonical);
      for (auto i = static_cast<collide::id>(first); i < last; ++i) {
        collide::id const n = i - static_cast<collide::id>(first);
        auto const& row = rows[i];
        CAPTURE(row.id);
        CAPTURE(row.family);
        CAPTURE(row.sub);
        CHECK(right(row, std::binary_search(pairs.begin(), pairs.end(), collide::pair{n, n})));
      }
    }
  }
}

std::vector<oracle::hard_case> rows_of(char const* file, bool single) {
  return oracle::read_hard_cases(std::string(TEST_DATA_DIR "/") + file, single);
}

/// True if the verdict is exact or the contact nearer than `units` units in the last place (of float) of the triangle
/// as seen from the centre: plain arithmetic is not asked for more.
bool exact_or_near(oracle::hard_case const& row, bool hit, double units) {
  if (hit == row.hit) return true;
  auto const& t = row.shape;
  auto const& p = row.ball.centre;
  double seen = 0;
  for (auto const& v : {t.a, t.b, t.c})
    seen = std::max({seen, std::abs(v.x / 4 - p.x / 4), std::abs(v.y / 4 - p.y / 4), std::abs(v.z / 4 - p.z / 4)});
  double const slack =
      4 * units * 0x1p-24 * std::max(seen, row.ball.radius / 4) + std::numeric_limits<double>::denorm_min();
  double const radius = row.ball.radius + (hit ? slack : -slack);
  return oracle::hit(t, {p, radius}) == hit;
}

}  // namespace

TEST_CASE_TEMPLATE("policy: every row of the policy family, in every composition", S, float, double) {
  auto rows = rows_of("static_f32.csv", true);
  rows.erase(std::remove_if(rows.begin(), rows.end(), [](auto const& r) { return r.family != "f_policy"; }),
             rows.end());
  REQUIRE(rows.size() == 384);
  // "R=1e-45" and "R0" rows lie exactly on or off the triangle, one on a face in a general position among them
  check_rows<S>(rows, [](auto const& row, bool hit) {
    bool const tiny = row.ball.radius >= 0 && row.ball.radius < 1e-40;
    return hit == row.hit || (tiny && exact_or_near(row, hit, 64));
  });
}

TEST_CASE_TEMPLATE("policy: every hard case that is not nearer to contact than rounding", S, float, double) {
  check_rows<S>(rows_of("static_f32.csv", true),
                [](auto const& row, bool hit) { return exact_or_near(row, hit, 256); });
  if (std::is_same<S, double>::value)
    check_rows<S>(rows_of("static_f64.csv", false),
                  [](auto const& row, bool hit) { return exact_or_near(row, hit, 256); });
}

TEST_CASE_TEMPLATE("policy: bad values anywhere are no hit, and harm nothing else", S, float, double) {
  S const nan = std::numeric_limits<S>::quiet_NaN(), infinity = std::numeric_limits<S>::infinity();
  auto made = tests::lattice_scene<S>(31, 60, 60, 3);
  auto const clean = made;
  S const bad[] = {nan, infinity, -infinity};
  for (std::size_t i = 0; i < 9; ++i) made.mesh.vertices[9 * (5 * i) + i] = bad[i % 3];  // each corner, each axis
  for (std::size_t i = 0; i < 9; ++i) made.spheres.centres[3 * (6 * i + 1) + i / 3] = bad[i % 3];
  S const bad_radii[] = {nan, -infinity, S(-1), -std::numeric_limits<S>::denorm_min(), S(-0.0), S(0), infinity};
  for (std::size_t i = 0; i < 7; ++i) made.spheres.radii[6 * i + 3] = bad_radii[i];
  CHECK(made.expect(0).certain.size() > 60);
  for (auto mesh : {tests::mesh_form::indexed, tests::mesh_form::soup})
    for (auto spheres : {tests::sphere_form::xyz, tests::sphere_form::soa, tests::sphere_form::xyzr})
      for (double width : {0., 0.5}) tests::check_all(made, {mesh, spheres, {width, 0, 2}, 0});

  for (S radius : bad_radii) {  // the one radius of all spheres
    auto same = clean;
    for (auto& r : same.spheres.radii) r = radius;
    CAPTURE(radius);
    tests::check_all(same, {tests::mesh_form::indexed, tests::sphere_form::xyz_one, {}, 0});
    tests::check_all(same, {tests::mesh_form::indexed, tests::sphere_form::soa_one, {}, 0});
  }
  for (auto& x : made.mesh.vertices) x = nan;
  CHECK(tests::check_all(made, {}).empty());
}
