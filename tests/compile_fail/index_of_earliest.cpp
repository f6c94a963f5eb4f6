// expect: collide: results are in memory of the space, which the host may be unable to read: use to_host()
#include <collide/bucket.cuh>
#include <collide/karabassi_swept.hpp>
#include <collide/sinks/earliest.hpp>

/// The host, but it says of its memory what the CUDA spaces say of theirs.
struct device : collide::host {
  using host::host;
  static constexpr bool host_accessible = false;
};

using detector = collide::detector<collide::bucket, collide::karabassi_swept<>, device>;

void f(detector& detector, collide::moving_sphere_view<float> spheres) {
  auto const found = detector.query(spheres, collide::earliest<>());
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].time > 0) return;
  }
}
