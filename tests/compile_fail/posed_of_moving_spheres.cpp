// expect: collide: posed is for spheres that rest: bodies and spheres that move in a step are those of a simulation
#include <collide/bucket.cuh>
#include <collide/detectors/posed.hpp>
#include <collide/karabassi_swept.hpp>

int main() { collide::posed<collide::detector<collide::bucket, collide::karabassi_swept<>>> robot; }
