/// \file
/// The part of the programs that show scenes which is compiled once: the film, the command line, the files.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <collide/effects/bodies.hpp>
#include <collide/io/vtk.hpp>

#include "ranks.hpp"
#include "scenes/scene.hpp"

namespace io {

/// A sphere that is there when a film begins.
struct first_sphere {
  double centre[3], velocity[3], radius;
};

/// A film: what it shows, and what the command line says of it.
struct film {
  char const* name;
  char const* about;
  scene stage;                          ///< the mesh, and the radius of the particles
  double dt;                            ///< a step
  std::size_t particles;                ///< how many there are at most
  double seconds;                       ///< of the scene's time
  double pouring = 1;                   ///< for which part of them there are new particles
  std::size_t frames = 100, until = 0;  ///< how many pictures there are, and after how many to stop; 0: after all
  std::string space = "host", output = "", report = "", save = "", load = "", ranks = "";
  int threads = 0;
  std::vector<collide::body> bodies =
      {};  ///< parts of the mesh that move; no triangle of one shares a vertex with others
  std::vector<first_sphere> (*first)(film const&) = nullptr;  ///< besides the particles; for scenes with `polydisperse`

  /// How many steps there are, and after how many of them nothing more comes.
  std::size_t steps() const { return static_cast<std::size_t>(std::ceil(seconds / dt)); }
  std::size_t pouring_steps() const { return static_cast<std::size_t>(std::ceil(pouring * seconds / dt)); }
  /// After how many steps picture number `i` is taken, if the one before was taken after `done`.
  std::size_t picture(std::size_t i, std::size_t done) const { return std::max(done + 1, steps() * (i + 1) / frames); }
  /// How many particles must come a second, for all to have come then.
  double rate() const {
    double const simulated = static_cast<double>(static_cast<float>(dt)) * static_cast<double>(pouring_steps());
    return (static_cast<double>(particles) + 0.5) / simulated;
  }
};

/// Makes a body of the triangles that the stage has got since the body before.
inline void add_body(film& of, collide::body_motion const& motion) {
  std::size_t const first = of.bodies.empty() ? 0 : of.bodies.back().first + of.bodies.back().size;
  of.bodies.push_back({first, of.stage.triangle_count() - first, motion});
}

/// A motion around an axis through a point.
inline collide::body_motion turning(point const& pivot, point const& axis, double rate) {
  collide::body_motion m;
  std::copy(pivot.begin(), pivot.end(), m.pivot);
  std::copy(axis.begin(), axis.end(), m.axis);
  m.rate = rate;
  return m;
}

/// Where particle number 0, 1, 2, ... of a source begins, in coordinates between -1 and 1. Those of `evenly` are spread
/// over the square such that numbers that follow each other are far apart, so that particles do not overlap when they
/// begin (M. Roberts' sequence R2); those of `anyhow` have no order.
struct spot {
  double evenly[2], anyhow[2];

  COLLIDE_HD explicit spot(std::uint64_t number) {
    double const i = static_cast<double>(number), slope[] = {0.7548776662466927, 0.5698402909980532};
    for (int k = 0; k < 2; ++k) {
      evenly[k] = 2 * fraction(slope[k] * i) - 1;
      anyhow[k] = 2 * fraction(fraction(slope[k] * i) * i) - 1;  // of large numbers, too, some fraction is left
    }
  }

 private:
  static COLLIDE_HD double fraction(double x) { return x - static_cast<double>(static_cast<std::uint64_t>(x)); }
};

/// The cost of a film.
struct film_cost {
  std::size_t steps;
  double milliseconds_per_step;
  std::size_t bytes_per_particle;
  int threads, ranks;
  std::string device;
};

/// Says what a film has cost, also in the file of `--report`.
void report(film const& of, film_cost const& cost);

/// Writes the triangles of the stage.
void write_mesh(std::string const& path, std::vector<float> const& vertices, std::vector<std::uint32_t> const& corners);

/// The vertices of a stage, where its bodies have been taken.
std::vector<float> moved_vertices(film const& of, std::vector<collide::body_state> const& states);

/// The files of picture number `i`.
collide::vtk_frame next_frame(film const& of, std::size_t i, double time);

/// The program of a film: reads the command line into it. On each of the ranks that are wished for it calls
/// take(film, rank), which makes the device of a rank current and throws if there is no such space here, and then
/// shoot(film, ranks); with null if there is one.
int run_film(int argc, char** argv, film wish, std::function<void(film const&, int)> const& take,
             std::function<void(film const&, any_ranks const*)> const& shoot);

}  // namespace io
