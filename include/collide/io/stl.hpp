/// \file
/// A mesh from an STL file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include <collide/io/detail/text.hpp>
#include <collide/io/mesh_data.hpp>

namespace collide {
namespace detail {

/// Reads the triangles of a binary STL file, which has 50 bytes for each after a header of 84.
template <class S>
void read_binary_stl(mesh_data<S>& mesh, std::string_view content) {
  for (std::size_t at = 84; at < content.size(); at += 50) {
    for (std::size_t k = 0; k < 9; ++k) {
      mesh.vertices.push_back(static_cast<S>(number_in_bytes<float>(content, at + 12 + 4 * k, false)));
    }
  }
}

/// Reads the triangles of all solids of an STL file in text, from its first line on.
template <class S>
void read_ascii_stl(mesh_data<S>& mesh, text_lines& text) {
  auto const next = [&] {
    if (!text.next()) text.fail("the file ends before 'endsolid'");
  };
  do {
    text.expect("solid");  // its name follows
    next();
    auto keyword = text.word();
    for (; !is_keyword(keyword, "endsolid"); keyword = (next(), text.word())) {
      text.expect("facet", keyword);  // its normal follows
      next();
      text.expect("outer");
      text.expect("loop");
      text.expect_end();
      for (int corner = 0; corner < 3; ++corner) {
        next();
        text.expect("vertex");
        for (int k = 0; k < 3; ++k) mesh.vertices.push_back(text.number<S>());
        text.expect_end();
      }
      for (char const* end : {"endloop", "endfacet"}) {
        next();
        text.expect(end);
        text.expect_end();
      }
    }
  } while (text.next());
}

}  // namespace detail

/// Reads the triangles of an STL file, binary or in text, in its order. Vertices of equal coordinates become one;
/// normals and attributes are left out. O(n log n).
///
/// \throws error  names the file, and in text the line: if the file cannot be read, is shorter or longer than its
///                header says or ends before `endsolid`, has no triangle, or a coordinate that is not finite
template <class S = float>
mesh_data<S> read_stl(std::string const& path) {
  std::string const what = "collide: read_stl: " + path;
  std::string const content = detail::bytes_of_file(path, what);
  detail::text_lines text(content, what);
  mesh_data<S> mesh;
  std::uint64_t const n = content.size() < 84 ? 0 : detail::number_in_bytes<std::uint32_t>(content, 80, false);
  if (content.size() == 84 + 50 * n) {
    detail::read_binary_stl(mesh, content);
  } else if (content.find('\0') == content.npos && text.next() &&
             detail::is_keyword(detail::text_lines(text).word(), "solid")) {
    detail::read_ascii_stl(mesh, text);
  } else {
    throw error(what + ": neither text that begins with 'solid' nor binary: it has " + std::to_string(content.size()) +
                " bytes, and a header that says " + std::to_string(n) + " triangles, which have " +
                std::to_string(84 + 50 * n));
  }
  mesh.corners.resize(mesh.vertices.size() / 3);
  for (std::size_t i = 0; i < mesh.corners.size(); ++i) mesh.corners[i] = static_cast<std::uint32_t>(i);
  return detail::welded(detail::checked_mesh(std::move(mesh), what));
}

}  // namespace collide
