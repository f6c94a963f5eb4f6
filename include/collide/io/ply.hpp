/// \file
/// A mesh from a PLY file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <collide/io/detail/text.hpp>
#include <collide/io/mesh_data.hpp>

namespace collide {
namespace detail {

/// Reads a PLY file: its header, and then each element as the header describes it, to the last byte.
template <class S>
class ply_reader {
 public:
  ply_reader(std::string_view content, std::string const& what) : what_{what}, text_{content, what} { read_header(); }

  mesh_data<S> read() {
    bool faces = false;
    for (element const& e : elements_) {
      if (e.name == "face" && mesh_.vertices.empty()) throw error(what_ + ": no vertices before the faces");
      if (e.name == "tristrips" && e.count > 0) throw error(what_ + ": triangle strips are not read: export triangles");
      faces = faces || e.name == "face";
      for (std::uint64_t i = 0; i < e.count && !e.properties.empty(); ++i) read_item(e, i);
    }
    if (!faces) throw error(what_ + ": the header has no element 'face'");
    if (ascii_ ? text_.next() : !left_.empty()) throw error(what_ + ": the file is longer than its header says");
    return std::move(mesh_);
  }

 private:
  enum class scalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
  enum class role { none, x, y, z, corners };

  struct property {
    scalar type, count_type;
    bool is_list;
    role used;
  };

  struct element {
    std::string name;
    std::uint64_t count;
    std::vector<property> properties;
  };

  static bool is_integer(scalar type) { return type < scalar::float32; }

