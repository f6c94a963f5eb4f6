// expect: collide: the index of a broad phase has a const member cell_width(space)
#include <collide/all_pairs.cuh>

struct broad : collide::all_pairs {
  template <class S>
  class index : public all_pairs::index<S> {
    using all_pairs::index<S>::cell_width;
  };
};
collide::detector<broad> detector;
