// expect: collide: an execution space has a const member for_each(n, f)
#include <collide/all_pairs.cuh>

class space : public collide::host {
  using host::for_each;
};
collide::detector<collide::all_pairs, collide::karabassi<>, space> detector;
