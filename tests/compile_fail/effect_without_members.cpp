// expect: collide: what follows the detector in a simulation are effects, such as gravity or bounce: copyable classes
// with at least one of the members that effect.hpp names
#include <collide/bucket.cuh>
#include <collide/simulation.cuh>

struct nothing_at_all {
  void tough() const {}
};

int main() { collide::simulation<collide::detector<collide::bucket>, nothing_at_all> simulation; }
