// expect: collide: closest is for spheres that rest: of those that move, earliest finds the first impact
#include <collide/all_pairs.cuh>
#include <collide/karabassi_swept.hpp>

int main() {
  collide::detector<collide::all_pairs, collide::karabassi_swept<>> detector;
  detector.query(collide::moving_sphere_view<float>(), collide::closest<float>());
}
