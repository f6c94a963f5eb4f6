/// Any triangle and any ball: every stage of the exact verdict says the same, whatever the corners and axes are called,
/// and the same as the oracle; and the contact of a hit is one.
#include <collide/karabassi.hpp>

#include "numbers.hpp"

namespace {

using numbers = fuzz::numbers<float, 13>;
template <class S>
using pair = fuzz::numbers<S, 13>;
using collide::detail::verdict;

/// Slow questions are asked of one input in so many.
constexpr std::uint32_t asks_slowly = 64, asks_oracle = 8;

template <class S>
bool exact_hit(pair<S> const& n) {
  return collide::karabassi<>::intersects(n.shape(), n.ball());
}

/// Checks that bad values are treated as the README says.
template <class Precision, class S>
void check_bad_values(pair<S> const& n) {
  n.check_bad_values(collide::karabassi<Precision>::intersects(n.shape(), n.ball()));
}

/// Integers of each kind, where they hold.
template <class S>
void check_integers(pair<S> const& n, bool hit) {
  auto const shape = collide::detail::widened(n.shape());
  auto const ball = collide::detail::widened(n.ball());
  collide::detail::fixed_width_predicate const fixed(shape, ball);
  n.require(!fixed.fits() || fixed.intersects() == hit, "integers of fixed width are right");
  n.require(collide::detail::intersects_in_integers(shape, ball) == hit, "integers of any width are right");
}

template <class S>
void check_contact(pair<S> const& n, bool asks) {
  auto const c = collide::karabassi<>::contact_of(n.shape(), n.ball());
  n.check_contact(c);
  n.require(c.depth >= 0, "the depth of a hit is not below 0");
  if (!asks || std::isinf(n.radius())) return;
  auto const distance = oracle::closest(n.exact_shape(), n.exact_point(3)).distance;
  n.require(fuzz::nearly(c.distance, distance), "the distance is exact");
  n.require(fuzz::nearly(c.depth, oracle::depth(n.exact_shape(), n.exact_ball())), "the depth is exact");
}

template <class S>
void check(pair<S> const& n) {
  using stages = collide::detail::filtered_predicate<collide::karabassi<>>;
  auto const hash = n.hash();
  bool const slowly = hash % asks_slowly == 0, asks = hash / asks_slowly % asks_oracle == 0;
  auto const quick = stages::filter(n.shape(), n.ball()), straight = stages::filter_branchless(n.shape(), n.ball());
  bool const is_sure = straight == verdict::hit || straight == verdict::miss;
  n.require(!is_sure || quick == verdict::uncertain || straight == quick, "both filters agree");
  check_bad_values<collide::single_precision>(n);
  check_bad_values<collide::double_precision>(n);
  collide::karabassi<collide::baseline>::intersects(n.shape(), n.ball());  // promises nothing, but harms nothing
  if (quick != verdict::uncertain) {
    n.require(stages::resolve(n.shape(), n.ball()) == (quick == verdict::hit), "the later stages say the same");
    n.require(exact_hit(n.turned(hash)) == (quick == verdict::hit), "the order of corners and axes does not matter");
  }
  if (!slowly) return;

  bool const hit = exact_hit(n);
  check_bad_values<collide::exact>(n);
  n.require(!is_sure || (straight == verdict::hit) == hit, "the quick verdict is right");
  n.require(exact_hit(n.turned(hash)) == hit, "the order of corners and axes does not matter");
  if (n.plain()) check_integers(n, hit);
  if (asks) n.require(oracle::hit(n.exact_shape(), n.exact_ball()) == hit, "the oracle says the same");
  if (hit) check_contact(n, asks);
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  return fuzz::mutated<numbers::count>(data, size, most, seed);
}

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  fuzz::run<numbers::count>(data, size, [](auto const& n) { check(n); });
  return 0;
}
