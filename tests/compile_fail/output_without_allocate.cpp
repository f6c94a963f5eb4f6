// expect: collide: what a sink passes to query has a const member allocate(n) that returns the number of a slot
#include <collide/all_pairs.cuh>

struct output {
  template <class Hit>
  void store(std::uint64_t, Hit const&) const {}
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
