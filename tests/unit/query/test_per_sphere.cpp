/// Broad phases that enumerate the candidates of one sphere, against the list that they enumerate.
#include <algorithm>
#include <type_traits>
#include <vector>

#include <doctest/doctest.h>

#include <collide/broad/detail/per_sphere.hpp>
#include <collide/karabassi.hpp>
#include <collide/spaces/detail/block.hpp>

#include "execution/lockstep.hpp"
#include "query/pair_output.hpp"

using namespace collide::detail;

namespace {

using tests::pair_output;

/// Candidates in any order, and some of them several times. Remembers the sphere.
struct listed {
  std::vector<collide::id> const* all;
  collide::sphere<float>* seen;

  template <class F>
  void for_each_candidate(collide::sphere<float> const& s, F const& f) const {
    *seen = s;
    for (collide::id t : *all) f(t);
  }
};

/// One that takes moving spheres as they are.
struct swept {
  collide::moving_sphere<float>* seen;

  template <class F>
  void for_each_candidate(collide::moving_sphere<float> const& s, F const&) const {
    *seen = s;
  }
};

collide::moving_sphere<float> const moves{{{1, 2, 3}, 0.5f}, {4, 0, 0}};

}  // namespace

TEST_CASE("per sphere: a sphere that moves is replaced by one around its path, unless it is asked for") {
  std::vector<collide::id> const all{3, 1};
  collide::sphere<float> seen{};
  std::vector<collide::id> found;
  for_each_candidate(listed{&all, &seen}, moves, [&](collide::id t) { found.push_back(t); });
  CHECK(found == all);
  CHECK(seen.centre == collide::vec3<float>(3, 2, 3));
  CHECK(seen.radius >= 2.5f);
  CHECK(seen.radius < 2.51f);

  collide::moving_sphere<float> as_it_is{};
  for_each_candidate(swept{&as_it_is}, moves, [](collide::id) {});
  CHECK(as_it_is.displacement == moves.displacement);
}

TEST_CASE("per sphere: a lookup gives each candidate once, by rising number") {
  std::vector<float> const vertices(9 * 100, 0.f);
  std::vector<collide::id> const all{70, 3, 99, 3, 0, 42};
  collide::sphere<float> seen{};
  per_sphere_ref<float, listed> lookup{{collide::triangle_soup(vertices.data(), 100), nullptr}, {&all, &seen}};
  auto cursor = lookup.begin(moves);
  candidate_range range;
  std::vector<collide::id> found;
  while (lookup.next(moves, cursor, 5, range)) {
    for (std::uint32_t k = 0; k < range.count; ++k) found.push_back(range.at(k).triangle);
  }
  CHECK(found == std::vector<collide::id>{0, 3, 42, 70, 99});
  CHECK(cursor.at_end());
  CHECK(!lookup.next(moves, cursor, 5, range));
  CHECK(!lookup.empty(moves));
}

TEST_CASE("per sphere: kernels try all candidates, however many there are for the room") {
  // triangles in the plane z = 0 at the origin, of which the even ones are moved away
  std::vector<float> vertices;
  std::vector<collide::id> all;
  for (collide::id t = 0; t < 45; ++t) {
    float const z = t % 2 == 0 ? 10.f : 0.f;
    vertices.insert(vertices.end(), {-1, -1, z, 1, -1, z, 0, 1, z});
    all.push_back(44 - t);
  }
  std::vector<float> const centres = {0, 0, 0.1f, 0, 0, 5, 0, 0, -0.2f};
  collide::sphere<float> seen{};
  std::vector<collide::pair> expected;
  for (collide::id s : {0u, 2u}) {
    for (collide::id t = 1; t < 45; t += 2) expected.push_back({s, t});
  }
  auto const mesh = collide::triangle_soup(vertices.data(), 45);
  auto const spheres = collide::spheres_xyz(centres.data(), 3, 0.5f);
  auto const check = [&](auto const& space) {
    using space_type = std::decay_t<decltype(space)>;
    std::vector<collide::pair> found;
    per_sphere_query<float, collide::karabassi<>, pair_output, listed> const kernel{{mesh, spheres, {&found}, nullptr},
                                                                                    {&all, &seen}};
    space.launch(grid_size<space_type>(3, kernel), kernel);
    std::sort(found.begin(), found.end());
    CHECK(std::equal(found.begin(), found.end(), expected.begin(), expected.end(),
                     [](auto const& a, auto const& b) { return a.sphere == b.sphere && a.triangle == b.triangle; }));
  };
  check(collide::host(1));
  check(tests::lockstep<8, false>());
  check(tests::lockstep<8, true>());
}
