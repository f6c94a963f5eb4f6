// expect: collide: an execution space has a static constexpr bool host_accessible
#include <collide/all_pairs.cuh>

class space : public collide::host {
  using host::host_accessible;
};
collide::detector<collide::all_pairs, collide::karabassi<>, space> detector;
