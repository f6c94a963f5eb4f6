/// scenes FOLDER: fails at a row that goes wrong as a scene of one pair, or in a scene with more open pairs than the
/// list of the undecided has room for.
#include <collide/bucket.cuh>
#include <collide/detector.hpp>

#include "rows.hpp"

/// The steps of a query that CUDA has, on the host.
struct stepwise : collide::host {};

template <>
struct collide::query_tuning<stepwise> {
  static constexpr bool defers_exact_tests = true;
};

template <class S>
struct scenes {
  using detector = collide::detector<collide::bucket, collide::karabassi<>, stepwise, S>;

  detector single, crowded;  // a list that was too short once must not stand for those that suffice
  collide::pairs found;

  /// Triangles and spheres of these rows, `copies` times each.
  bool right(std::vector<tests::row<S>> const& rows, std::size_t copies) {
    std::vector<S> corners, balls;
    for (std::size_t i = 0; i < copies; ++i) {
      for (auto const& r : rows) {
        corners.insert(corners.end(), r.numbers.begin(), r.numbers.begin() + 9);
        balls.insert(balls.end(), r.numbers.begin() + 9, r.numbers.end());
      }
    }
    std::size_t expected = 0;
    for (auto const& r : rows)
      for (auto const& other : rows)
        expected += collide::karabassi<>::intersects(other.triangle(), r.sphere()) ? copies * copies : 0;
    std::size_t const n = copies * rows.size();
    (copies == 1 ? single : crowded)
        .detect(collide::triangle_soup(corners.data(), n), collide::spheres_xyzr(balls.data(), n), found);
    return found.size() == expected;
  }

  bool all_right(std::vector<tests::row<S>> const& rows) {
    namespace detail = collide::detail;
    int open = 0;
    tests::row<S> const certain{{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1}, 1, 0, 1};
    return tests::all_right(rows, [&](tests::row<S> const& r) {
      if (!right({r}, 1)) return false;
      bool const uncertain = detail::filter_exact(r.triangle(), r.sphere()).verdict == detail::verdict::uncertain;
      return !(uncertain && open++ < 20) || right({r, certain}, 50);
    });
  }
};

int main(int, char** argv) {
  return !(scenes<float>().all_right(tests::read_rows<float>(argv[1])) &&
           scenes<double>().all_right(tests::read_rows<double>(argv[1])));
}
