// expect: collide: an execution space has a const member fill(to, byte, bytes)
#include <collide/all_pairs.cuh>

class space : public collide::host {
  using host::fill;
};
collide::detector<collide::all_pairs, collide::karabassi<>, space> detector;
