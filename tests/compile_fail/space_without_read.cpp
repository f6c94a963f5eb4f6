// expect: collide: an execution space has a const member read(from)
#include <collide/all_pairs.cuh>

class space : public collide::host {
  using host::read;
};
collide::detector<collide::all_pairs, collide::karabassi<>, space> detector;
