/// \file
/// Puts clumps into a simulation, and says where they are.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/core/memory.hpp>
#include <collide/effects/clumps.hpp>
#include <collide/simulation/clump_shape.hpp>
#include <collide/spheres.hpp>

namespace collide {

template <class Detector, class... Effect>
class simulation;

/// A clump in space.
struct placed_clump {
  std::size_t shape = 0;  ///< its number in the list of shapes
  pose at;                ///< of the frame in which the spheres of the shape were given
  twist moving;           ///< how that moves
  double scale = 1;       ///< by how much larger than its shape it is, above 0
};

/// A clump in each of some spheres, of which x, y, z and the radii are given as by `fill`: with its centre of mass in
/// the middle, as large as it fits, and turned at random, always the same for a seed below 2^24. `number` is that of
/// the shape in the list. Clumps of the size of the shape come of spheres of the radius `shape.reach()`.
inline std::vector<placed_clump> clumps_within(std::vector<double> const& centres, std::vector<double> const& radii,
                                               clump_shape const& shape, std::uint64_t seed = 0,
                                               std::size_t number = 0) {
  std::vector<placed_clump> placed(radii.size());
  double const reach = shape.reach();
  for (std::size_t i = 0; i < radii.size(); ++i) {
    placed_clump& c = placed[i];
    c.shape = number;
    c.scale = radii[i] / reach;
    turn_at_random(c.at.rotation, (seed << 20) + i);
    double const* const middle = shape.frame.position;
    vec3<double> const arm =
        detail::rotated(c.at.rotation, vec3<double>(middle[0] * c.scale, middle[1] * c.scale, middle[2] * c.scale));
    for (std::size_t k = 0; k < 3; ++k) c.at.position[k] = centres[3 * i + k] - arm[int(k)];
  }
  return placed;
}

namespace detail {

/// Numbers in memory of a space.
template <class T, class Space>
buffer<T> copied_to(Space const& space, std::vector<T> const& from) {
  buffer<T> to;
  space.copy_from_host(to.reserve(space.resource(), from.size() + 1), from.data(), from.size());
  return to;
}
template <class Column, class Simulation, class T>
void assign_from_host(Simulation& to, std::vector<T> const& values) {
  auto const there = copied_to(to.space(), values);
  to.template assign<Column>(there.data());
  to.space().synchronize();
}

/// The columns of clumps, on the host.
template <class S>
struct columns_of_clumps {
  std::vector<S> centres, velocities, turnings, radii, masses, offsets, clump_centres, clump_velocities, momenta,
      rotations, inertias;
  std::vector<id> first;
  double reach = 0;
  std::size_t there = 0;  ///< spheres of those that do not wait

  std::size_t size() const { return radii.size(); }

  /// As `set_clumps`.
  void add(std::vector<clump_shape> const& shapes, std::vector<placed_clump> const& placed, std::size_t waiting) {
    for (auto const& shape : shapes) shape.check();
    std::size_t numbers = 0;  // spheres of each that waits
    for (std::size_t i = 0; i < placed.size(); ++i) {
      check_parameter(placed[i].shape < shapes.size(), "set_clumps: the number of a shape is that of one of the list");
      clump_shape const& shape = shapes[placed[i].shape];
      add(shape, placed[i]);
      if (i + waiting < placed.size()) {
        there = size();
      } else {
        check_parameter(numbers == 0 || numbers == shape.spheres.size(),
                        "set_clumps: all clumps that wait have as many spheres");
        numbers = shape.spheres.size();
      }
    }
  }

  /// The number of the first sphere, where others are before.
  void number_from(std::uint64_t number) {
    for (id& of : first)
      if (of != no_id) of += static_cast<id>(number);
  }

  /// Spheres in memory of a space.
  struct spheres_in_space {
    buffer<S> centres, velocities, radii;
    sphere_view<S> view;
  };
  template <class Space>
  spheres_in_space spheres_in(Space const& space) const {
    spheres_in_space found{copied_to(space, centres), copied_to(space, velocities), copied_to(space, radii), {}};
    bool const alike = size() == 0 || std::equal(radii.begin() + 1, radii.end(), radii.begin());
    S const* const x = found.centres.data();
    found.view =
        alike ? spheres_xyz(x, size(), size() == 0 ? S(1) : radii[0]) : spheres_xyz(x, size(), found.radii.data());
    return found;
  }

