/// Which centres and paths are in cells with triangles, against the cells themselves.
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/broad/detail/grid/occupancy.hpp>

using namespace collide::detail;

namespace {

/// A grid of one level, of 8 x 4 x 16 cells of 0.5, of which a third have triangles.
template <class S>
struct scene {
  grid<S> cells{};
  std::vector<std::uint8_t> occupied;
  occupancy_view<S> occupancy;

  explicit scene(S x = 0) : occupied(8 * 4 * 16 / 8 + 1) {
    S const lower[3] = {x - 2, -1, 3};
    std::uint32_t const across[3] = {8, 4, 16};
    cells.levels = 1;
    for (int k = 0; k < 3; ++k) {
      cells.lower[k] = lower[k];
      cells.upper[k] = lower[k] + S(0.5) * static_cast<S>(across[k]) - S(1e-3);
      cells.level[0].mask[k] = across[k] - 1;
      occupancy.lower[k] = lower[k];
      occupancy.extent[k] = to_bits(cells.upper[k] - lower[k]);
    }
    cells.level[0].width = S(0.5);
    cells.level[0].inverse_width = 2;
    cells.level[0].stride[0] = 8;
    cells.level[0].stride[1] = 32;
    cells.level[0].first = 3;
    std::mt19937 engine(1);
    for (std::uint32_t c = 3; c < 3 + 8 * 4 * 16; ++c) {
      if (engine() % 3 == 0) occupied[c / 8] = static_cast<std::uint8_t>(occupied[c / 8] | 1 << c % 8);
    }
    occupancy.level = cells.level[0];
    occupancy.occupied = occupied.data();
  }

  /// True if a point is in a cell with triangles.
  bool expects(collide::vec3<S> const& p) const {
    if (!cells.contains(p.x(), p.y(), p.z())) return false;
    std::uint32_t const c = cells.cell_at(cells.level[0], p).number;
    return (occupied[c / 8] >> c % 8 & 1) != 0;
  }
};

}  // namespace

TEST_CASE_TEMPLATE("occupancy: centres, inside the grid and outside, and what is not finite", S, float, double) {
  scene<S> const made;
  std::mt19937 engine(2);
  std::uniform_real_distribution<S> uniform(-8, 12);
  constexpr S strange[] = {std::numeric_limits<S>::infinity(), -std::numeric_limits<S>::infinity(),
                           std::numeric_limits<S>::quiet_NaN(), std::numeric_limits<S>::max()};
  int found = 0;
  for (int round = 0; round < 20000; ++round) {
    S x[4], y[4], z[4];
    bool near[4];
    for (int k = 0; k < 4; ++k) {
      x[k] = uniform(engine) / 3, y[k] = uniform(engine) / 5, z[k] = uniform(engine);
      if (round % 100 == 0) (k == 0 ? x : k == 1 ? y : z)[k] = strange[round / 100 % 4];
    }
    auto const places = made.occupancy.places_of(x, y, z);
    made.occupancy.test_occupied(places, near);
    for (int k = 0; k < 4; ++k) {
      CHECK(near[k] == made.expects({x[k], y[k], z[k]}));
      if (places.inside[k] != 0) CHECK(near[k] == made.occupancy.is_occupied(places.cells[k]));
      found += near[k];
    }
  }
  CHECK(found > 1000);
}

TEST_CASE_TEMPLATE("occupancy: a path that comes through a cell with triangles is marked", S, float, double) {
  scene<S> const made;
  std::mt19937 engine(3);
  std::uniform_real_distribution<S> uniform(-1, 1);
  int known = 0, marked = 0, missed = 0;
  for (int round = 0; round < 20000; ++round) {
    moving_pack<S, 4> batch;
    S const length = round % 2 == 0 ? S(0.2) : S(0.6);
    for (int k = 0; k < 4; ++k) {
      batch.x[k] = 3 * uniform(engine), batch.y[k] = 2 * uniform(engine), batch.z[k] = 7 + 5 * uniform(engine);
      batch.dx[k] = length * uniform(engine), batch.dy[k] = length * uniform(engine);
      batch.dz[k] = length * uniform(engine);
      batch.radius[k] = 1;
    }
    bool near[4];
    if (!made.occupancy.test_swept(batch, near)) continue;
    ++known;
    for (int k = 0; k < 4; ++k) {
      bool passes = false;
      for (int t = 0; t <= 64; ++t)
        passes = passes || made.expects(batch.centre(k) + batch.displacement(k) * (static_cast<S>(t) / 64));
      marked += near[k];
      missed += passes && !near[k];
    }
  }
  CHECK(known > 10000);
  CHECK(marked > 1000);
  CHECK(missed == 0);
}

TEST_CASE_TEMPLATE("occupancy: what is long, or not finite, is not known", S, float, double) {
  scene<S> const made;
  moving_pack<S, 4> batch{};
  for (int k = 0; k < 4; ++k) batch.z[k] = 5, batch.radius[k] = 1;
  bool near[4];
  CHECK(made.occupancy.test_swept(batch, near));
  batch.dx[1] = 1.5;
  CHECK(!made.occupancy.test_swept(batch, near));
  batch.dx[1] = std::numeric_limits<S>::quiet_NaN();
  CHECK(!made.occupancy.test_swept(batch, near));
  batch.dx[1] = 0;
  batch.y[2] = std::numeric_limits<S>::infinity();
  CHECK(!made.occupancy.test_swept(batch, near));
  batch.y[2] = 1000;  // a long path outside of the grid
  batch.dy[2] = 1000;
  CHECK(made.occupancy.test_swept(batch, near));
  CHECK(!near[2]);
}
