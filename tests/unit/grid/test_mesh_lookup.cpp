/// Triangles that a kernel goes through without a grid.
#include <vector>

#include <doctest/doctest.h>

#include <collide/broad/detail/mesh_lookup.hpp>

using namespace collide::detail;

namespace {

/// Three triangles in a row along x, 10 apart.
std::vector<float> const row = {0, 0, 0, 1, 0, 0, 0, 1, 0, 10, 0, 0, 11, 0, 0, 10, 1, 0, 20, 0, 0, 21, 0, 0, 20, 1, 0};
auto const mesh = collide::triangle_soup(row.data(), 3);

}  // namespace

TEST_CASE("mesh lookup: all triangles, once each and in order, in pieces of any length") {
  mesh_lookup<float> const ref{mesh, nullptr};
  for (std::uint32_t most : {1u, 2u, 3u, 100u}) {
    candidate_cursor cursor{0, 0, 0, 0};
    candidate_range range;
    std::vector<collide::id> seen;
    while (ref.next_of_all(cursor, most, range)) {
      CHECK(range.count <= most);
      for (std::uint32_t k = 0; k < range.count; ++k) {
        seen.push_back(range.at(k).triangle);
        CHECK(range.passes_coverage(range.at(k)));
      }
    }
    CHECK(seen == std::vector<collide::id>{0, 1, 2});
    CHECK(cursor.at_end());
  }
}

TEST_CASE("mesh lookup: boxes rule out what is far, if there are any") {
  std::vector<triangle_aabb<float>> boxes;
  for (std::size_t i = 0; i < mesh.size(); ++i) boxes.push_back(triangle_aabb_of(mesh[i]));
  mesh_lookup<float> const without{mesh, nullptr}, with{mesh, boxes.data()};
  collide::sphere<float> const s{{10.5f, 0.5f, 2}, 3};
  for (collide::id t : {0u, 1u, 2u}) {
    CHECK(without.near(s, t));
    CHECK(with.near(s, t) == (t == 1));
    for (int k = 0; k < 3; ++k) {
      CHECK(without.box_at(t).lower[k] == with.box_at(t).lower[k]);
      CHECK(without.box_at(t).upper[k] == with.box_at(t).upper[k]);
    }
  }
}

TEST_CASE("mesh lookup: entries of a cell") {
  cell_item const entries[] = {{7, cell_coverage::full_box}, {9, 0}};
  candidate_range const range{entries, 0, 2, cell_coverage::full_query};
  CHECK(range.at(0).triangle == 7);
  CHECK(range.at(1).triangle == 9);
  CHECK(range.passes_coverage(range.at(0)));
}
