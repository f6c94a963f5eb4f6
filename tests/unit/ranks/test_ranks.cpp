/// Ranks that are threads, on the host, and detectors on them.
#include <algorithm>
#include <atomic>
#include <thread>

#include <collide/ranks/thread_ranks.hpp>

#include "ranks/ranks.hpp"

namespace {

/// Calls check(ranks, complaints) on so many threads; returns what is wrong.
template <class Check>
std::string on_threads(int n, Check const& check) {
  std::vector<tests::complaints> wrong(static_cast<std::size_t>(n));
  collide::thread_ranks::run(
      n, [&](collide::thread_ranks const& ranks) { check(ranks, wrong[static_cast<std::size_t>(ranks.rank())]); });
  std::string all;
  for (int r = 0; r < n; ++r) {
    auto const& text = wrong[static_cast<std::size_t>(r)].text();
    if (!text.empty()) all += "rank " + std::to_string(r) + ": " + text;
  }
  return all;
}

/// The error that `run` throws.
template <class F>
std::string thrown(int n, F const& f) {
  try {
    collide::thread_ranks::run(n, f);
  } catch (std::exception const& e) {
    return e.what();
  }
  return "nothing";
}

}  // namespace

TEST_CASE("ranks: members, agreement and short memory, one to eight threads") {
  for (int n = 1; n <= 8; ++n) {
    CAPTURE(n);
    CHECK(on_threads(n, [](auto const& r, auto& wrong) { tests::check_members(r, wrong); }) == "");
    CHECK(on_threads(n, [](auto const& r, auto& wrong) { tests::check_agreement(r, wrong); }) == "");
  }
  for (int const n : {1, 2, 3}) {
    CHECK(on_threads(n, [](auto const& r, auto& wrong) { tests::check_short_memory(r, wrong); }) == "");
  }
  tests::complaints wrong;
  tests::check_members(collide::one_rank(), wrong);
  tests::check_both(collide::one_rank(), tests::random_motion<float>(7, {}), {}, wrong);
  CHECK(wrong.text() == "");
}

TEST_CASE("ranks: queries find what one detector finds, one rank and a few") {
  for (int n = 1; n <= 4; ++n) {
    CHECK(on_threads(n, [](auto const& r, auto& wrong) { tests::check_queries(r, wrong); }) == "");
  }
}

TEST_CASE("ranks: queries find what one detector finds, up to eight ranks") {
  for (int n = 5; n <= 8; ++n) {
    CHECK(on_threads(n, [](auto const& r, auto& wrong) { tests::check_queries(r, wrong); }) == "");
  }
}

TEST_CASE("ranks: more ranks than a word has bits") {
  CHECK(on_threads(67, [](auto const& r, auto& wrong) {
          tests::motion m;
          m.triangles = 300;
          m.spheres = 300;
          auto const made = tests::random_motion<float>(8, m);
          tests::check_sinks<collide::detector<collide::bucket>>(r, made, made.spheres(), {}, wrong);
        }) == "");
}

TEST_CASE("ranks: triangles are divided evenly, and those near each other are on one rank") {
  tests::motion m;
  m.size = 12;
  m.triangle = 0.1;
  m.triangles = 4000;
  auto const made = tests::random_motion<float>(9, m);
  for (tests::split const how : {tests::split::evenly, tests::split::first, tests::split::odd}) {
    collide::thread_ranks::run(4, [&](collide::thread_ranks const& ranks) {
      auto const part = tests::part_of(made.mesh().size(), how, ranks.rank(), ranks.size());
      collide::detail::divided_mesh<float> mesh;
      mesh.build(ranks, collide::host(1), collide::triangle_soup(made.corners.data() + 9 * part.first, part.size));
      std::size_t ranks_of_boxes = 0;
      for (std::size_t i = 0; i < mesh.view().size(); ++i) {
        mesh.map().for_each_rank(mesh[i].box(), [&](int) { ++ranks_of_boxes; });
      }
      collide::together(ranks, [&] {
        if (mesh.size() != 4000) throw collide::error("not all triangles are there");
        if (mesh.view().size() < 900 || mesh.view().size() > 1100) throw collide::error("not divided evenly");
        if (ranks_of_boxes > mesh.view().size() * 3 / 2) throw collide::error("not divided by place");
      });
    });
  }
}

