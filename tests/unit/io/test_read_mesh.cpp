/// Meshes from OBJ, OFF, PLY and STL files.
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <collide/io/obj.hpp>
#include <collide/io/off.hpp>
#include <collide/io/ply.hpp>
#include <collide/io/stl.hpp>

#include "io/written.hpp"

namespace {

using tests::written;

collide::mesh_data<float> read(std::string const& text) { return collide::read_obj<float>(written(text, ".obj").path); }

/// The reason for which a reader refuses a file, behind the file's name; "read" if it reads it.
template <class Read>
std::string why(Read const& read_file, std::string const& reader) {
  try {
    read_file();
    return "read";
  } catch (collide::error const& e) {
    std::string const what = e.what();
    CHECK(what.compare(0, 9 + reader.size(), "collide: " + reader) == 0);
    CHECK(what.find('\n') == std::string::npos);
    auto const name = what.find("collide-test-mesh-");
    REQUIRE(name != std::string::npos);
    return what.substr(std::min(what.find(": ", name), what.size() - 2) + 2);
  }
}

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
}

TEST_CASE("read_obj: a line that is not OBJ is refused, and named") {
  auto const refused = [](std::string const& lines) { return why([&] { read(square + lines); }, "read_obj"); };
  CHECK(refused("f 1 2 3\nff 1 3 4\n") == "line 6: OBJ has no keyword 'ff'");
  CHECK(refused("f 1 2 3\nf 1 3\n") == "line 6: a face of fewer than three corners");
  CHECK(refused("f 1 2 3\nf 1 3-4\n") == "line 6: '3-4' is not a number that is expected here");
  CHECK(refused("f 1 2 3\nf 1 3 5\n") == "line 6: vertex 5 does not exist: there are 4");
  CHECK(refused("f 1 2 3\nf 1 3 0\n") ==
        "line 6: a corner is not v, v/vt, v//vn or v/vt/vn, whole numbers other than 0");
  CHECK(refused("v 0 1\nf 1 2 3\n") == "line 5: a vertex has three coordinates");
  CHECK(refused("f 1 2 3 \\\n") == "line 5: a backslash, but no line that it continues");
}

