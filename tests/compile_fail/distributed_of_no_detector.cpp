// expect: collide: the first parameter of distributed is a detector, such as detector<bucket>
#include <collide/bucket.cuh>
#include <collide/ranks/distributed.hpp>

int main() { collide::distributed<collide::bucket> parts; }
