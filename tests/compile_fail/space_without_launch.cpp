// expect: collide: an execution space has a const member launch(blocks, kernel)
#include <collide/all_pairs.cuh>

class space : public collide::host {
  using host::launch;
};
collide::detector<collide::all_pairs, collide::karabassi<>, space> detector;
