/// Verdicts and contacts of the narrow phase where they are hardest, on the host. The hunt, for 1e7 more pairs, is in
/// four parts, which run side by side.
#include <cmath>
#include <cstring>
#include <limits>

#include <collide/host.hpp>
#include <collide/simulation/detail/step/mesh_contact.hpp>

#include "checks.hpp"
#include "narrow_phase/narrow_phase.hpp"

TEST_CASE("near contact: 3.6e5 pairs of floats within 4 ulp of tangency") {
  tests::check_near_contact<float>(collide::host(1), 5000, 2);
}

TEST_CASE("near contact: 3.6e5 pairs of doubles within 4 ulp of tangency") {
  tests::check_near_contact<double>(collide::host(1), 6000, 2);
}

TEST_CASE("hunt: near contact: 2.5e6 pairs of floats within 4 ulp of tangency") {
  tests::check_near_contact<float>(collide::host(1), 1000, 14);
}

TEST_CASE("hunt: near contact: another 2.5e6 pairs of floats within 4 ulp of tangency") {
  tests::check_near_contact<float>(collide::host(1), 2000, 14);
}

TEST_CASE("hunt: near contact: 2.5e6 pairs of doubles within 4 ulp of tangency") {
  tests::check_near_contact<double>(collide::host(1), 3000, 14);
}

TEST_CASE("hunt: near contact: another 2.5e6 pairs of doubles within 4 ulp of tangency") {
  tests::check_near_contact<double>(collide::host(1), 4000, 14);
}

TEST_CASE_TEMPLATE("near contact: exact ties of faces, edges and vertices, and coordinates of all exponents", S, float,
                   double) {
  tests::check_ties_and_exponents<S>(collide::host(1));
}

TEST_CASE_TEMPLATE("near contact: the contact, or the closest point where nothing touches", S, float, double) {
  for (auto const& cases :
       {tests::near_contact<S>(51, 1500), tests::ties<S>(52, 2000), tests::mixed_exponents<S>(53, 2000)})
    for (auto const& c : cases) {
      if (c.ball.radius < 0) continue;
      CAPTURE(tests::describe(c));
      tests::narrow_case<S> const made(c);
      auto const contact = collide::karabassi<collide::exact>::contact_of(made.shape, made.ball);
      tests::check_contact(contact, c.shape, c.ball, false);
    }
}

TEST_CASE_TEMPLATE("near contact: a simulation knows the depth of a ball whose centre lies on the triangle", S, float,
                   double) {
  collide::triangle<S> const t{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  for (S const height : {S(0), S(0x1p-21), S(-0x1p-30)}) {
    CAPTURE(height);
    collide::contact<S> const c = collide::detail::contact_double(t, collide::sphere<S>{{1, 1, height}, S(0.5)});
    CHECK(c.distance == std::abs(height));
    CHECK(c.depth == S(0.5) - std::abs(height));
  }
}

TEST_CASE_TEMPLATE("near contact: no contact is deeper than its radius, were that the largest number", S, float,
                   double) {
  for (auto c : tests::near_contact<S>(54, 300)) {
    c.ball.radius = std::numeric_limits<S>::max();
    CAPTURE(tests::describe(c));
    tests::narrow_case<S> const made(c);
    auto const contact = collide::karabassi<collide::exact>::contact_of(made.shape, made.ball);
    CHECK(contact.depth <= made.ball.radius);
    tests::check_contact(contact, c.shape, c.ball, false);
  }
}

TEST_CASE_TEMPLATE("near contact: what a simulation tells at once is right", S, float, double) {
  std::size_t hits = 0, misses = 0;
  auto const point_of = [](collide::vec3<S> const& v) { return oracle::point{v.x(), v.y(), v.z()}; };
  auto const check = [&](collide::triangle<S> const& shape, collide::sphere<S> const& ball) {
    collide::contact<S> found;
    auto const quick = collide::detail::try_contact_double(shape, ball, false, found);
    if (quick == collide::detail::verdict::uncertain) return;
    bool const expected = oracle::hit({point_of(shape.a), point_of(shape.b), point_of(shape.c)},
                                      {point_of(ball.centre), static_cast<double>(ball.radius)});
    CHECK((quick == collide::detail::verdict::hit) == expected);
    ++(expected ? hits : misses);
    if (!expected) return;
    auto const whole = collide::detail::contact_double(shape, ball);
    CHECK(std::memcmp(static_cast<void const*>(&found), static_cast<void const*>(&whole), sizeof found) == 0);
    CHECK((collide::detail::try_contact_double(shape, ball, true, found) == collide::detail::verdict::hit));
  };
  for (auto const& cases :
       {tests::near_contact<S>(61, 1500), tests::ties<S>(62, 2000), tests::mixed_exponents<S>(63, 2000)})
    for (auto const& c : cases) {
      if (c.ball.radius < 0) continue;
      CAPTURE(tests::describe(c));
      tests::narrow_case<S> const made(c);
      check(made.shape, made.ball);
      // the radius is next to the distance: more and less of it
      for (int bits = 12; bits <= (sizeof(S) == 4 ? 20 : 44); bits += 4) {
        S const part = std::ldexp(made.ball.radius, -bits);
        if (!(part > 16 * std::numeric_limits<S>::min()) || !std::isfinite(made.ball.radius + part)) continue;
        check(made.shape, {made.ball.centre, made.ball.radius + part});
        check(made.shape, {made.ball.centre, made.ball.radius - part});
      }
    }
  CHECK(hits > 10000);
  CHECK(misses > 10000);
}
