// Ten lines for scripts/compile-cost: balls on a GPU that fall on a triangle and bounce.
#include <iostream>

#include <thrust/device_vector.h>

#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/simulation.cuh>

int main() {
  thrust::device_vector<float> vertices(9), centres(6);
  thrust::device_vector<unsigned> triangles(3);
  using detector = collide::detector<collide::bucket, collide::karabassi<>, collide::cuda_shared>;
  collide::simulation<detector, collide::gravity, collide::bounce> scene;
  scene.set_mesh(collide::indexed_mesh(thrust::raw_pointer_cast(vertices.data()), 3,
                                       thrust::raw_pointer_cast(triangles.data()), 1));
  scene.set(collide::spheres_xyz(thrust::raw_pointer_cast(centres.data()), 2, 0.1f));
  scene.steps(100, 0.01f);
  std::cout << "it is at a height of " << scene.to_host<collide::position>()[2] << "\n";
}
