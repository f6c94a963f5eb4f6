/// Meshes from files, by Assimp.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <collide/io/assimp.hpp>

#include "io/written.hpp"

using tests::written;

namespace {

/// 36 indices of two bytes, and eight vertices, in base64.
std::string const data =
    "AAABAAMAAAADAAIABAAGAAcABAAHAAUAAAAEAAUAAAAFAAEAAgADAAcAAgAHAAYAAAACAAYAAAAGAAQAAQAFAAcAAQAHAAMAAAAA"
    "AAAAAAAAAAAAAAAAAAAAAAAAAIA/AAAAAAAAgD8AAAAAAAAAAAAAgD8AAIA/AACAPwAAAAAAAAAAAACAPwAAAAAAAIA/AACAPwAA"
    "gD8AAAAAAACAPwAAgD8AAIA/";

TEST_CASE("read_mesh: a tetrahedron in each format is the same") {
  std::string const off = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  std::string const ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  std::string const obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  std::vector<float> const corners[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  int const faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  std::string stl(84, '\0');
  stl[80] = 4;
  std::vector<float> soup;
  for (auto const& face : faces) {
    stl.append(12, '\0');
    for (int const v : face) {
      stl.append(reinterpret_cast<char const*>(corners[v].data()), 12);
      soup.insert(soup.end(), corners[v].begin(), corners[v].end());
    }
    stl.append(2, '\0');
  }
  for (auto const& [text, ending] : {std::pair{off, ".off"}, {ply, ".ply"}, {obj, ".obj"}, {stl, ".stl"}}) {
    CAPTURE(ending);
    auto const mesh = collide::read_mesh<double>(written(text, ending).path);
    CHECK(mesh.size() == 4);
    CHECK(mesh.vertices.size() == 12);  // each vertex is there once
    std::vector<float> found;
    for (auto const c : mesh.corners) {
      for (std::size_t k = 0; k < 3; ++k) found.push_back(float(mesh.vertices[3 * c + k]));
    }
    CHECK(found == soup);
  }
}

/// A cube of glTF: its buffer has 36 indices and 8 vertices, of which the nodes place a copy each.
std::string gltf(std::string const& nodes,
                 std::string const& accessor = R"({"bufferView":0,"componentType":5123,"count":36,"type":"SCALAR"})",
                 std::string const& part = R"("indices":0)", std::string const& base64 = data) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" + nodes +
         R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":1},)" + part +
         R"(}]}],"buffers":[{"byteLength":168,"uri":"data:application/octet-stream;base64,)" + base64 +
         R"("}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":72},{"buffer":0,"byteOffset":72,"byteLength":96}],"accessors":[)" +
         accessor + R"(,{"bufferView":1,"componentType":5126,"count":8,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}]})";
}

std::string refused(std::string const& text, std::string const& ending) {
  try {
    collide::read_mesh(written(text, ending).path);
    return "read";
  } catch (collide::error const& e) {
    std::string const what = e.what();
    CHECK(what.find("collide-test-mesh-") != std::string::npos);
    return what.substr(what.rfind(": ") + 2);
  }
}

TEST_CASE("read_mesh: glTF is read with all of its triangles, or refused") {
  CHECK(collide::read_mesh(written(gltf(R"({"mesh":0})"), ".gltf").path).size() == 12);
  auto const two =
      collide::read_mesh(written(gltf(R"({"children":[1,2]},{"mesh":0,"scale":[2,2,2]},{"mesh":0})"), ".gltf").path);
  CHECK(two.size() == 24);
  CHECK(*std::max_element(two.vertices.begin(), two.vertices.end()) == 2);
  std::string const node = R"({"mesh":0})",
                    nine = R"({"bufferView":0,"componentType":5123,"count":37,"type":"SCALAR"})";
  CHECK(refused(gltf(node, nine), ".gltf") == "an accessor is longer than its bufferView");
  CHECK(refused(gltf(node, R"({"bufferView":0,"componentType":5123,"count":35,"type":"SCALAR"})"), ".gltf") ==
        "corners that are no triangles");
  CHECK(refused(gltf(R"({"children":[0],"mesh":0})"), ".gltf") == "its nodes are no tree");
  CHECK(refused(gltf(node, R"({"bufferView":0,"componentType":5123,"count":36,"type":"SCALAR"})", R"("indices":0)",
                     data.substr(4)),
                ".gltf") == "a buffer is shorter than its byteLength");
  std::string far = data;  // vertex 0x4000 of 8
  far.replace(0, 4, "AEAA");
  CHECK(
      refused(gltf(node, R"({"bufferView":0,"componentType":5123,"count":36,"type":"SCALAR"})", R"("indices":0)", far),
              ".gltf") == "12 triangles, of which Assimp reads 11");
  auto const whole = gltf(node);
  CHECK(refused(whole.substr(0, whole.size() - 1), ".gltf") == "its JSON is not complete");
  CHECK(refused(std::string(R"({"asset":)") + std::string(100000, '[') + std::string(100000, ']') + "}", ".gltf") ==
        "its JSON is too deep");
}

TEST_CASE("read_mesh: vertices are one only if they are equal") {
  // one unit in the last place apart, and 0 beside -0
  std::string const off = "OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n1.00000012 0 0\n0 1 0\n-0 0 0\n3 0 1 2\n3 5 3 4\n";
  auto const mesh = collide::read_mesh<float>(written(off, ".off").path);
  CHECK(mesh.corners == std::vector<std::uint32_t>{0, 1, 2, 0, 3, 2});
  CHECK(mesh.vertices.size() == 12);
}

TEST_CASE("read_mesh: a file that is no mesh is refused, and named") {
  CHECK_THROWS_AS(collide::read_mesh("/no/such/file.stl"), collide::error);
  CHECK_THROWS_AS(collide::read_mesh(written("nonsense", ".off").path), collide::error);
}

}  // namespace
