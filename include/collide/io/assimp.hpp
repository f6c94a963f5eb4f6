/// \file
/// A mesh from a file of any format that Assimp reads: glTF and others (Debian: libassimp-dev). STL, PLY, OFF and OBJ
/// are not left to Assimp. Programs link assimp; to read glTF they need nlohmann/json.hpp, too (Debian:
/// nlohmann-json3-dev).
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <collide/io/detail/text.hpp>
#include <collide/io/mesh_data.hpp>
#include <collide/io/obj.hpp>
#include <collide/io/off.hpp>
#include <collide/io/ply.hpp>
#include <collide/io/stl.hpp>
#if __has_include(<nlohmann/json.hpp>)
#include <collide/io/detail/gltf.hpp>
#endif

namespace collide {
namespace detail {

/// How many triangles the polygons of a scene are, as its nodes place them. Throws if a corner is no vertex, which
/// Assimp does not look at.
inline std::size_t triangles_of_scene(aiScene const& scene, std::string const& what) {
  std::size_t n = 0;
  std::vector<aiNode const*> nodes{scene.mRootNode};
  while (!nodes.empty()) {
    aiNode const& node = *nodes.back();
    nodes.pop_back();
    nodes.insert(nodes.end(), node.mChildren, node.mChildren + node.mNumChildren);
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      aiMesh const& part = *scene.mMeshes[node.mMeshes[m]];
      for (unsigned i = 0; i < part.mNumFaces; ++i) {
        aiFace const& face = part.mFaces[i];
        for (unsigned k = 0; k < face.mNumIndices; ++k) {
          if (face.mIndices[k] >= part.mNumVertices) throw error(what + ": a corner of a face is no vertex");
        }
        n += std::max(face.mNumIndices, 2U) - 2;
      }
    }
  }
  return n;
}

/// Reads by Assimp. `expected` triangles, if not 0, must be found.
template <class S>
mesh_data<S> read_with_assimp(std::string const& path, std::string const& what, std::size_t expected) {
  Assimp::Importer importer;
  // of a vertex only its place counts
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                                          aiComponent_COLORS | aiComponent_TEXCOORDS |
                                                          aiComponent_BONEWEIGHTS | aiComponent_MATERIALS);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  auto const message = [&] {
    std::string text = importer.GetErrorString();
    for (char& c : text) c = c >= ' ' && c <= '~' ? c : ' ';
    return what + ": " + text;
  };
  aiScene const* scene = importer.ReadFile(path, 0);
  if (scene == nullptr) throw error(message());
  std::size_t const polygons = triangles_of_scene(*scene, what);
  if (expected != 0 && polygons != expected)
    throw error(what + ": " + std::to_string(expected) + " triangles, of which Assimp reads " +
                std::to_string(polygons));
  scene = importer.ApplyPostProcessing(aiProcess_RemoveComponent | aiProcess_Triangulate | aiProcess_SortByPType |
                                       aiProcess_PreTransformVertices);
  if (scene == nullptr) throw error(message());
  mesh_data<S> mesh;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    aiMesh const& part = *scene->mMeshes[m];
    auto const first = static_cast<std::uint32_t>(mesh.vertices.size() / 3);
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      aiVector3D const& v = part.mVertices[i];
      for (ai_real const x : {v.x, v.y, v.z}) mesh.vertices.push_back(static_cast<S>(x));
    }
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      aiFace const& face = part.mFaces[i];
      for (unsigned k = 0; k < 3 && face.mNumIndices == 3; ++k) mesh.corners.push_back(first + face.mIndices[k]);
    }
  }
  if (mesh.size() != polygons)
    throw error(what + ": its polygons are " + std::to_string(polygons) + " triangles, of which Assimp makes " +
                std::to_string(mesh.size()) + ": triangulate the mesh");
  return checked_mesh(std::move(mesh), what);
}

}  // namespace detail

/// Reads the triangles of a file, in its order, placed as its scene has them. STL, PLY, OFF and OBJ, by the ending of
/// the name, are read by `read_stl`, `read_ply`, `read_off` and `read_obj`; everything else by Assimp, whose
/// coordinates are floats. Polygons are cut into triangles, equal vertices become one, lines and points are left out.
/// O(n log n).
///
/// \throws error  names the file: if it cannot be read, has no triangle, or a coordinate that is not finite; and where
///                the other readers throw, or Assimp finds fewer triangles than a file has
template <class S = float>
mesh_data<S> read_mesh(std::string const& path) {
  if (detail::has_ending(path, ".stl")) return read_stl<S>(path);
  if (detail::has_ending(path, ".ply")) return detail::welded(read_ply<S>(path));
  if (detail::has_ending(path, ".off")) return detail::welded(read_off<S>(path));
  if (detail::has_ending(path, ".obj")) return detail::welded(read_obj<S>(path));
  std::string const what = "collide: read_mesh: " + path;
  std::size_t expected = 0;
  if (detail::has_ending(path, ".gltf") || detail::has_ending(path, ".glb")) {
#if __has_include(<nlohmann/json.hpp>)
    expected = detail::gltf_file(path, what).triangles();
    if (expected == 0) throw error(what + ": there are no triangles");
#else
    throw error(what + ": this program was compiled without nlohmann/json.hpp, which glTF needs");
#endif
  }
  return detail::welded(detail::read_with_assimp<S>(path, what, expected));
}

}  // namespace collide
