// expect: collide: results are in memory of the space, which the host may be unable to read: use to_host()
#include <collide/bucket.cuh>
#include <collide/karabassi_swept.hpp>
#include <collide/sinks/impacts.hpp>

/// The host, but it says of its memory what the CUDA spaces say of theirs.
struct device : collide::host {
  using host::host;
  static constexpr bool host_accessible = false;
};

using detector = collide::detector<collide::bucket, collide::karabassi_swept<>, device>;

void f(detector& detector, collide::moving_sphere_view<float> spheres) {
  for (auto const& impact : detector.query(spheres, collide::impacts<>())) {
    if (impact.time > 0) return;
  }
}
