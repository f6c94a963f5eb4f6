/// \file
/// Spheres that stay in host memory, as there may be more than the GPU has room for: they stream through the detector
/// in chunks. Without a GPU the same code runs on the host, where nothing is copied.

#include <cstdio>
#include <memory_resource>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/detectors/streamed.cuh>
#include <collide/spaces/upload.hpp>

template <class Space>
void run(Space space, std::pmr::memory_resource* memory) {
  float const vertices[] = {0, 0, 2500, 1, 0, 2500, 0, 1, 2500};
  unsigned const corners[] = {0, 1, 2};
  std::pmr::vector<float> centres(memory);
  for (float height = 0; height < 10000; ++height) centres.insert(centres.end(), {0.2f, 0.2f, height});
  auto const spheres = collide::spheres_xyz(centres.data(), centres.size() / 3, 1.5f);

  auto const mesh = collide::upload(space, collide::indexed_mesh(vertices, 3, corners, 1));
  collide::detector<collide::bucket, collide::karabassi<>, Space> detector(space);
  detector.build(mesh.view(), spheres.common_radius());

  std::vector<collide::pair> all;
  collide::streamed streamed(detector, 1000);  // a real chunk is some million spheres
  streamed.query(spheres, collide::pairs(collide::order::canonical), [&](collide::id first, auto const& found) {
    for (auto [sphere, triangle] : found.to_host()) all.push_back({first + sphere, triangle});
  });
  for (auto [sphere, triangle] : all) std::printf("sphere %u touches triangle %u\n", sphere, triangle);
}

int main() {
#if defined(__CUDACC__)
  if (collide::cuda_device_count() > 0) {
    run(collide::cuda_shared(), collide::cuda_pinned_memory::get());
    return 0;
  }
#endif
  run(collide::host(), std::pmr::new_delete_resource());
}
