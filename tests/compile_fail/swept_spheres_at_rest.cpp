// expect: collide: this narrow phase judges spheres that move: give query a moving_sphere_view, see
// `with_displacements`
#include <collide/all_pairs.cuh>
#include <collide/karabassi_swept.hpp>

int main() {
  collide::detector<collide::all_pairs, collide::karabassi_swept<>> detector;
  detector.query(collide::sphere_view<float>(), collide::count());
}
