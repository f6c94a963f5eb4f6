/// A mesh in passes: sinks hold what they hold after one detector of the whole mesh.
#pragma once

#include <algorithm>
#include <limits>
#include <type_traits>
#include <vector>

#include <doctest/doctest.h>

#include <collide/detectors/in_passes.hpp>

#include "ranks/ranks.hpp"
#include "type_erased_detector.hpp"

namespace tests {

/// Every kind of sink. Spheres are in memory of the space; `is_sorted`: whether the space can sort pairs.
template <class Passes, class Whole, class Spheres>
void check_same_sinks(Passes& passes, Whole& whole, Spheres const& spheres, bool is_sorted = true) {
  using S = typename Whole::scalar;
  auto const order = is_sorted ? collide::order::canonical : collide::order::unspecified;
  auto const check = [&](auto sink, char const* what) {
    CAPTURE(what);
    auto expected = whole.query(spheres, sink).to_host(), found = passes.query(spheres, sink).to_host();
    if (!is_sorted) {
      CHECK(found.size() == expected.size());
    } else {
      CHECK(equal_bytes(found, expected));
    }
  };
  auto pairs = whole.query(spheres, collide::pairs(order)).to_host();
  auto found = passes.query(spheres, collide::pairs(order)).to_host();
  std::sort(pairs.begin(), is_sorted ? pairs.begin() : pairs.end());
  std::sort(found.begin(), is_sorted ? found.begin() : found.end());
  CHECK((found == pairs));
  CHECK(passes.query(spheres, collide::count()).total() == pairs.size());
  CHECK(passes.query(spheres, collide::any_hit()).to_host() == whole.query(spheres, collide::any_hit()).to_host());
  if (is_sorted) {
    auto const rows = passes.query(spheres, collide::csr(order)).to_host(),
               all_rows = whole.query(spheres, collide::csr(order)).to_host();
    CHECK(rows.offsets == all_rows.offsets);
    CHECK(rows.triangles == all_rows.triangles);
  }
  check(collide::contacts<S>(order), "contacts");
  if constexpr (collide::detail::is_discrete<typename Whole::narrow_phase, S>) {
    auto const closest = passes.query(spheres, collide::closest_contact<S>()).to_host(),
               of_all = whole.query(spheres, collide::closest_contact<S>()).to_host();
    CHECK(equal_bytes(closest, of_all));
  } else {
    check(collide::impacts<S>(order), "impacts");
    auto const earliest = passes.query(spheres, collide::earliest_impact<S>()).to_host(),
               of_all = whole.query(spheres, collide::earliest_impact<S>()).to_host();
    CHECK(equal_bytes(earliest, of_all));
  }
}

/// Parts of many sizes, of meshes in host memory, in a space.
template <class Broad, class NarrowPhase, class S, class Space>
void check_passes(Space const& space, moving_scene<S> const& made, bool is_sorted = true) {
  using detector = collide::detector<Broad, NarrowPhase, Space, S>;
  placed_scene<S> const placed(space, made);
  typename detector::spheres_type const spheres = placed.moving;
  detector whole(space);
  whole.build(placed.mesh);
  collide::in_passes<detector> passes(space);
  std::size_t const n = made.mesh().size();
  for (std::size_t const most : {n + 1, n / 2 + 1, n / 2, std::size_t{7}, std::numeric_limits<std::size_t>::max()}) {
    if (most == 0) continue;
    CAPTURE(most);
    passes.build(made.mesh(), most);
    CHECK(passes.passes() == (n == 0 ? 1 : (n - 1) / most + 1));
    check_same_sinks(passes, whole, spheres, is_sorted);
  }
}

/// Static and moving spheres, with everything that is awkward.
template <class Broad, class S, class Space, class Precision = collide::exact>
void check_passes(Space const& space, bool is_sorted = true) {
  motion m;
  m.spread = 8;
  for (auto const& made : {hard_scene<S>(), random_motion<S>(3, m), moving_scene<S>()}) {
    CAPTURE(made.radii.size());
    check_passes<Broad, collide::karabassi<Precision>, S>(space, made, is_sorted);
    check_passes<Broad, collide::karabassi_swept<Precision>, S>(space, made, is_sorted);
  }
}

}  // namespace tests