TEST_CASE("read_obj: what exporters write") {
  // faces before their vertices, a continued line, weights and colours, a carriage return
  auto const mesh =
      read("mtllib a.mtl\r\nf 1 2/3/4 \\\r\n 3//5\r\nl 1 2\r\nv 0 0 0 1\r\nv +1 0 0 1 0 0\r\nv 0 1e0 0 # c\r\n");
  CHECK(mesh.corners == std::vector<std::uint32_t>{0, 1, 2});
  CHECK(mesh.vertices == std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
  CHECK(collide::read_obj<double>(written("v 0.1 1e-320 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ".obj").path).vertices[0] ==
        0.1);
  std::string corners, round = "f";
  for (int i = 1; i <= 300; ++i) corners += "v " + std::to_string(i) + " 0 0\n", round += " " + std::to_string(i);
  CHECK(read(corners + round + "\n").size() == 298);
}

/// `why` of a reader of OFF, PLY or STL files and a file.
template <class Read>
std::string said(Read const& of_path, char const* reader, std::string const& file) {
  return why([&] { of_path(written(file, ".file").path); }, reader);
}

std::string off(std::string const& file) { return said(collide::read_off<float>, "read_off", file); }
std::string ply(std::string const& file) { return said(collide::read_ply<float>, "read_ply", file); }
std::string stl(std::string const& file) { return said(collide::read_stl<float>, "read_stl", file); }

TEST_CASE("read_off: read, or refused in one line") {
  std::string const vertices = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  auto const mesh =
      collide::read_off<double>(written("# c\nOFF 4 2 0\n" + vertices + "3 0 1 2 255 0 0\n\n3 0 2 3\n", ".off").path);
  CHECK(mesh.corners == std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3});
  CHECK(mesh.vertices == std::vector<double>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  CHECK(off("COFF\n3 1 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2\n") == "read");
  CHECK(off("OFF\n4 1\n" + vertices + "4 0 1 2 3\n") == "read");
  CHECK(off("OFF\n4 2 0\n" + vertices + "3 0 1 2\n") == "line 7: the file ends among its faces");
  CHECK(off("OFF\n5 1 0\n" + vertices) == "line 6: the file ends among its vertices");
  CHECK(off("OFF\n4 1 0\n" + vertices + "3 0 1 2\n3 0 2 3\n") == "line 8: more lines than the header says");
  CHECK(off("OFF\n4 1 0\n" + vertices + "3 0 1 4\n") == "line 7: vertex 4 does not exist: there are 4");
  CHECK(off("OFF\n4 1 0\n" + vertices + "2 0 1\n") == "line 7: a face of fewer than three corners");
  CHECK(off("OFF\n4 1 0\n" + vertices + "3 0 1\n") == "line 7: a number is missing");
  CHECK(off("OFF BINARY\n") == "line 1: 'BINARY' is not a number that is expected here");
  CHECK(off("") == "line 0: the file ends among its header");
}

/// A number in the order of bytes of a binary PLY file.
template <class T>
std::string bytes(T x, bool big_endian = false) {
  std::string of(sizeof x, '\0');
  std::memcpy(of.data(), &x, sizeof x);
  return big_endian ? std::string(of.rbegin(), of.rend()) : of;
}

std::string const ply_header =
    " 1.0\ncomment c\nelement vertex 3\nproperty double z\nproperty uchar red\nproperty float x\nproperty short y\n"
    "element edge 1\nproperty list uchar short a\nproperty int b\n"
    "element face 1\nproperty list uchar float texcoord\nproperty list ushort int8 vertex_index\nend_header\n";

/// A triangle with attributes. The first byte of the data is 0x0a, a line feed, in either order of bytes.
std::string binary_ply(bool big) {
  std::string file = std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian" + ply_header;
  std::string z = std::string("\x0a\0\0\0\0\0\0\x3f", 8);
  if (big) z = std::string("\x0a\0\0\0\0\0\0\0", 8);
  for (int v = 0; v < 3; ++v) {
    file += (v == 0 ? z : bytes(0.1 * v, big)) + '\x7f' + bytes(float(v == 1), big) +
            bytes(std::int16_t(v == 2 ? -7 : 0), big);
  }
  file += '\2' + bytes(std::int16_t{1}, big) + bytes(std::int16_t{2}, big) + bytes(-1, big);
  return file + '\1' + bytes(0.5F, big) + bytes(std::uint16_t{3}, big) + std::string("\2\0\1", 3);
}

TEST_CASE("read_ply: each format, with attributes") {
  std::string const ascii =
      "ply\r\nformat ascii" + ply_header + "0 255 0 0\n0.1 255 1 0\n0.2 9 0 -7\n2 1 2 -1\n1 .5 3 2 0 1\n";
  for (auto const& file : {ascii, binary_ply(false), binary_ply(true)}) {
    auto const mesh = collide::read_ply<double>(written(file, ".ply").path);
    CHECK(mesh.corners == std::vector<std::uint32_t>{2, 0, 1});
    REQUIRE(mesh.vertices.size() == 9);
    CHECK(mesh.vertices[2] < 1e-3);
    CHECK(std::vector<double>(mesh.vertices.begin() + 3, mesh.vertices.end()) ==
          std::vector<double>{1, 0, 0.1, 0, -7, 0.2});
  }
}

TEST_CASE("read_ply: a file that is not as its header says is refused, and why") {
  for (bool const big : {false, true}) {
    auto const whole = binary_ply(big);
    CHECK(ply(whole) == "read");
    for (std::size_t n = 0; n < whole.size(); ++n) CHECK(ply(whole.substr(0, n)) != "read");
    CHECK(ply(whole.substr(0, whole.size() - 1)) == "face 0: the file ends in it");
    CHECK(ply(whole + '\0') == "the file is longer than its header says");
  }
  std::string const head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  std::string const two = "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
  CHECK(ply(head + two + "3 0 1 2\n3 0 2 1\n") == "read");
  CHECK(ply(head + two + "3 0 1 2\n") == "face 1: the file ends before it, of 2");
  CHECK(ply(head + two + "3 0 1 2\n3 0 2 9\n") == "face 1: vertex 9 does not exist: there are 3");
  CHECK(ply(head + two + "3 0 1 2\n3 0 2 -1\n") == "face 1: vertex -1 does not exist: there are 3");
  CHECK(ply(head + two + "3 0 1 2\n2 0 1\n") == "face 1: a face of fewer than three corners");
  CHECK(ply(head + two + "3 0 1 2\n3 0 2\n") == "line 14: a number is missing");
  CHECK(ply(head + two + "3 0 1 2\n3 0 2 1 1\n") == "line 14: '1' is more than is expected in this line");
  CHECK(ply(head + two + "3 0 1 2\n3 0 2 1\n3 0 1 2\n") == "the file is longer than its header says");
  CHECK(ply(head +
            "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n") ==
        "triangle strips are not read: export triangles");
  CHECK(ply(head) == "line 6: the file ends in its header");
  CHECK(ply(head + "element face 1\nproperty list uchar int vertices\nend_header\n") ==
        "the header does not give a face one list vertex_indices");
  CHECK(ply("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float x\nproperty float "
            "z\nend_header\n") == "the header does not give a vertex one x, y and z");
  CHECK(ply("ply\nformat ascii 2.0\n") == "line 2: '2.0' in place of '1.0'");
  CHECK(ply("plx\n") == "line 1: 'plx' in place of 'ply'");
}

TEST_CASE("files in text may begin with a byte order mark, as editors of Windows write") {
  std::string const mark = "\xef\xbb\xbf", corners = "0 0 0\n1 0 0\n0 1 0\n";
  CHECK(read(mark + square + "f 1 2 3\n").vertices.size() == 12);
  CHECK(read(mark + "# comment\n" + square + "f 1 2 3\n").vertices.size() == 12);
  CHECK(off(mark + "OFF\n3 1 0\n" + corners + "3 0 1 2\n") == "read");
  CHECK(ply(mark + "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + corners + "3 0 1 2\n") == "read");
  CHECK(stl(mark + "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n" +
            "endfacet\nendsolid\n") == "read");
}

TEST_CASE("read_stl: whole, or refused in one line") {
  std::string const facet =
      " facet normal 0 0 1\n  OUTER LOOP\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1e0 -0\n  endloop\n endfacet\n";
  std::string const solid = "solid a b\n" + facet + facet + "endsolid a b\n";
  auto const mesh = collide::read_stl<double>(written("\n" + solid + solid, ".stl").path);
  CHECK(mesh.corners == std::vector<std::uint32_t>{0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2});
  CHECK(mesh.vertices == std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0});
  for (std::size_t n = 0; n + 14 < solid.size(); ++n) CHECK(stl(solid.substr(0, n)) != "read");
  CHECK(stl("solid\n" + facet) == "line 8: the file ends before 'endsolid'");
  CHECK(stl("solid\n" + facet + "facer normal 0 0 1\nendsolid\n") == "line 9: 'facer' in place of 'facet'");
  CHECK(stl("solid\nendsolid\n") == "there are no triangles");
  // a binary file may begin as one in text does
  std::string binary = "solid" + std::string(75, ' ') + bytes(std::uint32_t{2});
  for (int i = 0; i < 2; ++i) {
    binary += std::string(12, '\0');
    for (float const x : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) binary += bytes(x);
    binary += "ab";
  }
  CHECK(stl(binary) == "read");
  std::string const neither = "neither text that begins with 'solid' nor binary: it has ";
  CHECK(stl(binary.substr(0, 134)) == neither + "134 bytes, and a header that says 2 triangles, which have 184");
  CHECK(stl(binary + "\n") == neither + "185 bytes, and a header that says 2 triangles, which have 184");
}

}  // namespace
