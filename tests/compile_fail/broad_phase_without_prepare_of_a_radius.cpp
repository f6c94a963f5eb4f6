// expect: collide: the index of a broad phase has a member prepare(space, options, radius)
#include <collide/all_pairs.cuh>

struct broad : collide::all_pairs {
  template <class S>
  class index : public all_pairs::index<S> {
   public:
    template <class Space>
    void prepare(Space&, all_pairs const&, collide::sphere_view<S> const&) {}
  };
};
collide::detector<broad> detector;
