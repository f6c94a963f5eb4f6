// Ten lines for scripts/compile-cost: a ball that falls on a triangle and bounces.
#include <iostream>

#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/simulation.cuh>

int main() {
  float const vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, centres[] = {0.2f, 0.2f, 1};
  unsigned const triangles[] = {0, 1, 2};
  collide::simulation<collide::detector<collide::bucket>, collide::gravity, collide::bounce> scene;
  scene.set_mesh(collide::indexed_mesh(vertices, 3, triangles, 1));
  scene.set(collide::spheres_xyz(centres, 1, 0.1f));
  for (int i = 0; i < 100; ++i) scene.step(0.01f);
  std::cout << "it is at a height of " << scene.data<collide::position>()[2] << "\n";
}
