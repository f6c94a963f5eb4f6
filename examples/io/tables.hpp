/// \file
/// Pairs and contacts as CSV files.
#pragma once

#include <string_view>
#include <vector>

#include <collide/contact.hpp>

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

}  // namespace io
