/// Which spheres of a rank go to which others, and that no others do.
#include <cstddef>
#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include <collide/bucket.cuh>
#include <collide/count.hpp>
#include <collide/distributed.hpp>
#include <collide/thread_ranks.hpp>

#include "swept_queries.hpp"

namespace {

/// Any ranks; counts the bytes that they send.
template <class Ranks>
struct counted_ranks : Ranks {
  std::size_t* sent;
  counted_ranks(Ranks const& ranks, std::size_t* count) : Ranks(ranks), sent{count} {}
  void exchange(void const* from, std::uint64_t const* to_each, void* to, std::uint64_t const* of_each,
                std::size_t bytes) const {
    for (int r = 0; r < this->size(); ++r) *sent += static_cast<std::size_t>(to_each[r]) * bytes;
    Ranks::exchange(from, to_each, to, of_each, bytes);
  }
};

tests::moving_scene<float> scene() {
  tests::motion m;
  m.size = 12;
  m.triangle = 0.5;
  m.radius = 0.3;
  m.longest = 1;
  m.triangles = 600;
  m.spheres = 5000;
  return tests::random_motion<float>(9, m);
}

/// The triangles of one of so many ranks.
collide::mesh_view<float> part_of(tests::moving_scene<float> const& made, int rank, int ranks) {
  std::size_t const n = made.mesh().size() / static_cast<std::size_t>(ranks);
  return collide::triangle_soup(made.corners.data() + 9 * n * static_cast<std::size_t>(rank), n);
}

}  // namespace

TEST_CASE("sphere routes: those that the map says, by rank and sphere, in any number of rounds") {
  auto const made = scene();
  std::vector<int> wrong(3, 0);
  collide::thread_ranks::run(3, [&](collide::thread_ranks const& ranks) {
    collide::host space(2);
    collide::detail::divided_mesh<float> mesh;
    mesh.build(ranks, space, part_of(made, ranks.rank(), 3));
    auto const spheres = made.moving();
    collide::detail::sphere_routes routes;
    routes.find(space, mesh.lookup(), spheres, ranks.rank(), ranks.size());
    double const extent = mesh.map().grid().frame().max_extent();
    std::size_t all = 0;
    int& mine = wrong[static_cast<std::size_t>(ranks.rank())];
    for (int r = 0; r < 3; ++r) {
      std::vector<collide::id> expected;
      for (std::size_t i = 0; i < spheres.size() && r != ranks.rank(); ++i) {
        mesh.map().for_each_rank(collide::detail::reach_of(spheres, i, extent), [&](int to) {
          if (to == r) expected.push_back(static_cast<collide::id>(i));
        });
      }
      all += expected.size();
      for (std::uint64_t const rounds : {1, 2, 7}) {
        std::vector<collide::id> found;
        for (std::uint64_t round = 0; round < rounds; ++round) {
          auto const part = routes.of(static_cast<std::size_t>(r), round, rounds);
          for (std::size_t i = 0; i < part.size; ++i) found.push_back(part.first[i].triangle);
        }
        mine += found != expected;
      }
    }
    mine += routes.size() != all || all == 0;
  });
  CHECK(wrong == std::vector<int>(3, 0));
}

TEST_CASE("sphere routes: one rank sends nothing, and two only what the other may need") {
  using detector = collide::detector<collide::bucket>;
  auto const made = scene();
  std::size_t sent = 0;
  counted_ranks<collide::one_rank> const one({}, &sent);
  collide::distributed<detector, counted_ranks<collide::one_rank>> alone(one, collide::host(1));
  alone.build(made.mesh(), collide::divided);
  sent = 0;
  CHECK(alone.query(made.spheres(), collide::count()).total() > 0);
  CHECK(sent == 0);

  std::vector<std::size_t> of(2, 0);
  collide::thread_ranks::run(2, [&](collide::thread_ranks const& threads) {
    auto& mine = of[static_cast<std::size_t>(threads.rank())];
    counted_ranks<collide::thread_ranks> const ranks(threads, &mine);
    collide::distributed<detector, counted_ranks<collide::thread_ranks>> parts(ranks, collide::host(1));
    parts.build(part_of(made, threads.rank(), 2), collide::divided);
    mine = 0;
    parts.query(made.spheres(), collide::count());
  });
  for (std::size_t const bytes : of) {
    CHECK(bytes > 0);
    CHECK(bytes < 16 * made.spheres().size());  // not all of them, and none to itself
  }
}
