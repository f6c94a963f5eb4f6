/// Spheres of many radii, on the host and in lockstep.
#include <stdexcept>

#include "execution/lockstep.hpp"
#include "grid/reaches.hpp"

namespace {

using lanes = tests::lockstep<8, false>;

/// A device that cannot be waited for.
struct never_waits : lanes {
  using lanes::lanes;
  template <class T>
  T read(T const*) const {
    throw std::logic_error("the host waits");
  }
};

}  // namespace

namespace collide {
template <>
struct bucket_tuning<never_waits> : device_bucket_tuning {};
}  // namespace collide

TEST_CASE("reaches: spheres whose radii change have the pairs of all pairs, on the host") {
  tests::check_changing_radii(collide::host(1));
  tests::check_changing_radii(lanes(1));
  tests::check_changing_radii(tests::lockstep<8, true>(1));
}

TEST_CASE("reaches: a device that is asked for spheres of many radii is not waited for, and keeps its grids") {
  tests::many_radii const scene(200, 8000, 1000);
  never_waits space;
  for (float const given : {-1.f, 1.f}) {
    collide::bucket::index<float> index;
    index.build(space, {}, scene.mesh());
    if (given > 0) index.prepare(space, {}, given);
    int asked = 0;
    auto const reach_for = [&](std::size_t i) {
      index.prepare(space, {}, scene.spheres(i));
      auto const made = index.mesh_lookup();
      CHECK(made.grid_count == 4);
      CHECK((made.grids[1].reach == -1) == (++asked < 3));  // it pays for many queries
      CHECK(made.grids[3].reach > 0);
      CHECK(*made.total <= made.capacity);
      return made.grids[0].reach;
    };
    float const first = reach_for(0);
    CHECK(first >= 0.99f);
    CHECK(first < 1.2f);
    for (int k = 0; k < 3; ++k) CHECK(reach_for(0) == first);  // from the third query on the cells are for many
    // other cells would tell that the grids were made anew
    auto* const changed = const_cast<std::uint32_t*>(index.mesh_lookup().total);
    --*changed;
    std::uint32_t const left = *changed;
    CHECK(reach_for(0) == first);
    CHECK(*index.mesh_lookup().total == left);
    float const wide = reach_for(1);
    CHECK((given > 0 ? wide == first : wide > 7.9f));
    CHECK((*index.mesh_lookup().total == left) == (given > 0));
    if (given < 0) CHECK(reach_for(0) == first);
  }
}

TEST_CASE("again: the third query makes narrower cells where the others were, and waits for nothing") {
  tests::many_radii const scene(200, 8000, 1000);
  auto const spheres = collide::spheres_xyz(scene.centres.data(), scene.centres.size() / 3, 0.1f);
  never_waits space;
  collide::bucket::index<float> index;
  index.build(space, {}, scene.mesh());
  float widths[5];
  std::uint32_t entries[5];
  collide::detail::bucket_ref<float> made[5];
  for (int k = 0; k < 5; ++k) {
    index.prepare(space, {}, spheres);
    made[k] = index.mesh_lookup();
    widths[k] = made[k].grids[0].width;
    entries[k] = *made[k].total;
    CHECK(entries[k] <= made[k].capacity);
    CHECK(made[k].entries == made[0].entries);  // so that a graph which was captured before stays valid
    CHECK(made[k].lists == made[0].lists);
    CHECK(made[k].occupied == made[0].occupied);
    CHECK(made[k].total == made[0].total);
    CHECK(made[k].grids == made[0].grids);
    CHECK(made[k].grid_count == made[0].grid_count);
    CHECK(made[k].capacity == made[0].capacity);
  }
  CHECK(widths[1] == widths[0]);
  CHECK(widths[2] < widths[1]);
  CHECK(entries[2] > entries[1]);
  CHECK(widths[3] == widths[2]);
  CHECK(widths[4] == widths[2]);
}
