/// Costs of cells, against volumes that random points find.
#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include <collide/broad/detail/grid/plan.hpp>

using collide::detail::triangle_sums;

namespace {

/// Distance of (x, y, z) from the triangle (0, 0, 0), (4, 0, 0), (0, 3, 0).
double distance(double x, double y, double z) {
  auto const from_segment = [&](double ax, double ay, double bx, double by) {
    double const ux = bx - ax, uy = by - ay;
    double const t = std::clamp(((x - ax) * ux + (y - ay) * uy) / (ux * ux + uy * uy), 0., 1.);
    return std::hypot(x - ax - t * ux, y - ay - t * uy, z);
  };
  if (x >= 0 && y >= 0 && 3 * x + 4 * y <= 12) return std::abs(z);
  return std::min({from_segment(0, 0, 4, 0), from_segment(4, 0, 0, 3), from_segment(0, 3, 0, 0)});
}

}  // namespace

TEST_CASE("cell cost: the number of entries is the volume around the triangles, in cells") {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  triangle_sums sum{};
  for (int i = 0; i < 7; ++i) sum += triangle_sums{1, 6, 12, 4};  // seven of these
  for (float width : {0.3f, 1.f, 5.f}) {
    for (float reach : {0.f, 0.5f, 3.f}) {
      double const d = static_cast<double>(reach + 0.7f * width), box = (4 + 2 * d) * (3 + 2 * d) * 2 * d;
      int within = 0;
      constexpr int points = 200000;
      for (int i = 0; i < points; ++i) {
        within += distance((4 + 2 * d) * uniform(engine) - d, (3 + 2 * d) * uniform(engine) - d,
                           2 * d * uniform(engine) - d) <= d;
      }
      double const volume = box * within / points, cell = std::pow(static_cast<double>(width), 3);
      CHECK(static_cast<double>(sum.entries(width, reach)) == doctest::Approx(7 * volume / cell).epsilon(0.01));
    }
  }
}

TEST_CASE("cell cost: a level costs its entries, its candidates and the steps of its paths") {
  collide::detail::pair_distances seen{};
  seen.sampled = collide::detail::pair_distances::spheres;
  for (std::uint32_t k = 8; k < 28; ++k)
    seen.counts[k] = seen.sampled * collide::detail::pair_distances::triangles / 20;
  collide::detail::share_of_pairs const share(seen);
  triangle_sums const triangles{1000, 1, 100, 0};
  auto const cost_of = [&](float entry_ns, float candidate_ns, float step_ns, float path, float width) {
    collide::bucket_costs costs{};
    costs.entry_ns = entry_ns;
    costs.candidate_ns = candidate_ns;
    costs.step_ns = step_ns;
    return collide::detail::level_cost{costs, 5000, 0.001f, path, share, {1, 1, 1}, 1e9f, false}(triangles, width);
  };
  for (float width : {0.001f, 0.01f, 0.1f}) {
    CHECK(cost_of(2, 0, 0, 0, width) == doctest::Approx(2 * triangles.entries(width, 0.001f)));
    CHECK(cost_of(0, 3, 0, 0, width) ==
          doctest::Approx(3 * 5000.f * 1000 * share(0.001f + width / 2, triangles.mean_extent())));
    CHECK(cost_of(0, 0, 4, 0.5f, width) == doctest::Approx(4 * 5000 * 0.5f / width));
    CHECK(cost_of(2, 3, 4, 0.5f, width) ==
          doctest::Approx(cost_of(2, 0, 0, 0, width) + cost_of(0, 3, 0, 0.5f, width) + cost_of(0, 0, 4, 0.5f, width)));
    // narrower cells have more entries, wider ones more candidates
    CHECK(cost_of(1, 0, 0, 0, width) > cost_of(1, 0, 0, 0, 2 * width));
    CHECK(cost_of(0, 1, 0, 0, width) < cost_of(0, 1, 0, 0, 2 * width));
  }
}
