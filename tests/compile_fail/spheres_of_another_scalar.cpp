// expect: For float centres and a double mesh take a detector of double and copy the centres to double, which is exact
#include <collide/bucket.cuh>

int main() {
  collide::detector<collide::bucket, collide::karabassi<>, collide::host, double> detector;
  detector.query(collide::sphere_view<float>(), collide::count());
}
