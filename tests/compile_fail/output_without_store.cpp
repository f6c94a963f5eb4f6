// expect: collide: what a sink passes to query has a const member store(slot, hit)
#include <collide/all_pairs.cuh>

struct output {
  std::uint64_t allocate(std::uint64_t) const { return 0; }
};
struct sink {
  template <class Space, class Query>
  void run(Space&, Query const& query) {
    query(output{});
  }
};
void f(collide::detector<collide::all_pairs>& detector, collide::sphere_view<float> spheres) {
  detector.query(spheres, sink());
}
