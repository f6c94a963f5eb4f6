/// Detectors that live longer than one query: rebuilt, asked again, asked for other radii, by any number of threads.
#include <algorithm>

#include <doctest/doctest.h>

#include "checks.hpp"

using collide::order;
using tests::mesh_form;
using tests::sphere_form;

namespace {

template <class S>
void query_everything(tests::subject<S>& detector) {
  detector.count();
  detector.any();
  detector.closest();
  for (auto o : {order::unspecified, order::canonical}) {
    detector.pairs(o);
    detector.contacts(o);
    detector.csr(o);
  }
}

/// A scene with its exact pairs.
template <class S>
struct with_answer {
  tests::scene<S> made;
  oracle::expectation expected = made.expect(0);
  with_answer(tests::scene<S> const& scene) : made(scene) {}
};

}  // namespace

TEST_CASE_TEMPLATE("lifecycle: after the first call with the same sizes nothing is allocated", S, float, double) {
  auto made = tests::lattice_scene<S>(41, 150, 150, 6);
  for (auto& r : made.spheres.radii) r = S(1.5);
  for (auto form : {sphere_form::xyz, sphere_form::xyz_one})
    for (auto const& c : tests::compositions<S>()) {
      CAPTURE(c.name());
      auto const detector = c.make({});
      auto const frame = [&] {
        detector->build(made.mesh, mesh_form::indexed);
        detector->place(made.spheres, form);
        query_everything(*detector);
        query_everything(*detector);
      };
      frame();
      auto const before = detector->memory().allocations;
      CHECK(before > 0);
      frame();
      CHECK(detector->memory().allocations == before);
      detector->place(tests::spheres<S>(made.spheres), form);
      query_everything(*detector);
      CHECK(detector->memory().allocations == before);
    }
}

TEST_CASE_TEMPLATE("lifecycle: a mesh that moves and deforms is rebuilt without a new allocation", S, float, double) {
  tests::random_scene random;
  random.seed = 42;
  random.triangles = 300;
  random.spheres = 100;
  auto const made = random.make<S>();
  for (auto const& c : tests::compositions<S>()) {
    CAPTURE(c.name());
    auto const detector = c.make({});
    detector->build(made.mesh, mesh_form::indexed);
    detector->place(made.spheres, sphere_form::xyz_one);
    for (int query = 0; query < 2; ++query) tests::check_pairs(*detector, made.expect(1e-4));
    auto const before = detector->memory().allocations;
    for (int frame = 1; frame <= 10; ++frame) {
      auto moved = made;
      for (std::size_t i = 0; i < moved.mesh.vertices.size(); ++i)
        moved.mesh.vertices[i] += static_cast<S>(0.137 * frame + 0.01 * ((static_cast<int>(i) * 7 + frame) % 5));
      detector->build(moved.mesh, mesh_form::indexed);
      detector->pairs(order::canonical);
      CHECK(detector->memory().allocations == before);
      if (frame % 5 == 0) tests::check_pairs(*detector, moved.expect(1e-4));
    }
  }
}

TEST_CASE_TEMPLATE("lifecycle: once there is room, more hits allocate nothing", S, float, double) {
  constexpr std::size_t triangles = 40, spheres = 300, room = 300000;  // more than are merged
  tests::scene<S> made;
  for (std::size_t i = 0; i < triangles; ++i) made.mesh.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  for (std::size_t i = 0; i < spheres; ++i) made.spheres.add({0.25, 0.25, 0.5}, 1);
  for (auto const& c : tests::compositions<S>()) {
    CAPTURE(c.name());
    auto const detector = c.make({});
    detector->build(made.mesh, mesh_form::soup);
    detector->reserve(spheres, room);
    auto const query = [&](std::size_t near) {
      auto now = made.spheres;
      for (std::size_t i = 3 * near; i < now.centres.size(); ++i) now.centres[i] = 100;
      detector->place(now, sphere_form::xyz_one);
      query_everything(*detector);
      query_everything(*detector);
      CHECK(detector->count() == near * triangles);
    };
    query(3);
    auto const before = detector->memory().allocations;
    for (auto const near : {std::size_t{100}, spheres, std::size_t{0}, spheres}) query(near);
    CHECK(detector->memory().allocations == before);
  }
}

TEST_CASE_TEMPLATE("lifecycle: pairs in order, more or fewer than are merged, without a new allocation", S, float,
                   double) {
  constexpr std::size_t triangles = 2017, all = 131, few = 124;  // 264,227 and 250,108 pairs
  tests::scene<S> made;
  for (std::size_t i = 0; i < triangles; ++i) made.mesh.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  for (std::size_t i = 0; i < all; ++i) made.spheres.add({0, 0, 0}, 1);
  auto fewer = made.spheres;
  for (std::size_t i = 3 * few; i < 3 * all; ++i) fewer.centres[i] = 100;
  for (auto const& c : tests::compositions<S>()) {
    CAPTURE(c.name());
    auto const detector = c.make({});
    detector->build(made.mesh, mesh_form::soup);
    auto const query = [&](tests::spheres<S> const& some, std::size_t n) {
      detector->place(some, sphere_form::xyz_one);
      auto const pairs = detector->pairs(order::canonical);
      CHECK(pairs.size() == n * triangles);
      CHECK(std::is_sorted(pairs.begin(), pairs.end()));
    };
    query(fewer, few);
    query(fewer, few);
    auto const before = detector->memory().allocations;
    query(made.spheres, all);
    query(fewer, few);
    query(made.spheres, all);
    CHECK(detector->memory().allocations == before);
  }
}

