// expect: collide: a source of emit_from is called as source(number, position&, velocity&) const
#include <collide/bucket.cuh>
#include <collide/effects/emit.hpp>
#include <collide/simulation.cuh>

struct spring_water {
  template <class V>
  void operator()(V& x, V& v) const {
    x = v;
  }
};

int main() {
  collide::simulation<collide::detector<collide::bucket>, collide::emit_from<spring_water>> simulation;
  simulation.step(1);
}
