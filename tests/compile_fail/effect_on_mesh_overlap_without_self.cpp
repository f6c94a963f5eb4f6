// expect: collide: an effect's on_mesh_overlap is called as on_mesh_overlap(particle&, self, mesh_overlap const&, dt)
#include <collide/bucket.cuh>
#include <collide/simulation.cuh>

struct pushes {
  using writes = collide::columns<collide::velocity>;
  template <class Particle, class S>
  COLLIDE_HD void on_mesh_overlap(Particle&, collide::mesh_overlap<S> const&, S) const {}
};

void run() {
  collide::simulation<collide::detector<collide::bucket>, pushes> scene;
  scene.step(0.001f);
}
