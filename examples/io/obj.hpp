/// \file
/// A triangle mesh from a Wavefront OBJ file.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <istream>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

#include <tiny_obj_loader.h>

#include "error.hpp"
#include "number.hpp"
#include "progress.hpp"
#include "text.hpp"
#include "triangulate.hpp"

namespace io {

/// An indexed mesh: vertices x0, y0, z0, x1, ... and three vertex numbers per triangle.
template <class S>
struct mesh_data {
  std::vector<S> vertices;
  std::vector<std::uint32_t> corners;

  std::size_t size() const { return corners.size() / 3; }
};

/// Reads the triangles of all faces of an OBJ file in the file's order, whatever objects, groups and materials they are
/// in.
///
/// tinyobjloader takes the records apart. Three things that it leaves to be desired are done here. It reads from this
/// class one line at a time, so that each of its callbacks is known to stem from a line, which messages then name. It
/// passes over what it does not understand; here every line must be one that OBJ knows. Its numbers are not correctly
/// rounded; the coordinates are read again, straight to `S`.
template <class S>
class obj_reader final : private std::streambuf {
 public:
  /// Throws `data_error`, which names file and line, unless all of the file is understood and it has a face.
  static mesh_data<S> read(std::string const& path) {
    text_file const file(path);
    return read(path, file.view());
  }

  /// Reads text in memory, which messages call `name`.
  static mesh_data<S> read(std::string const& name, std::string_view text) { return obj_reader(name, text).read(); }

 private:
  /// A polygon: where its corners begin, and the line that it stems from.
  struct face {
    std::size_t first;
    std::size_t line;
  };

  obj_reader(std::string const& path, std::string_view text)
      : path_{path}, left_{text}, bar_{"reading " + path, static_cast<double>(text.size())}, size_{text.size()} {}

  mesh_data<S> read() {
    std::istream stream(this);
    stream.exceptions(std::ios::badbit);  // passes on what underflow() throws
    tinyobj::callback_t callbacks;
    callbacks.vertex_cb = [](void* self, tinyobj::real_t, tinyobj::real_t, tinyobj::real_t, tinyobj::real_t) {
      static_cast<obj_reader*>(self)->add_vertex();
    };
    callbacks.index_cb = [](void* self, tinyobj::index_t* corners, int size) {
      static_cast<obj_reader*>(self)->add_face(corners, static_cast<std::size_t>(size));
    };
    tinyobj::LoadObjWithCallback(stream, callbacks, this);
    if (faces_.empty()) throw data_error(path_, "no faces");
    triangulate();
    return std::move(mesh_);
  }

  /// Gives tinyobjloader the next line, after a look at its keyword.
  int_type underflow() override {
    if (left_.empty()) return traits_type::eof();
    number_ += taken_;
    taken_ = 0;
    line_.clear();
    for (bool more = true; more && !left_.empty();) {  // a backslash continues a line on the next one
      auto const end = std::min(left_.find('\n'), left_.size());
      auto part = left_.substr(0, end);
      part = trimmed(part.substr(0, part.find('#')));
      more = !part.empty() && part.back() == '\\';
      if (more) part.remove_suffix(1);
      line_.append(part).append(more ? " " : "");
      left_.remove_prefix(std::min(end + 1, left_.size()));
      ++taken_;
    }
    if (number_ % 4096 == 0) bar_.update(static_cast<double>(size_ - left_.size()));
    check_keyword();
    line_ += '\n';
    setg(line_.data(), line_.data(), line_.data() + line_.size());
    return traits_type::to_int_type(line_.front());
  }

  /// Throws unless the line begins with a keyword of OBJ, with something after it where the geometry depends on it.
  void check_keyword() {
    static constexpr std::string_view known[] = {
        "v",         "f",      "vn",    "vt",     "vp",   "vw",    "g",        "o",        "s",
        "usemtl",    "mtllib", "l",     "p",      "mg",   "t",     "usemap",   "maplib",   "lod",
        "deg",       "bmat",   "step",  "cstype", "curv", "curv2", "surf",     "parm",     "trim",
        "hole",      "scrv",   "sp",    "end",    "con",  "bevel", "c_interp", "d_interp", "shadow_obj",
        "trace_obj", "ctech",  "stech", "call",   "csh",
    };
    auto const rest = trimmed(line_);
    if (rest.empty()) return;
    if (std::any_of(rest.begin(), rest.end(), [](unsigned char c) { return c < ' ' && c != '\t'; })) {
      fail("this is not a line of text");
    }
    auto const keyword = rest.substr(0, rest.find_first_of(" \t"));
    if (std::find(std::begin(known), std::end(known), keyword) == std::end(known)) {
      fail("OBJ has no keyword " + quoted(keyword));
    }
    if (keyword == rest && (keyword == "v" || keyword == "f")) fail("nothing after " + quoted(keyword));
  }

