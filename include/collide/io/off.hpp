/// \file
/// A mesh from an OFF file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <collide/io/detail/text.hpp>
#include <collide/io/mesh_data.hpp>

namespace collide {

/// Reads the triangles of an OFF file in text, in its order. Normals, colours and texture coordinates are left out; a
/// polygon is cut into triangles around one of its corners. O(size of the file).
///
/// \throws error  names the file, and the line: if the file cannot be read, has fewer lines or more than its header
///                says, no triangle, a vertex number that does not exist, a face of fewer than three corners, a
///                coordinate that is not finite, or a polygon that cannot be seen from one of its corners
template <class S = float>
mesh_data<S> read_off(std::string const& path) {
  std::string const what = "collide: read_off: " + path;
  std::string const content = detail::bytes_of_file(path, what);
  detail::text_lines text(content, what, '#');
  auto const next = [&](char const* part) {
    if (!text.next()) text.fail(std::string("the file ends among its ") + part);
  };
  next("header");
  auto const name = text.word();
  bool const more_of_vertices = name == "COFF" || name == "NOFF" || name == "CNOFF" || name == "STOFF" ||
                                name == "STCOFF" || name == "STNOFF" || name == "STCNOFF";
  if (name != "OFF" && !more_of_vertices) text.fail("the file begins with " + text.quoted(name) + ", not with OFF");
  auto word = text.word();
  if (word.empty()) {
    next("counts");
    word = text.word();
  }
  auto const vertices = text.number<std::uint64_t>(word);
  auto const faces = text.number<std::uint64_t>();
  if (!(word = text.word()).empty()) text.number<std::uint64_t>(word);  // of edges
  text.expect_end();
  mesh_data<S> mesh;
  for (std::uint64_t i = 0; i < vertices; ++i) {
    next("vertices");
    for (int k = 0; k < 3; ++k) mesh.vertices.push_back(text.number<S>());
    if (!more_of_vertices) text.expect_end();
  }
  std::vector<std::int64_t> face;
  for (std::uint64_t i = 0; i < faces; ++i) {
    next("faces");
    face.clear();
    for (auto n = text.number<std::uint64_t>(); n > 0; --n) face.push_back(text.number<std::int64_t>());
    detail::add_face(mesh, face, 0, [&](std::string const& why) { text.fail(why); });
    int colours = 0;
    while (!(word = text.word()).empty()) {
      text.number<double>(word);
      if (++colours > 4) text.fail("more follows a face than a colour");
    }
  }
  if (text.next()) text.fail("more lines than the header says");
  return detail::checked_mesh(std::move(mesh), what);
}

}  // namespace collide
