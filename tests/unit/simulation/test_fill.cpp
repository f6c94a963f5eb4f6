/// Filling of regions: nothing overlaps, all is inside, sizes are those asked for, equal spheres reach loose random
/// packing, and each sphere rests on three.
#include <algorithm>
#include <cstring>

#include <collide/effects/emit.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/simulation/detail/overlaps_on_host.hpp>
#include <collide/simulation/fill.hpp>

#include "simulation/granular.hpp"

namespace {

using collide::box_region;
using collide::filling;
using collide::size_distribution;

std::size_t overlaps(filling const& all) {
  std::size_t found = 0;
  collide::detail::for_each_overlap(all.centres, all.radii, collide::detail::open_space(),
                                    [&](auto const&, auto const&, double) { ++found; });
  return found;
}

/// Spheres in a region, of which `depth` says at each point how deep it is, in another way.
template <class Region, class Depth>
void check_region(Region const& region, size_distribution const& sizes, double fraction, Depth const& depth) {
  filling const all = collide::fill(region, sizes, fraction, 3), again = collide::fill(region, sizes, fraction, 3);
  REQUIRE(all.radii.size() > 50);
  CHECK(all.fraction == doctest::Approx(fraction).epsilon(0.03));
  CHECK(overlaps(all) == 0);
  for (std::size_t i = 0; i < all.radii.size(); ++i) CHECK(depth(&all.centres[3 * i]) >= all.radii[i] * (1 - 1e-12));
  CHECK(again.centres == all.centres);
  CHECK(again.radii == all.radii);
  CHECK(collide::fill(region, sizes, fraction, 4).centres != all.centres);
  CHECK_THROWS_AS(collide::fill(region, sizes, 0.8, 3), collide::error);
}

/// The corners of a box, outwards or inwards.
void add_box(std::vector<double>& soup, double lower, double upper, bool inwards) {
  int const faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  int const triangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
  for (auto const& f : faces)
    for (auto const& t : triangles)
      for (int k = 0; k < 3; ++k) {
        int const corner = f[t[inwards ? 2 - k : k]];
        for (int c = 0; c < 3; ++c) soup.push_back((corner >> c & 1) != 0 ? upper : lower);
      }
}

double in_box(double const* x, double lower, double upper) {
  double least = 1e300;
  for (int k = 0; k < 3; ++k) least = std::min({least, x[k] - lower, upper - x[k]});
  return least;
}

}  // namespace

TEST_CASE("fill: boxes, cylinders, meshes, and what is between two surfaces") {
  auto const one = size_distribution::one(0.05), many = size_distribution::uniform(0.02, 0.08);
  box_region const box{{0, 0, 0}, {1, 1, 1}};
  for (double const fraction : {0.05, 0.3, 0.5}) {
    check_region(box, one, fraction, [](double const* x) { return in_box(x, 0, 1); });
    check_region(box, many, fraction, [](double const* x) { return in_box(x, 0, 1); });
  }
  collide::cylinder_region const drum({0, -0.5, 0}, {0, 0.5, 0}, 0.5), shaft({0, -0.5, 0}, {0, 0.5, 0}, 0.1);
  check_region(drum, one, 0.4,
               [](double const* x) { return std::min(0.5 - std::hypot(x[0], x[2]), 0.5 - std::abs(x[1])); });
  check_region(collide::between(drum, shaft), one, 0.3, [](double const* x) {
    double const r = std::hypot(x[0], x[2]);
    return std::min({0.5 - r, r - 0.1, 0.5 - std::abs(x[1])});
  });
  std::vector<double> soup;
  add_box(soup, 0, 1, false);
  add_box(soup, 0.4, 0.6, true);
  collide::mesh_region const hollow(collide::triangle_soup(soup.data(), soup.size() / 9));
  CHECK(hollow.volume() == doctest::Approx(0.992));
  check_region(hollow, one, 0.3, [](double const* x) {
    double away = 0;
    for (int k = 0; k < 3; ++k) away += std::pow(std::max(std::abs(x[k] - 0.5) - 0.1, 0.0), 2);
    return std::min(in_box(x, 0, 1), std::sqrt(away));
  });
  std::vector<double> turned;
  add_box(turned, 0, 1, true);
  CHECK_THROWS_AS(collide::mesh_region(collide::triangle_soup(turned.data(), 12)), collide::error);
}

