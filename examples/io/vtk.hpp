/// \file
/// Points and surfaces with what is known of them, as VTK's XML files (.vtp), and films of these (.pvd), for ParaView.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "output.hpp"

namespace io {

/// Numbers under a name, so many for each point or cell, as they are in memory.
struct vtk_array {
  std::string name, type, bytes;
  std::size_t components;

  template <class T>
  vtk_array(char const* called, std::vector<T> const& values, std::size_t width = 1)
      : name{called},
        type{(std::is_floating_point<T>::value ? "Float"
              : std::is_signed<T>::value       ? "Int"
                                               : "UInt") +
             std::to_string(8 * sizeof(T))},
        bytes(reinterpret_cast<char const*>(values.data()), values.size() * sizeof(T)),
        components{width} {}
};

/// Writes points and cells between them, which are `Polys` (polygons) or `Verts` (dots): cell i has the corners
/// ends[i - 1] .. ends[i] of the list.
inline void write_vtp(output_file& out, std::vector<float> const& points, std::vector<vtk_array> const& of_points,
                      std::string const& kind, std::vector<std::uint32_t> const& corners,
                      std::vector<std::uint32_t> const& ends) {
  static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the header says so");
  std::string data;
  auto const section = [&](std::string const& name, std::vector<vtk_array> const& arrays) {
    out << "<" << name << ">\n";
    for (auto const& array : arrays) {
      out << "<DataArray type=\"" << array.type << "\" Name=\"" << array.name << "\" NumberOfComponents=\""
          << array.components << "\" format=\"appended\" offset=\"" << data.size() << "\"/>\n";
      std::uint64_t const size = array.bytes.size();
      data.append(reinterpret_cast<char const*>(&size), sizeof size).append(array.bytes);
    }
    out << "</" << name << ">\n";
  };
  out << "<?xml version=\"1.0\"?>\n"
         "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
         "<PolyData>\n<Piece NumberOfPoints=\""
      << points.size() / 3 << "\" NumberOf" << kind << "=\"" << ends.size() << "\">\n";
  section("PointData", of_points);
  section("Points", {{"position", points, 3}});
  section(kind, {{"connectivity", corners}, {"offsets", ends}});
  out << "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_" << data << "\n</AppendedData>\n</VTKFile>\n";
}

/// A frame of a film: a file, its time, and a file with the mesh then, if that moves.
struct vtk_frame {
  std::string file;
  double time;
  std::string mesh = "";
};

/// Writes the list of a film's frames.
inline void write_pvd(output_file& out, std::vector<vtk_frame> const& frames) {
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
  for (auto const& frame : frames) {
    out << "<DataSet timestep=\"" << frame.time << "\" file=\"" << frame.file << "\"/>\n";
    if (!frame.mesh.empty())
      out << "<DataSet timestep=\"" << frame.time << "\" part=\"1\" file=\"" << frame.mesh << "\"/>\n";
  }
  out << "</Collection>\n</VTKFile>\n";
}

}  // namespace io