  scalar scalar_of(std::string_view word) const {
    static constexpr std::string_view names[2][8] = {
        {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"},
        {"int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"}};
    for (int i = 0; i < 8; ++i) {
      if (word == names[0][i] || word == names[1][i]) return static_cast<scalar>(i);
    }
    text_.fail("PLY has no type " + text_.quoted(word));
  }

  void next_of_header() {
    if (!text_.next()) text_.fail("the file ends in its header");
  }

  void read_header() {
    next_of_header();
    text_.expect("ply");
    text_.expect_end();
    next_of_header();
    text_.expect("format");
    auto const format = text_.word();
    ascii_ = format == "ascii";
    big_endian_ = format == "binary_big_endian";
    if (!ascii_ && !big_endian_ && format != "binary_little_endian")
      text_.fail("PLY has no format " + text_.quoted(format));
    text_.expect("1.0");
    text_.expect_end();
    for (next_of_header();; next_of_header()) {
      auto const keyword = text_.word();
      if (keyword == "comment" || keyword == "obj_info") continue;
      if (keyword == "end_header") break;
      if (keyword == "element") {
        std::string const name(text_.word());
        elements_.push_back({name, text_.number<std::uint64_t>(), {}});
      } else if (keyword == "property" && !elements_.empty()) {
        read_property(elements_.back());
      } else {
        text_.fail(text_.quoted(keyword) + " in a header");
      }
      text_.expect_end();
    }
    text_.expect_end();
    left_ = text_.left();
    for (element const& e : elements_) check(e);
  }

  void read_property(element& e) {
    property p{};
    auto word = text_.word();
    p.is_list = word == "list";
    if (p.is_list) {
      p.count_type = scalar_of(text_.word());
      if (!is_integer(p.count_type)) text_.fail("the length of a list is no whole number");
      word = text_.word();
    }
    p.type = scalar_of(word);
    auto const name = text_.word();
    if (name.empty()) text_.fail("a property without a name");
    if (e.name == "vertex" && !p.is_list)
      p.used = name == "x" ? role::x : name == "y" ? role::y : name == "z" ? role::z : role::none;
    if (e.name == "face" && p.is_list && (name == "vertex_indices" || name == "vertex_index")) p.used = role::corners;
    if (p.used == role::corners && !is_integer(p.type)) text_.fail("numbers of vertices are no whole numbers");
    e.properties.push_back(p);
  }

  /// Throws unless an element has what a mesh needs of it.
  void check(element const& e) const {
    int of_role[5] = {};
    for (property const& p : e.properties) ++of_role[static_cast<int>(p.used)];
    if (e.name == "vertex" && (of_role[1] != 1 || of_role[2] != 1 || of_role[3] != 1))
      throw error(what_ + ": the header does not give a vertex one x, y and z");
    if (e.name == "face" && of_role[4] != 1)
      throw error(what_ + ": the header does not give a face one list vertex_indices");
    if (e.name != "vertex" && e.name != "face") return;
    int same = 0;
    for (element const& other : elements_) same += other.name == e.name ? 1 : 0;
    if (same > 1) throw error(what_ + ": the header has element " + text_.quoted(e.name) + " twice");
  }

  void read_item(element const& e, std::uint64_t i) {
    auto const fail = [&](std::string const& why) {
      throw error(what_ + ": " + e.name + ' ' + std::to_string(i) + ": " + why);
    };
    if (ascii_ && !text_.next()) fail("the file ends before it, of " + std::to_string(e.count));
    S position[3] = {};
    for (property const& p : e.properties) {
      if (p.used == role::corners) corners_.clear();
      auto n = p.is_list ? value<std::int64_t>(p.count_type, fail) : 1;
      if (n < 0) fail("a list of " + std::to_string(n));
      for (; n > 0; --n) {
        if (p.used == role::corners) {
          corners_.push_back(value<std::int64_t>(p.type, fail));
        } else {
          S const x = value<S>(p.type, fail);
          if (p.used != role::none) position[static_cast<int>(p.used) - 1] = x;
        }
      }
    }
    if (ascii_) text_.expect_end();
    if (e.name == "vertex") mesh_.vertices.insert(mesh_.vertices.end(), std::begin(position), std::end(position));
    if (e.name == "face") add_face(mesh_, corners_, 0, fail);
  }

  /// The next number of the file, which it has as a `type`.
  template <class T, class Fail>
  T value(scalar type, Fail const& fail) {
    if (ascii_) return text_.number<T>();
    switch (type) {
      case scalar::int8:
        return binary<std::int8_t, T>(fail);
      case scalar::uint8:
        return binary<std::uint8_t, T>(fail);
      case scalar::int16:
        return binary<std::int16_t, T>(fail);
      case scalar::uint16:
        return binary<std::uint16_t, T>(fail);
      case scalar::int32:
        return binary<std::int32_t, T>(fail);
      case scalar::uint32:
        return binary<std::uint32_t, T>(fail);
      case scalar::float32:
        return binary<float, T>(fail);
      default:
        return binary<double, T>(fail);
    }
  }

  template <class File, class T, class Fail>
  T binary(Fail const& fail) {
    if (left_.size() < sizeof(File)) fail("the file ends in it");
    auto const x = number_in_bytes<File>(left_, 0, big_endian_);
    left_.remove_prefix(sizeof(File));
    return static_cast<T>(x);
  }

  std::string what_;
  text_lines text_;
  std::string_view left_;  ///< of a binary file what has not been read
  std::vector<element> elements_;
  bool ascii_ = false, big_endian_ = false;
  std::vector<std::int64_t> corners_;
  mesh_data<S> mesh_;
};

}  // namespace detail

/// Reads the triangles of a PLY file, in text or binary in either order of bytes, in its order. Of vertices x, y and z
/// are read, of faces `vertex_indices`; everything else is left out, and a polygon is cut into triangles around one of
/// its corners. O(size of the file).
///
/// \throws error  names the file, and the line, vertex or face: if the file cannot be read, is shorter or longer than
///                its header says, or has no triangle, triangle strips, a vertex number that does not exist, a face of
///                fewer than three corners, a coordinate that is not finite, or a polygon that cannot be seen from one
///                of its corners
template <class S = float>
mesh_data<S> read_ply(std::string const& path) {
  std::string const what = "collide: read_ply: " + path;
  std::string const content = detail::bytes_of_file(path, what);
  return detail::checked_mesh(detail::ply_reader<S>(content, what).read(), what);
}

}  // namespace collide
