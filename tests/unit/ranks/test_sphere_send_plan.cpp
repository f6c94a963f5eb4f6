/// Which spheres of a rank go to which others, and that no others do.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/bucket.cuh>
#include <collide/ranks/distributed.hpp>
#include <collide/ranks/thread_ranks.hpp>
#include <collide/sinks/count.hpp>

#include "ranks/boxes.hpp"
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

using collide::detail::aabb;
constexpr int finest = collide::detail::coarse_grid::finest;

/// The map of so many ranks, as each of them has it, where each has some boxes.
class test_map {
 public:
  test_map(collide::thread_ranks const& ranks, std::vector<aabb<double>> const& mine) {
    auto all = aabb<double>::empty();
    for (auto const& box : mine) all = aabb<double>::merge()(all, box);
    collide::detail::coarse_grid grid;
    grid.build(ranks, all);
    map_.build(ranks, grid, [&](auto const& mark) {
      for (auto const& box : mine) mark(box);
    });
    lookup = map_.lookup(collide::host(1), memory_);
    extent = grid.meets(grid.bounds()) ? grid.bounds().max_extent() : 0;
  }

  collide::detail::rank_lookup lookup{};
  double extent = 0;

 private:
  collide::detail::rank_map map_;
  collide::detail::rank_map::lookup_memory memory_;
};

/// How many of some spheres the quick test passes, and how many have routes.
struct tally {
  std::size_t passed = 0, routed = 0;
  bool is_right = true;  ///< all that have routes have passed, and routes are those that the map says
};

/// Packs of so many spheres are tested at once.
template <int Items, class S, class Spheres>
std::vector<bool> passed_of(collide::detail::halo_filter<S> const& quick, Spheres const& spheres) {
  std::vector<bool> passed;
  for (std::size_t first = 0; first < spheres.size(); first += Items) {
    collide::detail::sphere_pack<S, Items> batch;
    batch.load(spheres, first);
    std::uint32_t const near = quick.mark(batch);
    for (std::size_t k = 0; k < Items && first + k < spheres.size(); ++k) passed.push_back((near >> k & 1) != 0);
  }
  return passed;
}

template <class S, class Spheres>
tally tally_of(test_map const& map, Spheres const& spheres, collide::thread_ranks const& ranks) {
  collide::detail::halo_filter<S> const quick(map.lookup, map.extent, spheres.common_radius());
  auto const passed = passed_of<32>(quick, spheres);
  tally t;
  t.is_right = passed == passed_of<4>(quick, spheres);
  t.passed = static_cast<std::size_t>(std::count(passed.begin(), passed.end(), true));
  std::vector<collide::pair> expected;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    bool goes = false;
    map.lookup.for_each_rank(collide::detail::reach_of(spheres, i, map.extent), [&](int r) {
      if (r == ranks.rank()) return;
      expected.push_back({static_cast<collide::id>(r), static_cast<collide::id>(i)});
      goes = true;
    });
    t.routed += goes;
    t.is_right = t.is_right && (!goes || passed[i]);
  }
  std::sort(expected.begin(), expected.end());
  collide::detail::sphere_send_plan routes;
  collide::host space(1);
  routes.find(space, map.lookup, spheres, ranks.rank(), ranks.size());
  t.is_right = t.is_right && routes.size() == expected.size();
  for (std::size_t r = 0, k = 0; t.is_right && r < static_cast<std::size_t>(ranks.size()); ++r) {
    auto const part = routes.of(r, 0, 1);
    for (std::size_t i = 0; i < part.size; ++i, ++k) t.is_right = t.is_right && part.first[i] == expected[k];
  }
  return t;
}

/// As `tally_of`, of spheres at rest and moving, of their own radii and, in turn, of each of the first `same` alone.
template <class S>
bool are_right(test_map const& map, tests::moving_scene<S> made, std::size_t same, collide::thread_ranks const& ranks) {
  bool so = tally_of<S>(map, made.spheres(), ranks).is_right && tally_of<S>(map, made.moving(), ranks).is_right;
  made.one_radius = true;
  for (std::size_t i = 0; i < same; ++i) {
    std::swap(made.radii[0], made.radii[i]);
    so = so && tally_of<S>(map, made.spheres(), ranks).is_right && tally_of<S>(map, made.moving(), ranks).is_right;
    std::swap(made.radii[0], made.radii[i]);
  }
  return so;
}

