/// stages FOLDER: fails at a row that some stage of a verdict gets wrong, or the ball of the broad phase drops;
/// subnormal numbers as they are and flushed to zero.
#include <collide/exact/detail/geometry/bounding_sphere.hpp>
#include <collide/exact/detail/geometry/lifted_bounds.hpp>
#include <collide/narrow/detail/intersects.hpp>

#include "../flush_to_zero.hpp"
#include "rows.hpp"

template <class S>
bool some_integers_are_wrong(collide::triangle<S> const& t, collide::sphere<S> const& s, bool hit) {
  namespace detail = collide::detail;
  auto const shape = detail::widened(t);
  auto const ball = detail::widened(s);
  detail::fixed_width_predicate const fixed(shape, ball);
  return (fixed.fits() && fixed.intersects() != hit) || detail::intersects_in_integers(shape, ball) != hit;
}

/// Of the quick tests: with branches and without.
template <class S>
bool some_attempt_is_wrong(collide::triangle<S> const& t, collide::sphere<S> const& s, bool hit) {
  using collide::detail::verdict;
  verdict const no = hit ? verdict::miss : verdict::hit;
  return collide::detail::filter_exact(t, s).verdict == no || collide::detail::filter_branchless(t, s) == no;
}

/// True if the lifted ball of the broad phase lets a sphere pass, relative to a corner or to the origin of the world.
template <class S>
bool passes(collide::triangle<S> const& t, collide::sphere<S> const& s) {
  namespace detail = collide::detail;
  S const numbers[4] = {s.centre.x(), s.centre.y(), s.centre.z(), s.radius};
  for (collide::vec3<S> const& origin : {t.a, collide::vec3<S>(0, 0, 0)}) {
    detail::lifted_batch<S, 4> batch;
    batch.load(collide::spheres_xyzr(numbers, 1), 0, origin);
    if (!batch.any_overlaps(detail::lifted_bounds<S>(detail::bounding_sphere_of(t), origin))) return false;
  }
  return true;
}

template <class S>
bool is_right(tests::row<S> const& r) {
  namespace detail = collide::detail;
  auto const t = r.triangle();
  auto const s = r.sphere();
  bool const hit = r.hit != 0;
  bool const sound = detail::is_finite(t) && detail::is_finite(s.centre) && detail::is_valid_radius(s.radius);
  return detail::intersects_exact(t, s).hit == hit && detail::intersects_exact_slow(t, s).hit == hit &&
         !(sound && !detail::is_infinite(s.radius) && some_integers_are_wrong(t, s, hit)) &&
         !some_attempt_is_wrong(t, s, hit) &&
         (!hit || (detail::bounding_sphere_of(t).overlaps(s.centre, s.radius) && passes(t, s)));
}

int main(int, char** argv) {
  auto const floats = tests::read_rows<float>(argv[1]);
  auto const doubles = tests::read_rows<double>(argv[1]);
  auto const all_right = [&] {
    return tests::all_right(floats, is_right<float>) && tests::all_right(doubles, is_right<double>);
  };
  bool right = all_right();
  tests::flush_to_zero const flushes;
  right = right && all_right();
  return !right;
}
