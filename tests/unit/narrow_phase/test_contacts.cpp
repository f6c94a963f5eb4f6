/// Contacts by the ways that there are to measure them, against the oracle.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>

#include <collide/all_pairs.cuh>
#include <collide/detector.hpp>
#include <collide/host.hpp>
#include <collide/karabassi.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/sinks/closest.hpp>
#include <collide/sinks/earliest.hpp>

#include "checks.hpp"
#include "narrow_phase/narrow_phase.hpp"
#include "scenes.hpp"

namespace {

using collide::vec3;

oracle::point point_of(vec3<double> const& v) { return {v.x(), v.y(), v.z()}; }

struct any_pair {
  collide::triangle<double> shape;
  collide::sphere<double> ball;

  oracle::triangle exact_shape() const { return {point_of(shape.a), point_of(shape.b), point_of(shape.c)}; }
  oracle::sphere exact_ball() const { return {point_of(ball.centre), ball.radius}; }
};

/// A triangle, and a sphere next to a point of it: distances and depths from 1 down to `smallest`, and triangles as
/// thin as `thinnest`.
any_pair next_pair(tests::dice& roll, double smallest, double thinnest) {
  auto const in_cube = [&] {
    auto const p = roll.in_cube(1);
    return vec3<double>(p.x, p.y, p.z);
  };
  auto const down_to = [&](double least) { return std::pow(10, roll.uniform(std::log10(least), 0)); };
  vec3<double> const a = in_cube(), b = in_cube(), flat = a + roll.uniform(-0.5, 1.5) * (b - a);
  vec3<double> const c = flat + down_to(thinnest) * in_cube();
  double const v = roll.integer(0, 2) == 0 ? 0 : roll.uniform(0, 1);
  double const w = roll.integer(0, 2) == 0 ? 0 : roll.uniform(0, 1 - v);
  vec3<double> const on_it = a + v * (b - a) + w * (c - a), normal = collide::detail::cross<double>(b - a, c - a);
  double const length = std::sqrt(normal.dot(normal));
  vec3<double> const direction = length == 0 || roll.integer(0, 1) ? in_cube() : vec3<double>(normal / length);
  any_pair made{{a, b, c}, {on_it + down_to(smallest) * direction, 0}};
  double const distance = oracle::closest(made.exact_shape(), point_of(made.ball.centre)).distance;
  made.ball.radius = distance + down_to(smallest) * distance;
  return made;
}

/// True if the contact takes no exact numbers.
bool is_measured_without(any_pair const& p) {
  collide::sphere<double> const centre{p.ball.centre, 0};
  auto const l = collide::detail::to_unit_range(collide::detail::to_local<double>(p.shape, centre), p.shape, centre);
  vec3<double> closest;
  collide::detail::contact_without_point found;
  return collide::detail::contact_compensated(p.shape, {p.ball, {0, 0, 0}}, 0, l.scale, true, closest, found);
}

std::atomic<int> contacts_computed;

struct counting_narrow_phase : collide::karabassi<> {
  template <class S>
  static COLLIDE_HD collide::contact<S> contact_of(collide::triangle<S> const& t, collide::sphere<S> const& s) {
#if !defined(__CUDA_ARCH__)
    ++contacts_computed;
#endif
    return collide::karabassi<>::contact_of(t, s);
  }
};

}  // namespace

TEST_CASE("contacts: those of doubles take exact numbers next to contact only") {
  tests::dice roll(71);
  int ordinary = 0, thin = 0;
  for (int i = 0; i < 4000; ++i) {
    any_pair const p = next_pair(roll, 1e-3, 0.1), q = next_pair(roll, 1e-4, 1e-4);
    ordinary += is_measured_without(p);
    thin += is_measured_without(q);
    tests::check_contact(collide::karabassi<>::contact_of(p.shape, p.ball), p.exact_shape(), p.exact_ball(), false);
    tests::check_contact(collide::karabassi<>::contact_of(q.shape, q.ball), q.exact_shape(), q.exact_ball(), false);
  }
  CHECK(ordinary == 4000);
  CHECK(thin > 3600);
}

TEST_CASE("contacts: those of doubles are right however small distance, depth and triangle are") {
  tests::dice roll(72);
  int without = 0;
  for (int i = 0; i < 8000; ++i) {
    any_pair const p = next_pair(roll, 1e-16, 1e-16);
    without += is_measured_without(p);
    tests::check_contact(collide::karabassi<>::contact_of(p.shape, p.ball), p.exact_shape(), p.exact_ball(), false);
  }
  CHECK(without > 1000);
  CHECK(without < 7000);
}

TEST_CASE_TEMPLATE("contacts: those of other precisions are right to within their rounding", S, float, double) {
  for (auto const& cases :
       {tests::near_contact<S>(81, 1000), tests::ties<S>(82, 2000), tests::mixed_exponents<S>(83, 1000)})
    for (auto const& c : cases) {
      if (c.ball.radius < 0) continue;
      CAPTURE(tests::describe(c));
      tests::narrow_case<S> const made(c);
      tests::check_plain_contact(collide::karabassi<collide::single_precision>::contact_of(made.shape, made.ball),
                                 c.shape, c.ball, 0x1p-24);
      tests::check_plain_contact(collide::karabassi<collide::double_precision>::contact_of(made.shape, made.ball),
                                 c.shape, c.ball, 0x1p-53);
    }
}

TEST_CASE("contacts: the precision of a narrow phase is that of its contacts") {
  collide::triangle<double> const t{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  collide::sphere<double> const s{{0.2, 0.3, 0.1}, 0.25};
  double const single = collide::karabassi<collide::single_precision>::contact_of(t, s).distance;
  CHECK(single == static_cast<double>(static_cast<float>(single)));
  CHECK(collide::karabassi<collide::double_precision>::contact_of(t, s).distance == 0.1);
  collide::moving_sphere<double> const moving{{{0.2, 0.3, 0.5}, 0.25}, {0, 0, -0.5}};
  CHECK(collide::karabassi_swept<collide::single_precision>::impact_of(t, moving).contact.depth ==
        doctest::Approx(0).epsilon(1e-6));
  CHECK(collide::karabassi_swept<collide::double_precision>::impact_of(t, moving).contact.depth ==
        doctest::Approx(0).epsilon(1e-9));
}

TEST_CASE_TEMPLATE("contacts: closest computes that of a pair once", S, float, double) {
  auto const made = tests::lattice_scene<S>(31, 60, 60, 3);
  auto const mesh = collide::indexed_mesh(made.mesh.vertices.data(), made.mesh.vertices.size() / 3,
                                          made.mesh.corners.data(), made.mesh.corners.size() / 3);
  auto const spheres =
      collide::spheres_xyz(made.spheres.centres.data(), made.spheres.radii.size(), made.spheres.radii.data());
  collide::detector<collide::all_pairs, counting_narrow_phase, collide::host, S> detector(collide::host(1));
  contacts_computed = 0;
  auto const closest = detector.detect(mesh, spheres, collide::closest<S>());
  CHECK(closest.total() > 60);
  CHECK(static_cast<std::uint64_t>(contacts_computed) == closest.total());

  contacts_computed = 0;
  auto const contacts = detector.query(spheres, collide::closest_contact<S>());
  auto const found = contacts.to_host();
  auto const touching =
      std::count_if(found.begin(), found.end(), [](auto const& c) { return c.triangle != collide::no_id; });
  CHECK(touching > 0);
  CHECK(static_cast<std::uint64_t>(contacts_computed) == contacts.total() + static_cast<std::uint64_t>(touching));
}
