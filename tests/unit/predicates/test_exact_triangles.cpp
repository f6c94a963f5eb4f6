/// Two triangles that meet, or do not, elsewhere than at shared corners and edges, against the oracle.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <doctest/doctest.h>

#include <collide/exact/detail/predicates/exact_triangles.hpp>

#include "compared.hpp"
#include "nearest/point_cases.hpp"

namespace {

using collide::detail::seen_triangle;

/// Two triangles whose corners have the same number where they have equal coordinates.
template <class S>
bool meet(collide::triangle<S> const& s, collide::triangle<S> const& t) {
  using collide::detail::widened;
  std::array<collide::vec3<S>, 6> const corners{{s.a, s.b, s.c, t.a, t.b, t.c}};
  std::array<std::uint32_t, 6> number{};
  for (unsigned i = 0; i < 6; ++i)
    while (!(corners[number[i]] == corners[i])) ++number[i];
  seen_triangle const first(widened(s), {number[0], number[1], number[2]});
  seen_triangle const second(widened(t), {number[3], number[4], number[5]});
  return first.has_area() && second.has_area() && seen_triangle::meet(first, second);
}

struct tally {
  int cases = 0, wrong = 0, meeting = 0;

  template <class S>
  void add(collide::triangle<S> const& s, collide::triangle<S> const& t) {
    bool const expected = oracle::meet(tests::to_oracle(s), tests::to_oracle(t));
    ++cases;
    meeting += expected;
    wrong += meet(s, t) != expected || meet(t, s) != expected;
  }
};

/// The next few numbers, up or down.
template <class S>
void nudge(collide::vec3<S>& v, tests::dice& roll, int ulps) {
  for (int k = 0; k < 3; ++k)
    for (int steps = roll.integer(-ulps, ulps); steps != 0; steps -= steps < 0 ? -1 : 1)
      v[k] = std::nextafter(v[k], std::copysign(std::numeric_limits<S>::max(), static_cast<S>(steps)));
}

}  // namespace

