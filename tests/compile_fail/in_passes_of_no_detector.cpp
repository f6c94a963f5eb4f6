// expect: collide: what gets a mesh in passes is a detector, such as detector<bucket>
#include <collide/bucket.cuh>
#include <collide/detectors/in_passes.hpp>

int main() { collide::in_passes<collide::bucket> passes; }
