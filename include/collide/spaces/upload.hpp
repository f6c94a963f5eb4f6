/// \file
/// Copies of meshes and spheres in the memory of a space.
#pragma once

#include <vector>

#include <collide/core/memory.hpp>
#include <collide/host.hpp>
#include <collide/mesh.hpp>
#include <collide/spaces/detail/check_memory.hpp>
#include <collide/spheres.hpp>

namespace collide {

namespace detail {

/// Copies points from host memory into memory of the space, packed. O(n); may wait.
template <class Space, class S>
point_view<S> upload_packed(Space const& space, point_view<S> const& from, buffer<S>& to) {
  S* const copy = to.reserve(space.resource(), 3 * from.size());
  if (from.packed()) {
    space.copy_from_host(copy, from.address(0), 3 * from.size());
  } else {
    std::vector<S> packed;
    packed.reserve(3 * from.size());
    for (std::size_t i = 0; i < from.size(); ++i) {
      vec3<S> const p = from[i];
      packed.insert(packed.end(), {p.x(), p.y(), p.z()});
    }
    space.copy_from_host(copy, packed.data(), packed.size());
  }
  return points<S>(copy, from.size());
}

}  // namespace detail

/// An owning, packed copy of a mesh in memory of a space, made by `upload`. It can be moved, which keeps its views
/// valid, but not copied. The resource of the space must outlive it.
template <class S>
class uploaded_mesh {
 public:
  /// Copies; see `upload`.
  template <class Space>
  uploaded_mesh(Space const& space, mesh_view<S> mesh) {
    detail::check_memory<host>(mesh, "upload: the mesh is", "upload copies from host memory");
    view_ =
        mesh_view<S>(detail::upload_packed(space, mesh.vertices(), vertices_), copy_indices(space, mesh), mesh.size());
  }

  /// The copy, valid as long as this object.
  mesh_view<S> view() const { return view_; }

 private:
  template <class Space>
  id const* copy_indices(Space const& space, mesh_view<S> const& mesh) {
    if (mesh.indices() == nullptr) return nullptr;
    id* const copy = corners_.reserve(space.resource(), 3 * mesh.size());
    if (mesh.packed_indices()) {
      space.copy_from_host(copy, mesh.indices(), 3 * mesh.size());
    } else {
      std::vector<id> packed;
      packed.reserve(3 * mesh.size());
      for (std::size_t i = 0; i < mesh.size(); ++i) {
        for (unsigned k = 0; k < 3; ++k) packed.push_back(static_cast<id>(mesh.corner(i, k)));
      }
      space.copy_from_host(copy, packed.data(), packed.size());
    }
    return copy;
  }

  buffer<S> vertices_;
  buffer<id> corners_;
  mesh_view<S> view_;
};

/// An owning, packed copy of spheres in memory of a space, made by `upload`. It can be moved, which keeps its views
/// valid, but not copied. The resource of the space must outlive it.
template <class S>
class uploaded_spheres {
 public:
  /// Copies; see `upload`.
  template <class Space>
  uploaded_spheres(Space const& space, sphere_view<S> spheres) {
    detail::check_memory<host>(spheres, "upload: the spheres are", "upload copies from host memory");
    point_view<S> const centres = detail::upload_packed(space, spheres.centres(), centres_);
    if (spheres.one_radius()) {
      view_ = spheres_at(centres, spheres.common_radius());
    } else {
      std::vector<S> radii(spheres.size());
      for (std::size_t i = 0; i < radii.size(); ++i) radii[i] = spheres.radius(i);
      S* const to = radii_.reserve(space.resource(), radii.size());
      space.copy_from_host(to, radii.data(), radii.size());
      view_ = spheres_at(centres, static_cast<S const*>(to));
    }
  }

  /// The copy, valid as long as this object.
  sphere_view<S> view() const { return view_; }

 private:
  buffer<S> centres_;
  buffer<S> radii_;
  sphere_view<S> view_;
};

/// Copies a mesh of any layout from host memory into memory of the space, packed.
///
/// \param space  where to: its resource gives the memory, its stream the order
/// \param mesh   in host memory, pageable or pinned; it may change as soon as this returns
/// \return the copy, which owns its memory: keep it as long as a detector is built from its `view()`
/// \throws error  if CUDA knows the mesh's memory as device memory
/// \throws cuda_error  if a CUDA call fails
/// \complexity O(vertices + triangles). Allocates. Waits for the copies.
template <class Space, class S>
uploaded_mesh<S> upload(Space const& space, mesh_view<S> mesh) {
  return uploaded_mesh<S>(space, mesh);
}

/// Copies spheres of any layout from host memory into memory of the space, as packed centres, and radii if they differ.
/// For displacements of spheres that move there is none: copy those yourself.
///
/// \param space    where to: its resource gives the memory, its stream the order
/// \param spheres  in host memory, pageable or pinned; it may change as soon as this returns
/// \return the copy, which owns its memory: keep it as long as its `view()` is used
/// \throws error  if CUDA knows the spheres' memory as device memory
/// \throws cuda_error  if a CUDA call fails
/// \complexity O(n). Allocates. Waits for the copies.
template <class Space, class S>
uploaded_spheres<S> upload(Space const& space, sphere_view<S> spheres) {
  return uploaded_spheres<S>(space, spheres);
}

}  // namespace collide
