/// Spheres that move, in every composition of the host.
#include "compositions.hpp"
#include "swept_queries.hpp"

namespace {

/// A closed mesh around the origin: the octahedron |x| + |y| + |z| = 1, its faces divided, flattened along z.
template <class S>
std::vector<S> octahedron(double flat, int divisions) {
  std::vector<S> corners;
  auto const add = [&](double x, double y, double z) {
    for (double v : {x, y, z * flat}) corners.push_back(static_cast<S>(v));
  };
  for (int side = 0; side < 8; ++side) {
    double const sx = side % 2 == 0 ? 1 : -1, sy = side / 2 % 2 == 0 ? 1 : -1, sz = side / 4 == 0 ? 1 : -1;
    auto const at = [&](int i, int k) {  // exact for divisions that are powers of two
      double const x = double(i) / divisions, y = double(k) / divisions;
      add(sx * x, sy * y, sz * (1 - x - y));
    };
    for (int i = 0; i < divisions; ++i)
      for (int k = 0; i + k < divisions; ++k) {
        at(i, k), at(i + 1, k), at(i, k + 1);
        if (i + k + 1 < divisions) at(i + 1, k), at(i + 1, k + 1), at(i, k + 1);
      }
  }
  return corners;
}

/// Spheres from outside to outside, through the middle of the mesh; how many are not reported.
template <class S>
std::size_t count_tunnels(std::vector<S> const& corners, double flat, std::size_t n, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<S> centres(3 * n), displacements(3 * n), radii(n);
  for (std::size_t i = 0; i < n; ++i) {
    // a point well inside the equator, and a direction not too near to the plane of that
    double const inside[] = {0.4 * uniform(engine), 0.4 * uniform(engine), 0};
    double way[] = {uniform(engine), uniform(engine), uniform(engine) < 0 ? -1.0 : 1.0};
    double const length = std::exp2(5 + 3 * uniform(engine)), before = 0.5 + 0.2 * uniform(engine);
    for (std::size_t k = 0; k < 3; ++k) {
      double const along = length * way[k] * (k == 2 ? std::max(1.0, flat) : 1);
      centres[3 * i + k] = static_cast<S>(inside[k] - before * along);
      displacements[3 * i + k] = static_cast<S>(along);
    }
    radii[i] = static_cast<S>(length * std::exp2(-10 + 3 * uniform(engine)));  // ways of 130 to 8,000 radii
    if (i % 64 == 0) radii[i] = 0;
  }
  collide::detector<collide::bucket, collide::karabassi_swept<>, collide::host, S> detector(collide::host(2));
  auto const view =
      collide::with_displacements(collide::spheres_xyz(centres.data(), n, radii.data()), displacements.data());
  auto const touched =
      detector.detect(collide::triangle_soup(corners.data(), corners.size() / 9), view, collide::any_hit());
  auto const hit = touched.to_host();
  return static_cast<std::size_t>(std::count(hit.begin(), hit.end(), 0));
}

/// A closed, a thin and a finely divided mesh, each with `n` spheres.
void check_tunnels(std::size_t n, unsigned seed) {
  CHECK(count_tunnels<float>(octahedron<float>(1, 1), 1, n, seed) == 0);
  CHECK(count_tunnels<float>(octahedron<float>(1e-4, 1), 1e-4, n, seed + 1) == 0);
  CHECK(count_tunnels<float>(octahedron<float>(1e-6, 16), 1e-6, n, seed + 2) == 0);
  CHECK(count_tunnels<float>(octahedron<float>(1e4, 4), 1e4, n, seed + 3) == 0);
  CHECK(count_tunnels<double>(octahedron<double>(1e-9, 8), 1e-9, n, seed + 4) == 0);
}

}  // namespace

