/// Statistics of a mesh, or of radii, against plain loops.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/broad/detail/grid/mesh_statistics.hpp>
#include <collide/host.hpp>

#include "execution/lockstep.hpp"
#include "random_triangles.hpp"

using namespace collide::detail;

namespace {

/// Triangles of all sizes, some with a number that is not finite.
template <class S>
std::vector<S> triangles(std::size_t n) {
  auto all = tests::random_triangles<S>(n, {100, 100, 100},
                                        [](std::size_t, auto const& draw) { return std::exp2(20 * draw()); });
  for (std::size_t i = 3; i < n; i += 17) {
    all[9 * i + i % 9] = i % 2 == 0 ? std::numeric_limits<S>::infinity() : std::numeric_limits<S>::quiet_NaN();
  }
  return all;
}

template <class S, class Space>
void check(Space space, std::size_t n) {
  auto const all = triangles<S>(n);
  auto const mesh = collide::triangle_soup(all.data(), n);
  mesh_statistics<S> seen;
  std::vector<triangle_aabb<S>> boxes(n);
  mesh_statistics<S>::clear(space, &seen);
  compute_mesh_statistics<S> const kernel{mesh, &seen, boxes.data()};
  space.launch(grid_size<Space>(n, kernel), kernel);

  constexpr S infinity = std::numeric_limits<S>::infinity();
  S lower[3] = {infinity, infinity, infinity}, upper[3] = {-infinity, -infinity, -infinity}, largest = 0;
  std::vector<std::uint64_t> counts(size_bins, 0);
  std::vector<double> areas(size_bins, 0);
  for (std::size_t i = 0; i < n; ++i) {
    S const* const t = all.data() + 9 * i;
    CHECK(boxes[i].is_empty() == !std::all_of(t, t + 9, [](S x) { return std::isfinite(x); }));
    if (boxes[i].is_empty()) continue;
    S extent = 0;
    for (int k = 0; k < 3; ++k) {
      S const least = std::min({t[k], t[3 + k], t[6 + k]}), most = std::max({t[k], t[3 + k], t[6 + k]});
      CHECK(boxes[i].lower[k] == least);
      CHECK(boxes[i].upper[k] == most);
      lower[k] = std::min(lower[k], least);
      upper[k] = std::max(upper[k], most);
      extent = std::max(extent, most - least);
      largest = std::max({largest, most, -least});
    }
    auto const bin = size_bin(extent);
    double const u[3] = {double(t[3]) - t[0], double(t[4]) - t[1], double(t[5]) - t[2]},
                 v[3] = {double(t[6]) - t[0], double(t[7]) - t[1], double(t[8]) - t[2]};
    ++counts[bin];
    areas[bin] += std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
  }
  CHECK(seen.largest_coordinate() == largest);
  if (!seen.extents.empty()) {
    for (int k = 0; k < 3; ++k) {
      CHECK(seen.lower_of(k) == lower[k]);
      CHECK(seen.upper_of(k) == upper[k]);
    }
  }
  bool is_right = true;
  for (std::uint32_t b = 0; b < size_bins; ++b) {
    is_right = is_right && seen.extents.counts[b] == counts[b];
    if (counts[b] == 0) continue;
    double const unit =
        static_cast<double>(bin_end(b)) * static_cast<double>(bin_end(b)) / 256;  // each is rounded to one
    is_right = is_right && std::abs(static_cast<double>(seen.extents.sums[b]) - areas[b] / unit) <=
                               0.51 * static_cast<double>(counts[b]);
  }
  CHECK(is_right);
}

}  // namespace

TEST_CASE_TEMPLATE("mesh statistics: bounds, boxes, sizes and areas of the finite triangles", S, float, double) {
  for (std::size_t n : {0u, 1u, 4u, 5u, 1000u}) {
    check<S>(collide::host(1), n);
    check<S>(collide::host(2), n);
    check<S>(tests::lockstep<8, false>(), n);
    check<S>(tests::lockstep<8, true>(), n);
  }
}

