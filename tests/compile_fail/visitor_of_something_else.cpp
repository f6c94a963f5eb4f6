// expect: collide: visit(f) calls f(hit): f must be a function object with a const operator() that takes a hit
#include <collide/bucket.cuh>

int main() {
  collide::detector<collide::bucket> detector;
  detector.query(collide::sphere_view<float>(), collide::visit([](collide::id, collide::id) {}));
}
