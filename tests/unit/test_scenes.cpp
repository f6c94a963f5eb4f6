/// Whole scenes through every composition and every sink.
#include <limits>

#include <doctest/doctest.h>

#include "checks.hpp"

using tests::mesh_form;
using tests::operator+;
using tests::sphere_form;
using pairs = std::vector<oracle::id_pair>;

TEST_CASE_TEMPLATE("unit cube: the corner sphere touches its three triangles, the one beside an edge its two", S, float,
                   double) {
  tests::scene<S> made{tests::unit_cube<S>(), {}};
  made.spheres.add({0, 0, 0}, 0.4);
  made.spheres.add({3, 3, 3}, 0.4);
  made.spheres.add({0.5, 0.5, 0.5}, 0.4);
  made.spheres.add({1.3, 0, 0.5}, 0.4);
  CHECK((tests::check_all(made, {}) == pairs{{0, 0}, {0, 4}, {0, 8}, {3, 5}, {3, 10}}));
}

TEST_CASE_TEMPLATE("octahedron: the sphere at the lower apex touches the four lower faces, that at the upper none", S,
                   float, double) {
  tests::scene<S> made;
  oracle::point const corners[] = {{45, 45, 0}, {-45, 45, 0}, {-45, -45, 0}, {45, -45, 0}};
  for (double apex : {78, -78})
    for (int i = 0; i < 4; ++i) made.mesh.add({{0, 0, apex}, corners[i], corners[(i + 1) % 4]});
  made.spheres.add({0, 0, -90}, 20);
  made.spheres.add({0, 0, 100}, 20);
  CHECK((tests::check_all(made, {}) == pairs{{0, 4}, {0, 5}, {0, 6}, {0, 7}}));
}

TEST_CASE_TEMPLATE("lattice: touching, ties and cell boundaries are exact in every layout of the input", S, float,
                   double) {
  auto made = tests::lattice_scene<S>(5, 150, 150, 6);
  std::size_t hits = 0;
  for (auto mesh : {mesh_form::indexed, mesh_form::soup})
    for (auto spheres : {sphere_form::xyz, sphere_form::soa, sphere_form::xyzr})
      hits += tests::check_all(made, {mesh, spheres, {}, 0}).size();
  CHECK(hits > 1000);
  for (auto& r : made.spheres.radii) r = S(1.5);
  hits = 0;
  for (auto spheres : {sphere_form::xyz_one, sphere_form::soa_one})
    hits += tests::check_all(made, {mesh_form::indexed, spheres, {}, 0}).size();
  CHECK(hits > 500);
}

TEST_CASE_TEMPLATE("random soups: small and large triangles, one radius and many", S, float, double) {
  tests::random_scene scenes[4];
  scenes[1].triangle_size = 10;
  scenes[2].triangle_size = 0.01;
  scenes[2].extent = 1;
  scenes[2].radius = 0.3;
  scenes[3].spread = 50;
  scenes[3].radius = 5;
  unsigned seed = 10;
  for (auto& random : scenes) {
    random.seed = ++seed;
    CAPTURE(seed);
    auto const form = random.spread == 1 ? sphere_form::xyz_one : sphere_form::soa;
    CHECK(tests::check_all(random.make<S>(), {mesh_form::soup, form, {}, 1e-4}).size() > 20);
  }
}

TEST_CASE_TEMPLATE("far from the origin: verdicts are as good as at the origin", S, float, double) {
  for (double far : {1e3, 1e5, 1e6, 1e7}) {
    CAPTURE(far);
    tests::random_scene random;
    random.extent = 20;
    random.triangle_size = 4;
    random.radius = 3;
    random.offset = {far, -far, far / 3};
    CHECK(tests::check_all(random.make<S>(), {mesh_form::indexed, sphere_form::xyzr, {}, 1e-4}).size() > 100);
  }
}

TEST_CASE_TEMPLATE("tangent: where plain arithmetic may err, all broad phases and spaces err alike", S, float, double) {
  for (double offset : {0., 100., 1e5}) {
    tests::random_scene random;
    random.seed = 12;
    random.triangles = 400;
    random.spheres = 0;
    random.extent = 30;
    random.triangle_size = 2;
    random.offset = {offset, offset, -offset};
    auto made = random.make<S>();
    tests::dice roll(13);
    for (std::size_t i = 0; i < made.mesh.size(); ++i) {
      oracle::point along[] = {roll.in_cube(1), {0, 0, 0}};
      (i % 3 == 0 ? along[1].x : i % 3 == 1 ? along[1].y : along[1].z) = roll.uniform(-1, 1);
      made.spheres.add(made.mesh[i].a + along[i / 3 % 2],
                       0);  // along an axis it may touch the end of the triangle's box
      double const distance = oracle::closest(made.mesh[i], made.spheres[i].centre).distance;
      // within some units in the last place of float, or of S
      double const unit = roll.integer(0, 1) ? 0x1p-24 : std::numeric_limits<S>::epsilon() / 2;
      made.spheres.radii[i] = static_cast<S>(distance * (1 + unit * roll.integer(-3, 3)));
    }
    CAPTURE(offset);
    CHECK(tests::check_all(made, {mesh_form::indexed, sphere_form::xyz, {}, 1e-4}).size() > 100);
  }
}

