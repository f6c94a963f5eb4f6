/// \file
/// The scenes on which the price of accuracy is measured for particles that move: elastic balls that fall about inside
/// a closed mesh, and where each of them truly is in the end.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/simulation.cuh>

#include "io/scenes.hpp"
#include "stopwatch.hpp"

namespace bench {

using vec = collide::vec3<double>;

/// Radius of all balls, acceleration downwards, and how long they fly.
constexpr double ball_radius = 3, gravity = 100, seconds = 2;
constexpr int frames_per_second = 60, frames = static_cast<int>(seconds * frames_per_second);

/// How far balls move in a frame when they start, in radii: as many in each octave.
constexpr double slowest = 1.0 / 16, fastest = 16;

/// A closed mesh, and what is inside.
struct arena {
  char const* name;
  io::scene (*mesh)();
  vec (*start)(io::random_numbers&);       ///< a point inside, clear of the mesh
  bool (*is_inside)(vec const&);           ///< of centres that are not within a part of a radius of the mesh
  vec (*end)(vec const& x, vec const& v);  ///< where a ball truly is in the end; null: there is no closed form
};

// ---- a cube that stands askew: on each of its axes a ball falls, or rises, between two walls

constexpr double half_width = 50;

inline Eigen::Matrix3d const& turn() {
  static Eigen::Matrix3d const made = Eigen::AngleAxisd(0.6, vec(0.48, 0.6, 0.64)).toRotationMatrix();
  return made;
}

inline io::scene cube_mesh() {
  constexpr int n = 24;
  io::scene s;
  for (int axis = 0; axis < 3; ++axis) {
    for (double const side : {-half_width, half_width}) {
      io::add_surface(s, n, n, false, [&](double across, double along) {
        vec p;
        p[axis] = side;
        p[(axis + 1) % 3] = half_width * (2 * across - 1);
        p[(axis + 2) % 3] = half_width * (2 * along - 1);
        p = turn() * p;
        return io::point{p.x(), p.y(), p.z()};
      });
    }
  }
  return s;
}

inline vec cube_start(io::random_numbers& random) {
  io::point const p = random.in_cube(half_width - 1.5 * ball_radius);
  return turn() * vec(p[0], p[1], p[2]);
}

inline bool is_in_cube(vec const& x) { return (turn().transpose() * x).cwiseAbs().maxCoeff() < half_width; }

/// The first time above 0 at which x + v t + a t^2 / 2 = 0, or infinity.
inline double first_zero(double x, double v, double a) {
  double first = std::numeric_limits<double>::infinity();
  double const square = v * v - 2 * a * x;
  if (square < 0) return first;
  double const q = -(v + std::copysign(std::sqrt(square), v));
  for (double const t : {q / a, 2 * x / q}) {
    if (t > 0 && t < first) first = t;
  }
  return first;
}

/// Where a point is after `t` that falls with `a` between elastic walls at -wall and wall.
inline double between_walls(double x, double v, double a, double wall, double t) {
  for (;;) {
    double const lower = first_zero(x + wall, v, a), upper = first_zero(x - wall, v, a),
                 impact = std::min(lower, upper);
    if (impact >= t) return x + v * t + a * t * t / 2;
    x = lower < upper ? -wall : wall;
    v = -(v + a * impact);
    t -= impact;
  }
}

inline vec cube_end(vec const& x, vec const& v) {
  vec const from = turn().transpose() * x, with = turn().transpose() * v, a = turn().transpose() * vec(0, 0, -gravity);
  vec to;
  for (int k = 0; k < 3; ++k) to[k] = between_walls(from[k], with[k], a[k], half_width - ball_radius, seconds);
  return turn() * to;
}

// ---- the study's torus

inline io::scene torus_mesh() { return io::study_scene(0); }

inline vec torus_start(io::random_numbers& random) {
  double const u = random.between(0, 2 * io::pi), v = random.between(0, 2 * io::pi);
  double const r = 95 * std::sqrt(random.unit()), d = 300 + r * std::cos(v);
  return {d * std::cos(u), d * std::sin(u), r * std::sin(v)};
}

/// As io::add_torus has it.
inline bool is_in_torus(vec const& x) {
  double const u = std::atan2(x.y(), x.x()), d = std::hypot(x.x(), x.y()) - 300, v = std::atan2(x.z(), d);
  return std::hypot(d, x.z()) < 120 * (1 + 0.12 * std::sin(5 * u) * std::cos(3 * v));
}

inline constexpr arena cube{"cube", cube_mesh, cube_start, is_in_cube, cube_end};
inline constexpr arena torus{"torus", torus_mesh, torus_start, is_in_torus, nullptr};

// ---- balls, and what becomes of them

/// The mesh of an arena and balls in it, with coordinates of type `S` that all are floats.
template <class S>
struct crowd {
  std::vector<S> vertices, centres, velocities;
  std::vector<std::uint32_t> corners;

