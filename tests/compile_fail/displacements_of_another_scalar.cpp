// expect: collide: centres, radii and displacements of spheres have one scalar type, that of the detector
#include <collide/core/moving_spheres.hpp>

auto make(collide::sphere_view<double> spheres, float const* displacements) {
  return collide::with_displacements(spheres, displacements);
}
