// expect: collide: visit(f) calls f(hit): f must be a function object with a const operator() that takes a hit
#include <collide/bucket.cuh>

int main() {
  collide::detector<collide::bucket> detector;
  int found = 0;
  detector.query(collide::sphere_view<float>(), collide::visit([found](auto const&) mutable { ++found; }));
}
