// expect: collide: an execution space has a static member name()
#include <collide/all_pairs.cuh>

class space : public collide::host {
  using host::name;
};
collide::detector<collide::all_pairs, collide::karabassi<>, space> detector;
