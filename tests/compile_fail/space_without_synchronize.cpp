// expect: collide: an execution space has a const member synchronize()
#include <collide/all_pairs.cuh>

class space : public collide::host {
  using host::synchronize;
};
collide::detector<collide::all_pairs, collide::karabassi<>, space> detector;