  crowd(arena const& in, std::size_t balls) {
    io::scene const s = in.mesh();
    corners = s.corners;
    for (double const x : s.vertices) vertices.push_back(static_cast<float>(x));
    io::random_numbers random(1);
    for (std::size_t i = 0; i < balls; ++i) {
      vec const x = in.start(random);
      double const speed = ball_radius * frames_per_second * slowest * std::pow(fastest / slowest, random.unit());
      double const up = random.between(-1, 1), around = random.between(0, 2 * io::pi);
      double const level = speed * std::sqrt(1 - up * up);
      for (int k = 0; k < 3; ++k) centres.push_back(static_cast<float>(x[k]));
      for (double const v : {level * std::cos(around), level * std::sin(around), speed * up}) {
        velocities.push_back(static_cast<float>(v));
      }
    }
  }

  collide::mesh_view<S> mesh() const {
    return collide::indexed_mesh(vertices.data(), vertices.size() / 3, corners.data(), corners.size() / 3);
  }
  collide::sphere_view<S> balls() const {
    return collide::spheres_xyz(centres.data(), centres.size() / 3, ball_radius);
  }
  /// Where nothing can be below.
  double bottom() const {
    double lowest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 2; i < vertices.size(); i += 3) lowest = std::min(lowest, static_cast<double>(vertices[i]));
    return lowest;
  }
};

template <class S>
vec at(std::vector<S> const& xyz, std::size_t i) {
  return collide::vec3<S>(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]).template cast<double>();
}
/// Where the balls of an arena are in the end: by closed form, or by steps so small, with double coordinates, that
/// twice as large ones hardly matter.
struct truth {
  std::vector<double> end;
  double doubt;  ///< median distance, in radii, from where balls get with steps twice as large; 0 for a closed form

  truth(arena const& in, std::size_t balls, int sub_steps) : doubt{0} {
    crowd<double> const made(in, balls);
    if (in.end != nullptr) {
      for (std::size_t i = 0; i < balls; ++i) {
        vec const x = in.end(at(made.centres, i), at(made.velocities, i));
        end.insert(end.end(), x.begin(), x.end());
      }
      return;
    }
    end = simulated(made, sub_steps);
    std::vector<double> const coarser = simulated(made, sub_steps / 2);
    std::vector<double> away;
    for (std::size_t i = 0; i < balls; ++i) away.push_back((at(end, i) - at(coarser, i)).norm() / ball_radius);
    doubt = median(away);
  }

 private:
  static std::vector<double> simulated(crowd<double> const& from, int sub_steps) {
    using detector = collide::detector<collide::bucket, collide::karabassi<>, collide::host, double>;
    collide::simulation<detector, collide::velocity_verlet, collide::gravity, collide::bounce> made(
        collide::host(1), collide::velocity_verlet{}, collide::gravity{0, 0, -gravity}, collide::bounce{1});
    made.set(from.balls(), from.velocities.data());
    made.set_mesh(from.mesh());
    made.steps(static_cast<std::size_t>(frames * sub_steps), 1.0 / (frames_per_second * sub_steps));
    return made.to_host<collide::position>();
  }
};

/// Errors of the balls after a simulation.
struct outcome {
  double error;      ///< median distance from where they truly are, in radii
  double drift;      ///< mean relative change of the energy of those inside
  double scatter;    ///< median of its magnitude
  double tunnelled;  ///< how many are outside

  template <class S>
  outcome(arena const& in, crowd<S> const& begin, truth const& true_end, std::vector<S> const& x,
          std::vector<S> const& v)
      : drift{0}, tunnelled{0} {
    double const bottom = begin.bottom();
    auto const energy = [&](auto const& positions, auto const& velocities, std::size_t i) {
      return at(velocities, i).squaredNorm() / 2 + gravity * (at(positions, i).z() - bottom);
    };
    std::vector<double> away, change;
    for (std::size_t i = 0; i < x.size() / 3; ++i) {
      bool const inside = in.is_inside(at(x, i));
      tunnelled += !inside;
      if (3 * i < true_end.end.size()) away.push_back((at(x, i) - at(true_end.end, i)).norm() / ball_radius);
      if (!inside) continue;
      double const before = energy(begin.centres, begin.velocities, i);
      change.push_back((energy(x, v, i) - before) / before);
      drift += change.back();
    }
    error = median(away);
    if (change.empty()) change.push_back(0);
    drift /= static_cast<double>(change.size());
    for (double& c : change) c = std::abs(c);
    scatter = median(change);
  }
};

}  // namespace bench