  /// Gives a simulation, whose places are these spheres, all else.
  template <class Simulation>
  void assign_to(Simulation& to) const {
    check_parameter(there == size() || Simulation::effects_type::makes,
                    "set_clumps: clumps wait for emit, which is not in the scene");
    to.space().copy_from_host(to.template data<angular_velocity>(), turnings.data(), turnings.size());
    to.space().synchronize();
    to.template effect<clumps>().reach = reach;
    assign_from_host<clump_mass>(to, masses);
    assign_from_host<clump_offset>(to, offsets);
    assign_from_host<clump_centre>(to, clump_centres);
    assign_from_host<clump_velocity>(to, clump_velocities);
    assign_from_host<clump_momentum>(to, momenta);
    assign_from_host<clump_rotation>(to, rotations);
    assign_from_host<clump_inertia>(to, inertias);
    assign_from_host<in_clump>(to, first);
    if constexpr (Simulation::effects_type::makes)
      to.space().fill(to.template data<alive>() + there, 0, size() - there);
  }

 private:
  void add(clump_shape const& shape, placed_clump const& c) {
    pose const& frame = shape.frame;
    double q[4], turn[4] = {c.at.rotation[0], c.at.rotation[1], c.at.rotation[2], c.at.rotation[3]}, squared = 0;
    for (double const x : turn) squared += x * x;
    check_parameter(is_positive(c.scale) && std::abs(squared - 1) < 1e-6,
                    "set_clumps: the scale of a clump is above 0, and its rotation a unit quaternion");
    multiply(q, turn, frame.rotation);
    vec3<double> const arm = rotated(turn, c.scale * in(frame.position)), w = in(c.moving.angular);
    vec3<double> const centre = in(c.at.position) + arm, v = in(c.moving.linear) + cross(w, arm);
    double const inverse[4] = {q[0], -q[1], -q[2], -q[3]}, larger = c.scale * c.scale;
    vec3<double> momentum = rotated(inverse, w);
    for (int k = 0; k < 3; ++k) momentum[k] *= larger * shape.inertia[k];
    momentum = rotated(q, momentum);
    bool const is_clump = shape.spheres.size() > 1;
    double const radius = std::cbrt(shape.volume / sphere_mass(1.0, 1.0));  // of a sphere of the volume
    auto const number = static_cast<id>(first.size());
    for (std::size_t n = 0; n < shape.spheres.size(); ++n) {
      vec3<double> const offset = c.scale * shape.spheres[n].centre, from = rotated(q, offset);
      put(centres, centre + from);
      put(velocities, v + cross(w, from));
      put(turnings, w);
      put(offsets, offset);
      radii.push_back(static_cast<S>(c.scale * shape.spheres[n].radius));
      masses.push_back(static_cast<S>(is_clump ? std::pow(radius / shape.spheres[n].radius, 3) : 1));
      first.push_back(is_clump ? number : no_id);
      bool const is_first = is_clump && n == 0;
      put(clump_centres, is_first * centre);
      put(clump_velocities, is_first * v);
      put(momenta, is_first * momentum);
      for (double const x : q) rotations.push_back(static_cast<S>(is_first * x));
      for (double const x : shape.inertia) inertias.push_back(static_cast<S>(is_first * larger * x));
      inertias.push_back(static_cast<S>(is_first * c.scale * radius));
    }
    reach = std::max(reach, c.scale * shape.reach());
  }

  static vec3<double> in(double const (&x)[3]) { return {x[0], x[1], x[2]}; }
  static void put(std::vector<S>& to, vec3<double> const& x) {
    for (int k = 0; k < 3; ++k) to.push_back(static_cast<S>(x[k]));
  }
  static void multiply(double (&to)[4], double const (&a)[4], double const (&b)[4]) {
    vec3<double> const u(a[1], a[2], a[3]), v(b[1], b[2], b[3]), axis = a[0] * v + b[0] * u + cross(u, v);
    to[0] = a[0] * b[0] - u.dot(v);
    for (int k = 0; k < 3; ++k) to[k + 1] = axis[k];
  }
};

}  // namespace detail

/// Puts clumps into a simulation that names `clumps`, in place of all particles: `set` with their spheres, those of one
/// after those of the other. A shape of one sphere is a grain by itself, and all its bits are those of such a one.
/// Radii that differ need `polydisperse`. The last `waiting` ones are not there yet: each is for one that `emit` makes,
/// turned at random, with its shape and scale; all have as many spheres. Throws `error` if a shape is none, or a
/// rotation is not of length 1, and what `set` throws. Allocates; waits. O(spheres).
template <class Detector, class... Effect>
void set_clumps(simulation<Detector, Effect...>& to, std::vector<clump_shape> const& shapes,
                std::vector<placed_clump> const& placed, std::size_t waiting = 0) {
  detail::columns_of_clumps<typename Detector::scalar> all;
  all.add(shapes, placed, waiting);
  auto const spheres = all.spheres_in(to.space());
  to.set(spheres.view, spheres.velocities.data());
  all.assign_to(to);
  to.internals().particles.placed = all.there;
}

}  // namespace collide
