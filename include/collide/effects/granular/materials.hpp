/// \file
/// Materials of granular particles and walls.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <collide/effects/effect.hpp>

namespace collide {

/// An elastic solid.
struct solid {
  double young;    ///< Young's modulus, force per area, above 0
  double poisson;  ///< Poisson's ratio, -1 < poisson <= 0.5
  double density;  ///< mass per volume, above 0
};

/// The constants of a contact of two solids.
struct surface_pair {
  double restitution = 1;       ///< coefficient of restitution, 0 < restitution <= 1
  double friction = 0;          ///< coefficient of sliding friction, not negative
  double rolling_friction = 0;  ///< coefficient of rolling friction, a ratio of lengths, not negative
  double cohesion = 0;  ///< `sjkr`: energy per volume; `jkr`, `dmt`: surface energy, energy per area; not negative
};

namespace detail {

/// Two solids and their surfaces as laws of contact need them.
struct contact_material {
  double young = 0;    ///< effective: 1/E* = (1 - nu_i^2) / E_i + (1 - nu_j^2) / E_j; 0: nobody has said
  double shear = 0;    ///< effective: 1/G* = (2 - nu_i) / G_i + (2 - nu_j) / G_j
  double damping = 0;  ///< beta = -ln e / sqrt(ln^2 e + pi^2), 0 to 1
  double friction = 0, rolling_friction = 0, cohesion = 0;

  contact_material() = default;
  contact_material(solid const& a, solid const& b, surface_pair const& p)
      : friction{p.friction}, rolling_friction{p.rolling_friction}, cohesion{p.cohesion} {
    set_solids(a, b);
    constexpr double pi = 3.14159265358979323846;
    double const log_e = std::log(p.restitution);
    damping = p.restitution < 1 ? -log_e / std::sqrt(log_e * log_e + pi * pi) : 0;
  }
  /// Takes other solids, with the same surfaces.
  void set_solids(solid const& a, solid const& b) {
    young = 1 / ((1 - a.poisson * a.poisson) / a.young + (1 - b.poisson * b.poisson) / b.young);
    shear = 1 / (2 * (1 + a.poisson) * (2 - a.poisson) / a.young + 2 * (1 + b.poisson) * (2 - b.poisson) / b.young);
  }
};

inline void check(solid const& s) {
  check_parameter(is_positive(s.young) && is_positive(s.density),
                  "materials: Young's modulus and density of a solid are above 0, and finite");
  check_parameter(s.poisson > -1 && s.poisson <= 0.5, "materials: Poisson's ratio is above -1, and at most 0.5");
}
inline void check(surface_pair const& p) {
  check_parameter(p.restitution > 0 && p.restitution <= 1,
                  "materials: the coefficient of restitution is above 0, and at most 1");
  check_parameter(is_amount(p.friction) && is_amount(p.rolling_friction) && is_amount(p.cohesion),
                  "materials: friction, rolling friction and cohesion of a pair are not negative, and finite");
}

}  // namespace detail

/// The mass per volume of particles that all have the same: in place of `materials` where an effect asks for masses
/// only.
struct one_density {
  using reads = columns<>;

  double density = 1;  ///< mass per volume, above 0

  void check_parameters() const {
    detail::check_parameter(detail::is_positive(density), "one_density: density is above 0, and finite");
  }
  template <class S, class Particle>
  COLLIDE_HD_INLINE S density_of(Particle const&) const {
    return S(density);
  }
};

/// Particles and walls of one material. There is no column for it.
class one_material {
 public:
  using reads = columns<>;

  /// Throws `error` if a number is out of its range.
  explicit one_material(solid const& of = {1e7, 0.3, 1000}, surface_pair const& surfaces = {}) : solid_{of} {
    detail::check(of);
    detail::check(surfaces);
    pair_ = detail::contact_material(of, of, surfaces);
  }

  void check_parameters() const {}
  /// f(solid, smallest radius of it).
  template <class F>
  double min_of(smallest_radii const& radii, F const& f) const {
    return f(solid_, radii.of_all);
  }

  template <class S, class Particle>
  COLLIDE_HD_INLINE S density_of(Particle const&) const {
    return S(solid_.density);
  }
  static constexpr int pairs = 1;  ///< of solids
  /// The number of a particle's solid, from 0.
  template <class Particle>
  static COLLIDE_HD_INLINE int solid_of(Particle const&) {
    return 0;
  }
  /// The number of the pair of two solids, from 0.
  static COLLIDE_HD_INLINE int pair_of(int, int) { return 0; }
  /// Constants of the pair of solids of a number.
  COLLIDE_HD_INLINE detail::contact_material const& of_pair(int) const { return pair_; }
  template <class Particle>
  COLLIDE_HD_INLINE detail::contact_material const& between(Particle const&, Particle const&) const {
    return pair_;
  }
  template <class Particle>
  COLLIDE_HD_INLINE detail::contact_material const& with_wall(Particle const&, id, id) const {
    return pair_;
  }

 private:
  solid solid_;
  detail::contact_material pair_;
};

/// `N` solids, 1 to 32, and what each pair of them does. Particles have a column `material`, 0 to N - 1: which solid.
/// Walls are of `wall_material`, or of one each triangle or body. A particle of a number that is too large is an
/// `error` in the next `step` after `set` or `assign<material>`, a triangle or a body in `set_mesh`; what is written in
/// place later, or given by way of `effect`, is taken for N - 1.
///
///     materials<2> m;
///     m.set(0, {1e9, 0.2, 2500});
///     m.set(1, {210e9, 0.2, 7200});
///     m.set_pair(0, 0, {0.5, 0.3});   // all of them: also 0-1 and 1-1
template <int N>
class materials {
  static_assert(N >= 1 && N <= 32, "collide: materials has 1 to 32 solids");