TEST_CASE_TEMPLATE("tangent: at the end of the grid and of the triangle's box and ball", S, float, double) {
  tests::dice roll(14);
  for (int i = 0; i < 60; ++i) {
    double const sign = i % 2 ? 1 : -1, d = roll.uniform(0.1, 3), length = roll.uniform(0.1, 30);
    auto const along = [&](double x) {
      return oracle::point{i % 3 == 0 ? sign * x : 0, i % 3 == 1 ? sign * x : 0, i % 3 == 2 ? sign * x : 0};
    };
    tests::scene<S> made;
    auto const end = i < 30 ? roll.in_cube(10) : oracle::point{0, 0, 0};
    made.mesh.add({end, end + along(-length), end + along(-length / 2)});
    for (int ulp = -4; ulp <= 4; ++ulp) made.spheres.add(end + along(d), d * (1 - ulp * 0x1p-24));
    CAPTURE(i);
    tests::check_all(made, {mesh_form::indexed, sphere_form::xyz, {}, 1e-4});
    for (auto& r : made.spheres.radii) r = made.spheres.radii[static_cast<std::size_t>(i % 9)];
    tests::check_all(made, {mesh_form::indexed, sphere_form::xyz_one, {}, 1e-4});
  }
}

TEST_CASE_TEMPLATE("real meshes: a character of many open parts, an aeroplane of long thin triangles", S, float,
                   double) {
  for (char const* name : {"wuson.off", "airplane.off"}) {
    CAPTURE(name);
    double const unit = name[0] == 'w' ? 0.01 : 5;
    tests::scene<S> made{tests::read_off<S>(name), {}};
    made.spheres = tests::spheres_near(made.mesh, 6, 600, 3 * unit, unit);
    CHECK(tests::check_all(made, {mesh_form::indexed, sphere_form::xyz_one, {}, 1e-4}).size() > 500);
  }
}

TEST_CASE_TEMPLATE("degenerate triangles are the segments and points that they are", S, float, double) {
  auto made = tests::lattice_scene<S>(7, 120, 150, 4);
  auto& corners = made.mesh.corners;
  for (std::size_t t = 0; t < made.mesh.size(); ++t) {
    auto* const c = &corners[3 * t];
    switch (t % 5) {
      case 0:
        c[1] = c[0];
        break;  // AAC
      case 1:
        c[2] = c[1];
        break;  // ABB
      case 2:
        c[2] = c[0];
        break;  // ABA
      case 3:
        c[1] = c[2] = c[0];
        break;  // AAA
      case 4:   // collinear, b beyond c
        for (unsigned k = 0; k < 3; ++k) {
          S const* const v = made.mesh.vertices.data();
          made.mesh.vertices[3 * c[1] + k] = 2 * v[3 * c[2] + k] - v[3 * c[0] + k];
        }
        break;
    }
  }
  CHECK(tests::check_all(made, {}).size() > 100);
}

TEST_CASE_TEMPLATE("the same triangle many times over: every copy is reported, the closest is the first", S, float,
                   double) {
  tests::scene<S> made;
  for (int i = 0; i < 70; ++i) made.mesh.add({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}});
  for (int i = 0; i < 40; ++i) made.spheres.add({1, 1, 0.5 * (i % 4)}, 1);
  CHECK(tests::check_all(made, {}).size() == 30 * 70);
  for (auto const& c : tests::compositions<S>()) {
    auto const detector = c.make({});
    detector->build(made.mesh, mesh_form::indexed);
    detector->place(made.spheres, sphere_form::xyz);
    CAPTURE(c.name());
    for (auto const& entry : detector->closest()) CHECK((entry.triangle == 0 || entry.triangle == collide::no_id));
  }
}

TEST_CASE_TEMPLATE("nothing against something: empty meshes and empty sphere sets", S, float, double) {
  auto const full = tests::lattice_scene<S>(8, 40, 40, 3);
  tests::scene<S> no_spheres{full.mesh, {}}, no_mesh{{}, full.spheres}, nothing;
  for (auto form : {sphere_form::xyz, sphere_form::xyz_one, sphere_form::soa, sphere_form::soa_one, sphere_form::xyzr})
    for (auto const* made : {&no_spheres, &no_mesh, &nothing})
      for (auto mesh : {mesh_form::indexed, mesh_form::soup})
        CHECK(tests::check_all(*made, {mesh, form, {}, 0}).empty());
}