TEST_CASE_TEMPLATE("swept queries: pairs, impacts and first impacts are those of the narrow phase alone", S, float,
                   double) {
  tests::check_motions<S>(collide::host(2));
  tests::check_motions<S, tests::lockstep<256, false>>({});
  tests::check_motions<S, tests::lockstep<64, true>>({});
  tests::check_motions<S, collide::host, collide::single_precision>(collide::host(1));
  tests::check_motions<S, collide::host, collide::double_precision>(collide::host(1));
}

TEST_CASE_TEMPLATE("swept queries: spheres that do not move collide as those at rest", S, float, double) {
  tests::motion m;
  m.longest = 0;
  auto const made = tests::random_motion<S>(5, m);
  collide::detector<collide::bucket, collide::karabassi<>, collide::host, S> at_rest;
  collide::detector<collide::bucket, collide::karabassi_swept<>, collide::host, S> swept;
  auto const pairs = at_rest.detect(made.mesh(), made.spheres(), collide::pairs(collide::order::canonical)).to_host();
  CHECK(pairs.size() > 20);
  CHECK((swept.detect(made.mesh(), made.moving(), collide::pairs(collide::order::canonical)).to_host() == pairs));
}

TEST_CASE_TEMPLATE("swept queries: bad values harm nothing else", S, float, double) {
  auto made = tests::random_motion<S>(9, {});
  S const bad[] = {std::numeric_limits<S>::quiet_NaN(), std::numeric_limits<S>::infinity(),
                   -std::numeric_limits<S>::infinity(), std::numeric_limits<S>::max(),
                   -std::numeric_limits<S>::max(),      std::numeric_limits<S>::denorm_min()};
  for (std::size_t i = 0; i < 60; ++i) {
    (i % 2 == 0 ? made.centres : made.displacements)[3 * (5 * i) + i % 3] = bad[i % 6];
    if (i % 7 == 0) made.radii[5 * i + 1] = bad[i / 7 % 5];
  }
  using narrow_phase = collide::karabassi_swept<>;
  auto const expected = tests::pairs_that_touch<narrow_phase>(made);
  for (double const width : {0.0, 0.25}) {
    collide::detector<collide::bucket, narrow_phase, collide::host, S> detector(collide::host(), {width});
    CHECK(
        (detector.detect(made.mesh(), made.moving(), collide::pairs(collide::order::canonical)).to_host() == expected));
  }
  collide::detector<collide::all_pairs, narrow_phase, collide::host, S> detector;
  CHECK((detector.detect(made.mesh(), made.moving(), collide::pairs(collide::order::canonical)).to_host() == expected));
}

TEST_CASE_TEMPLATE("swept queries: bad values harm no spheres that are sorted", S, float, double) {
  tests::motion m;
  m.one_radius = true;
  m.triangles = 60;
  m.spheres = 2500;
  m.longest = 1;
  auto made = tests::random_motion<S>(10, m);
  S const nan = std::numeric_limits<S>::quiet_NaN(), infinity = std::numeric_limits<S>::infinity();
  auto const check = [&] {
    using narrow_phase = collide::karabassi_swept<>;
    auto const expected = tests::pairs_that_touch<narrow_phase>(made);
    CHECK(expected.size() > 20);
    collide::detector<collide::bucket, narrow_phase, collide::host, S> detector;
    CHECK(
        (detector.detect(made.mesh(), made.moving(), collide::pairs(collide::order::canonical)).to_host() == expected));
  };
  for (std::size_t i = 0; i < 200; ++i) (i % 2 == 0 ? made.centres : made.displacements)[3 * (5 * i) + i % 3] = nan;
  check();
  made.displacements[3] = infinity;
  check();
  made.displacements[3] = std::numeric_limits<S>::max();
  check();
  for (S const radius : {S(0), S(-1), infinity, nan}) {
    made.radii.assign(made.radii.size(), radius);
    using narrow_phase = collide::karabassi_swept<>;
    collide::detector<collide::bucket, narrow_phase, collide::host, S> detector;
    CHECK((detector.detect(made.mesh(), made.moving(), collide::pairs(collide::order::canonical)).to_host() ==
           tests::pairs_that_touch<narrow_phase>(made)));
  }
}

