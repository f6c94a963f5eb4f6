// expect: collide: an execution space has a const member copy_from_host(to, from, n)
#include <collide/all_pairs.cuh>

class space : public collide::host {
  using host::copy_from_host;
};
collide::detector<collide::all_pairs, collide::karabassi<>, space> detector;