TEST_CASE_TEMPLATE("mesh statistics: a histogram of the radii that are valid", S, float, double) {
  std::vector<S> radii, centres;
  for (int i = 0; i < 1000; ++i) radii.push_back(static_cast<S>(std::exp2(i % 23 - 11)));
  for (S bad : {S(-1), -std::numeric_limits<S>::infinity(), std::numeric_limits<S>::infinity(),
                std::numeric_limits<S>::quiet_NaN()})
    radii.insert(radii.begin() + 500, bad);
  radii.push_back(S(0)), radii.push_back(S(-0.));
  centres.resize(3 * radii.size());
  auto const spheres = collide::spheres_xyz(centres.data(), radii.size(), radii.data());
  size_histogram seen{};
  radius_histogram_kernel<S> const kernel{spheres, &seen};
  tests::lockstep<8, false> const space;
  space.launch(grid_size<tests::lockstep<8, false>>(radii.size(), kernel), kernel);
  std::vector<std::uint64_t> counts(size_bins, 0);
  for (S r : radii) {
    if (r >= 0 && std::isfinite(r)) ++counts[size_bin(r + S(0))];
  }
  CHECK(std::equal(counts.begin(), counts.end(), seen.counts));
  CHECK(counts[0] == 2);
}

namespace {

using lanes = tests::lockstep<8, false>;
using lanes_reversed = tests::lockstep<8, true>;

/// The reaches that a block of `Space` chooses, where `before` is there.
template <class Space>
grid_reaches<float> chosen(size_histogram const& radii, float enough, std::uint64_t fewest, int most,
                           grid_reaches<float> before = {}, float given = -1) {
  bool const anew = before.count == 0;
  Space().launch(1, choose_reaches<float>{&radii, &before, given, enough, fewest, most, anew});
  return before;
}

}  // namespace

TEST_CASE_TEMPLATE("reaches: grids a factor of 4 apart, each but the first for more spheres than stated", Space, lanes,
                   lanes_reversed, collide::host) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<float> octaves(-12, 3);
  for (std::size_t n : {1u, 100u, 3000u}) {
    size_histogram radii{};
    std::vector<float> all(n);
    for (float& r : all) {
      r = std::exp2(octaves(engine));
      radii.add(size_bin(r), 1, 0);
    }
    for (std::size_t fewest : {std::size_t{0}, std::size_t{50}, std::size_t{2000}, std::size_t{4000}}) {
      for (int const most : {2, max_grids}) {
        CAPTURE(n);
        CAPTURE(fewest);
        auto const made = chosen<Space>(radii, 0.f, fewest, most);
        auto const& reaches = made.reaches;
        int const count = made.count;
        REQUIRE(count >= 1);
        REQUIRE(count <= most);
        CHECK(made.are_new);
        auto const up_to = [&](float reach) {
          return static_cast<std::size_t>(std::count_if(all.begin(), all.end(), [&](float r) { return r <= reach; }));
        };
        CHECK(up_to(reaches[0]) == n);
        for (int i = 1; i < count; ++i) {
          CHECK(4 * reaches[i] <= reaches[i - 1]);
          CHECK(up_to(reaches[i]) > fewest);
        }
        for (int i = count; i < max_grids; ++i) CHECK(reaches[i] == -1);
        // no grid is left out that would have had enough
        if (count < most) CHECK(up_to(reaches[count - 1] / 4 / 1.26f) <= fewest);
        CHECK(!chosen<Space>(radii, 0.f, fewest, most, made).are_new);
        if (count > 1) CHECK(chosen<Space>(radii, 0.f, fewest, 1, made).are_new);
        float const enough = reaches[count - 1];
        CHECK(chosen<Space>(radii, enough, fewest, most).count == count);
        if (count > 1) CHECK(chosen<Space>(radii, reaches[0], fewest, most).count == 1);
        for (float const given : {0.f, 0.01f, 1.f, 100.f}) {
          CAPTURE(given);
          auto const by_given = chosen<Space>(radii, 0.f, fewest, most, {}, given);
          CHECK(by_given.reaches[0] == given);
          for (int i = 1; i < by_given.count; ++i) {
            CHECK(4 * by_given.reaches[i] <= by_given.reaches[i - 1] * 1.26f);
            CHECK(up_to(by_given.reaches[i]) > fewest);
          }
        }
      }
    }
  }
  size_histogram const none{};
  CHECK(chosen<Space>(none, 0.f, 0, 4).count == 1);
  CHECK(chosen<Space>(none, 0.f, 0, 4).reaches[0] == 0);
}
