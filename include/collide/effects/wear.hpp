/// \file
/// Effect: how hard grains press on each triangle of the mesh, and how they slide on it.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <collide/core/memory.hpp>
#include <collide/effects/detail/column_list.hpp>
#include <collide/effects/effect.hpp>
#include <collide/effects/granular/materials.hpp>
#include <collide/spaces/atomic_add.hpp>

namespace collide {

/// By how much the mesh has changed a particle's velocity in the step, by the contacts before; see `wear`.
struct worn_by : detail::vector_column {};

/// The load of a triangle, as `wear_sums` reads it.
struct triangle_load {
  double normal_impulse = 0;  ///< of all forces along normals, force times time; over area and time the mean pressure
  double sliding_work = 0;    ///< of all forces along the surface; times K / (friction hardness) Archard's worn volume
};

/// Sums up what `granular_contact`, which is before it in the list, gives to each triangle: forces along the normal of
/// the contact times dt, and the work of forces along the surface, by the velocity with which the particle's surface
/// slides against the mesh's. The first step counts the forces at its start, too. Springs that give back what they took
/// count below 0: J. F. Archard, Journal of Applied Physics 24, 1953, counts what slides. It is made by `wear_sums`,
/// which has its memory. Three scalars a particle.
///
/// \tparam Materials  whose masses: `one_density`, or that of `granular_contact`
template <class Materials = one_density>
struct wear {
  using reads = detail::union_of<columns<velocity, angular_velocity>, typename Materials::reads>;
  using writes = columns<worn_by>;
  static constexpr bool needs_solid_mesh = true;   ///< `granular_contact` is before it in the list
  static constexpr bool begins_on_ranks = true;    ///< `begin_step` does its work whatever rank a particle is on
  static constexpr bool saves_parameters = false;  ///< they have a pointer

  Materials made_of{};           ///< densities
  double unit_of_impulse = 0;    ///< each contact is rounded to a multiple
  double unit_of_work = 0;       ///< each contact is rounded to a multiple
  std::int64_t* sums = nullptr;  ///< memory of the space, of `wear_sums`
  std::size_t triangles = 0;     ///< of how many there are sums

  void check_parameters() const {
    made_of.check_parameters();
    detail::check_parameter(
        detail::is_positive(unit_of_impulse) && detail::is_positive(unit_of_work) && sums != nullptr,
        "wear: units are above 0, and finite, and wear_sums makes the effect");
  }

  template <class Space, class State, class S>
  void begin_step(Space& space, State const& state, S) const {
    space.fill(state.at(worn_by{}), 0, 3 * state.size * sizeof(S));
  }
  template <class Particle, class Seen, class S>
  COLLIDE_HD_INLINE void on_mesh_overlap(Particle& p, Seen const& self, mesh_overlap<S> const& wall, S dt) const {
    vec3<S> const all = p[velocity{}] - self[velocity{}], change = all - p[worn_by{}];
    p[worn_by{}] = all;
    if (wall.triangle >= triangles) return;
    S const r = self.radius(), along = detail::dot(change, wall.normal);
    vec3<S> const aside = change - wall.normal * along;
    vec3<S> const relative = self[velocity{}] + all * S(0.5) - wall.surface_velocity;  // in the middle of the kick
    vec3<S> const turning = (self[angular_velocity{}] + p[angular_velocity{}]) * S(0.5);
    vec3<S> const turned = detail::cross(turning, vec3<S>(wall.normal * (wall.overlap / 2 - r)));
    double const mass = detail::sphere_mass(1.0, static_cast<double>(r)) * made_of.template density_of<double>(self);
    double const work = -static_cast<double>(detail::dot(aside, vec3<S>(relative + turned))) * mass;
    add(sums + 2 * std::size_t{wall.triangle}, static_cast<double>(along) * mass, unit_of_impulse);
    add(sums + 2 * std::size_t{wall.triangle} + 1, work, unit_of_work);
    (void)dt;
  }

 private:
  static COLLIDE_HD_INLINE void add(std::int64_t* to, double x, double unit) {
    double const count = std::floor(detail::div_rn(x, unit) + 0.5);
    if (count != 0 && count > -0x1p61 && count < 0x1p61) atomic_add(to, static_cast<std::int64_t>(count));
  }
};

/// The memory in which `wear` sums up, as integers: the same in any order. It must outlive the steps of the simulation
/// that has its effect.
class wear_sums {
 public:
  /// For so many triangles, from the first on. Each contact of a step is rounded to multiples of the units, which are
  /// above 0; sums hold 9e18 of them. Allocates 16 bytes a triangle in the space.
  template <class Space>
  wear_sums(Space const& space, std::size_t triangles, double unit_of_impulse, double unit_of_work)
      : triangles_{triangles}, unit_of_impulse_{unit_of_impulse}, unit_of_work_{unit_of_work} {
    sums_.reserve(space.resource(), 2 * triangles + 1);
    clear(space);
  }
  /// The effect, for particles of a density, or of materials.
  template <class Materials = one_density>
  wear<Materials> effect(Materials const& made_of) const {
    return {made_of, unit_of_impulse_, unit_of_work_, sums_.data(), triangles_};
  }
  /// Begins anew, after the work that is on the stream of a space. Does not wait.
  template <class Space>
  void clear(Space const& space) {
    space.fill(sums_.data(), 0, (2 * triangles_ + 1) * sizeof(std::int64_t));
  }
  /// The loads of all triangles since `clear`. On ranks each has its own, to be added. Waits.
  template <class Space>
  std::vector<triangle_load> read(Space const& space) const {
    std::vector<std::int64_t> counts(2 * triangles_);
    if (triangles_ != 0) space.copy_to_host(counts.data(), sums_.data(), counts.size());
    std::vector<triangle_load> found(triangles_);
    for (std::size_t t = 0; t < triangles_; ++t)
      found[t] = {static_cast<double>(counts[2 * t]) * unit_of_impulse_,
                  static_cast<double>(counts[2 * t + 1]) * unit_of_work_};
    return found;
  }

 private:
  std::size_t triangles_;
  double unit_of_impulse_, unit_of_work_;
  buffer<std::int64_t> sums_;
};

}  // namespace collide
