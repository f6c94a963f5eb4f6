// expect: collide: an effect's try_wake is called as try_wake(particle&, other) const
#include <collide/bucket.cuh>
#include <collide/simulation.cuh>

struct mine {
  using writes = collide::columns<collide::velocity>;
  template <class Particle>
  void try_wake(Particle&) const {}
};

int main() { collide::simulation<collide::detector<collide::bucket>, mine> simulation; }
