/// \file
/// The detection of the program `detect`: its input, its output, and the function from one to the other.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <collide/core/contact.hpp>

#include "../io/csv.hpp"
#include "../io/obj.hpp"

namespace detection {

using clock = std::chrono::steady_clock;

inline double milliseconds(clock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); }

struct options {
  std::string mesh, spheres, radius;
  std::string broad, space = "host", precision = "exact", scalar;
  bool nearest = false, signed_distance = false, inside = false;  ///< what is asked of points, in place of pairs
  std::string output, contacts, ply, report;
  std::string ranks;
  double cell_width = 0;
  std::size_t triangles_per_pass = 0;  ///< 0: the mesh is not divided
  int threads = 0;
  int repeat = 1;
  bool strict = false;

  /// True if points are asked about, and not pairs.
  bool asks_points() const { return nearest || signed_distance || inside; }
  bool asks_for_sides() const { return signed_distance || inside; }
};

/// The files' contents.
template <class S>
struct scene {
  io::mesh_data<S> mesh;
  io::sphere_data<S> spheres;
  S radius = 0;                  ///< of all spheres, if the file has none
  io::rounding tally;            ///< of all numbers
  bool coarse = false;           ///< true if rounding moved one by more than a thousandth of the smallest radius
  std::size_t first_sphere = 0;  ///< how many the ranks before have
  std::size_t all_spheres = 0;   ///< of all ranks
};

/// Results of a detection: the pairs, the contacts or the answers about points, if somebody wants them, and what it
/// cost.
template <class S>
struct findings {
  std::uint64_t total = 0;  ///< pairs; points that are inside, or have a nearest triangle
  std::vector<collide::pair> pairs;
  std::vector<collide::contact<S>> contacts;
  std::vector<collide::nearest_triangle<S>> nearest;  ///< of each point; signed or not
  std::vector<std::uint8_t> inside;                   ///< of each point
  std::vector<double> build_ms, query_ms, total_ms;
  std::size_t peak_bytes = 0;
  int threads = 1;
  double cell_width = 0;
  std::string device;
};

/// Throws unless this program has the space of that name, and this computer the device.
void require_space(std::string const& name);

/// Makes a device of the space that of this thread: ranks take them in turn.
void take_device(std::string const& space, int rank);

/// Detects with the composition that the options name. It is instantiated in a file for each scalar type.
template <class S>
findings<S> detect(options const& wish, scene<S> const& from);

}  // namespace detection
