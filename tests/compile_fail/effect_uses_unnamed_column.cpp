// expect: collide: an effect may use a column only if it names it in its reads or writes, or in its optional_writes
#include <collide/bucket.cuh>
#include <collide/simulation.cuh>

struct falls {
  template <class Particle, class S>
  COLLIDE_HD void accelerate(Particle& p, S dt) const {
    p[collide::velocity{}].z() -= dt;
  }
};

int main() {
  collide::simulation<collide::detector<collide::bucket>, falls> simulation;
  simulation.step(1);
}
