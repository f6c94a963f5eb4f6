#include "scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace oracle {
namespace {

struct box {
  point low, high;

  explicit box(triangle const& t)
      : low{std::min({t.a.x, t.b.x, t.c.x}), std::min({t.a.y, t.b.y, t.c.y}), std::min({t.a.z, t.b.z, t.c.z})},
        high{std::max({t.a.x, t.b.x, t.c.x}), std::max({t.a.y, t.b.y, t.c.y}), std::max({t.a.z, t.b.z, t.c.z})} {}

  /// True only if the box is farther than the radius on some axis: rounding is monotone, so a rounded difference above
  /// the radius means an exact difference above the radius. False for every NaN.
  bool apart_from(sphere const& s) const {
    auto const& p = s.centre;
    return low.x - p.x > s.radius || p.x - high.x > s.radius || low.y - p.y > s.radius || p.y - high.y > s.radius ||
           low.z - p.z > s.radius || p.z - high.z > s.radius;
  }
};

/// A number below all that round to x.
double down(double x) { return std::nextafter(x, -std::numeric_limits<double>::infinity()); }

}  // namespace

expectation expect(std::vector<triangle> const& triangles, std::vector<sphere> const& spheres, double band) {
  std::vector<std::pair<box, std::uint32_t>> boxes;  // by their lower ends along x
  double widest = 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    box const b(triangles[t]);
    if (!std::isfinite(b.low.x) || !std::isfinite(b.high.x)) continue;  // touches nothing
    boxes.emplace_back(b, t);
    widest = std::max(widest, -down(b.low.x - b.high.x));
  }
  std::sort(boxes.begin(), boxes.end(), [](auto const& p, auto const& q) { return p.first.low.x < q.first.low.x; });

  expectation expected;
  for (std::uint32_t s = 0; s < spheres.size(); ++s) {
    sphere const less{spheres[s].centre, spheres[s].radius * (1 - band)},
        more{spheres[s].centre, spheres[s].radius * (1 + band)};
    // a box that begins before this, rounded down, ends before the sphere
    double const begin = down(down(more.centre.x - more.radius) - widest);
    auto b =
        std::lower_bound(boxes.begin(), boxes.end(), begin, [](auto const& p, double x) { return p.first.low.x < x; });
    std::vector<std::uint32_t> near;
    for (; b != boxes.end() && !(b->first.low.x - more.centre.x > more.radius); ++b)
      if (!b->first.apart_from(more)) near.push_back(b->second);
    std::sort(near.begin(), near.end());
    for (std::uint32_t t : near) {
      bool const certain = hit(triangles[t], less), exact = certain || (band != 0 && hit(triangles[t], spheres[s]));
      if (certain) expected.certain.push_back({s, t});
      if (exact) expected.exact.push_back({s, t});
      if (exact || (band != 0 && hit(triangles[t], more))) expected.possible.push_back({s, t});
    }
  }
  return expected;
}

std::vector<hard_case> read_hard_cases(std::string const& path, bool float_inputs) {
  std::ifstream file(path);
  std::string line, cell;
  if (!std::getline(file, line)) throw std::runtime_error(path + ": no such file, or empty");
  bool const swept = line.find(",dx,dy,dz,") != std::string::npos;
  std::vector<hard_case> cases;
  while (std::getline(file, line)) {
    std::vector<std::string> cells;
    for (std::istringstream row(line); std::getline(row, cell, ',');) cells.push_back(cell);
    if (line.back() == ',') cells.emplace_back();
    if (cells.size() != (swept ? 22u : 19u)) throw std::runtime_error(path + ": not a row: " + line);
    auto const number = [&](std::size_t i) {
      char* end;
      double const value = float_inputs ? std::strtof(cells[i].c_str(), &end) : std::strtod(cells[i].c_str(), &end);
      if (cells[i].empty() || *end != '\0') throw std::runtime_error(path + ": not a number: " + cells[i]);
      return value;
    };
    auto const at = [&](std::size_t i) { return point{number(i), number(i + 1), number(i + 2)}; };
    cases.push_back({std::stoi(cells[0]),
                     std::stoi(cells[3]),
                     cells[1],
                     cells[2],
                     cells[4] == "1",
                     {at(5), at(8), at(11)},
                     {at(14), number(swept ? 20 : 17)},
                     swept ? at(17) : point{0, 0, 0}});
  }
  return cases;
}

}  // namespace oracle
