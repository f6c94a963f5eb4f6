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
#include "rounding.hpp"
#include "triangulate.hpp"

namespace io {

/// An indexed mesh: vertices x0, y0, z0, x1, ... and three vertex numbers per triangle.
template <class S>
struct mesh_data {
  std::vector<S> vertices;
  std::vector<std::uint32_t> corners;
  rounding tally;                    ///< of the coordinates
  std::vector<std::string> remarks;  ///< what the file has that was left out or may be a mistake, a line each

  std::size_t size() const { return corners.size() / 3; }
};

/// Reads the triangles of all faces of an OBJ file in the file's order, whatever objects, groups and materials they are
/// in. Faces of fewer than three corners, which exporters write, are left out.
///
/// tinyobjloader takes the records apart. Three things that it leaves to be desired are done here. It reads from this
/// class one line at a time, so that each of its callbacks is known to stem from a line, which messages then name. It
/// passes over what it does not understand; here every line must be one that OBJ knows. Its numbers are not correctly
/// rounded; the coordinates are read again, straight to `S`.
template <class S>
class obj_reader final : private std::streambuf {
 public:
  /// Reads `text`, which is the file `path`. Throws `data_error`, which names file and line, unless all of it is
  /// understood and it has a face; if `strict`, also where there would be a remark.
  static mesh_data<S> read(std::string const& path, std::string_view text, bool strict) {
    return obj_reader(path, text, strict).read();
  }

 private:
  /// A polygon: where its corners begin, and the line that it stems from.
  struct face {
    std::size_t first;
    std::size_t line;
  };

  /// A possible mistake, and its reading unless in strict mode; how often that was, and where first.
  struct oddity {
    std::string problem, remark;
    std::size_t count = 0;
    std::size_t line = 0;
  };

  obj_reader(std::string const& path, std::string_view text, bool strict)
      : path_{path},
        left_{text},
        strict_{strict},
        bar_{"reading " + path, static_cast<double>(text.size())},
        size_{text.size()} {}

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
    if (faces_.empty()) {
      throw data_error(path_, short_faces_.count > 0 ? "no faces of at least three corners" : "no faces");
    }
    triangulate();
    for (auto const* odd : {&short_faces_, &stray_backslashes_}) {
      if (odd->count == 0) continue;
      mesh_.remarks.push_back(path_ + ':' + std::to_string(odd->line) + ": " + odd->remark + " (the first of " +
                              std::to_string(odd->count) + ')');
    }
    return std::move(mesh_);
  }

  /// Counts an oddity of the line that is being read.
  void note(oddity& odd) {
    if (strict_) fail(odd.problem);
    if (odd.count++ == 0) odd.line = number_;
  }

  /// Gives tinyobjloader the next line, after a look at its keyword.
  int_type underflow() override {
    if (left_.empty()) return traits_type::eof();
    number_ += taken_;
    taken_ = 0;
    line_.clear();
    do {
      line_.append(next_part());
      left_.remove_prefix(std::min(left_.find('\n'), left_.size() - 1) + 1);
      ++taken_;
    } while (continued());
    if (number_ % 4096 == 0) bar_.update(static_cast<double>(size_ - left_.size()));
    check_keyword();
    line_ += '\n';
    setg(line_.data(), line_.data(), line_.data() + line_.size());
    return traits_type::to_int_type(line_.front());
  }

  /// The next line of the file, without a comment and blanks around it.
  std::string_view next_part() const {
    auto const line = left_.substr(0, left_.find('\n'));
    return trimmed(line.substr(0, line.find('#')));
  }

  /// If the line ends in a backslash, which continues it on the next one, takes that off and returns true. No number
  /// and no corner is a keyword: where the next line begins with one, the backslash belongs to a name, such as a path
  /// of Windows, that is of no interest here.
  bool continued() {
    if (line_.empty() || line_.back() != '\\') return false;
    auto const keyword = first_word(line_);
    if (keyword != "v" && keyword != "f" && keyword != "\\" && is_keyword(first_word(next_part()))) {
      note(stray_backslashes_);
      return false;
    }
    line_.back() = ' ';
    return !left_.empty();
  }

  static std::string_view first_word(std::string_view text) {
    auto const rest = trimmed(text);
    return rest.substr(0, rest.find_first_of(" \t"));
  }

  static bool is_keyword(std::string_view word) {
    static constexpr std::string_view known[] = {
        "v",         "f",      "vn",    "vt",     "vp",   "vw",    "g",        "o",        "s",
        "usemtl",    "mtllib", "l",     "p",      "mg",   "t",     "usemap",   "maplib",   "lod",
        "deg",       "bmat",   "step",  "cstype", "curv", "curv2", "surf",     "parm",     "trim",
        "hole",      "scrv",   "sp",    "end",    "con",  "bevel", "c_interp", "d_interp", "shadow_obj",
        "trace_obj", "ctech",  "stech", "call",   "csh",
    };
    return std::find(std::begin(known), std::end(known), word) != std::end(known);
  }

  /// Throws unless the line begins with a keyword of OBJ.
  void check_keyword() {
    auto const rest = trimmed(line_);
    if (rest.empty()) return;
    if (std::any_of(rest.begin(), rest.end(), [](unsigned char c) { return c < ' ' && c != '\t'; })) {
      fail("this is not a line of text");
    }
    auto const keyword = first_word(rest);
    if (!is_keyword(keyword)) fail("OBJ has no keyword " + quoted(keyword));
    if (rest == "v") fail("nothing after 'v'");
    if (rest == "f") note(short_faces_);  // of which tinyobjloader says nothing
  }

  /// Reads the coordinates of the `v` line that tinyobjloader has just passed.
  void add_vertex() {
    std::size_t n = 0;
    for_each_word([&](std::string_view word) {
      S value{};
      rounding here;
      if (!parse_number(word, value, here)) fail(quoted(word) + " is not a number");
      if (!std::isfinite(value)) fail(quoted(word) + " is not finite");
      if (n++ >= 3) return;  // a weight or a colour
      mesh_.vertices.push_back(value);
      mesh_.tally += here;
    });
    if (n < 3) fail("a vertex has three coordinates");
  }

  /// Keeps a face until all vertices are known: OBJ files exist whose faces come first.
  void add_face(tinyobj::index_t const* corners, std::size_t size) {
    for_each_word([&](std::string_view word) {
      if (!is_corner(word)) fail(quoted(word) + " is not a corner of a face");
    });
    if (size < 3) return note(short_faces_);
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
  bool strict_;
  progress bar_;
  std::size_t size_;
  mesh_data<S> mesh_;
  std::vector<face> faces_;
  std::vector<std::uint32_t> corners_;
  oddity short_faces_{"a face of fewer than three corners", "a face of fewer than three corners is left out"};
  oddity stray_backslashes_{"a backslash at the end, but the next line begins with a keyword",
                            "the backslash at the end does not continue this line, as the next begins with a keyword"};
};

/// Reads a mesh from the text of an OBJ file; see `obj_reader`.
template <class S>
mesh_data<S> read_obj(std::string const& path, std::string_view text, bool strict) {
  return obj_reader<S>::read(path, text, strict);
}

}  // namespace io
