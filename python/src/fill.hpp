/// \file
/// Spheres that fill a region, for Python.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>

#include <collide/simulation/fill.hpp>

#include "calls.hpp"

namespace collide_python {

/// The distribution of a name, of numbers that Python has counted.
inline collide::size_distribution distribution(std::string const& name, std::vector<double> const& n) {
  using sizes = collide::size_distribution;
  if (name == "uniform") return sizes::uniform(n[0], n[1]);
  if (name == "normal") return sizes::normal(n[0], n[1], n[2], n[3]);
  if (name == "lognormal") return sizes::lognormal(n[0], n[1], n[2], n[3]);
  auto const middle = n.begin() + static_cast<std::ptrdiff_t>(n.size() / 2);
  return sizes::sieve({n.begin(), middle}, {middle, n.end()});
}

/// Doubles as bytes: x, y, z of all centres, then all radii; and the fraction. A region of 6 numbers is a box, of 7 a
/// cylinder, others are corners of triangles. `number` spheres, or, if it is 0, up to a fraction.
inline std::pair<nb::bytes, double> fill(std::vector<double> const& region, std::string const& name,
                                         std::vector<double> const& sizes, double fraction, std::size_t number,
                                         std::uint64_t seed) {
  call_under_way const now;
  collide::filling found;
  {
    without_gil const others_run;
    auto const of = distribution(name, sizes);
    auto const fill_region = [&](auto const& shape) {
      found = number > 0 ? collide::fill_number(shape, of, number, seed) : collide::fill(shape, of, fraction, seed);
    };
    double const* const r = region.data();
    if (region.size() == 6) {
      fill_region(collide::box_region{{r[0], r[1], r[2]}, {r[3], r[4], r[5]}});
    } else if (region.size() == 7) {
      fill_region(collide::cylinder_region({r[0], r[1], r[2]}, {r[3], r[4], r[5]}, r[6]));
    } else {
      fill_region(
          collide::mesh_region(collide::triangle_soup(r, region.size() / 9), collide::host(is_forked() ? 1 : 0)));
    }
  }
  found.centres.insert(found.centres.end(), found.radii.begin(), found.radii.end());
  return {nb::bytes(found.centres.data(), found.centres.size() * sizeof(double)), found.fraction};
}

}  // namespace collide_python
