// expect: collide: an effect's on_pair_contact is called as on_pair_contact(particle&, self, other, dt)
#include <collide/bucket.cuh>
#include <collide/simulation.cuh>

struct mine {
  using writes = collide::columns<collide::velocity>;
  template <class Particle, class S>
  void on_pair_contact(Particle&, Particle&, S) const {}
};

int main() { collide::simulation<collide::detector<collide::bucket>, mine> simulation; }
