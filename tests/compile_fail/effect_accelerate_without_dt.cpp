// expect: collide: an effect's accelerate is called as accelerate(particle&, dt) const
#include <collide/bucket.cuh>
#include <collide/simulation.cuh>

struct mine {
  using writes = collide::columns<collide::velocity>;
  template <class Particle>
  void accelerate(Particle&) const {}
};

int main() { collide::simulation<collide::detector<collide::bucket>, mine> simulation; }
