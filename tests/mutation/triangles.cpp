/// triangles FOLDER: fails at a row whose two triangles meet where they should not, or do not where they should.
#include <collide/exact/detail/predicates/exact_triangles.hpp>

#include "rows.hpp"

namespace {

/// A triangle as its pair sees it: corners of equal coordinates have one number.
collide::detail::seen_triangle seen(tests::pair_row const& r, std::size_t i) {
  std::array<std::uint32_t, 3> vertices{};
  for (std::size_t k = 0; k < 3; ++k) {
    std::size_t first = 0;
    while (r.at(3 * first) != r.at(9 * i + 3 * k)) ++first;
    vertices[k] = static_cast<std::uint32_t>(first);
  }
  return {r.triangle(i), vertices};
}

bool meets_right(tests::pair_row const& r) {
  using collide::detail::seen_triangle;
  seen_triangle const s = seen(r, 0), t = seen(r, 1);
  bool const have_area = s.has_area() && t.has_area(), expected = r.meet != 0;
  return have_area ? seen_triangle::meet(s, t) == expected && seen_triangle::meet(t, s) == expected : !expected;
}

}  // namespace

int main(int, char** argv) {
  return !tests::all_right(tests::read_all<tests::pair_row>(tests::path_of_pairs(argv[1])), meets_right);
}