  /// Reads the coordinates of the `v` line that tinyobjloader has just passed.
  void add_vertex() {
    std::size_t n = 0;
    for_each_word([&](std::string_view word) {
      S value{};
      if (!parse_number(word, value)) fail(quoted(word) + " is not a number");
      if (!std::isfinite(value)) fail(quoted(word) + " is not finite");
      if (n++ < 3) mesh_.vertices.push_back(value);  // then a weight or a colour
    });
    if (n < 3) fail("a vertex has three coordinates");
  }

  /// Keeps a face until all vertices are known: OBJ files exist whose faces come first.
  void add_face(tinyobj::index_t const* corners, std::size_t size) {
    for_each_word([&](std::string_view word) {
      if (!is_corner(word)) fail(quoted(word) + " is not a corner of a face");
    });
    if (size < 3) fail("a face has at least three corners");
    auto const known = static_cast<std::ptrdiff_t>(mesh_.vertices.size() / 3);
    faces_.push_back({corners_.size(), number_});
    for (std::size_t i = 0; i < size; ++i) {
      std::ptrdiff_t const index = corners[i].vertex_index;  // from 1, or from -1 backwards
      if (index == 0 || index < -known) fail(out_of_range(index));
      corners_.push_back(static_cast<std::uint32_t>(index < 0 ? known + index : index - 1));
    }
  }

  /// True if `word` is v, v/vt, v//vn or v/vt/vn, each a whole number small enough for tinyobjloader.
  static bool is_corner(std::string_view word) {
    for (int part = 0; part < 3; ++part) {
      auto number = word.substr(0, word.find('/'));
      word.remove_prefix(number.size());
      if (!number.empty() && number.front() == '-') number.remove_prefix(1);
      bool const digits = number.find_first_not_of("0123456789") == number.npos;
      if (!digits || number.size() > 9 || (part == 0 && number.empty())) return false;
      if (word.empty()) return true;
      word.remove_prefix(1);
    }
    return false;
  }

  void triangulate() {
    auto const vertex_count = mesh_.vertices.size() / 3;
    polygon_cutter<S> cutter;
    mesh_.corners.reserve(corners_.size());
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      auto const first = faces_[i].first;
      auto const last = i + 1 < faces_.size() ? faces_[i + 1].first : corners_.size();
      number_ = faces_[i].line;
      for (auto c = first; c < last; ++c) {
        if (corners_[c] >= vertex_count) fail(out_of_range(std::ptrdiff_t{corners_[c]} + 1));
      }
      cutter.cut(mesh_.vertices.data(), &corners_[first], last - first, mesh_.corners);
    }
  }

  /// Calls f with each word of the line after its keyword.
  template <class F>
  void for_each_word(F const& f) const {
    constexpr auto blanks = " \t\r\n";
    std::string_view rest = trimmed(line_);
    rest.remove_prefix(std::min(rest.find_first_of(blanks), rest.size()));
    for (auto at = rest.find_first_not_of(blanks); at != rest.npos; at = rest.find_first_not_of(blanks)) {
      rest.remove_prefix(at);
      auto const word = rest.substr(0, rest.find_first_of(blanks));
      f(word);
      rest.remove_prefix(word.size());
    }
  }

  std::string out_of_range(std::ptrdiff_t index) const {
    return "vertex " + std::to_string(index) + " does not exist: the file has " +
           std::to_string(mesh_.vertices.size() / 3);
  }

  [[noreturn]] void fail(std::string const& what) const { throw data_error(path_, number_, what); }

  std::string const& path_;
  std::string_view left_;   ///< the part of the file that tinyobjloader has not yet seen
  std::string line_;        ///< the line that it sees
  std::size_t number_ = 0;  ///< its number
  std::size_t taken_ = 1;   ///< how many lines of the file it takes up
  progress bar_;
  std::size_t size_;
  mesh_data<S> mesh_;
  std::vector<face> faces_;
  std::vector<std::uint32_t> corners_;
};

/// Reads a mesh from an OBJ file; see `obj_reader`.
template <class S>
mesh_data<S> read_obj(std::string const& path) {
  return obj_reader<S>::read(path);
}

}  // namespace io
