/// \file
/// A triangle mesh from a file: OBJ, or what Assimp reads where the program is built with it.
#pragma once

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

#include <collide/error.hpp>
#if defined(COLLIDE_HAS_ASSIMP)
#include <collide/io/assimp.hpp>
#endif

#include "error.hpp"
#include "obj.hpp"

namespace io {

/// True for names of files that are Assimp's: all others are taken for OBJ.
inline bool is_for_assimp(std::string const& path) {
  std::string ending = path.substr(std::min(path.rfind('.'), path.size()));
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  static constexpr std::string_view known[] = {".stl", ".ply", ".off", ".gltf", ".glb"};
  return std::find(std::begin(known), std::end(known), ending) != std::end(known);
}

/// Reads the mesh of the file `path`, which has this text. Throws `data_error`, which names the file.
template <class S>
mesh_data<S> read_mesh(std::string const& path, std::string_view text, bool strict) {
  if (!is_for_assimp(path)) return read_obj<S>(path, text, strict);
#if defined(COLLIDE_HAS_ASSIMP)
  if (strict) throw data_error(path, "--strict is for OBJ files");
  mesh_data<S> mesh;
  try {
    auto read = collide::read_mesh<S>(path);
    mesh.vertices = std::move(read.vertices);
    mesh.corners = std::move(read.corners);
  } catch (collide::error const& e) {
    std::string_view const what = e.what(), prefix = "collide: read_mesh: ";
    throw data_error(path, one_line(what.substr(std::min(what.size(), prefix.size() + path.size() + 2))));
  }
  mesh.tally.numbers = mesh.vertices.size();
  mesh.remarks.push_back(path + ": coordinates are floats, as Assimp reads them");
  return mesh;
#else
  throw data_error(path, "this program reads OBJ files only: it was built without Assimp");
#endif
}

}  // namespace io
