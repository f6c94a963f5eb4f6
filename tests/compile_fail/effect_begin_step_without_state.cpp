// expect: collide: an effect's begin_step is called as begin_step(space&, state, dt)
#include <collide/bucket.cuh>
#include <collide/simulation.cuh>

struct mine {
  using writes = collide::columns<collide::velocity>;
  template <class Space>
  void begin_step(Space&) const {}
};

int main() { collide::simulation<collide::detector<collide::bucket>, mine> simulation; }
