/// \file
/// A scene in coordinates of a type, as the library takes it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/mesh.hpp>
#include <collide/spheres.hpp>

#include "io/scenes/scene.hpp"

namespace bench {

/// A scene in coordinates of type `S`, in host memory.
template <class S>
struct scene {
  std::vector<S> vertices;
  std::vector<std::uint32_t> corners;
  std::vector<S> centres, radii;

  explicit scene(io::scene const& from)
      : vertices(from.vertices.begin(), from.vertices.end()),
        corners(from.corners),
        centres(from.centres.begin(), from.centres.end()),
        radii(from.radii.begin(), from.radii.end()),
        radius_{static_cast<S>(from.radius)} {}

  collide::mesh_view<S> mesh() const {
    return collide::indexed_mesh(vertices.data(), vertices.size() / 3, corners.data(), corners.size() / 3);
  }
  collide::sphere_view<S> spheres() const {
    std::size_t const n = centres.size() / 3;
    return radii.empty() ? collide::spheres_xyz(centres.data(), n, radius_)
                         : collide::spheres_xyz(centres.data(), n, radii.data());
  }
  S largest_radius() const { return radii.empty() ? radius_ : *std::max_element(radii.begin(), radii.end()); }

 private:
  S radius_;
};

}  // namespace bench
