/// Bad values, degenerate triangles and extreme scales: the hard cases through every composition.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include <doctest/doctest.h>

#include "checks.hpp"

namespace {

using rows = std::vector<oracle::hard_case>;

template <class S>
tests::scene<S> scene_of(rows const& cases) {
  tests::scene<S> made;
  for (auto const& row : cases) {
    made.mesh.add(row.shape);
    made.spheres.add(row.ball.centre, row.ball.radius);
  }
  return made;
}

/// The rows in lists of up to `most`.
std::vector<rows> in_lists(rows const& all, std::size_t most) {
  std::vector<rows> lists;
  for (std::size_t first = 0; first < all.size(); first += most)
    lists.emplace_back(all.begin() + static_cast<std::ptrdiff_t>(first),
                       all.begin() + static_cast<std::ptrdiff_t>(std::min(first + most, all.size())));
  return lists;
}

/// A list of rows as a scene, in which row i has sphere i and triangle i.
template <class S>
std::vector<collide::pair> pairs_of(tests::subject<S>& detector, tests::scene<S> const& made) {
  detector.build(made.mesh, tests::mesh_form::soup);
  detector.place(made.spheres, tests::sphere_form::xyzr);
  return detector.pairs(collide::order::canonical);
}

/// Runs rows through every composition as scenes of up to 100 triangles and spheres, of which only those of the same
/// row are looked at.
template <class S>
void check_rows(rows const& all, std::function<bool(oracle::hard_case const&, bool)> const& right) {
  auto const lists = in_lists(all, 100);
  for (auto const& c : tests::compositions<S>()) {
    CAPTURE(c.name());
    auto const detector = c.make({});
    for (auto const& list : lists) {
      auto const pairs = pairs_of(*detector, scene_of<S>(list));
      for (collide::id i = 0; i < list.size(); ++i) {
        auto const& row = list[i];
        CAPTURE(row.id);
        CAPTURE(row.family);
        CAPTURE(row.sub);
        CHECK(right(row, std::binary_search(pairs.begin(), pairs.end(), collide::pair{i, i})));
      }
    }
  }
}

rows rows_of(char const* file, bool single) {
  return oracle::read_hard_cases(std::string(TEST_DATA_DIR "/") + file, single);
}

/// The rows of all static files that `S` can hold.
template <class S>
rows all_rows() {
  auto all = rows_of("static_f32.csv", true);
  if (std::is_same<S, double>::value) {
    auto const more = rows_of("static_f64.csv", false);
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
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
  check_rows<S>(all_rows<S>(), [](auto const& row, bool hit) { return exact_or_near(row, hit, 256); });
}

TEST_CASE_TEMPLATE("exact: every hard case, alone in its scene", S, float, double) {
  auto const all = all_rows<S>();
  for (auto const& c : tests::compositions<S>("exact")) {
    CAPTURE(c.name());
    auto const detector = c.make({});
    for (auto const& row : all) {
      CAPTURE(row.id);
      CAPTURE(row.family);
      CAPTURE(row.sub);
      CHECK(pairs_of(*detector, scene_of<S>({row})).size() == (row.hit ? 1 : 0));
    }
  }
}

TEST_CASE_TEMPLATE("exact: the triangles of 100 hard cases with the spheres of all of them", S, float, double) {
  for (auto const& list : in_lists(all_rows<S>(), 100)) {
    auto const made = scene_of<S>(list);
    auto const expected = made.expect(0);
    CAPTURE(list[0].id);
    for (auto const& c : tests::compositions<S>("exact")) {
      CAPTURE(c.name());
      auto const detector = c.make({});
      detector->build(made.mesh, tests::mesh_form::indexed);
      detector->place(made.spheres, tests::sphere_form::xyz);
      tests::check_pairs(*detector, expected);
    }
  }
}

TEST_CASE_TEMPLATE("exact: the hard cases of one group as one mesh", S, float, double) {
  std::map<int, rows> groups;
  for (auto const& row : rows_of("static_f32.csv", true))
    if (row.group > 0) groups[row.group].push_back(row);
  CHECK(groups.size() == 10);
  for (auto const& [group, members] : groups) {
    CAPTURE(group);
    std::map<std::array<double, 9>, std::uint32_t> triangles;
    std::map<std::array<double, 4>, std::uint32_t> spheres;
    tests::scene<S> made;
    std::vector<oracle::id_pair> hits;
    for (auto const& row : members) {
      auto const& [a, b, c] = row.shape;
      auto const& [p, r] = row.ball;
      auto const [t, new_triangle] =
          triangles.insert({{a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z}, static_cast<collide::id>(triangles.size())});
      auto const [s, new_sphere] = spheres.insert({{p.x, p.y, p.z, r}, static_cast<collide::id>(spheres.size())});
      if (new_triangle) made.mesh.add(row.shape);
      if (new_sphere) made.spheres.add(p, r);
      if (row.hit) hits.push_back({s->second, t->second});
    }
    std::sort(hits.begin(), hits.end());
    hits.erase(std::unique(hits.begin(), hits.end()), hits.end());
    auto const expected = made.expect(0);
    CHECK(std::includes(expected.exact.begin(), expected.exact.end(), hits.begin(), hits.end()));
    for (auto const& c : tests::compositions<S>("exact")) {
      CAPTURE(c.name());
      auto const detector = c.make({});
      detector->build(made.mesh, tests::mesh_form::indexed);
      detector->place(made.spheres, tests::sphere_form::xyz);
      tests::check_sinks(*detector, made, expected);
    }
  }
}

TEST_CASE_TEMPLATE("contacts: of every hard case that hits, in every composition", S, float, double) {
  auto all = all_rows<S>();
  all.erase(std::remove_if(all.begin(), all.end(), [](auto const& row) { return !row.hit; }), all.end());
  auto const compositions = tests::compositions<S>("exact");
  for (auto const& list : in_lists(all, 50)) {
    auto const made = scene_of<S>(list);
    std::vector<collide::contact<S>> first;
    for (auto const& c : compositions) {
      CAPTURE(c.name());
      auto const detector = c.make({});
      pairs_of(*detector, made);
      auto const contacts = detector->contacts(collide::order::canonical);
      if (first.empty()) first = contacts;
      CHECK(tests::same(contacts, first));
    }
    for (auto const& contact : first) {
      if (contact.sphere != contact.triangle) continue;
      auto const& row = list[contact.sphere];
      CAPTURE(row.id);
      CAPTURE(row.family);
      CAPTURE(row.sub);
      tests::check_contact(contact, row.shape, row.ball, false);
    }
  }
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
  CHECK(made.expect(0).exact.size() > 60);
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
