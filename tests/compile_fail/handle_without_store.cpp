// expect: collide: what a sink passes to query has a const member reserve(n) and a const member store(slot, hit)
#include <collide/bucket.cuh>

struct handle {};
struct sink {
  template <class Space, class Query>
  void run(Space&, Query const& query) {
    query(handle{});
  }
};
void f(collide::detector<collide::bucket>& detector, collide::sphere_view<float> spheres) {
  detector.query(spheres, sink());
}
