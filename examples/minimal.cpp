#include <iostream>

#include <collide/bucket.cuh>

int main() {
  float const vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  unsigned const triangles[] = {0, 1, 2};
  float const centres[] = {0.2f, 0.2f, 0.4f, 2, 2, 2};
  collide::detector<collide::bucket> detector;
  detector.build(collide::indexed_mesh(vertices, 3, triangles, 1));
  for (auto [sphere, triangle] : detector.query(collide::spheres_xyz(centres, 2, 0.5f), collide::pairs()).to_host())
    std::cout << "sphere " << sphere << " touches triangle " << triangle << "\n";
}
