// expect: collide: an effect's after_mesh_contact is called as after_mesh_contact(particle&, mesh_contact&, dt)
#include <collide/bucket.cuh>
#include <collide/simulation.cuh>

struct mine {
  using writes = collide::columns<collide::velocity>;
  template <class Particle, class S>
  void after_mesh_contact(Particle&, S) const {}
};

int main() { collide::simulation<collide::detector<collide::bucket>, mine> simulation; }