TEST_CASE_TEMPLATE("lifecycle: all memory is given back", S, float, double) {
  auto const made = tests::lattice_scene<S>(43, 60, 60, 4);
  for (auto const& c : tests::compositions<S>()) {
    CAPTURE(c.name());
    auto const detector = c.make({});
    auto const idle = detector->memory().in_use;
    CHECK(idle == 0);
    detector->build(made.mesh, mesh_form::indexed);
    detector->place(made.spheres, sphere_form::xyz);
    for (int query = 0; query < 2; ++query) detector->pairs_within(10, order::canonical);
    auto const held = detector->memory().in_use;
    CHECK(held > 0);
    detector->pairs_within(10, order::canonical);
    detector->contacts_within(10, order::canonical);
    CHECK(detector->memory().in_use == held);  // temporary sinks leave nothing behind
  }
}

TEST_CASE_TEMPLATE("lifecycle: the mesh moves, grows, shrinks, vanishes and comes back", S, float, double) {
  auto const large = tests::lattice_scene<S>(44, 700, 80, 6), small = tests::lattice_scene<S>(45, 20, 80, 3);
  tests::scene<S> moved = large, none = small;
  for (auto& x : moved.mesh.vertices) x += 2;
  none.mesh = {};
  std::vector<with_answer<S>> const frames{small, large, moved, none, large, small, small};
  for (auto const& c : tests::compositions<S>())
    for (double budget : {0., 50e3}) {
      CAPTURE(c.name());
      CAPTURE(budget);
      auto const detector = c.make({0, static_cast<std::size_t>(budget), 2});
      for (auto const& now : frames) {
        detector->build(now.made.mesh, mesh_form::indexed);
        detector->place(now.made.spheres, sphere_form::xyz);
        tests::check_pairs(*detector, now.expected);
      }
    }
}

TEST_CASE_TEMPLATE("lifecycle: one build serves spheres of any radius, smaller and larger than built for", S, float,
                   double) {
  auto const made = tests::lattice_scene<S>(46, 150, 100, 6);
  std::vector<with_answer<S>> queries;
  for (double radius : {1., 0.5, 0., 4., 1., 30., 1e-3}) {
    auto now = made;
    for (auto& r : now.spheres.radii) r = static_cast<S>(radius);
    queries.push_back(now);
  }
  with_answer<S> const mixed = made;
  for (auto const& c : tests::compositions<S>())
    for (double built_for : {-1., 0., 0.5, 2., 1e6}) {  // -1: for none
      CAPTURE(c.name());
      CAPTURE(built_for);
      auto const detector = c.make({});
      if (built_for < 0)
        detector->build(made.mesh, mesh_form::indexed);
      else
        detector->build(made.mesh, mesh_form::indexed, static_cast<S>(built_for));
      for (auto const& now : queries)
        for (auto form : {sphere_form::xyz_one, sphere_form::xyzr}) {
          CAPTURE(now.made.spheres.radii[0]);
          detector->place(now.made.spheres, form);
          tests::check_pairs(*detector, now.expected);
        }
      detector->place(made.spheres, sphere_form::soa);
      tests::check_pairs(*detector, mixed.expected);
    }
}

TEST_CASE_TEMPLATE("lifecycle: the same bits with 1, 2 and 5 threads, and run after run", S, float, double) {
  tests::random_scene random;
  random.seed = 47;
  random.spheres = 3000;
  random.triangles = 600;
  auto const made = random.make<S>();
  auto const expected = made.expect(1e-4);
  for (char const* precision : tests::precisions) {
    tests::findings<S> first;
    for (auto const& c : tests::compositions<S>(precision)) {
      CAPTURE(c.name());
      for (int threads : {1, 2, 5}) {
        if (c.space.find("lockstep") == 0 && threads != 2) continue;
        CAPTURE(threads);
        auto const detector = c.make({0, 0, threads});
        for (int run = 0; run < 2; ++run) {
          detector->build(made.mesh, mesh_form::indexed);
          detector->place(made.spheres, sphere_form::xyz_one);
          auto const found = tests::check_sinks(*detector, made, expected);
          if (first.pairs.empty()) first = found;
          CHECK((found.pairs == first.pairs));
          CHECK(tests::same(found.contacts, first.contacts));
        }
      }
    }
  }
}
