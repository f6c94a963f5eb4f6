/// \file
/// A mesh that stays in host memory, as the GPU may have no room for it: the detector gets it in parts. Without a GPU
/// the same code runs on the host, where the parts are read where they lie.

#include <cstdio>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/detectors/in_passes.hpp>
#include <collide/spaces/upload.hpp>

template <class Space>
void run(Space space) {
  std::vector<float> mesh;  // a row of squares, each of two triangles
  for (int i = 0; i < 10; ++i) {
    float const x = static_cast<float>(i), y = x + 1;
    mesh.insert(mesh.end(), {x, 0, 0, y, 0, 0, y, 1, 0, x, 0, 0, y, 1, 0, x, 1, 0});
  }
  std::vector<float> centres;  // of which two are near it
  for (int i = 0; i < 10; ++i) centres.insert(centres.end(), {float(i) + 0.5f, 0.5f, i % 5 == 2 ? 0.1f : 5.f});
  auto const spheres = collide::upload(space, collide::spheres_xyz(centres.data(), 10, 0.2f));

  collide::in_passes<collide::detector<collide::bucket, collide::karabassi<>, Space>> detector(space);
  detector.build(collide::triangle_soup(mesh.data(), 20), 6);  // at a time; really some hundred million
  auto const found = detector.query(spheres.view(), collide::pairs(collide::order::canonical));

  std::printf("%zu passes\n", detector.passes());
  for (auto [sphere, triangle] : found.to_host()) std::printf("sphere %u touches triangle %u\n", sphere, triangle);
}

int main() {
#if defined(__CUDACC__)
  if (collide::cuda_device_count() > 0) {
    run(collide::cuda_shared());
    return 0;
  }
#endif
  run(collide::host());
}
