/// Clumps on ranks that are threads, in memory of a device.
#include <collide/ranks/thread_ranks.hpp>

#include "ranks/clumps.hpp"

namespace {

template <class Scene>
void check_on_device(Scene const& scene) {
  tests::expected_clumps<Scene> const expected(scene);
  std::size_t const spheres = scene.spheres_of(tests::range{0, scene.placed.size()}).size;
  for (int const n : {1, 3}) {
    std::vector<tests::complaints> wrong(static_cast<std::size_t>(n));
    std::vector<std::vector<int>> owners(10, std::vector<int>(spheres, -1));
    collide::thread_ranks::run(n, [&](collide::thread_ranks const& ranks) {
      collide::cuda_check(cudaSetDevice(ranks.rank() % collide::cuda_device_count()), "cudaSetDevice");
      tests::check_clumps(ranks, scene, expected, tests::split::odd, owners,
                          wrong[static_cast<std::size_t>(ranks.rank())]);
    });
    for (auto const& w : wrong) CHECK(w.text() == "");
  }
}

}  // namespace

TEST_CASE("clumps on ranks: one simulation's bits, in device memory") {
  check_on_device(tests::clumps_in_a_cube<double, collide::cuda>());
  check_on_device(tests::source_of_clumps<float, collide::cuda_shared>());
}
