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

namespace collide {

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

/// The columns of clumps, on the host.
template <class S>
struct columns_of_clumps {
  std::vector<S> centres, velocities, turnings, radii, masses, offsets, clump_centres, clump_velocities, momenta,
      rotations, inertias;
  std::vector<id> first;
  double reach = 0;

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

 private:
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

}  // namespace detail

/// Puts clumps into a simulation that names `clumps`, in place of all particles: `set` with their spheres, those of one
/// after those of the other. A shape of one sphere is a grain by itself, and all its bits are those of such a one.
/// Radii that differ need `polydisperse`. The last `waiting` ones are not there yet: each is for one that `emit` makes,
/// turned at random, with its shape and scale; all have as many spheres. Throws `error` if a shape is none, or a
/// rotation is not of length 1, and what `set` throws. Allocates; waits. O(spheres).
template <class Simulation>
void set_clumps(Simulation& to, std::vector<clump_shape> const& shapes, std::vector<placed_clump> const& placed,
                std::size_t waiting = 0) {
  using S = typename Simulation::scalar;
  for (auto const& shape : shapes) shape.check();
  detail::columns_of_clumps<S> all;
  std::size_t there = 0, numbers = 0;  // spheres of those that do not wait, and of each one that does
  for (std::size_t i = 0; i < placed.size(); ++i) {
    detail::check_parameter(placed[i].shape < shapes.size(),
                            "set_clumps: the number of a shape is that of one of the list");
    clump_shape const& shape = shapes[placed[i].shape];
    all.add(shape, placed[i]);
    if (i + waiting < placed.size()) {
      there = all.radii.size();
    } else {
      detail::check_parameter(numbers == 0 || numbers == shape.spheres.size(),
                              "set_clumps: all clumps that wait have as many spheres");
      numbers = shape.spheres.size();
    }
  }
  auto const& radii = all.radii;
  std::size_t const n = radii.size();
  bool const alike = n == 0 || std::equal(radii.begin() + 1, radii.end(), radii.begin());
  auto const centres = detail::copied_to(to.space(), all.centres),
             velocities = detail::copied_to(to.space(), all.velocities), own = detail::copied_to(to.space(), radii);
  to.set(alike ? spheres_xyz(centres.data(), n, n == 0 ? S(1) : radii[0]) : spheres_xyz(centres.data(), n, own.data()),
         velocities.data());
  to.space().copy_from_host(to.template data<angular_velocity>(), all.turnings.data(), all.turnings.size());
  to.space().synchronize();
  to.template effect<clumps>().reach = all.reach;
  detail::assign_from_host<clump_mass>(to, all.masses);
  detail::assign_from_host<clump_offset>(to, all.offsets);
  detail::assign_from_host<clump_centre>(to, all.clump_centres);
  detail::assign_from_host<clump_velocity>(to, all.clump_velocities);
  detail::assign_from_host<clump_momentum>(to, all.momenta);
  detail::assign_from_host<clump_rotation>(to, all.rotations);
  detail::assign_from_host<clump_inertia>(to, all.inertias);
  detail::assign_from_host<in_clump>(to, all.first);
  if (there == n) return;
  detail::check_parameter(Simulation::effects_type::makes,
                          "set_clumps: clumps wait for emit, which is not in the scene");
  if constexpr (Simulation::effects_type::makes) to.space().fill(to.template data<alive>() + there, 0, n - there);
  to.internals().particles.placed = there;
}

}  // namespace collide
