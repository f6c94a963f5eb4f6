/// Spheres in chunks, on the host.
#include <collide/detectors/detail/contiguous_ranges.hpp>

#include "compositions.hpp"
#include "streaming/streamed.hpp"

namespace {

template <class S, class Broad, class... Space>
void check_spaces(tests::list<Space...>) {
  (tests::check_streamed<Broad, S>(Space(2), std::pmr::new_delete_resource()), ...);
}

template <class S, class... Broad>
void check_broad_phases(tests::list<Broad...>) {
  (check_spaces<S, Broad>(tests::host_spaces{}), ...);
}

/// Copies the pieces of a view, and returns how many there were, or 0 if the copy is not of the same spheres.
template <class S, class Spheres, class Same>
int copied_pieces(Spheres const& spheres, Same const& same) {
  collide::detail::contiguous_ranges<Spheres> const pieces(spheres);
  std::vector<S> to(pieces.size(), S(-1));
  int n = 0;
  Spheres const copied = pieces.copy(to.data(), [&](S* there, S const* from, std::size_t size) {
    CHECK(there - to.data() + static_cast<std::ptrdiff_t>(size) <= static_cast<std::ptrdiff_t>(to.size()));
    CHECK((there - to.data()) % 64 == 0);
    std::copy(from, from + size, there);
    ++n;
  });
  CHECK(copied.size() == spheres.size());
  for (std::size_t i = 0; i < spheres.size(); ++i) n = same(copied[i], spheres[i]) ? n : 0;
  return n;
}

bool equal(collide::sphere<float> const& a, collide::sphere<float> const& b) {
  return a.centre == b.centre && a.radius == b.radius;
}

}  // namespace

TEST_CASE("streamed: chunks find what a query of all spheres finds, on the host, floats") {
  check_broad_phases<float>(tests::broad_phases{});
}

TEST_CASE("streamed: chunks find what a query of all spheres finds, on the host, doubles") {
  check_broad_phases<double>(tests::broad_phases{});
}

TEST_CASE("streamed: spheres that move, on the host") {
  tests::check_streamed_swept<collide::bucket, float>(collide::host(2), std::pmr::new_delete_resource());
  tests::check_streamed_swept<collide::all_pairs, double>(collide::host(2), std::pmr::new_delete_resource());
}

TEST_CASE("streamed: no spheres, no chunk, exceptions on the way, on the host") {
  tests::check_streamed_edges(collide::host(2), std::pmr::new_delete_resource());
  tests::check_streamed_edges(tests::lockstep<64, true>(1), std::pmr::new_delete_resource());
}

TEST_CASE("streamed: spheres in any layout are copied in as few pieces as there are arrays") {
  tests::layouts<float> const from(30, std::pmr::new_delete_resource());
  std::vector<int> pieces;
  for (auto const& layout : from.all()) {
    auto const& spheres = layout.spheres;
    CAPTURE(layout.name);
    pieces.push_back(copied_pieces<float>(spheres, equal));
    CHECK(copied_pieces<float>(spheres.subview(11, 1), equal) == pieces.back());
  }
  CHECK(pieces == std::vector<int>{2, 1, 4, 3, 1, 1});
  auto const equally = [](collide::moving_sphere<float> const& a, collide::moving_sphere<float> const& b) {
    return equal(a, b) && a.displacement == b.displacement;
  };
  auto const moving = collide::with_displacements(from.xyz(), from.ways());
  CHECK(copied_pieces<float>(moving, equally) == 3);
  CHECK(copied_pieces<float>(moving.subview(7, 20), equally) == 3);
  // a record of everything, and all displacements alike
  float const* const xyz = from.xyz().centres().address(0);
  auto const records = collide::spheres_at(collide::points(xyz, 10, 9), xyz + 3, 9);
  auto const ways = collide::points(xyz + 8, xyz + 6, xyz + 7, 10, 9);
  CHECK(copied_pieces<float>(collide::with_displacements(records, ways), equally) == 1);
  auto const& spheres = from.all()[1].spheres;
  auto const alike = collide::points(xyz, xyz, xyz, spheres.size(), 0);
  CHECK(copied_pieces<float>(collide::with_displacements(spheres, alike), equally) > 0);
}

TEST_CASE("streamed: parts of views") {
  tests::layouts<double> const from(30, std::pmr::new_delete_resource());
  for (auto const& layout : from.all()) {
    auto const& spheres = layout.spheres;
    CAPTURE(layout.name);
    auto const moving = collide::with_displacements(spheres, from.ways());
    auto const part = moving.subview(10, 5);
    CHECK(part.size() == 5);
    CHECK(part[4].centre == moving[14].centre);
    CHECK(part[4].radius == moving[14].radius);
    CHECK(part[4].displacement == moving[14].displacement);
    CHECK(spheres.subview(10, 5)[0].centre == moving[10].centre);
    CHECK(spheres.subview(30, 0).size() == 0);
  }
}
