#include <iostream>

#include <thrust/device_vector.h>

#include <collide/bucket.cuh>

int main() {
  if (collide::cuda_device_count() == 0) return 77;  // there is no GPU
  thrust::device_vector<float> const vertices{0, 0, 0, 1, 0, 0, 0, 1, 0};
  thrust::device_vector<unsigned> const triangles{0, 1, 2};
  thrust::device_vector<float> const centres{0.2f, 0.2f, 0.4f, 2, 2, 2};
  collide::detector<collide::bucket, collide::karabassi<>, collide::cuda_shared> detector;
  detector.build(collide::indexed_mesh(vertices.data().get(), 3, triangles.data().get(), 1));
  auto const spheres = collide::spheres_xyz(centres.data().get(), 2, 0.5f);
  for (auto [sphere, triangle] : detector.query(spheres, collide::pairs()).to_host())
    std::cout << "sphere " << sphere << " touches triangle " << triangle << "\n";
}