TEST_CASE_TEMPLATE("exact triangles: what meets, by hand", S, float, double) {
  using triangle = collide::triangle<S>;
  triangle const flat{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  CHECK(meet<S>(flat, {{1, 1, -1}, {1, 1, 1}, {2, 1, 1}}));        // cut through
  CHECK(meet<S>(flat, {{1, 1, 0}, {1, 1, 1}, {2, 1, 1}}));         // touched in a point of the face
  CHECK(meet<S>(flat, {{2, 2, 0}, {3, 3, 1}, {3, 3, -1}}));        // of an edge
  CHECK(meet<S>(flat, {{2, 0, 0}, {6, 0, 0}, {4, 0, 3}}));         // edges overlap
  CHECK(meet<S>(flat, {{1, 1, 0}, {9, 1, 0}, {9, 2, 0}}));         // overlap in a plane
  CHECK(meet<S>(flat, {{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}));         // one in the other
  CHECK(meet<S>(flat, {{0, 4, 0}, {0, 0, 0}, {4, 0, 0}}));         // the same
  CHECK(meet<S>(flat, {{0, 0, 0}, {4, 0, 0}, {1, 1, 0}}));         // folded onto it at an edge
  CHECK(meet<S>(flat, {{0, 0, 0}, {1, 1, 0}, {1, 1, 1}}));         // from a corner along the face
  CHECK(meet<S>(flat, {{0, 0, 0}, {2, 0, 0}, {0, 0, 1}}));         // along the edge
  CHECK(meet<S>(flat, {{0, 0, 0}, {1, 1, 1}, {1, 1, -1}}));        // across the face
  CHECK_FALSE(meet<S>(flat, {{0, 0, 0}, {4, 0, 0}, {1, -1, 0}}));  // beside it at an edge
  CHECK_FALSE(meet<S>(flat, {{0, 0, 0}, {4, 0, 0}, {1, 1, 1}}));
  CHECK_FALSE(meet<S>(flat, {{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}}));
  CHECK_FALSE(meet<S>(flat, {{0, 0, 0}, {-1, 2, 0}, {0, 0, 1}}));
  CHECK_FALSE(meet<S>(flat, {{3, 3, 0}, {5, 3, 0}, {3, 5, 0}}));
  CHECK_FALSE(meet<S>(flat, {{1, 1, 1}, {2, 1, 1}, {1, 2, 3}}));
  CHECK_FALSE(meet<S>(flat, {{-1, 1, 0}, {1, 1, 0}, {3, 1, 0}}));  // has no area
}

TEST_CASE_TEMPLATE("exact triangles: corners of small integers, which share, touch and overlap", S, float, double) {
  tests::dice roll(1);
  tally all;
  for (int i = 0; i < 8000; ++i) {
    int const depth = i % 3;  // 0: all in a plane
    auto corner = [&] {
      return collide::vec3<S>(S(roll.integer(-2, 2)), S(roll.integer(-2, 2)), S(roll.integer(-depth, depth)));
    };
    collide::triangle<S> const s{corner(), corner(), corner()};
    collide::triangle<S> t{corner(), corner(), corner()};
    int const shared = roll.integer(0, 2);
    if (shared > 0) t.b = s.c;
    if (shared > 1) t.a = s.a;
    all.add(s, t);
  }
  CHECK(all.wrong == 0);
  CHECK(all.meeting > all.cases / 4);
  CHECK(all.meeting < all.cases * 3 / 4);
  tests::compared<S>("pairs of triangles told wrongly to meet or not", "cut off at sides, in rational numbers",
                     all.wrong, 0, std::size_t(all.cases));
}

TEST_CASE_TEMPLATE("exact triangles: corners within 2 ulp of another's face, edge or corner, needles too", S, float,
                   double) {
  tests::dice roll(2);
  tally all;
  for (int i = 0; i < 6000; ++i) {
    auto corner = [&](double offset) {
      auto const p = roll.in_cube(1);
      return collide::vec3<S>(S(p.x + offset), S(p.y + offset), S(p.z + offset));
    };
    double const offset = i % 3 == 0 ? 0 : (i % 3 == 1 ? 1e2 : 1e5);
    collide::triangle<S> s{corner(offset), corner(offset), corner(offset)};
    if (i % 4 == 1) {  // a needle
      s.c = collide::vec3<S>((s.a + s.b) * S(0.5));
      nudge(s.c, roll, 3);
    }
    std::vector<collide::triangle<S>> const mesh{s};
    collide::triangle<S> t{tests::point_at_surface(mesh, roll, roll.integer(0, 2)), corner(offset), corner(offset)};
    if (i % 2 == 0) t.b = tests::point_at_surface(mesh, roll, roll.integer(0, 2));
    if (i % 8 >= 6) t.c = tests::point_at_surface(mesh, roll, roll.integer(0, 2));
    all.add(s, t);
  }
  CHECK(all.wrong == 0);
  CHECK(all.meeting > all.cases / 8);
  CHECK(all.meeting < all.cases * 7 / 8);
}

TEST_CASE_TEMPLATE("exact triangles: coordinates of all exponents", S, float, double) {
  tests::dice roll(3);
  tally all;
  using limits = std::numeric_limits<S>;
  for (S const unit : {limits::denorm_min(), limits::max() / 8}) {
    for (int i = 0; i < 300; ++i) {
      auto corner = [&] {
        return collide::vec3<S>(unit * S(roll.integer(-4, 4)), unit * S(roll.integer(-4, 4)),
                                unit * S(roll.integer(-1, 1)));
      };
      all.add<S>({corner(), corner(), corner()}, {corner(), corner(), corner()});
    }
  }
  for (int i = 0; i < (sizeof(S) == 4 ? 600 : 60); ++i) {
    auto number = [&] {
      int const exponent = roll.integer(limits::min_exponent - limits::digits, limits::max_exponent - 2);
      return std::ldexp(S(roll.integer(-2, 2)), exponent);
    };
    auto corner = [&] { return collide::vec3<S>(number(), number(), number()); };
    collide::triangle<S> const s{corner(), corner(), corner()};
    all.add<S>(s, {i % 2 == 0 ? s.a : corner(), corner(), corner()});
  }
  CHECK(all.wrong == 0);
  CHECK(all.meeting > all.cases / 20);
}