/// Spheres whose boxes begin, end or have their middle at the border of a cell of some level, or next to it; radii from
/// nothing to more than all cells, many of about half a cell. Some move, by such lengths as well.
template <class S>
tests::moving_scene<S> spheres_at_borders(collide::detail::coarse_grid const& grid, int n) {
  constexpr S huge = std::numeric_limits<S>::max(), infinite = std::numeric_limits<S>::infinity(),
              nan = std::numeric_limits<S>::quiet_NaN();
  std::mt19937 engine(5);
  auto const one_of = [&](auto const& some) {
    return some[std::uniform_int_distribution<std::size_t>(0, std::size(some) - 1)(engine)];
  };
  auto const width = [&](int axis, int level) {
    double const cells = grid.cells_on(axis, level);
    return cells > 0 ? 1 / cells : 1.;
  };
  auto const next_to = [&](double x) {  // or nearly so
    double const off = std::exp2(std::uniform_real_distribution<double>(-30, -2)(engine));
    S const at = static_cast<S>(x * (1 + one_of(std::vector<double>{0, 0, off, -off})));
    return one_of(std::vector<S>{at, std::nextafter(at, huge), std::nextafter(at, -huge)});
  };
  tests::moving_scene<S> made;
  for (int i = 0; i < n; ++i) {
    int const level = one_of(std::vector<int>{finest, finest, finest, finest - 1, 2, 0});
    double const wide = width(std::uniform_int_distribution<int>(0, 2)(engine), level);
    S radius = next_to(wide * one_of(std::vector<double>{0, 0.01, 0.25, 0.5, 0.5, 0.5, 1, 1.5}));
    if (i % 16 == 0) radius = one_of(std::vector<S>{S(0), S(-0.), S(-1), nan, infinite, huge});
    made.radii.push_back(radius);
    for (int k = 0; k < 3; ++k) {
      double const w = width(k, level), low = grid.bounds().lower[k];
      double const border = w * std::uniform_int_distribution<int>(-3, (1 << level) + 3)(engine);
      double const r = std::abs(static_cast<double>(radius)) < 1e30 ? static_cast<double>(radius) : 0;
      S at = next_to(low + border + r * one_of(std::vector<double>{-1, 0, 1}));
      if (i % 32 == 1) at = one_of(std::vector<S>{huge, -huge, infinite, nan, S(0), at});
      made.centres.push_back(at);
      S way = next_to(w * one_of(std::vector<double>{0, 0, 0.5, -0.5, 1, -1, 0.01, 3}));
      if (i % 64 == 2) way = one_of(std::vector<S>{huge, -huge, infinite, nan, S(0), way});
      made.displacements.push_back(i % 4 == 0 ? S(0) : way);
    }
  }
  return made;
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
    collide::detail::sphere_send_plan routes;
    routes.find(space, mesh.lookup(), spheres, ranks.rank(), ranks.size());
    double const extent = mesh.map().grid().bounds().max_extent();
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

TEST_CASE_TEMPLATE("sphere routes: the quick test loses none, at borders of cells and with any numbers", S, float,
                   double) {
  struct frame {
    double at[3], half[3];
  };
  double const far = 0.9 * static_cast<double>(std::numeric_limits<S>::max());
  // a cube; of no height; a line; a point; far away; so small and so large that numbers would overflow
  for (frame const& f : {frame{{1, 2, 3}, {8, 8, 8}}, frame{{0, 0, 5}, {3, 7, 0}}, frame{{0, 0, 0}, {0, 1, 0}},
                         frame{{4, 4, 4}, {0, 0, 0}}, frame{{9000, -70000, 1}, {1, 4, 0.25}},
                         frame{{0, 0, 0}, {1e-37, 1e-37, 1e-37}}, frame{{0, 0, 0}, {far, far, far}}}) {
    for (int const size : {1, 2, 5, 8, 70}) {
      std::atomic<int> wrong{0};
      collide::thread_ranks::run(size, [&](collide::thread_ranks const& ranks) {
        std::mt19937 engine(static_cast<unsigned>(100 + ranks.rank()));
        std::uniform_real_distribution<double> inside(-1, 1);
        std::vector<aabb<double>> mine;  // rank 1 has none, the others few and small ones, and together all corners
        for (int i = 0; i < (ranks.rank() == 1 ? 0 : 6); ++i) {
          auto box = aabb<double>::empty();
          for (int k = 0; k < 3; ++k) {
            bool const at_corner = i == 0 && ranks.rank() < 3;
            double const x = at_corner ? (ranks.rank() == 0 ? -1 : 1) : inside(engine);
            box.lower[k] = box.upper[k] = static_cast<double>(static_cast<S>(f.at[k] + f.half[k] * x));
          }
          mine.push_back(box);
        }
        test_map const map(ranks, mine);
        int const n = size == 70 ? 100 : 1500;
        if (!are_right(map, spheres_at_borders<S>(map.lookup.grid, n), size == 70 ? 2 : 16, ranks)) ++wrong;
      });
      CHECK_MESSAGE(wrong == 0, size << " ranks around " << f.at[0] << ", " << f.half[0]);
    }
  }
}

TEST_CASE_TEMPLATE("sphere routes: the quick test has room for what a reach is longer than a radius", S, float,
                   double) {
  std::atomic<int> wrong{0};
  collide::thread_ranks::run(2, [&](collide::thread_ranks const& ranks) {
    // thin, so that the reach of spheres is longer by a good part of a cell; rank 1 has a layer of cells, the 11th
    std::vector<aabb<double>> mine{tests::box_at(0, 0, 0, 0), tests::box_at(4096, 4096, 1, 0)};
    for (int i = 0; i < 32 * 32 && ranks.rank() == 1; ++i) {
      mine.push_back(tests::box_at(128 * (i % 32) + 64, 128 * (i / 32) + 64, 10.5 / 32, 0));
    }
    test_map const map(ranks, mine);
    tests::moving_scene<S> made;
    for (double off = 1; off > 1e-12; off /= 1.1) {
      made.centres.insert(made.centres.end(), {S(2000), S(2000), static_cast<S>((11.25 + off) / 32)});
      made.displacements.insert(made.displacements.end(), 3, S(0));
      made.radii.push_back(S(0.25 / 32));
    }
    tally const t = tally_of<S>(map, made.spheres(), ranks);
    if (!are_right(map, made, 1, ranks)) ++wrong;
    if (ranks.rank() == 0 && (t.routed == 0 || t.routed == made.radii.size())) ++wrong;
  });
  CHECK(wrong == 0);
}

TEST_CASE("sphere routes: no rank has a triangle, and more ranks than triangles") {
  for (int const triangles : {0, 1}) {
    std::atomic<int> wrong{0};
    collide::thread_ranks::run(3, [&](collide::thread_ranks const& ranks) {
      std::vector<aabb<double>> mine;
      if (ranks.rank() < triangles) mine.push_back(tests::box_at(0.5, 0.25, 0.5, 0.25));
      test_map const map(ranks, mine);
      auto made = spheres_at_borders<float>(map.lookup.grid, 500);
      for (std::size_t i = 0; i < made.centres.size(); ++i) made.centres[i] = 0.5f;
      if (!are_right(map, made, 8, ranks)) ++wrong;
    });
    CHECK(wrong == 0);
  }
}

TEST_CASE("sphere routes: ranks beyond the 64th are others, too") {
  constexpr int size = 70;
  std::atomic<int> wrong{0};
  collide::thread_ranks::run(size, [&](collide::thread_ranks const& ranks) {
    tests::moving_scene<float> made;  // a sphere at the box of each rank, where there is no other
    for (int r = 0; r < size; ++r) {
      for (int const at : {r % 8, r / 8, 0}) made.centres.push_back(static_cast<float>(at));
      made.radii.push_back(0.01f);
      made.displacements.insert(made.displacements.end(), 3, 0.01f);
    }
    test_map const map(ranks, {tests::box_at(ranks.rank() % 8, ranks.rank() / 8, 0, 0)});
    if (!are_right(map, made, 1, ranks) || tally_of<float>(map, made.spheres(), ranks).routed != size - 1) ++wrong;
  });
  CHECK(wrong == 0);
}

TEST_CASE("sphere routes: the quick test passes few more than have routes, of any radius that all have") {
  std::vector<double> needless;
  // the other rank has one cell of 32 x 32 x 32, in the middle
  collide::thread_ranks::run(2, [&](collide::thread_ranks const& ranks) {
    std::vector<aabb<double>> mine{tests::box_at(16, 16, 16, 16)};
    if (ranks.rank() == 1) mine = {tests::box_at(16.5, 16.5, 16.5, 0.25)};
    test_map const map(ranks, mine);
    if (ranks.rank() == 1) return;
    tests::moving_scene<float> made;
    made.one_radius = true;
    for (int i = 0; i < 64 * 64 * 64; ++i) {
      for (int const at : {i % 64, i / 64 % 64, i / 4096}) made.centres.push_back(static_cast<float>(at) - 15.75f);
    }
    made.radii.assign(made.centres.size() / 3, 0);
    made.displacements.assign(made.centres.size(), 0.01f);
    for (float const radius : {0.f, 0.45f, 0.9f, 1.9f, 3.9f}) {
      made.radii.assign(made.radii.size(), radius);
      for (tally const& t : {tally_of<float>(map, made.spheres(), ranks), tally_of<float>(map, made.moving(), ranks)}) {
        CHECK(t.is_right);
        CHECK(t.routed > 0);
        double const across = std::exp2(std::ceil(std::log2(std::max(1.f, 2 * radius))));  // of its cells, two of which
        CHECK(static_cast<double>(t.passed) <= 1.1 * std::pow(2 * across, 3));             // it may begin in
      }
    }
  });
}
