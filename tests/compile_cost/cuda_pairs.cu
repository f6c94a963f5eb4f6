// Ten lines for scripts/compile-cost: a query on a GPU, as the README has it for the host.
#include <iostream>

#include <thrust/device_vector.h>

#include <collide/bucket.cuh>

int main() {
  thrust::device_vector<float> vertices(9), centres(6);
  thrust::device_vector<unsigned> triangles(3);
  collide::detector<collide::bucket, collide::karabassi<>, collide::cuda_shared> detector;
  detector.build(collide::indexed_mesh(thrust::raw_pointer_cast(vertices.data()), 3,
                                       thrust::raw_pointer_cast(triangles.data()), 1));
  auto const spheres = collide::spheres_xyz(thrust::raw_pointer_cast(centres.data()), 2, 0.5f);
  for (auto [sphere, triangle] : detector.query(spheres, collide::pairs()).to_host())
    std::cout << "sphere " << sphere << " touches triangle " << triangle << "\n";
}
