/// Simulations on ranks that are threads, with particles in memory of a device.
#include <collide/ranks/thread_ranks.hpp>

#include "ranks/simulations.hpp"

namespace {

template <class Scene>
void check_on_device(Scene const& scene) {
  tests::expected_values<Scene> const expected(scene);
  for (int const n : {1, 2, 3, 7}) {
    std::vector<tests::complaints> wrong(static_cast<std::size_t>(n));
    collide::thread_ranks::run(n, [&](collide::thread_ranks const& ranks) {
      collide::cuda_check(cudaSetDevice(ranks.rank() % collide::cuda_device_count()), "cudaSetDevice");
      tests::check_scene(ranks, scene, expected, tests::split::odd, wrong[static_cast<std::size_t>(ranks.rank())]);
    });
    for (auto const& w : wrong) CHECK(w.text() == "");
  }
}

}  // namespace

TEST_CASE("simulations on ranks: one simulation's bits, in device memory") {
  check_on_device(tests::sizes_that_repeat<collide::cuda_shared>());
  check_on_device(tests::snow<collide::cuda>());
  check_on_device(tests::piston_and_belt<collide::karabassi_swept<>, collide::cuda_shared>());
}
