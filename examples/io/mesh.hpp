/// \file
/// A triangle mesh from a file: OBJ, STL, PLY, OFF, and glTF where the program is built with Assimp.
#pragma once

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <string_view>

#include <collide/core/error.hpp>
#include <collide/io/off.hpp>
#include <collide/io/ply.hpp>
#include <collide/io/stl.hpp>
#if defined(COLLIDE_HAS_ASSIMP)
#include <collide/io/assimp.hpp>
#endif

#include "error.hpp"
#include "obj.hpp"

namespace io {

/// The ending of a name, in lower case: ".stl", say.
inline std::string ending_of(std::string const& path) {
  std::string ending = path.substr(std::min(path.rfind('.'), path.size()));
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

/// Reads a file of glTF. Throws `error`.
inline collide::mesh_data<double> read_gltf(std::string const& path) {
#if defined(COLLIDE_HAS_ASSIMP)
  return collide::read_mesh<double>(path);
#else
  throw data_error(path, "this program was built without Assimp, which reads glTF");
#endif
}

/// Reads the mesh of the file `path`, which has this text. Throws `data_error`, which names the file.
template <class S>
mesh_data<S> read_mesh(std::string const& path, std::string_view text, bool strict) {
  std::string const ending = ending_of(path);
  bool const gltf = ending == ".gltf" || ending == ".glb";
  if (ending != ".stl" && ending != ".ply" && ending != ".off" && !gltf) return read_obj<S>(path, text, strict);
  if (strict) throw data_error(path, "--strict is for OBJ files");
  mesh_data<S> mesh;
  try {
    auto const read = ending == ".stl"   ? collide::read_stl<double>(path)
                      : ending == ".ply" ? collide::read_ply<double>(path)
                      : ending == ".off" ? collide::read_off<double>(path)
                                         : read_gltf(path);
    mesh.corners = read.corners;
    for (double const x : read.vertices) {
      mesh.vertices.push_back(static_cast<S>(x));
      if (!std::isfinite(mesh.vertices.back())) throw data_error(path, "a coordinate is beyond the range of float");
      mesh.tally.add(static_cast<double>(mesh.vertices.back()) == x, x, mesh.vertices.back());
    }
  } catch (collide::error const& e) {  // which names the file, too
    std::string const what = e.what(), named = path + ": ";
    throw data_error(path, one_line(what.substr(what.find(named) + named.size())));
  }
  if (gltf) mesh.remarks.push_back(path + ": coordinates are floats, as Assimp reads them");
  return mesh;
}

}  // namespace io
