// expect: collide: an execution space has a const member template max_resident_blocks<Kernel>()
#include <collide/all_pairs.cuh>

class space : public collide::host {
  using host::max_resident_blocks;
};
collide::detector<collide::all_pairs, collide::karabassi<>, space> detector;
