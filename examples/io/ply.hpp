/// \file
/// A picture of the hits as a PLY file, which ParaView, MeshLab and Blender open.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/core/contact.hpp>

#include "csv.hpp"
#include "obj.hpp"
#include "output.hpp"

namespace io {

/// Writes the mesh, grey where nothing touches it and red where something does, and every sphere that touches it as a
/// blue octahedron of its radius. `hits` is in canonical order; `radius` counts where `spheres` has no radii.
template <class S>
void write_ply(output_file& out, mesh_data<S> const& mesh, sphere_data<S> const& spheres, S radius,
               std::vector<collide::pair> const& hits) {
  using colour = std::array<unsigned char, 3>;
  constexpr colour untouched{190, 190, 190}, touched{214, 39, 40}, sphere{31, 119, 180};
  constexpr std::uint32_t octahedron[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                              {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  auto const vertex_count = mesh.vertices.size() / 3;
  std::vector<char> triangle_hit(mesh.size()), vertex_hit(vertex_count);
  std::vector<std::size_t> touching;
  for (auto const& hit : hits) {
    triangle_hit[hit.triangle] = 1;
    for (std::size_t k = 0; k < 3; ++k) vertex_hit[mesh.corners[3 * std::size_t{hit.triangle} + k]] = 1;
    if (touching.empty() || touching.back() != hit.sphere) touching.push_back(hit.sphere);
  }

  char const* const type = sizeof(S) == sizeof(float) ? "float" : "double";
  out << "ply\nformat binary_little_endian 1.0\ncomment written by collide\nelement vertex "
      << vertex_count + 6 * touching.size();
  for (char const* name : {"x", "y", "z"}) out << "\nproperty " << type << " " << name;
  for (char const* name : {"red", "green", "blue"}) out << "\nproperty uchar " << name;
  out << "\nelement face " << mesh.size() + 8 * touching.size() << "\nproperty list uchar int vertex_indices";
  for (char const* name : {"red", "green", "blue"}) out << "\nproperty uchar " << name;
  out << "\nend_header\n";

  auto const vertex = [&](S x, S y, S z, colour const& c) {
    for (S const coordinate : {x, y, z}) out.raw(coordinate);
    for (auto const part : c) out.raw(part);
  };
  auto const face = [&](std::size_t a, std::size_t b, std::size_t c, colour const& paint) {
    out.raw(std::uint8_t{3});
    for (auto const corner : {a, b, c}) out.raw(static_cast<std::int32_t>(corner));
    for (auto const part : paint) out.raw(part);
  };
  for (std::size_t i = 0; i < vertex_count; ++i) {
    auto const* const p = &mesh.vertices[3 * i];
    vertex(p[0], p[1], p[2], vertex_hit[i] != 0 ? touched : untouched);
  }
  for (auto const i : touching) {
    S const r = spheres.radii.empty() ? radius : spheres.radii[i];
    S const x = spheres.xyz[3 * i], y = spheres.xyz[3 * i + 1], z = spheres.xyz[3 * i + 2];
    vertex(x + r, y, z, sphere);
    vertex(x - r, y, z, sphere);
    vertex(x, y + r, z, sphere);
    vertex(x, y - r, z, sphere);
    vertex(x, y, z + r, sphere);
    vertex(x, y, z - r, sphere);
  }
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    auto const* const c = &mesh.corners[3 * t];
    face(c[0], c[1], c[2], triangle_hit[t] != 0 ? touched : untouched);
  }
  for (std::size_t i = 0; i < touching.size(); ++i) {
    auto const first = vertex_count + 6 * i;
    for (auto const& f : octahedron) face(first + f[0], first + f[1], first + f[2], sphere);
  }
}

}  // namespace io
