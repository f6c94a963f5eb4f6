/// \file
/// Copies of meshes and spheres in the memory of a space.
#pragma once

#include <vector>

#include <collide/detail/execution/check_memory.hpp>
#include <collide/host.hpp>
#include <collide/memory.hpp>
#include <collide/mesh.hpp>
#include <collide/spheres.hpp>

namespace collide {

/// An owning copy of a mesh in memory of a space, made by `upload`.
template <class S>
class uploaded_mesh {
 public:
  template <class Space>
  uploaded_mesh(Space const& space, mesh_view<S> mesh) {
    detail::check_memory<host>(mesh, "upload: the mesh is", "upload copies from host memory");
    std::size_t const coordinates = 3 * mesh.vertex_count();
    space.copy_from_host(vertices_.reserve(space.resource(), coordinates), mesh.vertices(), coordinates);
    id const* corners = nullptr;
    if (mesh.indices() != nullptr) {
      id* const to = corners_.reserve(space.resource(), 3 * mesh.size());
      space.copy_from_host(to, mesh.indices(), 3 * mesh.size());
      corners = to;
    }
    view_ = mesh_view<S>(vertices_.data(), mesh.vertex_count(), corners, mesh.size());
  }

  /// The copy, valid as long as this object.
  mesh_view<S> view() const { return view_; }

 private:
  buffer<S> vertices_;
  buffer<id> corners_;
  mesh_view<S> view_;
};

/// An owning, packed copy of spheres in memory of a space, made by `upload`.
template <class S>
class uploaded_spheres {
 public:
  template <class Space>
  uploaded_spheres(Space const& space, sphere_view<S> spheres) {
    detail::check_memory<host>(spheres, "upload: the spheres are", "upload copies from host memory");
    std::size_t const n = spheres.size();
    std::vector<S> packed(3 * n), radii(spheres.one_radius() ? 0 : n);
    for (std::size_t i = 0; i < n; ++i) {
      vec3<S> const c = spheres.centre(i);
      for (std::size_t k = 0; k < 3; ++k) packed[3 * i + k] = c[static_cast<int>(k)];
      if (!radii.empty()) radii[i] = spheres.radius(i);
    }
    S* const centres = centres_.reserve(space.resource(), packed.size());
    space.copy_from_host(centres, packed.data(), packed.size());
    if (spheres.one_radius()) {
      view_ = spheres_xyz(centres, n, spheres.common_radius());
    } else {
      S* const to = radii_.reserve(space.resource(), n);
      space.copy_from_host(to, radii.data(), n);
      view_ = spheres_xyz(centres, n, static_cast<S const*>(to));
    }
  }

  /// The copy, valid as long as this object.
  sphere_view<S> view() const { return view_; }

 private:
  buffer<S> centres_;
  buffer<S> radii_;
  sphere_view<S> view_;
};

/// Copies a mesh from host memory into memory of the space. O(vertices + triangles); may wait. Throws `error` if CUDA
/// knows the mesh's memory as device memory.
template <class Space, class S>
uploaded_mesh<S> upload(Space const& space, mesh_view<S> mesh) {
  return uploaded_mesh<S>(space, mesh);
}

/// Copies spheres of any layout from host memory into memory of the space, as packed centres. O(n); may wait. Throws
/// `error` if CUDA knows the spheres' memory as device memory.
template <class Space, class S>
uploaded_spheres<S> upload(Space const& space, sphere_view<S> spheres) {
  return uploaded_spheres<S>(space, spheres);
}

}  // namespace collide
