/// contacts FOLDER: fails at a row with a contact whose distance or depth is more than 4 units in the last place off.
#include <cmath>
#include <limits>

#include <collide/narrow/detail/contact.hpp>

#include "rows.hpp"

/// A number beyond the range must have become infinite.
template <class S>
bool within_4_ulp(S x, double exact) {
  S const size = static_cast<S>(std::abs(exact));
  if (std::isinf(size)) return x == std::copysign(size, static_cast<S>(exact));
  S const before = std::nextafter(size, S(0)), next = std::nextafter(size, std::numeric_limits<S>::infinity());
  double const unit = std::isinf(next) ? double(size) - before : double(next) - size;
  return std::abs(x - exact) <= 4 * unit;
}

template <class S>
bool is_right(tests::row<S> const& r) {
  namespace detail = collide::detail;
  auto const t = r.triangle();
  auto const s = r.sphere();
  if (!(detail::is_finite(t) && detail::is_finite(s.centre) && detail::is_finite(s.radius) && s.radius >= 0))
    return true;
  auto const c = detail::contact_of_pair(t, s);
  return within_4_ulp(c.distance, r.distance) && within_4_ulp(c.depth, r.depth);
}

int main(int, char** argv) {
  return !(tests::all_right(tests::read_rows<float>(argv[1]), is_right<float>) &&
           tests::all_right(tests::read_rows<double>(argv[1]), is_right<double>));
}
