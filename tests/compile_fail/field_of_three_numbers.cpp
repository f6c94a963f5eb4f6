// expect: collide: a field of wind is called as field(position) const, and returns a velocity
#include <collide/bucket.cuh>
#include <collide/effects/wind.hpp>
#include <collide/simulation.cuh>

struct breeze {
  float operator()(float x, float, float) const { return x; }
};

int main() {
  collide::simulation<collide::detector<collide::bucket>, collide::wind<breeze>> simulation;
  simulation.step(1);
}
