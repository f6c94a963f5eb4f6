/// To which ranks boxes go, against all boxes of all ranks.
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include <doctest/doctest.h>

#include <collide/ranks/detail/rank_map.hpp>
#include <collide/ranks/thread_ranks.hpp>

#include "ranks/boxes.hpp"

using collide::detail::aabb;
using tests::overlap;

namespace {

aabb<double> random_box(std::mt19937& engine, double at_x) {
  std::uniform_real_distribution<double> uniform(-1, 1), size(-8, -1);
  double const half = std::exp2(size(engine)), x = at_x + uniform(engine), y = uniform(engine), z = uniform(engine);
  return tests::box_at(x, y, z, half);
}

}  // namespace

TEST_CASE("rank map: a box goes to all ranks that have a box that meets it, and not to all others") {
  for (int size : {1, 3, 70}) {
    // the boxes of rank r are near x = r; rank 1 has none
    std::vector<std::vector<aabb<double>>> boxes(static_cast<std::size_t>(size));
    std::mt19937 engine(1);
    for (int r = 0; r < size; ++r) {
      for (int i = 0; i < (r == 1 ? 0 : 50); ++i) boxes[static_cast<std::size_t>(r)].push_back(random_box(engine, r));
    }
    std::vector<int> missing(static_cast<std::size_t>(size)), needless = missing, rising = missing;
    collide::thread_ranks::run(size, [&](auto const& ranks) {
      auto const me = static_cast<std::size_t>(ranks.rank());
      auto extent = aabb<double>::empty();
      for (auto const& b : boxes[me]) extent = typename aabb<double>::merge{}(extent, b);
      collide::detail::coarse_grid grid;
      grid.build(ranks, extent);
      collide::detail::rank_map map;
      map.build(ranks, grid, [&](auto const& f) {
        for (auto const& b : boxes[me]) f(b);
      });
      std::mt19937 own(7);  // each rank asks for the same boxes
      std::uniform_real_distribution<double> anywhere(-3, size + 2);
      for (int i = 0; i < 200; ++i) {
        auto const box = random_box(own, anywhere(own));
        std::vector<int> found;
        map.for_each_rank(box, [&](int r) { found.push_back(r); });
        std::set<int> const all(found.begin(), found.end());
        rising[me] += std::vector<int>(all.begin(), all.end()) == found;
        for (int r = 0; r < size; ++r) {
          bool meets = false;
          for (auto const& b : boxes[static_cast<std::size_t>(r)]) meets = meets || overlap(b, box);
          missing[me] += meets && all.count(r) == 0;
          needless[me] += !meets && all.count(r) != 0;
        }
      }
    });
    for (std::size_t r = 0; r < missing.size(); ++r) {
      CHECK(missing[r] == 0);
      CHECK(rising[r] == 200);
      if (size == 70) CHECK(needless[r] <= 200 * size / 2);
    }
  }
}
