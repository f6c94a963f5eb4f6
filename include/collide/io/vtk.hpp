/// \file
/// Meshes and contacts as VTK's XML files (.vtp), and films of such files (.pvd), for ParaView. Binary, uncompressed.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <collide/core/contact.hpp>
#include <collide/mesh.hpp>

namespace collide {

/// Numbers under a name, for the points of a file.
class vtk_array {
 public:
  /// `values` has `components` numbers for each point.
  template <class T>
  vtk_array(std::string name, std::vector<T> const& values, std::size_t components = 1)
      : name_{std::move(name)},
        type_{(std::is_floating_point<T>::value ? "Float"
               : std::is_signed<T>::value       ? "Int"
                                                : "UInt") +
              std::to_string(8 * sizeof(T))},
        components_{components},
        bytes_(reinterpret_cast<char const*>(values.data()), values.size() * sizeof(T)) {
    static_assert(std::is_arithmetic<T>::value, "collide: a vtk_array is of numbers");
  }

  std::string const& name() const { return name_; }       ///< as ParaView shows it
  std::string const& type() const { return type_; }       ///< VTK's name of the type
  std::size_t components() const { return components_; }  ///< numbers a point
  std::string const& bytes() const { return bytes_; }     ///< the numbers, as they are in memory

 private:
  std::string name_, type_;
  std::size_t components_;
  std::string bytes_;
};

/// The kind of cells that a file has.
enum class vtk_cells {
  dots,      ///< points; all are one cell
  lines,     ///< two points each
  triangles  ///< three points each
};

/// Writes points (x0, y0, z0, x1, ...), what is known of each, and cells between them, whose points are listed in
/// `corners`, and what is known of each cell, to a stream `out` that takes `<<` of text and numbers.
template <class Out, class S>
void write_vtp(Out& out, std::vector<S> const& points, std::vector<vtk_array> const& of_points, vtk_cells kind,
               std::vector<std::uint32_t> const& corners, std::vector<vtk_array> const& of_cells = {}) {
  static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the header says so");
  std::size_t const width = kind == vtk_cells::dots    ? std::max<std::size_t>(corners.size(), 1)
                            : kind == vtk_cells::lines ? 2
                                                       : 3;
  char const* const name = kind == vtk_cells::dots ? "Verts" : kind == vtk_cells::lines ? "Lines" : "Polys";
  std::vector<std::uint32_t> ends(corners.size() / width);
  for (std::size_t i = 0; i < ends.size(); ++i) ends[i] = static_cast<std::uint32_t>(width * (i + 1));
  std::string data;
  auto const section = [&](std::string_view called, std::vector<vtk_array> const& arrays) {
    out << "<" << called << ">\n";
    for (auto const& array : arrays) {
      out << "<DataArray type=\"" << array.type() << "\" Name=\"" << array.name() << "\" NumberOfComponents=\""
          << array.components() << "\" format=\"appended\" offset=\"" << data.size() << "\"/>\n";
      std::uint64_t const size = array.bytes().size();
      data.append(reinterpret_cast<char const*>(&size), sizeof size).append(array.bytes());
    }
    out << "</" << called << ">\n";
  };
  out << "<?xml version=\"1.0\"?>\n"
         "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
         "<PolyData>\n<Piece NumberOfPoints=\""
      << points.size() / 3 << "\" NumberOf" << name << "=\"" << ends.size() << "\">\n";
  section("PointData", of_points);
  if (!of_cells.empty()) section("CellData", of_cells);
  section("Points", {{"position", points, 3}});
  section(name, {{"connectivity", corners}, {"offsets", ends}});
  out << "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_" << data << "\n</AppendedData>\n</VTKFile>\n";
}

/// A picture of a film: a file, its time, and perhaps a file with the mesh then.
struct vtk_frame {
  std::string file;       ///< name of the file, as seen from the .pvd
  double time;            ///< in the scene's units
  std::string mesh = "";  ///< name of another file of that time; none if empty
};

/// Writes the list of a film's frames, a .pvd file, to a stream that takes `<<` of text and numbers.
template <class Out>
void write_pvd(Out& out, std::vector<vtk_frame> const& frames) {
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
  for (auto const& frame : frames) {
    out << "<DataSet timestep=\"" << frame.time << "\" file=\"" << frame.file << "\"/>\n";
    if (!frame.mesh.empty())
      out << "<DataSet timestep=\"" << frame.time << "\" part=\"1\" file=\"" << frame.mesh << "\"/>\n";
  }
  out << "</Collection>\n</VTKFile>\n";
}

namespace detail {

/// Calls write(stream) for the file `path`; throws `error`, which names it, unless all was written.
template <class Write>
void write_file(std::string const& path, Write const& write) {
  std::ofstream out(path, std::ios::binary);
  out.precision(17);
  write(out);
  out.close();
  if (!out) throw error("collide: " + path + " cannot be written");
}

/// The numbers 0, 1, 2, ...
inline std::vector<std::uint32_t> first_numbers(std::size_t n) {
  std::vector<std::uint32_t> all(n);
  for (std::size_t i = 0; i < n; ++i) all[i] = static_cast<std::uint32_t>(i);
  return all;
}

}  // namespace detail

/// Writes a film's list of frames, the file `path` (.pvd). Throws `error` if it cannot be written.
inline void write_vtk_film(std::string const& path, std::vector<vtk_frame> const& frames) {
  detail::write_file(path, [&](std::ofstream& out) { write_pvd(out, frames); });
}

/// Writes a mesh, which is in host memory, as the file `path` (.vtp), with numbers of each triangle, such as pressures.
/// Throws `error` if it cannot be written. O(triangles).
template <class S>
void write_vtk_mesh(std::string const& path, mesh_view<S> const& mesh,
                    std::vector<vtk_array> const& of_triangles = {}) {
  std::vector<S> points;
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < mesh.vertices().size(); ++i) {
    for (int k = 0; k < 3; ++k) points.push_back(mesh.vertices()[i][k]);
  }
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    for (unsigned k = 0; k < 3; ++k) corners.push_back(static_cast<std::uint32_t>(mesh.corner(i, k)));
  }
  detail::write_file(
      path, [&](std::ofstream& out) { write_vtp(out, points, {}, vtk_cells::triangles, corners, of_triangles); });
}

/// Writes contacts, as `to_host()` of a sink gives them, as the file `path` (.vtp): the point of each on the mesh, with
/// `normal`, `depth`, `sphere` and `triangle`. ParaView's filter Glyph shows the normals. Throws `error` if it cannot
/// be written. O(contacts).
template <class S>
void write_vtk_contacts(std::string const& path, std::vector<contact<S>> const& contacts) {
  std::vector<S> points, normals, depths;
  std::vector<id> spheres, triangles;
  for (contact<S> const& c : contacts) {
    for (int k = 0; k < 3; ++k) {
      points.push_back(c.point[k]);
      normals.push_back(c.normal[k]);
    }
    depths.push_back(c.depth);
    spheres.push_back(c.sphere);
    triangles.push_back(c.triangle);
  }
  detail::write_file(path, [&](std::ofstream& out) {
    write_vtp(out, points, {{"normal", normals, 3}, {"depth", depths}, {"sphere", spheres}, {"triangle", triangles}},
              vtk_cells::dots, detail::first_numbers(contacts.size()));
  });
}

}  // namespace collide
