// expect: collide: the index of a broad phase has a member template query<NarrowPhase>(space, spheres, output)
#include <collide/all_pairs.cuh>

struct broad : collide::all_pairs {
  template <class S>
  class index : public all_pairs::index<S> {
    using all_pairs::index<S>::query;
  };
};
collide::detector<broad> detector;
