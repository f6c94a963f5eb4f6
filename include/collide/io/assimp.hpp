/// \file
/// A mesh from a file of any format that Assimp reads: STL, PLY, OFF, glTF, OBJ and others (Debian: libassimp-dev).
/// Programs link assimp.
#pragma once

#include <string>
#include <utility>

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <collide/io/mesh_data.hpp>

namespace collide {

/// Reads the triangles of a file, in its order, placed as its scene has them. Polygons are cut into triangles, equal
/// vertices become one, lines and points are left out. Assimp's coordinates are floats. O(size of the file).
///
/// \throws error  names the file: if it cannot be read, has no triangle, or a coordinate that is not finite
template <class S = float>
mesh_data<S> read_mesh(std::string const& path) {
  std::string const what = "collide: read_mesh: " + path;
  Assimp::Importer importer;
  // of a vertex only its place counts
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                                          aiComponent_COLORS | aiComponent_TEXCOORDS |
                                                          aiComponent_BONEWEIGHTS | aiComponent_MATERIALS);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  aiScene const* const scene =
      importer.ReadFile(path, aiProcess_RemoveComponent | aiProcess_Triangulate | aiProcess_SortByPType |
                                  aiProcess_PreTransformVertices | aiProcess_JoinIdenticalVertices);
  if (scene == nullptr) throw error(what + ": " + importer.GetErrorString());
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
  return detail::checked_mesh(std::move(mesh), what);
}

}  // namespace collide
