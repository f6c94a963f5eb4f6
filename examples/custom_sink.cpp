/// \file
/// A sink of one's own: it counts for each triangle how many spheres touch it, and stores no pairs.

#include <cstdio>
#include <utility>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/spaces/atomic_add.hpp>

/// The part of the sink that goes into the query: it is copied to where the query runs, and called there from many
/// threads at once.
struct count_for_triangle {
  unsigned* counts;

  /// Called for each batch of n hits, for sinks that store them one after another. This one does not.
  COLLIDE_HD std::uint64_t allocate(std::uint64_t) const { return 0; }

  /// Called for each hit.
  template <class Hit>
  COLLIDE_HD void store(std::uint64_t, Hit const& hit) const {
    collide::atomic_add(&counts[hit.triangle], 1);
  }
};

/// The sink: takes memory from the space, runs the query, and brings the result home. The same code serves all spaces.
class touches {
 public:
  std::vector<unsigned> const& counts() const { return counts_; }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    std::size_t const n = query.mesh.size();
    unsigned* const counts = buffer_.reserve(space.resource(), n);
    space.fill(counts, 0, n * sizeof(unsigned));
    query(count_for_triangle{counts});
    counts_.resize(n);
    space.copy_to_host(counts_.data(), counts, n);
  }

 private:
  collide::buffer<unsigned> buffer_;
  std::vector<unsigned> counts_;
};

int main() {
  float const vertices[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  unsigned const corners[] = {0, 1, 2, 0, 2, 3};
  float const centres[] = {0.9f, 0.1f, 0, 0.1f, 0.9f, 0, 0.5f, 0.5f, 0, 0.8f, 0.3f, 0, 5, 5, 5};
  collide::detector<collide::bucket> detector;
  touches const sink = detector.detect(collide::indexed_mesh(vertices, 4, corners, 2),
                                       collide::spheres_xyz(centres, 5, 0.2f), touches());
  for (unsigned const n : sink.counts()) std::printf("%u\n", n);
}
