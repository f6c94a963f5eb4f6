/// Parts of cells, against intervals of steps.
#include <algorithm>
#include <cstdint>
#include <random>

#include <doctest/doctest.h>

#include <collide/broad/detail/grid/grid.hpp>

namespace {

using coverage = collide::detail::cell_coverage;

struct interval {
  std::uint32_t from, to;
};

bool meet(interval a, interval b) { return a.from <= b.to && b.from <= a.to; }

}  // namespace

TEST_CASE("cell coverage: steps are sixteenths of a cell, except for the last, which is two") {
  for (int i = 0; i < 1600; ++i) {
    auto const expected = static_cast<std::uint32_t>(i / 100 < 14 ? i / 100 + 1 : 15);
    CHECK(coverage::subcell_of(static_cast<double>(i) / 1600) == expected);
    CHECK(coverage::subcell_of(static_cast<float>(i) / 1600) == expected);
  }
}

TEST_CASE("cell coverage: a box and what may be in a part of the cell meet if they do on each axis") {
  std::mt19937 engine(1);
  auto const roll = [&](std::uint32_t from, std::uint32_t to) {
    return std::uniform_int_distribution<std::uint32_t>(from, to)(engine);
  };
  int meetings = 0;
  for (int i = 0; i < 100000; ++i) {
    interval box[3], query[3];
    std::uint32_t encoded_box = 0, encoded_query = 0;
    bool expected = true;
    for (int k = 0; k < 3; ++k) {
      box[k].from = roll(coverage::before, coverage::last);
      box[k].to = roll(box[k].from < 1 ? 1 : box[k].from, coverage::last);
      query[k].from = roll(coverage::first, coverage::last);
      query[k].to = roll(query[k].from, coverage::last);
      encoded_box |= coverage::encode_box(box[k].from, box[k].to, k);
      encoded_query |= coverage::encode_query(query[k].from, query[k].to, k);
      expected = expected && meet(box[k], query[k]);
    }
    bool earlier = true;
    for (int k = 0; k < 3; ++k) {
      earlier = earlier && coverage::starts_in_earlier_cell(encoded_box, coverage::axis(k)) == (box[k].from == 0);
    }
    CHECK(earlier);
    CHECK(coverage::overlaps(encoded_box, encoded_query) == expected);
    CHECK(coverage::overlaps(coverage::full_box, encoded_query));
    CHECK(coverage::overlaps(encoded_box, coverage::full_query));
    meetings += expected;
  }
  CHECK(meetings > 10000);
  CHECK(meetings < 90000);
}

TEST_CASE("cell coverage: all intervals of one axis, beside whole ones on the others") {
  using collide::detail::cell_coverage;
  constexpr std::uint32_t first = cell_coverage::first, last = cell_coverage::last, before = cell_coverage::before;
  auto const everywhere = [&](int axis) {
    return cell_coverage::encode_query(first, last, (axis + 1) % 3) |
           cell_coverage::encode_query(first, last, (axis + 2) % 3);
  };
  auto const whole = [&](int axis) {
    return cell_coverage::encode_box(before, last, (axis + 1) % 3) |
           cell_coverage::encode_box(before, last, (axis + 2) % 3);
  };
  for (int axis = 0; axis < 3; ++axis) {
    CHECK((whole(axis) | cell_coverage::encode_box(before, last, axis)) == cell_coverage::full_box);
    CHECK((everywhere(axis) | cell_coverage::encode_query(first, last, axis)) == cell_coverage::full_query);
    for (std::uint32_t from = before; from <= last; ++from) {
      for (std::uint32_t to = std::max(from, first); to <= last; ++to) {
        std::uint32_t const part = whole(axis) | cell_coverage::encode_box(from, to, axis);
        CHECK(cell_coverage::overlaps(part, cell_coverage::full_query));
        CHECK(cell_coverage::starts_in_earlier_cell(part, cell_coverage::axis(axis)) == (from == before));
        CHECK_FALSE(cell_coverage::starts_in_earlier_cell(part, 0));
        for (std::uint32_t a = first; a <= last; ++a) {
          for (std::uint32_t b = a; b <= last; ++b) {
            std::uint32_t const place = everywhere(axis) | cell_coverage::encode_query(a, b, axis);
            CHECK(cell_coverage::overlaps(part, place) == (a <= to && b >= from));
            CHECK(cell_coverage::overlaps(cell_coverage::full_box, place));
          }
        }
      }
    }
  }
}
