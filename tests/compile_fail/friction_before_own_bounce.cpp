// expect: collide: an effect comes after those whose result it uses: name friction and adhesion after bounce
#include <collide/bucket.cuh>
#include <collide/effects/friction.hpp>
#include <collide/simulation.cuh>

struct own_bounce {
  using writes = collide::columns<collide::velocity>;
  static constexpr bool repels = true;

  template <class Particle, class S>
  COLLIDE_HD void on_mesh_contact(Particle& p, collide::mesh_contact<S>& t, S) const {
    p[collide::velocity{}] += t.normal * t.approach_speed;
  }
};

int main() { collide::simulation<collide::detector<collide::bucket>, collide::friction, own_bounce> simulation; }
