/// \file
/// The columns that an effect names, and a particle as the effect sees it.
#pragma once

#include <type_traits>

#include <collide/core/detail/detected.hpp>
#include <collide/effects/detail/particle.hpp>
#include <collide/effects/effect.hpp>

namespace collide::detail {

template <class E>
using reads_member = typename E::reads;
template <class E>
using reads_of = detected_or<columns<>, reads_member, E>;
template <class E>
using writes_member = typename E::writes;
template <class E>
using writes_of = detected_or<columns<>, writes_member, E>;
template <class E>
using optional_writes_member = typename E::optional_writes;
template <class E>
using optional_writes_of = detected_or<columns<>, optional_writes_member, E>;
template <class E>
using optional_reads_member = typename E::optional_reads;
template <class E>
using optional_reads_of = detected_or<columns<>, optional_reads_member, E>;
template <class E>
using remembers_member = typename E::remembers;
template <class E>
using remembers_of = typename detected_or<contact_columns<>, remembers_member, E>::list;

/// By how many of its radii more than its radius a particle sees the mesh for an effect, or for a law of cohesion.
COLLIDE_MEMBER_OR(farther_of, farther, 0.0)
/// By how many of its radii more than its radius a saddle of the surface may be away for an effect or a law.
COLLIDE_MEMBER_OR(farthest_saddle_of, farthest_saddle, farther_of<T>)

/// A particle as an effect sees it: with the columns that it names and no others.
template <class Effect, class Particle>
class particle_access {
 public:
  using scalar = typename Particle::scalar;

  COLLIDE_HD_INLINE explicit particle_access(Particle& p) : p_{p} {}

  /// True if the scene has the column.
  template <class C>
  static constexpr bool has = contains<typename Particle::list, C>;

  template <class C>
  COLLIDE_HD_INLINE decltype(auto) operator[](C) const {
    constexpr bool writes = contains<writes_of<Effect>, C> || (contains<optional_writes_of<Effect>, C> && has<C>);
    static_assert(
        writes || contains<reads_of<Effect>, C> || (contains<optional_reads_of<Effect>, C> && has<C>),
        "collide: an effect may use a column only if it names it in its reads or writes, or in its optional_writes "
        "or optional_reads and the scene has it");
    if constexpr (writes) {
      return static_cast<column_value<C, scalar>&>(p_[C{}]);
    } else {
      return static_cast<column_value<C, scalar> const&>(p_[C{}]);
    }
  }

  COLLIDE_HD_INLINE scalar radius() const { return p_.the_radius; }
  COLLIDE_HD_INLINE id number() const { return number_of(p_); }

 private:
  Particle& p_;
};

/// True of a sphere of a clump, which moves as that does (clump_motion.hpp).
template <class Particle>
COLLIDE_HD_INLINE bool is_of_clump([[maybe_unused]] Particle const& p) {
  if constexpr (contains<typename Particle::list, in_clump>) return p[in_clump{}] != no_id;
  return false;
}

}  // namespace collide::detail
