/// \file
/// Effect: the forces and torques with which particles act on bodies.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <collide/core/error.hpp>
#include <collide/core/memory.hpp>
#include <collide/effects/effect.hpp>
#include <collide/spaces/atomic_add.hpp>

namespace collide {

struct bounce;
struct friction;
struct spin;
struct adhesion;

/// The impulse that a body, or a triangle, has got from all particles, force times time, and its moment about the
/// origin of space. About a point x it is angular - x x linear.
struct body_impulse {
  double linear[3] = {0, 0, 0};   ///< impulse, mass times velocity
  double angular[3] = {0, 0, 0};  ///< moment of it about the origin
};

namespace detail {

/// Sums as integers, which do not depend on the order.
struct impulse_counts {
  std::int64_t count[6];
};

[[noreturn]] inline void throw_too_many_units() {
  throw error("collide: reaction_sums: a sum is more than 9e18 units: choose a larger unit, or clear more often");
}

}  // namespace detail

/// Sums up what the particles give to each body, which touch it, stick to it or sleep on it: minus mass times the
/// change of their velocities, and minus that of their angular momentum about the origin. So both of particles and
/// bodies together are conserved; without `spin` particles do not turn, and what would turn them goes to the body. It
/// is made by `reaction_sums`, which has its memory. Its place in the list does not matter. A contact that gives what
/// is not finite, or 2e18 units or more, is in no sum: `reaction_sums::refused` counts it.
struct reaction {
  static constexpr bool saves_parameters = false;  ///< what has been summed is not of the state that steps depend on
  static constexpr std::size_t copies = 256;       ///< of the sums, so that particles do not wait for each other

  double density = 1;                      ///< mass per volume
  double unit = 0;                         ///< of impulse, and of its moment: each contact is rounded to a multiple
  detail::impulse_counts* sums = nullptr;  ///< memory of the space, of `reaction_sums`
  detail::impulse_counts* sums_of_triangles = nullptr;  ///< memory of the space, of `reaction_sums`
  std::size_t triangles = 0;                            ///< of how many there are sums
  std::size_t bodies = 0;                               ///< of how many there are sums
  std::int64_t* refused = nullptr;                      ///< memory of the space: contacts that are in no sum

  void check_parameters() const {
    detail::check_parameter(detail::is_positive(density) && detail::is_positive(unit) && sums != nullptr,
                            "reaction: density and unit are above 0, and finite, and reaction_sums makes the effect");
  }
  /// The sums of the bodies of a simulation's mesh.
  void check_bodies(std::size_t of_mesh) const {
    detail::check_parameter(of_mesh <= bodies, "reaction: the mesh has more bodies than reaction_sums was made for");
  }

  template <class Particle, class S>
  COLLIDE_HD_INLINE void on_mesh_impulse(Particle& p, mesh_impulse<S> const& t, S) const {
    add_impulse(p, t, density);
  }

 protected:
  /// Adds what a particle of a density has given.
  template <class Particle, class S>
  COLLIDE_HD_INLINE void add_impulse(Particle& p, mesh_impulse<S> const& t, double of_density) const {
    using namespace detail;
    double const radius = static_cast<double>(p.radius()), mass = div_rn(sphere_mass(of_density, radius), unit);
    vec3<double> const change = t.change.template cast<double>(), turn = t.spin_change.template cast<double>();
    vec3<double> const centre = t.centre.template cast<double>(), shift = t.shift.template cast<double>();
    vec3<double> const velocity = t.velocity.template cast<double>(), impulse = scaled(change, -mass);
    vec3<double> const moment = cross(centre, impulse) - scaled(cross(shift, velocity), mass) -
                                scaled(turn, mul_rn(0.4 * mass, mul_rn(radius, radius)));
    bool const has_counts = dot(impulse, impulse) + dot(moment, moment) < max_squared;  // false for NaN
    if (!has_counts) {
      atomic_add(refused, 1);
      return;
    }
    std::size_t const body = t.body == no_id ? 0 : std::size_t{t.body} + 1;
    add(sums[body * copies + p.number() % copies], impulse, moment);
    std::size_t const number = t.triangle;
    if (number < triangles) add(sums_of_triangles[number], impulse, moment);
  }

 private:
  static constexpr double max_squared = 0x1p122;  ///< of units: each fits into 64 bits

  static COLLIDE_HD_INLINE void add(detail::impulse_counts& to, vec3<double> const& impulse,
                                    vec3<double> const& moment) {
    for (int k = 0; k < 3; ++k) {
      add(to.count[k], impulse[k]);
      add(to.count[k + 3], moment[k]);
    }
  }
  static COLLIDE_HD_INLINE void add(std::int64_t& to, double x) {
    if (x != 0) atomic_add(&to, static_cast<std::int64_t>(std::floor(x + 0.5)));
  }
};

/// `reaction` of particles of several materials, those of `granular_contact`.
template <class Materials>
struct reaction_of : reaction {
  using reads = typename Materials::reads;

  Materials made_of{};  ///< densities

