// expect: collide: results are in memory of the space, which the host may be unable to read: use to_host()
#include <collide/bucket.cuh>
#include <collide/sinks/csr.hpp>

/// The host, but it says of its memory what the CUDA spaces say of theirs.
struct device : collide::host {
  using host::host;
  static constexpr bool host_accessible = false;
};

using detector = collide::detector<collide::bucket, collide::karabassi<>, device>;

void f(detector& detector, collide::sphere_view<float> spheres) {
  for (auto triangle : detector.query(spheres, collide::csr())) {
    if (triangle == 0) return;
  }
}
