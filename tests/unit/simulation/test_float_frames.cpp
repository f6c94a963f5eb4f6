/// The quick test whether particles may touch a body, against the places that contacts are computed with.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/bucket.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/simulation.cuh>

#include "execution/lockstep.hpp"

using namespace collide::detail;

namespace {

using vector = collide::vec3<double>;

vector direction(std::mt19937_64& engine) {
  std::normal_distribution<double> normal;
  vector d(normal(engine), normal(engine), normal(engine));
  return d / d.norm();
}

/// Any rotation, tiny angles and quarters of a turn among them.
frame_pose any_pose(std::mt19937_64& engine, double far) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  double const angles[] = {uniform(engine) * 3.2, uniform(engine) * 1e-6, 1.5707963267948966, 3.141592653589793, 0};
  double const half = angles[engine() % 5] / 2;
  vector const axis = engine() % 4 == 0 ? vector(0, 0, 1) : direction(engine), sine = std::sin(half) * axis;
  return {far * vector(uniform(engine), uniform(engine), uniform(engine)), std::cos(half), sine};
}

}  // namespace

TEST_CASE_TEMPLATE("quick frames: no place is off by more than the bound says, of 2e6", S, float, double) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  double worst = 0;
  for (int round = 0; round < 20000; ++round) {
    double const size = std::pow(10, 12 * uniform(engine) - 6), far = size * std::pow(10, 8 * uniform(engine) - 4);
    double const radius = size * std::pow(10, 6 * uniform(engine) - 5);
    vector const own = 3 * size * uniform(engine) * direction(engine);
    body_frame<S> f{};
    f.now = any_pose(engine, far);
    vector const world = f.now.to_world(own);
    f.centre = rounded_to<S>(world);
    // as `advance_bodies` has it
    f.reach = static_cast<S>(size * (1 + 1e-5) + 32 * double(std::numeric_limits<S>::epsilon()) * world.norm());
    auto const q = float_frame<S>::of(f);
    S x[100], y[100], z[100], at[3][100];
    for (int k = 0; k < 100; ++k) {
      double const part = k % 2 == 0 ? 1 : uniform(engine);
      auto const p = rounded_to<S>(vector(world + part * (double(f.reach) + radius) * direction(engine)));
      x[k] = p.x(), y[k] = p.y(), z[k] = p.z();
    }
    std::uint32_t close[100];
    q.find_close(x, y, z, S(radius), close);
    q.to_local(x, y, z, at);
    double const bound = double(q.slack) + double(float_frame_error<S>) * radius;
    for (int k = 0; k < 100; ++k) {
      if (close[k] == 0) continue;
      auto const exact = rounded_to<S>(f.now.to_local(vector(double(x[k]), double(y[k]), double(z[k]))));
      vector const apart(double(at[0][k]) - double(exact.x()), double(at[1][k]) - double(exact.y()),
                         double(at[2][k]) - double(exact.z()));
      worst = std::max(worst, apart.norm() / bound);
    }
  }
  MESSAGE("the largest error is ", worst, " of the bound");
  CHECK(worst <= 1);
  CHECK(worst > (sizeof(S) == 4 ? 0.05 : 0.01));  // in double most of the bound is for how places are computed
}

TEST_CASE_TEMPLATE("quick frames: what `body_frame` does not find far is close", S, float, double) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int round = 0; round < 100000; ++round) {
    body_frame<S> f{};
    f.now = any_pose(engine, 100);
    f.centre = rounded_to<S>(f.now.position);
    f.reach = S(uniform(engine));
    f.shrink = S(1 - 1e-5);
    S const radius = round % 3 == 0 ? S(0) : S(std::pow(10, 6 * uniform(engine) - 4));
    double const edge = (double(f.reach) + double(radius)) * (1 + 4e-5 * (uniform(engine) - 0.5));
    auto const p = rounded_to<S>(vector(f.now.position + edge * direction(engine)));
    S const x[1] = {p.x()}, y[1] = {p.y()}, z[1] = {p.z()};
    std::uint32_t close[1];
    float_frame<S>::of(f).find_close(x, y, z, radius, close);
    if (!f.is_far(p, radius, S(0))) CHECK(close[0] == 1);
  }
}

namespace {

/// The bodies of a scene: boxes of two triangles a side, and what rests.
template <class S>
struct boxes_scene {
  std::vector<S> corners, centres, velocities;
  std::vector<collide::body> bodies;
  S radius;

