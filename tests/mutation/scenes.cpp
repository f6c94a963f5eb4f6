/// scenes ROWS: how many rows go wrong as scenes of one pair, or their contacts do, and how many scenes with more open
/// pairs than the list of the undecided has room for.
#include <cstdio>

#include <collide/bucket.cuh>
#include <collide/detector.hpp>

#include "rows.hpp"

/// The steps of a query that CUDA has, on the host.
struct stepwise : collide::host {
  static constexpr bool defers = true;
};

template <class S>
struct scenes {
  collide::detector<collide::bucket, collide::karabassi<>, stepwise, S> detector;
  collide::pairs found;

  /// A triangle and a sphere, `copies` times each.
  bool right(tests::row<S> const& r, std::size_t copies) {
    std::vector<S> corners, balls;
    for (std::size_t i = 0; i < copies; ++i) {
      corners.insert(corners.end(), r.numbers.begin() + 1, r.numbers.begin() + 10);
      balls.insert(balls.end(), r.numbers.begin() + 10, r.numbers.end());
    }
    detector.detect(collide::triangle_soup(corners.data(), copies), collide::spheres_xyzr(balls.data(), copies), found);
    return found.size() == (r.hit() ? copies * copies : 0);
  }

  int count_wrong(std::vector<tests::row<S>> const& rows) {
    namespace detail = collide::detail;
    int wrong = 0, open = 0;
    for (auto const& r : rows) {
      auto const t = r.triangle();
      auto const s = r.sphere();
      wrong += right(r, 1) ? 0 : 1;
      // which of its digits are exact is asked elsewhere; that of doubles may underflow if sizes differ by more than 2^1000
      bool const sound = detail::finite(t) && detail::finite(s.centre) && detail::valid_radius(s.radius);
      if (sizeof(S) == 4 && sound) wrong += (detail::contact_between(t, s).depth >= 0) != r.hit() ? 1 : 0;
      if (detail::attempt(t, s).verdict == detail::verdict::unsure && open++ < 20) wrong += right(r, 50) ? 0 : 1;
    }
    return wrong;
  }
};

int main(int, char** argv) {
  int const wrong = scenes<float>().count_wrong(tests::read_rows<float>(argv[1])) +
                    scenes<double>().count_wrong(tests::read_rows<double>(argv[1]));
  std::printf("%d wrong\n", wrong);
  return wrong != 0;
}
