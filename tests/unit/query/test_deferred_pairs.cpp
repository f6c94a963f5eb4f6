/// Pairs that a quick attempt leaves open: the list of them, and what happens when it is full.
#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include <collide/karabassi_swept.hpp>

#include "checks.hpp"
#include "compositions.hpp"

namespace {

/// Spheres next to `layers` triangles each, all in the same place: a third touches them at exactly the radius, which no
/// filter decides, a third is a unit in the last place (of float) too far away, and a third nearer by as much. So
/// threads that decide side by side take unequally long.
template <class S>
tests::scene<S> touching_scene(int layers, int spheres) {
  tests::scene<S> made;
  float const radii[] = {1.5f, std::nextafter(1.5f, 1.0f), std::nextafter(1.5f, 2.0f)};
  for (int i = 0; i < layers; ++i) made.mesh.add({{0, 0, 0}, {64, 0, 0}, {0, 64, 0}});
  for (int i = 0; i < spheres; ++i) made.spheres.add({1.0 + i % 5, 1.0 + i % 7, i % 2 == 0 ? 1.5 : -1.5}, radii[i % 3]);
  return made;
}

/// A narrow phase that derives from one with a quick attempt, and decides otherwise.
struct nothing_touches final : collide::karabassi<> {
  template <class S>
  static COLLIDE_HD bool intersects(collide::triangle<S> const&, collide::sphere<S> const&) {
    return false;
  }
};

/// A sink whose handle has members of its own, with names that the library uses elsewhere.
struct counting_sink {
  struct output final {
    int* count;
    static bool needed() { return false; }
    static bool takes() { return false; }
    std::uint64_t allocate(std::uint64_t n) const { return *count += static_cast<int>(n), 0; }
    template <class Hit>
    void store(std::uint64_t, Hit const&) const {}
  };
  int total = 0;

  template <class Space, class Query>
  void run(Space&, Query const& query) {
    query(output{&total});
  }
};

/// A broad phase that cannot be asked for the triangles near one sphere.
struct blind {
  template <class S>
  struct index : collide::all_pairs::index<S> {
    void mesh_lookup() const = delete;
    template <class Space>
    void build(Space& space, blind const&, collide::mesh_view<S> mesh) {
      collide::all_pairs::index<S>::build(space, collide::all_pairs(), mesh);
    }
    template <class Space, class RadiusOrSpheres>
    void prepare(Space&, blind const&, RadiusOrSpheres const&) {}
  };
};

using stepwise = tests::lockstep<64, true>;

template <class NarrowPhase, class Space, class BroadPhase = collide::bucket>
int count_touching() {
  auto const made = touching_scene<float>(60, 60);
  auto const mesh = collide::indexed_mesh(made.mesh.vertices.data(), made.mesh.vertices.size() / 3,
                                          made.mesh.corners.data(), made.mesh.size());
  auto const balls = collide::spheres_xyz(made.spheres.centres.data(), made.spheres.size(), made.spheres.radii.data());
  collide::detector<BroadPhase, NarrowPhase, Space> detector;
  return detector.detect(mesh, balls, counting_sink()).total;
}

}  // namespace

TEST_CASE_TEMPLATE("undecided: a few open pairs", S, float, double) {
  CHECK(tests::check_all(touching_scene<S>(3, 60), {}).size() == 120);
}

TEST_CASE_TEMPLATE("undecided: more open pairs than their list has room for, and room beside the entries", S, float,
                   double) {
  // the list has room for 1024 pairs and one per sphere
  CHECK(tests::check_all(touching_scene<S>(20, 60), {}).size() == 800);
}

TEST_CASE_TEMPLATE("undecided: more open pairs than there is room for", S, float, double) {
  CHECK(tests::check_all(touching_scene<S>(60, 60), {}).size() == 2400);
}

TEST_CASE("undecided: more hard cases than there is room for") {
  auto const rows = oracle::read_hard_cases(TEST_DATA_DIR "/static_f32.csv", true);
  for (std::size_t first : {2400, 4600}) {
    tests::scene<float> made;
    for (std::size_t i = first; i < first + 100; ++i) {
      made.mesh.add(rows[i].shape);
      made.spheres.add(rows[i].ball.centre, rows[i].ball.radius);
    }
    std::vector<collide::pair> expected;
    for (auto const& c : tests::compositions<float>("exact")) {
      CAPTURE(c.name());
      auto const detector = c.make({});
      detector->build(made.mesh, tests::mesh_form::soup);
      detector->place(made.spheres, tests::sphere_form::xyzr);
      auto const found = detector->pairs(collide::order::canonical);
      if (expected.empty()) expected = found;
      CHECK(found == expected);
    }
    CHECK(expected.size() > 1024);
  }
}

TEST_CASE("undecided: of spheres that move more open pairs than their list has room for, each once") {
  // on their ways along the plane z = 0 they pass several cells that list the same triangles
  auto const made = touching_scene<float>(60, 60);
  auto const mesh = collide::indexed_mesh(made.mesh.vertices.data(), made.mesh.vertices.size() / 3,
                                          made.mesh.corners.data(), made.mesh.size());
  auto const balls = collide::spheres_xyz(made.spheres.centres.data(), made.spheres.size(), made.spheres.radii.data());
  std::vector<float> ways;
  for (int i = 0; i < 60; ++i) ways.insert(ways.end(), {8.0f * float(i % 4), 6.0f * float(i % 3), 0});
  auto const moving = collide::with_displacements(balls, static_cast<float const*>(ways.data()));
  using narrow = collide::karabassi_swept<collide::exact>;
  for (double width : {0.0, 3.0}) {
    CAPTURE(width);
    collide::bucket cells;
    cells.cell_width = width;
    collide::detector<collide::bucket, narrow, stepwise> detector(stepwise{}, cells);
    collide::pairs found(collide::order::canonical);
    detector.build(mesh);
    detector.query(moving, found);
    std::vector<collide::pair> expected;
    for (collide::id s = 0; s < balls.size(); ++s) {
      for (collide::id t = 0; t < mesh.size(); ++t) {
        if (narrow::intersects(mesh[t], moving[s])) expected.push_back({s, t});
      }
    }
    CHECK(expected.size() == 2400);
    CHECK(found.to_host() == expected);
  }
}

TEST_CASE_TEMPLATE("undecided: sinks and narrow phases of a user", Space, collide::host, stepwise) {
  CHECK(count_touching<collide::karabassi<>, Space>() == 2400);
  CHECK(count_touching<nothing_touches, Space>() == 0);
  CHECK(count_touching<collide::karabassi<>, Space, blind>() == 2400);
}
