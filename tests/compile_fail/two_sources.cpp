// expect: collide: a simulation has one source
#include <collide/bucket.cuh>
#include <collide/effects/emit.hpp>
#include <collide/simulation.cuh>

struct sprinkler {
  template <class S>
  COLLIDE_HD void operator()(std::uint64_t, collide::vec3<S>&, collide::vec3<S>&) const {}
};

collide::simulation<collide::detector<collide::bucket>, collide::emit, collide::emit_from<sprinkler>> two_sources;