  template <class Particle, class S>
  COLLIDE_HD_INLINE void on_mesh_impulse(Particle& p, mesh_impulse<S> const& t, S) const {
    add_impulse(p, t, made_of.template density_of<double>(p));
  }
};

/// The memory in which `reaction` sums up: of each body, and of what rests; of each triangle, if asked. The same
/// contacts give the same bits, in any order. Sums hold 9e18 units: `error` if what is read is more, but one of the 256
/// parts of a sum that alone gets more is wrong. It must outlive the steps of the simulation that has its effect.
class reaction_sums {
 public:
  /// For so many bodies; a step of a mesh with more is refused (`error`). `unit` is the impulse to which each contact
  /// is rounded, and the moment: a sum may be off by half a unit for each contact of a step. It is above 0, else a step
  /// throws `error`. `triangles`: for how many of the mesh, from the first on, there are sums too. Allocates 12 KB a
  /// body, as much for what rests, and 48 bytes a triangle in the space.
  template <class Space>
  reaction_sums(Space const& space, std::size_t bodies, double unit, std::size_t triangles = 0)
      : bodies_{bodies}, triangles_{triangles}, unit_{unit} {
    sums_.reserve(space.resource(), size());
    clear(space);
  }

  /// The effect, for particles of a density.
  reaction effect(double density) const {
    return {density, unit_, sums_.data(), sums_.data() + of_bodies(), triangles_, bodies_, refused_count()};
  }

  /// The effect, for particles of materials.
  template <class Materials, class = typename Materials::reads>
  reaction_of<Materials> effect(Materials const& made_of) const {
    return {effect(1.0), made_of};
  }

  /// Begins anew, after the work that is on the stream of a space. Does not wait.
  template <class Space>
  void clear(Space const& space) {
    space.fill(sums_.data(), 0, size() * sizeof(detail::impulse_counts));
  }

  /// The impulse of each body since `clear`, and last that of what rests. Over the time since then it is the mean
  /// force. Throws `error` if a sum is 9e18 units or more. Waits.
  template <class Space>
  std::vector<body_impulse> read(Space const& space) const {
    return impulses(counts(space));
  }

  /// How many contacts since `clear` are in no sum, because what they gave is not finite, or 2e18 units or more: the
  /// unit is too small, or particles too fast. Waits.
  template <class Space>
  std::uint64_t refused(Space const& space) const {
    return static_cast<std::uint64_t>(space.read(refused_count()));
  }

  /// The sums of each body, and last of what rests, as multiples of the unit: six numbers each. Those of several ranks
  /// may be added. Throws `error` if one is 9e18 or more. Waits.
  template <class Space>
  std::vector<std::int64_t> counts(Space const& space) const {
    std::vector<detail::impulse_counts> all(of_bodies());
    space.copy_to_host(all.data(), sums_.data(), all.size());
    std::vector<std::int64_t> found(6 * (bodies_ + 1));
    for (std::size_t b = 0; b <= bodies_; ++b) {
      auto const* const of = all.data() + (b + 1) % (bodies_ + 1) * reaction::copies;
      for (std::size_t i = 0; i < reaction::copies; ++i) {
        for (std::size_t k = 0; k < 6; ++k) {
          std::int64_t& sum = found[6 * b + k];
          if (__builtin_add_overflow(sum, of[i].count[k], &sum)) detail::throw_too_many_units();
        }
      }
    }
    return found;
  }

  /// The sums of each triangle since `clear`, as multiples of the unit: six numbers each. Waits.
  template <class Space>
  std::vector<std::int64_t> triangle_counts(Space const& space) const {
    std::vector<detail::impulse_counts> all(triangles_);
    space.copy_to_host(all.data(), sums_.data() + of_bodies(), all.size());
    std::vector<std::int64_t> found;
    for (detail::impulse_counts const& one : all) found.insert(found.end(), one.count, one.count + 6);
    return found;
  }

  /// The impulse of each triangle since `clear`. Waits.
  template <class Space>
  std::vector<body_impulse> read_triangles(Space const& space) const {
    return impulses(triangle_counts(space));
  }

  /// The value of counts, in units of impulse.
  std::vector<body_impulse> impulses(std::vector<std::int64_t> const& counts) const {
    std::vector<body_impulse> found(counts.size() / 6);
    for (std::size_t b = 0; b < found.size(); ++b) {
      for (std::size_t k = 0; k < 3; ++k) {
        found[b].linear[k] = static_cast<double>(counts[6 * b + k]) * unit_;
        found[b].angular[k] = static_cast<double>(counts[6 * b + 3 + k]) * unit_;
      }
    }
    return found;
  }

 private:
  std::size_t of_bodies() const { return (bodies_ + 1) * reaction::copies; }
  std::size_t size() const { return of_bodies() + triangles_ + 1; }
  std::int64_t* refused_count() const { return sums_.data()[of_bodies() + triangles_].count; }

  std::size_t bodies_, triangles_;
  double unit_;
  buffer<detail::impulse_counts> sums_;
};

}  // namespace collide
