// expect: collide: the index of a broad phase has a member build(space, options, mesh)
#include <collide/all_pairs.cuh>

struct broad : collide::all_pairs {
  template <class S>
  class index : public all_pairs::index<S> {
    using all_pairs::index<S>::build;
  };
};
collide::detector<broad> detector;
