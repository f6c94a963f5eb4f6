/// A scene of the programs, as the tests have them.
#pragma once

#include <io/scenes/scene.hpp>

#include "scenes.hpp"

namespace tests {

/// The scene in coordinates of type `S`.
template <class S>
scene<S> rounded(io::scene const& from) {
  scene<S> to;
  to.mesh.vertices.assign(from.vertices.begin(), from.vertices.end());
  to.mesh.corners = from.corners;
  to.spheres.centres.assign(from.centres.begin(), from.centres.end());
  to.spheres.radii.assign(from.radii.begin(), from.radii.end());
  if (from.radii.empty()) to.spheres.radii.assign(from.sphere_count(), static_cast<S>(from.radius));
  return to;
}

/// The spheres that touch something, and as many others.
template <class S>
scene<S> touching(scene<S> const& all, oracle::expectation const& expected) {
  std::vector<bool> touches(all.spheres.size() + 1);
  for (auto p : expected.exact) touches[p.sphere] = touches[p.sphere ^ 1] = true;
  scene<S> some{all.mesh, {}};
  for (std::size_t i = 0; i < all.spheres.size(); ++i)
    if (touches[i]) some.spheres.add(all.spheres[i].centre, all.spheres[i].radius);
  return some;
}

}  // namespace tests
