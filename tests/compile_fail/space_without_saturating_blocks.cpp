// expect: collide: an execution space has a const member saturating_blocks()
#include <collide/all_pairs.cuh>

class space : public collide::host {
  using host::saturating_blocks;
};
collide::detector<collide::all_pairs, collide::karabassi<>, space> detector;