 public:
  using reads = columns<material>;

  int wall_material = 0;                             ///< of the mesh, 0 to N - 1
  std::uint8_t const* triangle_materials = nullptr;  ///< of each triangle, in memory of the space; null: all the same
  std::uint8_t const* body_materials = nullptr;      ///< of each body, in memory of the space; null: all the same
  static constexpr bool saves_parameters = false;    ///< they may have pointers

  /// Says what solid number `i` is, also in pairs that are set already. Throws `error` if a number is out of its range.
  void set(int i, solid const& s) {
    check_number(i);
    detail::check(s);
    solids_[i] = s;
    is_set_[i] = true;
    for (int j = 0; j < N; ++j) {
      detail::contact_material& pair = pairs_[pair_of(i, j)];
      if (pair.young > 0) pair.set_solids(solids_[i], solids_[j]);
    }
  }
  /// Says what solids `i` and `j`, which are set, do where they touch. Throws `error` if a number is out of its range.
  void set_pair(int i, int j, surface_pair const& p) {
    check_number(i);
    check_number(j);
    detail::check(p);
    if (!is_set_[i] || !is_set_[j]) throw error("collide: materials: set both solids before their pair");
    pairs_[pair_of(i, j)] = detail::contact_material(solids_[i], solids_[j], p);
  }

  /// Throws `error`, which names the solid or the pair that nobody has set.
  void check_parameters() const {
    detail::check_parameter(wall_material >= 0 && wall_material < N,
                            "materials: wall_material is the number of a solid");
    for (int i = 0; i < N; ++i) {
      for (int j = i; j < N; ++j) {
        if (pairs_[pair_of(i, j)].young > 0) continue;
        throw error("collide: materials: the pair of " + std::to_string(i) + " and " + std::to_string(j) +
                    " is missing: call set_pair");
      }
    }
  }
  /// Throws `error` if particles are of solids up to a number that there is not.
  void check_particles(int largest) const {
    if (largest >= N)
      throw error("collide: materials: a particle is of solid " + std::to_string(largest) + ", and there are " +
                  std::to_string(N));
  }
  /// Throws `error` if one of so many triangles and bodies is of a solid that there is not. Waits.
  template <class Space>
  void check_walls(Space const& space, std::size_t triangles, std::size_t bodies) const {
    check_each(space, triangle_materials, triangles, "triangle ");
    check_each(space, body_materials, bodies, "body ");
  }
  /// The least of f(solid, smallest radius of it) of all solids that particles are of; infinite if there are none.
  template <class F>
  double min_of(smallest_radii const& radii, F const& f) const {
    double found = std::numeric_limits<double>::infinity();
    for (int i = 0; i < smallest_radii::numbers; ++i) {
      double const r = radii.of_material[i];
      if (detail::is_finite(r)) found = std::min(found, f(solids_[std::min(i, N - 1)], r));
    }
    return found;
  }

  template <class S, class Particle>
  COLLIDE_HD_INLINE S density_of(Particle const& p) const {
    return S(solids_[solid_of(p)].density);
  }
  static constexpr int pairs = N * (N + 1) / 2;  ///< of solids
  /// The number of a particle's solid, from 0.
  template <class Particle>
  static COLLIDE_HD_INLINE int solid_of(Particle const& p) {
    int const number = p[material{}];
    return number < N ? number : N - 1;
  }
  /// The number of the pair of two solids, from 0.
  static COLLIDE_HD_INLINE int pair_of(int i, int j) { return i < j ? j * (j + 1) / 2 + i : i * (i + 1) / 2 + j; }
  /// Constants of the pair of solids of a number.
  COLLIDE_HD_INLINE detail::contact_material const& of_pair(int number) const { return pairs_[number]; }
  template <class Particle>
  COLLIDE_HD_INLINE detail::contact_material const& between(Particle const& p, Particle const& other) const {
    return of_pair(pair_of(solid_of(p), solid_of(other)));
  }
  template <class Particle>
  COLLIDE_HD_INLINE detail::contact_material const& with_wall(Particle const& p, id triangle, id body) const {
    int wall = wall_material;
    if (body != no_id && body_materials != nullptr) wall = body_materials[body];
    if (triangle_materials != nullptr) wall = triangle_materials[triangle];
    return pairs_[pair_of(solid_of(p), wall < N ? wall : N - 1)];
  }

 private:
  template <class Space>
  static void check_each(Space const& space, std::uint8_t const* numbers, std::size_t n, char const* what) {
    std::vector<std::uint8_t> each(numbers == nullptr ? 0 : n);
    if (!each.empty()) space.copy_to_host(each.data(), numbers, each.size());
    for (std::size_t i = 0; i < each.size(); ++i) {
      if (each[i] < N) continue;
      throw error("collide: materials: " + (what + std::to_string(i)) + " is of solid " + std::to_string(each[i]) +
                  ", and there are " + std::to_string(N));
    }
  }
  static void check_number(int i) {
    detail::check_parameter(i >= 0 && i < N, "materials: the number of a solid is from 0 to N - 1");
  }

  static constexpr std::size_t count = N;

  solid solids_[count] = {};
  bool is_set_[count] = {};
  detail::contact_material pairs_[count * (count + 1) / 2];
};

}  // namespace collide
