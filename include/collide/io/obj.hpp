/// \file
/// A mesh from a Wavefront OBJ file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <collide/io/detail/text.hpp>
#include <collide/io/mesh_data.hpp>

namespace collide {
namespace detail {

/// True for words that begin a line which has no triangles.
inline bool is_other_keyword_of_obj(std::string_view word) {
  for (std::string_view const known :
       {"vn", "vt",     "vp",   "vw",    "g",   "o",      "s",   "usemtl",   "mtllib",   "l",          "p",
        "mg", "usemap", "call", "bevel", "lod", "maplib", "csh", "c_interp", "d_interp", "shadow_obj", "trace_obj"}) {
    if (word == known) return true;
  }
  return false;
}

/// Calls f with each other word of the line, and of the next ones where a backslash at the end continues it.
template <class F>
void for_each_word(text_lines& text, F const& f) {
  for (auto w = text.word(); !w.empty(); w = text.word()) {
    bool const goes_on = w.back() == '\\';
    if (goes_on) w.remove_suffix(1);
    if (!w.empty()) f(w);
    if (goes_on && (!text.word().empty() || !text.next())) text.fail("a backslash, but no line that it continues");
  }
}

/// The number, from 0, of the vertex of a corner v, v/vt, v//vn or v/vt/vn, after `known` vertices.
inline std::int64_t vertex_of_corner(text_lines const& text, std::string_view corner, std::size_t known) {
  auto const v = corner.substr(0, corner.find('/'));
  corner.remove_prefix(v.size());
  int slashes = 0;
  for (char const c : corner) slashes += c == '/' ? 1 : (c >= '0' && c <= '9') || c == '-' ? 0 : 3;
  auto const number = text.number<std::int64_t>(v);
  if (slashes > 2 || number == 0) text.fail("a corner is not v, v/vt, v//vn or v/vt/vn, whole numbers other than 0");
  return number < 0 ? static_cast<std::int64_t>(known) + number : number - 1;
}

}  // namespace detail

/// Reads the triangles of all faces of an OBJ file, in its order, whatever objects and groups they are in. Lines,
/// points and curves are left out; a polygon is cut into triangles around one of its corners. O(size of the file).
///
/// \throws error  names the file, and the line: if the file cannot be read, has no triangle, a line that OBJ does not
///                know, a vertex number that does not exist, a face of fewer than three corners, a coordinate that is
///                not finite, or a polygon that cannot be seen from one of its corners
template <class S = float>
mesh_data<S> read_obj(std::string const& path) {
  std::string const what = "collide: read_obj: " + path;
  std::string const content = detail::bytes_of_file(path, what);
  detail::text_lines text(content, what, '#');
  mesh_data<S> mesh;
  std::vector<std::int64_t> all, face;  // of each face its line, its number of corners, and these
  while (text.next()) {
    auto const keyword = text.word();
    std::size_t n = 0;
    if (keyword == "v") {
      detail::for_each_word(text, [&](std::string_view word) {
        S const x = text.number<S>(word);
        if (n++ < 3) mesh.vertices.push_back(x);  // a weight or a colour may follow
      });
      if (n < 3) text.fail("a vertex has three coordinates");
    } else if (keyword == "f") {
      auto const first = all.size();
      all.insert(all.end(), {static_cast<std::int64_t>(text.line_number()), 0});
      detail::for_each_word(text, [&](std::string_view corner) {
        all.push_back(detail::vertex_of_corner(text, corner, mesh.vertices.size() / 3));
      });
      all[first + 1] = static_cast<std::int64_t>(all.size() - first - 2);
    } else if (!detail::is_other_keyword_of_obj(keyword)) {
      text.fail("OBJ has no keyword " + text.quoted(keyword));
    }
  }
  for (auto at = all.begin(); at != all.end(); at += 2 + at[1]) {  // vertices may come after the faces
    face.assign(at + 2, at + 2 + at[1]);
    detail::add_face(mesh, face, 1,
                     [&](std::string const& why) { throw error(what + ": line " + std::to_string(*at) + ": " + why); });
  }
  return detail::checked_mesh(std::move(mesh), what);
}

}  // namespace collide
