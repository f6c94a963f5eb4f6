/// \file
/// Pairs and contacts as CSV files.
#pragma once

#include <string_view>
#include <vector>

#include <collide/core/contact.hpp>

#include "output.hpp"
#include "progress.hpp"

namespace io {

/// Writes a header and a line for each of `rows`.
template <class Row, class WriteRow>
void write_table(output_file& out, std::string_view header, std::vector<Row> const& rows, WriteRow const& write_row) {
  progress bar("writing", static_cast<double>(rows.size()));
  out << header << "\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    write_row(rows[i]);
    out << "\n";
    if (i % 65536 == 0) bar.update(static_cast<double>(i));
  }
}

/// Writes pairs as `sphere,triangle`.
inline void write_pairs(output_file& out, std::vector<collide::pair> const& pairs) {
  write_table(out, "sphere,triangle", pairs, [&](collide::pair const& p) { out << p.sphere << "," << p.triangle; });
}

/// Writes contacts: the pair, the point on the triangle, the normal towards the centre, the depth and the feature
/// touched.
template <class S>
void write_contacts(output_file& out, std::vector<collide::contact<S>> const& contacts) {
  constexpr std::string_view features[] = {"face", "edge", "vertex"};
  write_table(out, "sphere,triangle,x,y,z,nx,ny,nz,depth,feature,index", contacts, [&](collide::contact<S> const& c) {
    out << c.sphere << "," << c.triangle;
    for (auto const* v : {&c.point, &c.normal}) out << "," << v->x() << "," << v->y() << "," << v->z();
    out << "," << c.depth << "," << features[static_cast<int>(c.feature)] << "," << c.feature_index;
  });
}

/// Writes the nearest triangle of each point: its number, the closest point on it, and the distance. Where there is
/// none the number and the point are left out, and the distance is inf.
template <class S>
void write_nearest(output_file& out, std::vector<collide::nearest_triangle<S>> const& nearest) {
  std::size_t point = 0;
  write_table(out, "point,triangle,x,y,z,distance", nearest, [&](collide::nearest_triangle<S> const& n) {
    out << point++ << ",";
    if (n.triangle == collide::no_id) {
      out << ",,,," << (n.distance < 0 ? "-inf" : "inf");
    } else {
      out << n.triangle << "," << n.point.x() << "," << n.point.y() << "," << n.point.z() << "," << n.distance;
    }
  });
}

/// Writes for each point whether it is inside: 1 or 0.
inline void write_inside(output_file& out, std::vector<std::uint8_t> const& inside) {
  std::size_t point = 0;
  write_table(out, "point,inside", inside, [&](std::uint8_t flag) { out << point++ << "," << (flag != 0 ? 1 : 0); });
}

}  // namespace io
