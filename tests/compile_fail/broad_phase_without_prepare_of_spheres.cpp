// expect: collide: the index of a broad phase has a member prepare(space, options, spheres)
#include <collide/all_pairs.cuh>

struct broad : collide::all_pairs {
  template <class S>
  class index : public all_pairs::index<S> {
   public:
    template <class Space>
    void prepare(Space&, all_pairs const&, S) {}
  };
};
collide::detector<broad> detector;