TEST_CASE("ranks: nobody waits for a rank that has thrown, or ended") {
  auto const gather = [](collide::thread_ranks const& ranks) {
    std::vector<int> all(static_cast<std::size_t>(ranks.size()));
    int const mine = ranks.rank();
    ranks.all_gather(&mine, sizeof mine, all.data());
  };
  std::atomic<int> heard{0};
  CHECK(thrown(4, [&](collide::thread_ranks const& ranks) {
          gather(ranks);
          if (ranks.rank() == 2) throw collide::error("of mine");
          try {
            gather(ranks);
          } catch (collide::rank_error const& e) {
            heard += std::string(e.what()) == "collide: rank 2 of 4 failed: of mine";
            throw;
          }
        }) == "of mine");
  CHECK(heard == 3);
  CHECK(thrown(3, [&](collide::thread_ranks const& ranks) {
          if (ranks.rank() != 1) gather(ranks);
        }) == "collide: rank 1 of 3 has ended, and others wait for it");
  CHECK_THROWS_AS(collide::thread_ranks::run(3, [](auto const& ranks) { ranks.rank() == 1 ? throw 1 : 0; }), int);
  CHECK(thrown(0, gather) == "collide: thread_ranks: there must be at least one rank");
}

TEST_CASE("ranks: those of one process share the threads of the host") {
  int offered = 0;
  std::thread([&] { offered = collide::host().threads(); }).join();
  for (int const n : {1, 2, offered, offered + 1}) {
    std::atomic<int> wrong{0};
    collide::thread_ranks::run(n, [&](collide::thread_ranks const&) {
      if (collide::host().threads() != std::max(1, offered / n)) ++wrong;
      if (collide::host(1).threads() != 1) ++wrong;
    });
    CHECK(wrong == 0);
  }
}

TEST_CASE("ranks: what makes no sense is refused on all ranks") {
  using detector = collide::detector<collide::bucket>;
  CHECK(thrown(2, [](collide::thread_ranks const& ranks) {
          collide::distributed<detector, collide::thread_ranks> parts(ranks, collide::host(1), {}, 0);
        }) == "collide: distributed: chunk is 0");
  std::atomic<int> refused{0};
  collide::thread_ranks::run(
      3, [&](collide::thread_ranks const& ranks) {  // one has no memory, and nobody has a mesh then
        tests::short_memory memory;
        if (ranks.rank() == 1) memory.left = 0;
        auto const made = tests::random_motion<float>(2, {});
        collide::distributed<detector, collide::thread_ranks> parts(ranks, collide::host(1, &memory));
        try {
          parts.build(made.mesh(), collide::divided);
        } catch (std::exception const&) {
          ++refused;
        }
        try {
          parts.query(made.spheres(), collide::count());
        } catch (collide::error const&) {
          ++refused;
        }
      });
  CHECK(refused == 6);
  std::string const missing = "collide: detector: query needs a mesh: call build before it";
  CHECK(thrown(2, [](collide::thread_ranks const& ranks) {
          collide::distributed<detector, collide::thread_ranks> parts(ranks, collide::host(1));
          parts.query({}, collide::count());
        }) == missing);
  CHECK(thrown(2, [](collide::thread_ranks const& ranks) {
          collide::distributed<detector, collide::thread_ranks> parts(ranks, collide::host(1));
          parts.build({}, ranks.rank() == 1 ? -1.0f : 1.0f, collide::on_every_rank);
        }) == "collide: detector: the radius passed to build is negative or NaN");
  CHECK(thrown(3, [](collide::thread_ranks const& ranks) {  // views of which no triangle is read
          float const some[9] = {};
          collide::distributed<detector, collide::thread_ranks> parts(ranks, collide::host(1));
          parts.build(collide::triangle_soup(some, collide::no_id / 2), collide::divided);
        }) == "collide: a mesh has at most 2^32 - 2 triangles, also on many ranks");
}