TEST_CASE("fill: a region without a volume is refused, and one far from the origin is filled as one near") {
  auto const sizes = size_distribution::one(0.1);
  double const nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (auto const& region : {collide::box_region{{0, 0, 0}, {1, 1, 0}}, collide::box_region{{0, 1, 0}, {1, 0, 1}},
                             collide::box_region{{0, 1, 1}, {1, 0, 0}}, collide::box_region{{0, 0, 0}, {1, 1, nan}},
                             collide::box_region{{0, 0, 0}, {1, 1, infinity}}}) {
    CHECK_THROWS_AS(collide::fill(region, sizes, 0.3, 1), collide::error);
    CHECK_THROWS_AS(collide::fill_number(region, sizes, 3, 1), collide::error);
  }
  CHECK_THROWS_AS(collide::fill(collide::cylinder_region({0, 0, 0}, {0, 0, 0}, 1), sizes, 0.3, 1), collide::error);
  double const far = 1e6;
  double corners[24];
  for (int k = 0; k < 8; ++k)
    for (int c = 0; c < 3; ++c) corners[3 * k + c] = far + (k >> c & 1);
  unsigned const faces[] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                            2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  collide::mesh_region const cube(collide::indexed_mesh(corners, 8, faces, 12));
  CHECK(cube.volume() == doctest::Approx(1).epsilon(1e-9));
  CHECK(collide::fill_number(cube, sizes, 40, 1).radii.size() == 40);
}

TEST_CASE("fill: a narrow normal distribution is as narrow in wide limits") {
  auto const radii = size_distribution::normal(1, 0.001, 0.5, 1.5).sample(10000, 2);
  double sum = 0;
  for (double const r : radii) sum += (r - 1) * (r - 1);
  CHECK(std::sqrt(sum / 10000) == doctest::Approx(0.001).epsilon(0.03));
  CHECK_THROWS_AS(size_distribution::one(1).sample(1, 1u << 24), collide::error);
  CHECK_THROWS_AS(size_distribution::one(1).rate_of(1, 0), collide::error);
}

TEST_CASE("fill: equal spheres reach loose random packing, and each rests on three") {
  box_region const box{{0, 0, 0}, {30, 30, 30}};
  filling const all = collide::detail::fill_once(box, size_distribution::one(0.5), 1 + 1e-6, 1);
  std::vector<int> below(all.radii.size(), 0);
  std::vector<double> wide(all.radii.size(), 0.5 * (1 + 2e-6));
  collide::detail::for_each_overlap(
      all.centres, wide, collide::detail::open_space(),
      [&](auto const& a, auto const& b, double) { ++below[std::max(a.number, b.number)]; });
  double middle = 0;
  std::size_t inside = 0, held = 0;
  for (std::size_t i = 0; i < all.radii.size(); ++i) {
    double const* const x = &all.centres[3 * i];
    if (in_box(x, 5, 25) > 0) middle += 3.14159265358979 / 6;
    if (in_box(x, 2, 28) < 0) continue;
    ++inside;
    held += below[i] >= 3 ? 1 : 0;
  }
  CHECK(middle / 8000 > 0.57);
  CHECK(middle / 8000 < 0.61);
  CHECK(static_cast<double>(held) > 0.999 * static_cast<double>(inside));
  CHECK(collide::fill(box, size_distribution::one(0.5), 0.55, 1).fraction == doctest::Approx(0.55).epsilon(1e-4));
  CHECK(collide::fill_number(box, size_distribution::one(0.5), 1, 1).radii.size() == 1);
}

