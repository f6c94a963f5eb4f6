/// Once there is room, and all has run once, nothing is allocated as hits grow: neither from the space's resource nor
/// by operator new.
#include <vector>

#include <doctest/doctest.h>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/bvh.cuh>
#include <collide/karabassi_swept.hpp>
#include <collide/sinks/csr.hpp>
#include <collide/sinks/earliest.hpp>
#include <collide/sinks/impacts.hpp>

#include "counted_new.hpp"
#include "type_erased_detector.hpp"

namespace {

using collide::host, collide::order, collide::pair;

/// Triangles all at one place, and spheres of which the first `near` touch them all.
struct crowd {
  static constexpr std::size_t triangles = 2, spheres = 100000, most = triangles * spheres;
  std::vector<float> corners, centres = std::vector<float>(3 * spheres), ways = std::vector<float>(3 * spheres);

  crowd() {
    for (std::size_t i = 0; i < triangles; ++i) corners.insert(corners.end(), {0, 0, 0, 1, 0, 0, 0, 1, 0});
  }
  collide::mesh_view<float> mesh() const { return collide::triangle_soup(corners.data(), triangles); }
  collide::sphere_view<float> view(std::size_t near) {
    for (std::size_t i = 0; i < spheres; ++i) centres[3 * i + 2] = i < near ? 0.5f : 100.0f;
    return collide::spheres_xyz(static_cast<float const*>(centres.data()), spheres, 1.0f);
  }
};

/// Queries of many spheres near the mesh allocate nothing that those of few, with room in all sinks, have not.
template <class Detector, class View, class... Sink>
void check_no_allocation(Detector& detector, tests::counting_resource& memory, crowd& scene, View const& view,
                         Sink&... sink) {
  auto const query = [&](std::size_t near) {
    auto const spheres = view(near);
    (detector.query(spheres, sink), ...);
    (detector.query(spheres, sink), ...);
  };
  auto const taken = memory.allocations;
  detector.build(scene.mesh());
  detector.reserve(crowd::spheres, crowd::most, sink...);
  query(10);
  auto const before = memory.allocations, news_before = tests::counted_news();
  CHECK(before > taken);
  for (auto const near : {crowd::spheres / 50, crowd::spheres / 5, crowd::spheres, std::size_t{0}, crowd::spheres})
    query(near);
  auto const news_after = tests::counted_news();
  CHECK(memory.allocations == before);
  CHECK(news_after == news_before);
}

template <class Broad>
void check_spheres_at_rest(int threads) {
  CAPTURE(threads);
  crowd scene;
  tests::counting_resource memory(std::pmr::new_delete_resource());
  collide::detector<Broad> detector(host(threads, &memory));
  collide::count count;
  collide::any_hit any;
  collide::pairs pairs, sorted_pairs(order::canonical);
  collide::contacts<float> contacts, sorted_contacts(order::canonical);
  collide::closest<float> closest;
  collide::closest_contact<float> closest_contact;
  collide::csr rows, sorted_rows(order::canonical);
  auto const view = [&](std::size_t near) { return scene.view(near); };
  check_no_allocation(detector, memory, scene, view, count, any, pairs, sorted_pairs, contacts, sorted_contacts,
                      closest, closest_contact, rows, sorted_rows);
  for (std::uint64_t const total : {count.total(), pairs.total(), sorted_contacts.total(), rows.total()})
    CHECK(total == crowd::most);

  std::vector<std::uint8_t> flags(crowd::spheres);
  std::vector<pair> to(crowd::most), sorted_to(crowd::most);
  std::vector<collide::contact<float>> contacts_to(crowd::most), sorted_contacts_to(crowd::most);
  std::vector<std::uint64_t> offsets(crowd::spheres + 1), sorted_offsets(crowd::spheres + 1);
  std::vector<collide::id> triangles(crowd::most), sorted_triangles(crowd::most);
  collide::any_hit own_any(flags.data());
  collide::pairs own_pairs(to.data(), to.size()), own_sorted_pairs(sorted_to.data(), crowd::most, order::canonical);
  collide::contacts<float> own_contacts(contacts_to.data(), crowd::most);
  collide::contacts<float> own_sorted_contacts(sorted_contacts_to.data(), crowd::most, order::canonical);
  collide::csr own_rows(offsets.data(), triangles.data(), crowd::most);
  collide::csr own_sorted_rows(sorted_offsets.data(), sorted_triangles.data(), crowd::most, order::canonical);
  check_no_allocation(detector, memory, scene, view, own_any, own_pairs, own_sorted_pairs, own_contacts,
                      own_sorted_contacts, own_rows, own_sorted_rows);
  CHECK(own_sorted_pairs.complete());
  CHECK((sorted_to.back() == pair{crowd::spheres - 1, crowd::triangles - 1}));
  CHECK(own_rows.complete());
  CHECK(sorted_offsets.back() == crowd::most);
}

/// Broad phase that counts what it was asked to make room for.
struct asked : collide::all_pairs {
  template <class S>
  struct index : collide::all_pairs::index<S> {
    template <class Space>
    void reserve(Space&, std::size_t spheres) {
      for_spheres = spheres;
    }
    static inline std::size_t for_spheres = 0;
  };
};

}  // namespace

TEST_CASE("allocation: none as hits grow, in sinks with memory of their own and with the caller's") {
  std::size_t const before = tests::counted_news();
  int* volatile const number = new int;  // so that compilers do not leave it out
  delete number;
  CHECK(tests::counted_news() > before);  // they are counted
  for (int const threads : {1, 2}) {
    check_spheres_at_rest<collide::all_pairs>(threads);
    check_spheres_at_rest<collide::bucket>(threads);
    check_spheres_at_rest<collide::bvh>(threads);
  }
}

TEST_CASE("allocation: none as spheres that move hit more") {
  crowd scene;
  tests::counting_resource memory(std::pmr::new_delete_resource());
  collide::detector<collide::bucket, collide::karabassi_swept<>> detector(host(2, &memory));
  collide::impacts<float> impacts, sorted_impacts(order::canonical);
  collide::earliest<float> earliest;
  collide::earliest_impact<float> earliest_impact;
  auto const view = [&](std::size_t near) {
    return collide::with_displacements(scene.view(near), static_cast<float const*>(scene.ways.data()));
  };
  check_no_allocation(detector, memory, scene, view, impacts, sorted_impacts, earliest, earliest_impact);
  CHECK(earliest.total() == crowd::most);
}

TEST_CASE("allocation: a broad phase is asked to make room too") {
  collide::detector<asked> detector;
  detector.reserve(123, 4567);
  CHECK(asked::index<float>::for_spheres == 123);
}
