// expect: collide: an effect's end_step is called as end_step(particle&, dt) const
#include <collide/bucket.cuh>
#include <collide/simulation.cuh>

struct mine {
  using writes = collide::columns<collide::velocity>;
  template <class Particle, class S>
  void end_step(Particle&, S) {}
};

int main() { collide::simulation<collide::detector<collide::bucket>, mine> simulation; }