TEST_CASE_TEMPLATE("swept queries: a detector may be asked in turn for spheres that rest, that move, and that move far",
                   S, float, double) {
  tests::motion m;
  m.one_radius = true;
  m.triangles = 60;
  m.spheres = 2500;
  collide::detector<collide::bucket, collide::karabassi_swept<>, collide::host, S> detector;
  bool built = false;
  for (double const longest : {0.5, 20.0, 1.0, 0.0, 0.7}) {
    m.longest = longest;
    auto const made = tests::random_motion<S>(11, m);  // the mesh is always the same
    static auto const mesh = made.corners;
    if (!built) detector.build(collide::triangle_soup(mesh.data(), mesh.size() / 9), S(1));
    built = true;
    CHECK((detector.query(made.moving(), collide::pairs(collide::order::canonical)).to_host() ==
           tests::pairs_that_touch<collide::karabassi_swept<>>(made)));
  }
}

TEST_CASE("swept queries: of 2e5 fast spheres none tunnels through a closed, a thin or a finely divided mesh") {
  check_tunnels(40000, 11);
}

TEST_CASE("hunt: swept queries: of 1e7 fast spheres none tunnels through a closed, a thin or a finely divided mesh") {
  check_tunnels(2000000, 1);
}

TEST_CASE_TEMPLATE("swept queries: many spheres with short ways are sorted, those with long ways are not", S, float,
                   double) {
  tests::motion m;
  m.one_radius = true;
  m.triangles = 60;
  m.spheres = 2500;
  for (double const longest : {0.5, 20.0}) {
    m.longest = longest;
    auto const made = tests::random_motion<S>(12, m);
    collide::detector<collide::bucket, collide::karabassi_swept<>, collide::host, S> detector(collide::host(1));
    auto const pairs = detector.detect(made.mesh(), made.moving(), collide::pairs()).to_host();
    CHECK(pairs.size() > 20);
    // one thread finds pairs in the order of whoever looks for the others
    bool const spheres_look =
        std::is_sorted(pairs.begin(), pairs.end(), [](auto const& a, auto const& b) { return a.sphere < b.sphere; });
    CHECK(spheres_look == (longest > 1));
  }
}

TEST_CASE("swept queries: a grid for small spheres does not stay for large ones") {
  std::vector<float> corners;  // small triangles, one apart
  for (int x = 0; x < 32; ++x)
    for (int y = 0; y < 32; ++y)
      for (float const d : {0.f, 0.5f, 0.25f}) {
        corners.insert(corners.end(), {float(x) + d, float(y) + (d == 0.25f ? 0.5f : 0.f), 0.f});
      }
  auto const spheres = [](std::size_t n, float radius, float way) {
    std::vector<float> centres, displacements;
    for (std::size_t i = 0; i < n; ++i) {
      centres.insert(centres.end(), {float(i % 61) / 2, float(i / 61 % 61) / 2, float(i % 7) / 10});
      displacements.insert(displacements.end(), {way, 0, 0});
    }
    return std::tuple(centres, displacements, radius);
  };
  auto const small = spheres(5000, 0.1f, 0.05f), large = spheres(100, 1, 8);
  collide::detector<collide::bucket, collide::karabassi_swept<>> detector(collide::host(1));
  auto const width_after = [&](auto const& of) {
    auto const& [centres, displacements, radius] = of;
    detector.query(collide::with_displacements(collide::spheres_xyz(centres.data(), centres.size() / 3, radius),
                                               displacements.data()),
                   collide::count());
    return detector.cell_width();
  };
  detector.build(collide::triangle_soup(corners.data(), corners.size() / 9), 1.f);
  double const wide = width_after(large);
  CHECK(width_after(small) < wide);
  CHECK(width_after(large) == wide);  // else no cell would be wide enough, and they would look at all triangles
}