TEST_CASE("fill: sizes are those of their distribution, in a region too") {
  std::size_t const n = 200000;
  auto const mean_of = [&](size_distribution const& d) {
    double sum = 0;
    for (double const r : d.sample(n, 1)) sum += r;
    return sum / static_cast<double>(n);
  };
  CHECK(mean_of(size_distribution::uniform(1, 3)) == doctest::Approx(2).epsilon(2e-3));
  CHECK(mean_of(size_distribution::normal(2, 0.2, 1, 3)) == doctest::Approx(2).epsilon(2e-3));
  CHECK(mean_of(size_distribution::lognormal(1, 0.3, 0.2, 4)) == doctest::Approx(std::exp(0.045)).epsilon(3e-3));
  // of a normal distribution 68 % are within a deviation
  std::size_t near = 0;
  for (double const r : size_distribution::normal(2, 0.2, 1, 3).sample(n, 2)) near += std::abs(r - 2) < 0.2 ? 1 : 0;
  CHECK(static_cast<double>(near) / static_cast<double>(n) == doctest::Approx(0.6827).epsilon(5e-3));

  std::vector<double> const openings{0.05, 0.1, 0.2, 0.3}, passing{0, 0.2, 0.7, 1};
  auto const sieved = size_distribution::sieve(openings, passing);
  auto const check_mass = [&](std::vector<double> const& radii, double close) {
    double all = 0;
    std::vector<double> through(openings.size(), 0);
    for (double const r : radii) {
      all += r * r * r;
      for (std::size_t k = 0; k < openings.size(); ++k) through[k] += 2 * r < openings[k] ? r * r * r : 0;
    }
    for (std::size_t k = 0; k < openings.size(); ++k) CHECK(std::abs(through[k] / all - passing[k]) < close);
  };
  check_mass(sieved.sample(n, 5), 0.01);
  double sum = 0;
  for (double const r : sieved.sample(n, 6)) sum += 4.18879020478639 * r * r * r;
  CHECK(sum / static_cast<double>(n) == doctest::Approx(sieved.mean_volume()).epsilon(0.02));
  check_mass(collide::fill(box_region{{0, 0, 0}, {4, 4, 4}}, sieved, 0.5, 1).radii, 0.02);
  for (auto const& wrong : {std::vector<double>{0.1, 0.05}, std::vector<double>{0, 1}})
    CHECK_THROWS_AS(size_distribution::sieve(wrong, {0, 1}), collide::error);
  CHECK_THROWS_AS(size_distribution::uniform(2, 1), collide::error);
}

TEST_CASE("fill: a source has radii of a distribution, at a rate of mass") {
  using simulation = collide::simulation<tests::meets_mesh<collide::host, collide::karabassi<>, double>,
                                         collide::polydisperse, collide::emit>;
  auto const sizes = size_distribution::sieve({0.002, 0.004}, {0, 1});
  std::size_t const room = 20000;
  collide::emit source;
  source.rate = sizes.rate_of(3, 2500);
  source.source.half_width = 1;
  source.radius = sizes.largest();
  simulation made(collide::host(1), collide::polydisperse{}, source);
  double const nowhere = 0;
  made.set(collide::spheres_xyz(&nowhere, 0, 1.0), nullptr, room);
  made.assign<collide::radius>(sizes.sample(room, 1));
  for (int k = 0; k < 100; ++k) made.step(0.001);
  auto const there = made.to_host<collide::alive>();
  auto const radii = made.to_host<collide::radius>();
  double mass = 0;
  std::size_t born = 0;
  for (std::size_t i = 0; i < room; ++i) {
    if (there[i] == 0) continue;
    ++born;
    mass += 2500 * 4.18879020478639 * std::pow(radii[i], 3);
  }
  CHECK(born > 1000);
  CHECK(born < room);
  CHECK(mass == doctest::Approx(3 * 0.1).epsilon(0.03));
}
