// expect: collide: sphere_pairs gives ids alone: its sinks are count, pairs, csr and any_hit
#include <collide/detectors/sphere_pairs.cuh>

int main() {
  collide::sphere_pairs<> finder;
  finder.query(collide::sphere_view<float>(), collide::contacts<float>());
}
