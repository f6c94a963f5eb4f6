/// Meshes in host memory, a part at a time on the GPU.
#include "streaming/in_passes.hpp"

TEST_CASE("in passes: sinks hold what they hold after one detector, on the device") {
  tests::check_passes<collide::bucket, float>(collide::cuda_shared());
  tests::motion m;
  tests::check_passes<collide::bucket, collide::karabassi<>, double>(collide::cuda(),
                                                                     tests::random_motion<double>(3, m));
}

TEST_CASE("in passes: a mesh that is in device memory already is refused") {
  collide::cuda_shared const space;
  tests::placed_scene<float> const placed(space, tests::hard_scene<float>());
  collide::in_passes<collide::detector<collide::bucket, collide::karabassi<>, collide::cuda_shared>> passes(space);
  CHECK_THROWS_AS(passes.build(placed.mesh, 10), collide::error);
  CHECK(passes.passes() == 0);
}

TEST_CASE("in passes: memory of the device is that of a part") {
  tests::motion m;
  m.triangles = 400000;
  m.triangle = 0.1;
  m.radius = 0.05;  // few pairs: these are kept
  auto const made = tests::random_motion<float>(12, m);
  tests::placed_scene<float> const placed(collide::cuda_shared(), made);
  auto const peak = [&](std::size_t most) {
    tests::counting_resource memory(collide::cuda_memory::get());
    collide::cuda_shared const space(nullptr, &memory);
    collide::in_passes<collide::detector<collide::bucket, collide::karabassi<>, collide::cuda_shared>> passes(space);
    passes.build(made.mesh(), most);
    collide::sphere_view<float> const spheres = placed.moving;
    passes.query(spheres, collide::count());
    return static_cast<double>(memory.peak);
  };
  CHECK(peak(10000) < 0.4 * peak(400000));
}
