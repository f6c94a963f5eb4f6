/// Meshes from files, by Assimp.
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <collide/io/assimp.hpp>

#include "io/written.hpp"

using tests::written;

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

TEST_CASE("read_mesh: a file that is no mesh is refused, and named") {
  CHECK_THROWS_AS(collide::read_mesh("/no/such/file.stl"), collide::error);
  CHECK_THROWS_AS(collide::read_mesh(written("nonsense", ".off").path), collide::error);
}
