/// Ranks that are threads, with spheres and triangles in memory of a device.
#include <collide/ranks/thread_ranks.hpp>

#include "ranks/ranks.hpp"

namespace {

/// One detector of everything, and ranks that divide it, hold the same bytes in each sink.
template <class NarrowPhase, class Space, class Spheres>
void check_device(collide::thread_ranks const& ranks, tests::moving_scene<float> const& made, Spheres const& spheres_of,
                  bool is_divided, tests::complaints& wrong) {
  using detector = collide::detector<collide::bucket, NarrowPhase, Space>;
  using collide::order;
  Space const space;
  tests::placed_scene<float> const all(space, made);
  auto const triangles = tests::part_of(made.mesh().size(), tests::split::evenly, ranks.rank(), ranks.size());
  auto const own = tests::part_of(made.radii.size(), tests::split::odd, ranks.rank(), ranks.size());
  tests::moving_scene<float> mine = made;
  mine.corners.assign(made.corners.begin() + static_cast<std::ptrdiff_t>(9 * triangles.first),
                      made.corners.begin() + static_cast<std::ptrdiff_t>(9 * (triangles.first + triangles.size)));
  tests::placed_scene<float> const part(space, mine);

  detector whole(space);
  whole.build(all.mesh);
  collide::distributed<detector, collide::thread_ranks> parts(ranks, space, {}, 37);
  if (is_divided) {
    parts.build(part.mesh, collide::divided);
  } else {
    parts.build(all.mesh, collide::on_every_rank);
  }
  auto const spheres = spheres_of(all).subview(own.first, own.size);
  auto const found = whole.query(spheres, collide::count()).total();
  auto const counted = parts.query(spheres, collide::count());
  wrong.expect(counted.total() == found, "count");
  wrong.expect(parts.total(counted) >= found, "total");
  auto const rows = parts.query(spheres, collide::csr(order::canonical)).to_host();
  wrong.expect(rows.triangles.size() == found, "rows");
  wrong.expect(parts.query(spheres, collide::any_hit()).to_host() == whole.query(spheres, collide::any_hit()).to_host(),
               "flags");
  wrong.expect(parts.query(spheres, collide::pairs(order::canonical)).to_host() ==
                   whole.query(spheres, collide::pairs(order::canonical)).to_host(),
               "pairs");
  if constexpr (collide::detail::is_discrete<NarrowPhase, float>) {
    wrong.expect(tests::equal_bytes(parts.query(spheres, collide::contacts<float>(order::canonical)).to_host(),
                                    whole.query(spheres, collide::contacts<float>(order::canonical)).to_host()),
                 "contacts");
    wrong.expect(tests::equal_bytes(parts.query(spheres, collide::closest_contact<float>()).to_host(),
                                    whole.query(spheres, collide::closest_contact<float>()).to_host()),
                 "closest_contact");
  } else {
    wrong.expect(tests::equal_bytes(parts.query(spheres, collide::impacts<float>(order::canonical)).to_host(),
                                    whole.query(spheres, collide::impacts<float>(order::canonical)).to_host()),
                 "impacts");
    wrong.expect(tests::equal_bytes(parts.query(spheres, collide::earliest_impact<float>()).to_host(),
                                    whole.query(spheres, collide::earliest_impact<float>()).to_host()),
                 "first impacts");
  }
}

template <class Space>
void check_devices() {
  auto const made = tests::hard_scene<float>();
  for (int const n : {1, 2, 5}) {
    std::vector<tests::complaints> wrong(static_cast<std::size_t>(n));
    collide::thread_ranks::run(n, [&](collide::thread_ranks const& ranks) {
      collide::cuda_check(cudaSetDevice(ranks.rank() % collide::cuda_device_count()), "cudaSetDevice");
      auto& mine = wrong[static_cast<std::size_t>(ranks.rank())];
      for (bool const is_divided : {false, true}) {
        check_device<collide::karabassi<>, Space>(
            ranks, made, [](auto const& s) { return collide::sphere_view<float>(s.moving); }, is_divided, mine);
        check_device<collide::karabassi_swept<>, Space>(
            ranks, made, [](auto const& s) { return s.moving; }, is_divided, mine);
      }
    });
    for (auto const& w : wrong) CHECK(w.text() == "");
  }
}

}  // namespace

TEST_CASE("ranks: queries find what one detector finds, in device memory") {
  check_devices<collide::cuda>();
  check_devices<collide::cuda_shared>();
}
