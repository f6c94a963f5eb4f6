// expect: collide: an effect's check_parameters is called as check_parameters() const
#include <collide/bucket.cuh>
#include <collide/simulation.cuh>

struct mine {
  using writes = collide::columns<collide::velocity>;
  bool check_parameters(int least) const { return least > 0; }
};

int main() { collide::simulation<collide::detector<collide::bucket>, mine> simulation; }
