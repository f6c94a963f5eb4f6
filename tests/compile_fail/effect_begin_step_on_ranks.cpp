// expect: collide: an effect's begin_step sees the places of one rank alone
#include <collide/bucket.cuh>
#include <collide/ranks/distributed_simulation.cuh>
#include <collide/ranks/thread_ranks.hpp>

struct clears {
  using writes = collide::columns<collide::velocity>;

  template <class Space, class State, class S>
  void begin_step(Space& space, State const& state, S) const {
    space.fill(state.at(collide::velocity{}), 0, 3 * state.size * sizeof(S));
  }
};

void use(collide::thread_ranks const& ranks) {
  collide::distributed<collide::simulation<collide::detector<collide::bucket>, clears>, collide::thread_ranks> parts(
      ranks);
}
