// expect: collide: an execution space has a member template block<Kernel>
#include <collide/all_pairs.cuh>

class space : public collide::host {
  using host::block;
};
collide::detector<collide::all_pairs, collide::karabassi<>, space> detector;
