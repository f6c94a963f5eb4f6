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
    auto const reach_for = [&](std::size_t i) {
      index.prepare(space, {}, scene.spheres(i));
      auto const made = index.mesh_lookup();
      CHECK(made.grid_count == 4);
      CHECK((made.grids[1].reach == -1) == (made.grids[0].reach < 2));  // it costs more than it saves
      CHECK(made.grids[3].reach > 0);
      CHECK(*made.total <= made.capacity);
      return made.grids[0].reach;
    };
    float const first = reach_for(0);
    CHECK(first >= 0.99f);
    CHECK(first < 1.2f);
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
    index.build(space, {}, scene.mesh());
    if (given > 0) index.prepare(space, {}, given);
    CHECK(reach_for(0) == first);
  }
}

TEST_CASE("reaches: a large mesh gets narrower cells for few spheres, as these cost little there") {
  float widths[2];
  for (std::size_t const more : {0u, 1u}) {
    std::size_t const triangles = (std::size_t{1} << 18) + more;
    tests::many_radii const scene(triangles, 1000, 1);
    lanes space;
    collide::bucket::index<float> index;
    index.build(space, {}, scene.mesh());
    index.prepare(space, {}, collide::spheres_xyz(scene.centres.data(), 1000, 0.01f));
    widths[more] = index.mesh_lookup().grids[0].width;
    CHECK(*index.mesh_lookup().total <= index.mesh_lookup().capacity);
  }
  CHECK(widths[1] < 0.9f * widths[0]);
}
