// expect: collide: what reserve makes room in are sinks with a member reserve(space, spheres, pairs)
#include <collide/bucket.cuh>

struct sink {
  template <class Space, class Query>
  void run(Space&, Query const&) {}
};

void f(collide::detector<collide::bucket>& detector, sink& mine) { detector.reserve(1, 2, mine); }
