// expect: collide: effects that touch the mesh need a broad phase whose index has a member mesh_lookup(), such as
// bucket or all_pairs
#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/simulation.cuh>

struct blind : collide::bucket {
  template <class S>
  class index : public bucket::index<S> {
    using bucket::index<S>::mesh_lookup;
  };
};

int main() { collide::simulation<collide::detector<blind>, collide::bounce> simulation; }
