// expect: collide: effects that touch the mesh need a broad phase whose index has a member lookup(), such as bucket or
// all_pairs
#include <collide/bounce.hpp>
#include <collide/bucket.cuh>
#include <collide/simulation.cuh>

struct blind {
  template <class S>
  struct index {
    template <class Space>
    void build(Space&, blind const&, collide::mesh_view<S>) {}
    template <class Space, class Spheres>
    void prepare(Space&, blind const&, Spheres const&) {}
  };
};

int main() { collide::simulation<collide::detector<blind>, collide::bounce> simulation; }
