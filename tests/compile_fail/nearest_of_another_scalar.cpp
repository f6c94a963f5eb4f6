// expect: collide: nearest<S> must have the scalar type of the detector
#include <collide/bvh.cuh>
#include <collide/sinks/nearest.hpp>

int main() {
  collide::detector<collide::bvh, collide::karabassi<>, collide::host, double> detector;
  detector.query(collide::point_view<double>(), collide::nearest<float>());
}
