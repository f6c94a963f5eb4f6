// expect: collide: the first parameter of a detector is a broad phase
#include <collide/bucket.cuh>

struct broad {
  template <class S>
  struct index {};
};
collide::detector<broad> detector;