  boxes_scene(unsigned seed, std::size_t count, double far, double r, bool rests) : radius(S(r)) {
    std::mt19937_64 engine(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (std::size_t i = 0; i < count + rests; ++i) {
      vector const at(3 * uniform(engine), 3 * uniform(engine), 3 * uniform(engine));
      std::size_t const first = corners.size() / 9;
      add_box(at, 0.2 + 0.4 * std::abs(uniform(engine)));
      if (i == count) break;
      collide::body b{first, 12, {}};
      for (int k = 0; k < 3; ++k) {
        b.motion.pivot[k] = at[k], b.motion.amplitude[k] = 0.1 * uniform(engine), b.motion.axis[k] = uniform(engine);
      }
      b.motion.frequency = 3, b.motion.phase = uniform(engine), b.motion.rate = 5 * uniform(engine);
      for (int k = 0; k < 3; ++k) b.motion.velocity[k] = far * uniform(engine);
      bodies.push_back(b);
    }
    int const n = r > 1 ? 90 : 1500;  // large ones touch all
    for (int i = 0; i < n; ++i) {
      // around the faces of boxes, some of them at once on a border of cells, or anywhere
      vector p(4 * uniform(engine), 4 * uniform(engine), 4 * uniform(engine));
      std::size_t const near = engine() % (corners.size() / 3);
      if (i % 3 != 0) {
        p = vector(corners[3 * near], corners[3 * near + 1], corners[3 * near + 2]) +
            (i % 3 == 1 ? r : 1.001 * r + 1e-6) * direction(engine);
      }
      for (int k = 0; k < 3; ++k) centres.push_back(S(p[k]));
      for (int k = 0; k < 3; ++k) velocities.push_back(S(uniform(engine)));
    }
    constexpr S strange[] = {std::numeric_limits<S>::infinity(), -std::numeric_limits<S>::infinity(),
                             std::numeric_limits<S>::quiet_NaN(), std::numeric_limits<S>::max(), S(-1e30)};
    for (std::size_t i = 0; i < 15; ++i) centres[9 * i + i % 3] = strange[i % 5];
  }

  void add_box(vector const& at, double h) {
    auto const corner = [&](int k, double i, double j, double side) {
      double p[3];
      p[k] = side, p[(k + 1) % 3] = i, p[(k + 2) % 3] = j;
      for (int c = 0; c < 3; ++c) corners.push_back(S(at[c] + h * p[c]));
    };
    for (int k = 0; k < 3; ++k) {
      for (double side : {-1.0, 1.0}) {
        corner(k, -1, -1, side), corner(k, 1, -1, side), corner(k, 1, 1, side);
        corner(k, -1, -1, side), corner(k, 1, 1, side), corner(k, -1, 1, side);
      }
    }
  }
};

template <class S, class Space, class... Effect>
std::vector<S> positions_of(Space const& space, boxes_scene<S> const& s, collide::bucket const& options, S dt,
                            Effect... effects) {
  collide::simulation<collide::detector<collide::bucket, collide::karabassi<>, Space, S>, Effect...> made(
      space, options, effects...);
  made.set_mesh(collide::triangle_soup(s.corners.data(), s.corners.size() / 9), s.bodies);
  made.set(collide::spheres_xyz(s.centres.data(), s.centres.size() / 3, s.radius), s.velocities.data());
  std::vector<S> all;
  for (int k = 0; k < 10; ++k) {
    made.step(dt);
    auto const x = made.template to_host<collide::position>(), v = made.template to_host<collide::velocity>();
    all.insert(all.end(), x.begin(), x.end());
    all.insert(all.end(), v.begin(), v.end());
  }
  return all;
}

}  // namespace

TEST_CASE_TEMPLATE("quick frames: steps with them have the bits of steps without", S, float, double) {
  using collide::bounce;
  using collide::bucket;
  using collide::gravity;
  using collide::moving_bodies;
  std::size_t hits = 0;
  for (std::size_t const count : {1, 16, 64}) {
    for (double const far : {0.0, 3.0, 1e4, 1e7}) {
      for (double const r : {1e-30, 1e-3, 0.05, 0.5, 30.0, 1e20, -1.0}) {
        bool const rests = static_cast<int>(r * 1e4) % 7 == 3 || far > 3;
        boxes_scene<S> const s(static_cast<unsigned>(count + 7), count, far, r, rests);
        // a scene with radii of their own, all the same, goes the way without quick frames
        auto const bits = [](std::vector<S> const& x) {
          std::vector<uint_for<S>> u(x.size());
          for (std::size_t i = 0; i < x.size(); ++i) u[i] = x[i] == x[i] ? to_bits(x[i]) : 1u;
          return u;
        };
        gravity const g{};
        auto const expected = bits(positions_of(collide::host(1), s, bucket{}, S(0.01), collide::polydisperse{}, g,
                                                bounce{}, moving_bodies<>{}));
        CHECK(bits(positions_of(collide::host(1), s, bucket{}, S(0.01), g, bounce{}, moving_bodies<>{})) == expected);
        if (count == 16) {
          tests::lockstep<256, true> const blocks;
          CHECK(bits(positions_of(blocks, s, bucket{}, S(0.01), g, bounce{}, moving_bodies<>{})) == expected);
        }
        boxes_scene<S> free = s;
        free.corners.resize(0), free.bodies.clear();
        auto const fall = bits(positions_of(collide::host(1), free, bucket{}, S(0.01), g, bounce{}, moving_bodies<>{}));
        for (std::size_t i = 0; i < fall.size(); ++i) hits += fall[i] != expected[i];
      }
    }
  }
  CHECK(hits > 100000);
}
