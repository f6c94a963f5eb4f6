// expect: collide: an effect's is_inactive is called as is_inactive(particle) const
#include <collide/bucket.cuh>
#include <collide/simulation.cuh>

struct mine {
  using writes = collide::columns<collide::velocity>;
  bool is_inactive() const { return false; }
};

int main() { collide::simulation<collide::detector<collide::bucket>, mine> simulation; }
