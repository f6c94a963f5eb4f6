/// Meshes from OBJ files, by tinyobjloader.
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#define TINYOBJLOADER_IMPLEMENTATION
#include <doctest/doctest.h>

#include <collide/io/obj.hpp>

#include "io/written.hpp"

namespace {

using tests::written;

collide::mesh_data<float> read(std::string const& text) { return collide::read_obj<float>(written(text, ".obj").path); }

std::string const square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

/// Twice the area of all triangles, with the sign of z.
double area(collide::mesh_data<float> const& m) {
  double sum = 0;
  for (std::size_t i = 0; i < m.size(); ++i) {
    auto const at = [&](std::size_t k, std::size_t c) { return double(m.vertices[3 * m.corners[3 * i + k] + c]); };
    double const one = (at(1, 0) - at(0, 0)) * (at(2, 1) - at(0, 1)) - (at(1, 1) - at(0, 1)) * (at(2, 0) - at(0, 0));
    CHECK(one >= 0);
    sum += one;
  }
  return sum;
}

TEST_CASE("read_obj: triangles in the order of the file, over objects and groups") {
  auto const mesh = read(square + "o a\nf 1 2 3\ng b\nusemtl c\nf 1/1 3/2 4/3\no c\nf -4 -3 -1\n");
  CHECK(mesh.corners == std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 0, 1, 3});
  CHECK(mesh.vertices == std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  CHECK(mesh.view().size() == 3);
}

TEST_CASE("read_obj: polygons become n - 2 triangles that cover them") {
  CHECK(area(read(square + "f 1 2 3 4\n")) == 2);
  // an arrow: only from two of its corners all of it is seen
  auto const arrow = read("v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 1 2 3 4\nf 2 3 4 1\nf 3 4 1 2\nf 4 1 2 3\n");
  CHECK(arrow.size() == 8);
  CHECK(area(arrow) == 4 * 8);
  auto const hexagon = read("v 0 0 0\nv 2 0 0\nv 3 1 0\nv 2 2 0\nv 0 2 0\nv -1 1 0\nf 1 2 3 4 5 6\n");
  CHECK(hexagon.size() == 4);
  CHECK(area(hexagon) == 12);
  CHECK(read("v 1 1 1\nv 2 2 2\nv 3 3 3\nv 4 4 4\nf 1 2 3 4\n").size() == 2);
}

TEST_CASE("read_obj: what is no mesh is refused, and named") {
  using collide::error;
  CHECK_THROWS_AS(collide::read_obj("/no/such/file.obj"), error);
  CHECK_THROWS_AS(read(square), error);
  CHECK_THROWS_AS(read(square + "f 1 2 9\n"), error);
  CHECK_THROWS_AS(read("v 0 0 0\nv 1 0 0\nv 1e60 0 0\nf 1 2 3\n"), error);
  // a comb, which no corner sees all of
  CHECK_THROWS_AS(read("v 0 0 0\nv 5 0 0\nv 5 4 0\nv 4 1 0\nv 3 4 0\nv 2 1 0\nv 1 4 0\nv 0.5 1 0\nv 0 4 0\n"
                       "f 1 2 3 4 5 6 7 8 9\n"),
                  error);
  std::string round = "f";
  std::string corners;
  for (int i = 1; i <= 300; ++i) corners += "v 0 0 0\n", round += " " + std::to_string(i);
  CHECK_THROWS_AS(read(corners + round + "\nf 1 2 3\n"), error);
}

}  // namespace
