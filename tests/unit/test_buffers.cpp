/// Buffers of fixed capacity: whatever the capacity, the caller learns how many there are, and nothing is written
/// beyond it.
#include <algorithm>

#include <doctest/doctest.h>

#include "checks.hpp"

using collide::order;

namespace {

collide::pair pair_of(collide::pair p) { return p; }
template <class S>
collide::pair pair_of(collide::contact<S> const& c) {
  return {c.sphere, c.triangle};
}

/// `all` is in canonical order.
template <class T>
void check_bounded(tests::bounded<T> const& got, std::vector<T> const& all, std::size_t capacity, order asked) {
  CHECK(got.total == all.size());
  CHECK(got.stored.size() == std::min(capacity, all.size()));
  CHECK(got.complete == (capacity >= all.size()));
  CHECK(got.guards_intact);
  std::vector<collide::pair> stored, possible;
  for (auto const& x : got.stored) stored.push_back(pair_of(x));
  for (auto const& x : all) possible.push_back(pair_of(x));
  if (asked == order::canonical) CHECK(std::is_sorted(stored.begin(), stored.end()));
  std::sort(stored.begin(), stored.end());
  CHECK((std::adjacent_find(stored.begin(), stored.end()) == stored.end()));
  CHECK(std::includes(possible.begin(), possible.end(), stored.begin(), stored.end()));
}

/// The offsets are those of all pairs, whatever there is room for. `all` is in canonical order.
void check_rows(tests::rows const& got, std::vector<collide::pair> const& all, std::size_t spheres,
                std::size_t capacity, order asked) {
  std::vector<std::uint64_t> ends(spheres + 1, 0);
  for (auto p : all) ++ends[p.sphere + 1];
  for (std::size_t i = 0; i < spheres; ++i) ends[i + 1] += ends[i];
  CHECK((got.offsets == ends));
  tests::bounded<collide::pair> pairs{{}, got.triangles.total, got.triangles.complete, got.triangles.guards_intact};
  REQUIRE(got.triangles.stored.size() == std::min(capacity, all.size()));
  for (std::size_t i = 0; i < got.triangles.stored.size(); ++i) {
    pairs.stored.push_back({all[i].sphere, got.triangles.stored[i]});
    if (asked == order::canonical) CHECK(got.triangles.stored[i] == all[i].triangle);
  }
  check_bounded(pairs, all, capacity, asked);
}

}  // namespace

TEST_CASE_TEMPLATE("buffers: every capacity from none to one more than needed", S, float, double) {
  auto const made = tests::lattice_scene<S>(9, 25, 25, 2);
  std::size_t const exact = made.expect(0).exact.size();
  REQUIRE(exact > 40);
  REQUIRE(exact < 200);
  for (auto const& c : tests::compositions<S>()) {
    CAPTURE(c.name());
    auto const detector = c.make({});
    detector->build(made.mesh, tests::mesh_form::indexed);
    detector->place(made.spheres, tests::sphere_form::xyzr);
    auto const all = detector->pairs(order::canonical);
    auto const all_contacts = detector->contacts(order::canonical);
    REQUIRE(all.size() == exact);
    for (std::size_t capacity = 0; capacity <= exact + 1; ++capacity)
      for (auto asked : {order::unspecified, order::canonical}) {
        CAPTURE(capacity);
        check_bounded(detector->pairs_within(capacity, asked), all, capacity, asked);
        auto const contacts = detector->contacts_within(capacity, asked);
        check_bounded(contacts, all_contacts, capacity, asked);
        if (asked == order::canonical)  // the first ones, bit for bit
          CHECK(tests::same(
              contacts.stored,
              {all_contacts.begin(), all_contacts.begin() + static_cast<std::ptrdiff_t>(contacts.stored.size())}));
        check_rows(detector->csr_within(capacity, asked), all, made.spheres.size(), capacity, asked);
      }
  }
}

TEST_CASE_TEMPLATE("buffers: more pairs than a first guess has room for, and then fewer", S, float, double) {
  tests::scene<S> many, few;
  for (int i = 0; i < 60; ++i) many.mesh.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  for (int i = 0; i < 100; ++i) many.spheres.add({0.25, 0.25, 0.5 + i / 128.0}, 2);
  few = many;
  for (auto& r : few.spheres.radii) r = S(0.5);
  for (auto const& c : tests::compositions<S>()) {
    CAPTURE(c.name());
    auto const detector = c.make({});
    detector->build(many.mesh, tests::mesh_form::indexed);
    for (auto const* now : {&few, &many, &few, &many}) {
      detector->place(now->spheres, tests::sphere_form::xyz);
      std::size_t const hits = now == &many ? 6000 : 60;
      CHECK(detector->pairs(order::canonical).size() == hits);
      CHECK(detector->contacts(order::unspecified).size() == hits);
      CHECK(detector->pairs_within(5, order::unspecified).total == hits);
      CHECK(detector->count() == hits);
      CHECK(detector->csr(order::unspecified).triangles.stored.size() == hits);
    }
  }
}
