/// Any triangle and any ball that moves: every stage of the exact verdict says the same, whatever the corners and axes
/// are called, and the same as the oracle; and of a hit, time and contact are.
#include <collide/karabassi.hpp>
#include <collide/karabassi_swept.hpp>

#include "numbers.hpp"

namespace {

using numbers = fuzz::numbers<float, 16>;
template <class S>
using pair = fuzz::numbers<S, 16>;
using collide::detail::verdict;
using swept = collide::karabassi_swept<>;

/// Slow questions are asked of one input in so many.
constexpr std::uint32_t asks_slowly = 128, asks_oracle = 4;

/// How much too early a time of impact may be, as the documentation says.
template <class S>
constexpr double most_early = sizeof(S) == sizeof(float) ? 0x1p-23 : 0x1p-30;

template <class S>
bool exact_hit(pair<S> const& n) {
  return swept::intersects(n.shape(), n.moving());
}

/// Checks that bad values are treated as the README says.
template <class Precision, class S>
void check_bad_values(pair<S> const& n) {
  n.check_bad_values(collide::karabassi_swept<Precision>::intersects(n.shape(), n.moving()));
}

/// Where the way ends at a number of S, it may as well be gone backwards.
template <class S>
void check_backwards(pair<S> const& n, bool hit) {
  auto back = n;
  for (std::size_t k = 9; k < 12; ++k) {
    S const from = n.x[k], by = n.x[k + 3], to = back.x[k] = from + by;
    S const part = to - from, lost = (from - (to - part)) + (by - part);
    if (!(lost == 0)) return;  // NaN is not either
    back.x[k + 3] = -by;
  }
  n.require(exact_hit(back) == hit, "a way backwards is the same way");
}

template <class S>
void check_impact(pair<S> const& n, bool at_rest, bool asks) {
  auto const impact = swept::impact_of(n.shape(), n.moving());
  double const time = impact.time;
  n.require(time >= 0 && time <= 1, "the time of impact is within the step");
  n.require(!at_rest || time == 0, "what overlaps at the beginning touches at 0");
  n.check_contact(impact.contact);
  if (!asks || std::isinf(n.radius())) return;
  auto const shape = n.exact_shape();
  auto const ball = n.exact_ball();
  auto const move = n.exact_point(4);
  n.require(!oracle::hit_before(shape, ball, move, time), "the time of impact is not late");
  n.require(oracle::hit_by(shape, ball, move, std::min(1.0, time + most_early<S>)), "the time of impact is not early");
}

template <class S>
void check(pair<S> const& n) {
  using stages = collide::detail::filtered_predicate<swept>;
  auto const hash = n.hash();
  bool const slowly = hash % asks_slowly == 0, asks = hash / asks_slowly % asks_oracle == 0;
  auto const quick = stages::filter(n.shape(), n.moving());
  check_bad_values<collide::single_precision>(n);
  check_bad_values<collide::double_precision>(n);
  if (quick != verdict::uncertain) {
    n.require(stages::resolve(n.shape(), n.moving()) == (quick == verdict::hit), "the later stages say the same");
    n.require(exact_hit(n.turned(hash)) == (quick == verdict::hit), "the order of corners and axes does not matter");
  }
  if (!slowly) return;

  bool const hit = exact_hit(n);
  check_bad_values<collide::exact>(n);
  n.require(exact_hit(n.turned(hash)) == hit, "the order of corners and axes does not matter");
  check_backwards(n, hit);
  if (n.plain()) {
    using namespace collide::detail;
    n.require(intersects_in_integers(widened(n.shape()), widened(n.moving()), {1, 0}) == hit, "integers are right");
  }
  if (asks) {
    n.require(oracle::hit(n.exact_shape(), n.exact_ball(), n.exact_point(4)) == hit, "the oracle says the same");
  }
  bool const moves = n.finite_point(4), at_rest = moves && collide::karabassi<>::intersects(n.shape(), n.ball());
  n.require(hit || !at_rest, "what touches at the beginning touches on the way");
  if (hit) check_impact(n, at_rest, asks);
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  return fuzz::mutated<numbers::count>(data, size, most, seed);
}

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  fuzz::run<numbers::count>(data, size, [](auto const& n) { check(n); });
  return 0;
}
