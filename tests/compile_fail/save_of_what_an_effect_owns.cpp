// expect: collide: save and load: the parameters of this effect are no plain values
#include <vector>

#include <collide/bucket.cuh>
#include <collide/simulation/checkpoint.hpp>

struct schedule {
  std::vector<double> times;
  template <class Particle, class S>
  void accelerate(Particle&, S) const {}
};

int main() {
  collide::simulation<collide::detector<collide::bucket>, schedule> simulation;
  collide::save(simulation, "file");
}
