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

/// A device of which nobody waits for a single thread, and one where that takes as long as very many spheres.
struct all_alike : lanes {
  using lanes::lanes;
};
struct one_slow : lanes {
  using lanes::lanes;
};

}  // namespace

namespace collide {
template <>
struct bucket_tuning<never_waits> : device_bucket_tuning {};
template <>
struct bucket_tuning<all_alike> : device_bucket_tuning {
  static constexpr bucket_costs costs{0.12f, 0.004f, 0.06f, 0.04f, 7, 0, 0, 0};
};
template <>
struct bucket_tuning<one_slow> : device_bucket_tuning {
  static constexpr bucket_costs costs{0.12f, 0.004f, 0.06f, 0.04f, 7, 0, 0, 99000};
};
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

namespace {

/// The width of the cells that so many spheres get in a space.
template <class Space>
float width_for(tests::many_radii const& scene, std::size_t spheres) {
  Space space;
  collide::bucket::index<float> index;
  index.build(space, {}, scene.mesh());
  index.prepare(space, {}, collide::spheres_xyz(scene.centres.data(), spheres, 0.01f));
  CHECK(*index.mesh_lookup().total <= index.mesh_lookup().capacity);
  return index.mesh_lookup().grids[0].width;
}

}  // namespace

TEST_CASE("reaches: a large mesh gets narrower cells for few spheres, as these cost little there") {
  tests::many_radii const small(std::size_t{1} << 18, 10000, 1), large((std::size_t{1} << 18) + 1, 10000, 1);
  CHECK(width_for<lanes>(large, 10000) < 0.9f * width_for<lanes>(small, 10000));
}

TEST_CASE("reaches: where the slowest thread is waited for few spheres get cells as narrow as many") {
  tests::many_radii const scene(2000, 100000, 1);
  float const few = width_for<all_alike>(scene, 1000), many = width_for<all_alike>(scene, 100000);
  CHECK(many < 0.7f * few);
  CHECK(width_for<one_slow>(scene, 1000) == many);
}
