/// \file
/// The kicks that each contact with the mesh gives to a particle by a force, from where particles meet until the first
/// half kick of the next step: effects are told of each half when it is given, so it is that of the step's own time.
#pragma once

#include <collide/effects/detail/effect_list.hpp>

namespace collide::detail {

/// The accelerations of a particle by the mesh where it meets it; nothing where nobody asks for them.
template <class S, class Effects, bool Keeps = Effects::keeps_mesh_kicks>
struct kicks_by_mesh {};
template <class S, class Effects>
struct kicks_by_mesh<S, Effects, true> {
  static constexpr int capacity = mesh_kicks::contacts;

  several<S, 6 * capacity> numbers;
  several<id, 2 * capacity> by;
  int count = 0;

  /// A contact that has given so much; the last of more than there is room for has the impulses of all others.
  COLLIDE_HD_INLINE void add(mesh_impulse<S> const& given, S per_time) {
    int const k = min(count, capacity - 1);
    if (count < capacity) by.of[2 * k] = given.triangle, by.of[2 * k + 1] = given.body, ++count;
    for (int c = 0; c < 3; ++c) {
      numbers.of[6 * k + c] += given.change[c] * per_time;
      numbers.of[6 * k + 3 + c] += given.spin_change[c] * per_time;
    }
  }
  template <class State>
  COLLIDE_HD_INLINE void store(State const& state, std::size_t i) const {
    if (count == 0) return;
    for (int k = 0; k < 6 * count; ++k)
      state.at(mesh_kicks{})[i * std::size_t(6 * capacity) + std::size_t(k)] = numbers.of[k];
    for (int k = 0; k < 2 * count; ++k)
      state.at(mesh_kicks_by{})[i * std::size_t(2 * capacity) + std::size_t(k)] = by.of[k];
    state.at(mesh_kick_count{})[i] = static_cast<std::uint8_t>(count);
  }
};

/// Kernel functor of `for_each` over particles, before the first half kick: tells effects of what the mesh gives in it.
/// What has just fallen asleep gets it too, in the ledger, which then takes it back with all that it is held against.
template <class S, class Effects>
struct record_first_kicks {
  particle_state<S, typename Effects::all> state;
  Effects effects;
  S dt;
  std::size_t triangles, bodies;  ///< of the mesh, which may be another than when particles met

  COLLIDE_HD void operator()(std::size_t i) const {
    int const count = state.at(mesh_kick_count{})[i];
    if (count == 0) return;
    particle<S, typename Effects::overlap_reads> p;
    state.load(p, i);
    if constexpr (Effects::any_inactive) {
      if (effects.is_inactive(p) && !sleeps(p)) return;
    }
    S const time = S(Effects::integrator::kick_before) * dt;
    S const* numbers = state.at(mesh_kicks{}) + i * std::size_t(6 * mesh_kicks::contacts);
    id const* by = state.at(mesh_kicks_by{}) + i * std::size_t(2 * mesh_kicks::contacts);
    vec3<S> const none(S(0), S(0), S(0));
    for (int k = 0; k < count; ++k, numbers += 6, by += 2) {
      effects.on_mesh_impulse(
          p,
          {vec3<S>(numbers[0], numbers[1], numbers[2]) * time, vec3<S>(numbers[3], numbers[4], numbers[5]) * time,
           p[position{}], none, p[velocity{}], by[0] < triangles ? by[0] : no_id, by[1] < bodies ? by[1] : no_id},
          dt);
    }
    state.store(p, i, typename Effects::overlap_writes{});
  }

 private:
  template <class P>
  COLLIDE_HD_INLINE bool sleeps([[maybe_unused]] P const& p) const {
    if constexpr (contains<typename P::list, slow_steps>) return effects.only_sleeps(p);
    return false;
  }
};

}  // namespace collide::detail
