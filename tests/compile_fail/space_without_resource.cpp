// expect: collide: an execution space has a const member resource()
#include <collide/all_pairs.cuh>

class space : public collide::host {
  using host::resource;
};
collide::detector<collide::all_pairs, collide::karabassi<>, space> detector;
