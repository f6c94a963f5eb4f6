// expect: collide: this narrow phase judges spheres that rest: for spheres that move there is karabassi_swept
#include <collide/all_pairs.cuh>

int main() {
  collide::detector<collide::all_pairs> detector;
  detector.query(collide::moving_sphere_view<float>(), collide::count());
}
