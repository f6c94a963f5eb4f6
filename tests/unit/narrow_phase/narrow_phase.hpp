/// The exact narrow phase alone, in a space, against the oracle; instantiated by test_near_contact.cpp and
/// test_near_contact_cuda.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include <collide/core/memory.hpp>
#include <collide/karabassi.hpp>

#include "compared.hpp"
#include "narrow_phase/near_contact.hpp"

namespace tests {

/// A triangle and a sphere as the library takes them.
template <class S>
struct narrow_case {
  collide::triangle<S> shape;
  collide::sphere<S> ball;

  explicit narrow_case(near_case const& c)
      : shape{vector(c.shape.a), vector(c.shape.b), vector(c.shape.c)},
        ball{vector(c.ball.centre), static_cast<S>(c.ball.radius)} {}

 private:
  static collide::vec3<S> vector(oracle::point const& p) {
    return {static_cast<S>(p.x), static_cast<S>(p.y), static_cast<S>(p.z)};
  }
};

template <class S>
struct exact_verdict {
  narrow_case<S> const* cases;
  std::uint8_t* hit;
  COLLIDE_HD void operator()(std::size_t i) const {
    hit[i] = collide::karabassi<collide::exact>::intersects(cases[i].shape, cases[i].ball) ? 1 : 0;
  }
};

/// Judges all cases in the space and checks that every verdict is right.
template <class S, class Space>
void check_verdicts(Space const& space, std::vector<near_case> const& cases) {
  std::vector<narrow_case<S>> const inputs(cases.begin(), cases.end());
  std::vector<std::uint8_t> hits(cases.size());
  collide::buffer<narrow_case<S>> from;
  collide::buffer<std::uint8_t> to;
  from.reserve(space.resource(), inputs.size());
  to.reserve(space.resource(), hits.size());
  space.copy_from_host(from.data(), inputs.data(), inputs.size());
  space.for_each(inputs.size(), exact_verdict<S>{from.data(), to.data()});
  space.copy_to_host(hits.data(), to.data(), hits.size());
  std::size_t wrong = 0, touching = 0, lost = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    lost += inputs[i].shape.a.template cast<double>().z() != cases[i].shape.a.z ||
            inputs[i].ball.centre.template cast<double>().y() != cases[i].ball.centre.y ||
            static_cast<double>(inputs[i].ball.radius) != cases[i].ball.radius;
    touching += cases[i].hit;
    if ((hits[i] != 0) != cases[i].hit && ++wrong <= 5) MESSAGE("wrong: " << describe(cases[i]));
  }
  REQUIRE(lost == 0);  // the cases are of numbers of S
  CHECK(wrong == 0);
  compared<S>("wrong results of `exact`", "hit if and only if the distance is at most R, in integers of any width",
              double(wrong), 0, cases.size());
  CHECK(touching > cases.size() / 4);
  CHECK(touching < cases.size() * 3 / 4);
}

/// `batches` times 180,000 pairs within 4 units in the last place of tangency.
template <class S, class Space>
void check_near_contact(Space const& space, unsigned seed, unsigned batches) {
  for (unsigned i = 0; i < batches; ++i) {
    CAPTURE(seed + i);
    check_verdicts<S>(space, near_contact<S>(seed + i, 20000));
  }
}

/// Touching at exactly the radius, and coordinates of all exponents.
template <class S, class Space>
void check_ties_and_exponents(Space const& space) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    CAPTURE(seed);
    check_verdicts<S>(space, ties<S>(seed, 20000));
    check_verdicts<S>(space, mixed_exponents<S>(seed, 2000));
  }
}

}  // namespace tests
