/// \file
/// Kernel bodies in which particles press on the mesh that they overlap: contacts with forces, and with memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/effects/detail/effect_list.hpp>
#include <collide/narrow/detail/intersects.hpp>
#include <collide/simulation/detail/bodies/bodies_ref.hpp>
#include <collide/simulation/detail/step/mesh_ledger.hpp>
#include <collide/simulation/detail/walls/mesh_kicks.hpp>
#include <collide/simulation/detail/walls/overlap_list.hpp>

namespace collide::detail {

/// Kernel functor of `for_each` over particles: what a source has just made has not touched the mesh, though the one
/// whose place it takes may have. Takes the mark off where nothing else needs it.
template <class Effects, class State>
struct forget_surfaces {
  State state;
  std::uint8_t* counts;

  COLLIDE_HD void operator()(std::size_t i) const {
    std::uint8_t& mark = state.at(alive{})[i];
    if (mark < newborn) return;
    counts[i] = 0;
    if constexpr (!Effects::any_pair_contact) mark = 1;
  }
};

/// How far from its centre a particle sees the mesh.
template <class Effects, class S>
COLLIDE_HD_INLINE S reach_of(S radius) {
  if constexpr (Effects::farther > 0) return radius * S(1 + Effects::farther);
  return radius;
}

/// Kernel functor of `for_each` over particles: wakes those that sleep where a body that moves may touch them.
template <class S, class Effects, class Triangles>
struct wake_by_bodies {
  particle_state<S, typename Effects::all> state;
  Effects effects;
  Triangles triangles;

  COLLIDE_HD void operator()(std::size_t i) const {
    particle<S, typename Effects::inactive_reads> p;
    state.load(p, i);
    if (!effects.is_inactive(p) || !effects.only_sleeps(p)) return;
    S const* const x = state.at(position{}) + 3 * i;
    sphere<S> const here{{x[0], x[1], x[2]}, reach_of<Effects>(state.radius_at(i))};
    if (!triangles.opened().misses_moving_bodies(here)) state.at(slow_steps{})[i] = 0;
  }
};

/// f(triangle, frame) for each triangle whose box a sphere meets, some of them several times; or for one of `shares`
/// shares of these.
template <class Triangles, class S, class F>
COLLIDE_HD_INLINE void for_each_box_met(Triangles const& open, sphere<S> const& shape, std::uint32_t share,
                                        std::uint32_t shares, F const& f) {
  constexpr std::uint32_t together = 4;
  auto cursor = open.begin(shape);
  candidate_range range{};
  while (next_range(open, shape, cursor, range)) {
    int frame = 0;
    if constexpr (has_moving_mesh<Triangles>) frame = cursor.frame_of_last;
    sphere<S> const seen = seen_from(open, frame, shape);
    COLLIDE_NO_UNROLL
    for (std::uint32_t first = share; first < range.count; first += together * shares) {
      id triangles[together];
      bool overlaps[together];
      for (std::uint32_t j = 0; j < together; ++j) {  // all are on their way at once
        std::uint32_t const k = first + j * shares;
        cell_item const e = range.at(min(k, range.count - 1));
        triangles[j] = e.triangle;
        overlaps[j] = k < range.count && range.passes_coverage(e) &&
                      triangle_aabb_of(open.mesh[e.triangle]).overlaps(seen.centre, seen.radius);
      }
      COLLIDE_NO_UNROLL
      for (std::uint32_t j = 0; j < together; ++j)
        if (overlaps[j] && frame_in(open, triangles[j]) == frame) f(triangles[j], frame);
    }
  }
}

/// A particle that may press on the mesh: it meets the boxes of triangles.
struct pressing_particle {
  static constexpr std::uint32_t capacity = 6;

  id number;
  std::uint32_t met;  ///< how many; if there is no room for these, they are to be looked for again
  id triangles[capacity];

  COLLIDE_HD_INLINE void add(id triangle) {
    COLLIDE_NO_UNROLL
    for (std::uint32_t k = 0; k < min(met, capacity); ++k)
      if (triangles[k] == triangle) return;
    if (met < capacity) triangles[met] = triangle;
    ++met;
  }
};

/// Which particles may press on the mesh, in any order.
struct pressing_list {
  std::uint32_t* count;  ///< of all, though there may not be room for them
  pressing_particle* particles;
  std::uint32_t capacity;
};

/// Kernel functor of `for_each` over one item, before particles press again: the list is empty if it is to be made
/// `anew`, and so is the pool of overlaps.
struct begin_pressing {
  std::uint32_t const* anew;
  std::uint32_t* counts;  ///< of the list and of the pool

  COLLIDE_HD void operator()(std::size_t) const {
    if (*anew != 0) counts[0] = 0;
    counts[1] = 0;
  }
};

template <class State>
COLLIDE_HD_INLINE void forget_mesh_kicks([[maybe_unused]] State const& state, [[maybe_unused]] std::size_t i) {
  if constexpr (contains<typename State::list, mesh_kick_count>) {
    if (state.at(mesh_kick_count{})[i] != 0) state.at(mesh_kick_count{})[i] = 0;
  }
}
/// True if the kicks of a particle have none of the mesh in them.
template <class State>
COLLIDE_HD_INLINE bool has_no_mesh_kicks([[maybe_unused]] State const& state, [[maybe_unused]] std::size_t i) {
  if constexpr (contains<typename State::list, mesh_kick_count>) return state.at(mesh_kick_count{})[i] == 0;
  return true;
}

/// Kernel functor of `for_each` over `lanes` threads for each particle, side by side: lists those that meet the box of
/// a triangle, or are less than `margin` away from it. These are few, and much work.
template <class S, class Effects, class Triangles, class Memory>
struct list_pressing {
  particle_state<S, typename Effects::all> state;
  Effects effects;
  Triangles triangles;
  Memory memory;
  pressing_list found;
  meeting what;
  std::uint32_t lanes;  ///< a power of two, at most 32
  S margin;

  /// As many lanes as keep a large device busy.
  template <class Space>
  static std::uint32_t lanes_for(std::size_t particles) {
    std::uint32_t lanes = 1;
    if (!Space::host_accessible)
      while (lanes < 8 && 2 * lanes * particles <= std::size_t{1} << 18) lanes *= 2;
    return lanes;
  }

  COLLIDE_AS_O3 COLLIDE_HD void operator()(std::size_t thread) const {
    std::size_t const i = thread / lanes;
    auto const share = static_cast<std::uint32_t>(thread % lanes), shares = COLLIDE_ON_DEVICE(lanes, 1u);
    if (share >= shares) return;
    if (what == meeting::of_woken && !(is_just_woken(state, i) && has_no_mesh_kicks(state, i))) return;
    if (share == 0) forget_mesh_kicks(state, i);
    if constexpr (Effects::any_inactive) {
      particle<S, typename Effects::inactive_reads> p;
      state.load(p, i);
      if (effects.is_inactive(p)) return;
    }
    particle<S, union_of<columns<position>, intersection_of<columns<radius>, typename Effects::all>>> p;
    state.load(p, i);
    sphere<S> const shape{p[position{}], reach_of<Effects>(p.the_radius) + margin};
    pressing_particle mine{static_cast<id>(i), 0, {}};
    if (is_finite(shape.centre)) find(shape, share, shares, mine);
    std::uint32_t met = mine.met, before = 0;
    with_lanes([&](auto const& shuffle_up, auto const& shuffle) {
      for (std::uint32_t apart = 1; apart < lanes; apart *= 2) {
        std::uint32_t const others = shuffle_up(met, apart);
        if (share >= apart) met += others;
      }
      before = met - mine.met;
      met = shuffle(met, lanes - 1);
    });
    if (met == 0) {
      if constexpr (Effects::remembered::size != 0) {
        if (share == 0 && what == meeting::in_step && memory.counts[i] != 0) memory.counts[i] = 0;
      }
      return;
    }
    std::uint32_t slot = 0;
    if (share == 0) slot = fetch_add(found.count, 1u);
    with_lanes([&](auto const&, auto const& shuffle) { slot = shuffle(slot, 0); });
    if (slot >= found.capacity) return;
    pressing_particle& to = found.particles[slot];
    if (share == 0) to.number = mine.number, to.met = met;
    COLLIDE_NO_UNROLL
    for (std::uint32_t k = 0; k < mine.met && before + k < to.capacity; ++k)
      to.triangles[before + k] = mine.triangles[k];
  }

 private:
  COLLIDE_HD_INLINE void find(sphere<S> const& shape, std::uint32_t share, std::uint32_t shares,
                              pressing_particle& mine) const {
    Triangles const open = triangles.opened();
    if (open.empty(shape)) return;
    for_each_box_met(open, shape, share, shares, [&](id triangle, int) { mine.add(triangle); });
  }

  /// Calls f(value of a lane so far before, value of lane k) where there are several lanes.
  template <class F>
  COLLIDE_HD_INLINE void with_lanes([[maybe_unused]] F const& f) const {
#if defined(__CUDA_ARCH__)
    if (lanes == 1) return;
    unsigned const mask = ((1u << lanes) - 1) << (threadIdx.x & 31 & ~(lanes - 1));
    int const width = static_cast<int>(lanes);
    f([&](std::uint32_t x, std::uint32_t apart) { return __shfl_up_sync(mask, x, apart, width); },
      [&](std::uint32_t x, std::uint32_t k) { return __shfl_sync(mask, x, static_cast<int>(k), width); });
#endif
  }
};

/// Memory of a device for particles that overlap more triangles than a list has room for.
struct overlap_pool {
  static constexpr std::size_t min_items = 65536;  ///< items, of a scene of few particles

  overlap_item* items;
  std::uint32_t capacity;
  std::uint32_t* used;     ///< in this step
  std::uint32_t* lacking;  ///< not 0: there was too little once
};

#if !defined(__CUDA_ARCH__)
/// Memory of a thread of the host, until it asks again.
inline overlap_item* overlap_items_of_thread(std::size_t n) {
  static thread_local std::vector<overlap_item> items;
  if (items.size() < n) items.resize(n);
  return items.data();
}
#endif

/// Kernel functor of `for_each` over as many as there are particles: those on the list press on the mesh.
template <class S, class Effects, class Triangles, class Memory>
struct press_on_mesh {
  using effects_type = Effects;
  using scalar = S;
  using remembered = typename Effects::remembered;
  static constexpr bool has_memory = remembered::size != 0;

  particle_state<S, typename Effects::all> state;
  Effects effects;
  Triangles triangles;
  Memory memory;
  pressing_list pressing;
  overlap_pool pool;
  S dt;
  meeting what;

  COLLIDE_AS_O3 COLLIDE_HD void operator()(std::size_t k) const {
    if (k < *pressing.count) press_with(pressing.particles[k]);
  }

 protected:
  using integrated = particle<S, typename Effects::overlap_reads>;
  using values_type = contact_values<S, remembered>;
  static constexpr int capacity = surface_memory_ref<S, remembered>::max_contacts;

  COLLIDE_HD_INLINE void press_with(pressing_particle const& one) const {
    std::size_t const i = one.number;
    S const* const x = state.at(position{}) + 3 * i;
    sphere<S> const shape{{x[0], x[1], x[2]}, state.radius_at(i)};
    Triangles const open = triangles.opened();
    overlap_list near(tolerance_of(shape));
    if (is_finite(shape.centre)) find(open, shape, near, &one);
    forget_mesh_kicks(state, i);
    int before = 0;
    if constexpr (has_memory) before = memory.counts[i];
    if (near.size != 0) return press(open, i, near, before);
    if constexpr (has_memory) {
      if (what == meeting::in_step && before != 0) memory.counts[i] = 0;
    }
  }

  /// Points of the surface that are so near to each other are one.
  static COLLIDE_HD_INLINE double tolerance_of(sphere<S> const& shape) {
    double const rounding = 4 * static_cast<double>(std::numeric_limits<S>::epsilon());
    return 1e-6 * static_cast<double>(shape.radius) + rounding * static_cast<double>(max_norm(shape.centre));
  }

  /// Lists the triangles that a sphere overlaps, of which the boxes that it meets may be known, and finds its contacts
  /// among them.
  COLLIDE_HD void find(Triangles const& open, sphere<S> const& shape, overlap_list& near,
                       pressing_particle const* known = nullptr) const {
    sphere<S> const wider{shape.centre, reach_of<Effects>(shape.radius)};
    if (known != nullptr && known->met <= known->capacity) {
      COLLIDE_NO_UNROLL
      for (std::uint32_t k = 0; k < known->met; ++k)
        add(open, wider, known->triangles[k], frame_in(open, known->triangles[k]), near);
    } else {
      list_overlaps(open, wider, near);
    }
    if (near.is_full()) {
      if (overlap_item* const items = items_for(near.added)) {
        near.use(items);
        list_overlaps(open, wider, near);
        near.sort();
      }
    }
    near.find_contacts(static_cast<double>(shape.radius) * (1 + Effects::farthest_saddle),
                       [&](overlap_item const& item) { return corners_of(open, shape, item); });
  }

  COLLIDE_HD overlap_item* items_for(std::uint32_t n) const {
#if defined(__CUDA_ARCH__)
    std::uint32_t const first = fetch_add(pool.used, n);
    if (first < pool.capacity && n <= pool.capacity - first) return pool.items + first;
    store_relaxed(pool.lacking, 1u);
    return nullptr;
#else
    return overlap_items_of_thread(n);
#endif
  }

  COLLIDE_AS_O3 COLLIDE_HD void list_overlaps(Triangles const& open, sphere<S> const& shape, overlap_list& near) const {
    for_each_box_met(open, shape, 0, 1, [&](id triangle, int frame) { add(open, shape, triangle, frame, near); });
  }

  COLLIDE_HD_INLINE void add(Triangles const& open, sphere<S> const& shape, id triangle, int frame,
                             overlap_list& near) const {
    sphere<S> const seen = seen_from(open, frame, shape);
    // of triangles that are near in their boxes only, such as thin ones that meet in a point, there may be very many
    if (filter_exact(open.mesh[triangle], seen).verdict == verdict::miss) return;
    nearest_of_triangle const n = nearest_to(open.mesh[triangle], seen.centre);
    if (!(n.distance < static_cast<double>(seen.radius))) return;
    vec3<double> const nearest = in_world(open, frame, scaled(n.normal, -n.distance));
    near.add({nearest, n.distance, triangle, static_cast<std::uint8_t>(frame), n.kind, false, false, 0, 0, 0, 0, 0});
  }

  /// A triangle relative to the centre of a sphere, along the axes of the world.
  static COLLIDE_HD_INLINE local_triangle<double> corners_of(Triangles const& open, sphere<S> const& shape,
                                                             overlap_item const& item) {
    local_triangle<double> t = to_local<double>(open.mesh[item.triangle], seen_from(open, item.frame, shape));
    if constexpr (has_moving_mesh<Triangles>) {
      if (item.frame != 0) {
        auto const& now = open.mesh.frames[item.frame].now;
        t.a = now.rotated(t.a), t.b = now.rotated(t.b), t.c = now.rotated(t.c);
      }
    }
    return t;
  }

  COLLIDE_AS_O3 COLLIDE_HD void press(Triangles const& open, std::size_t i, overlap_list const& near,
                                      int before) const {
    integrated p;
    state.load(p, i);
    integrated const self = p;
    vec3<S> normals[std::size_t(capacity)];
    id bodies[std::size_t(capacity)];
    values_type values[std::size_t(capacity)] = {};
    kicks_by_mesh<S, Effects> kicks;
    S const elapsed = what == meeting::in_step || before != 0 ? dt : S(0);
    int kept = 0;
    for_each_contact(open, i, self, near, before, [&](mesh_overlap<S> const& o, values_type& own) {
      if (!meet(p, self, o, own, elapsed, kicks) || kept == capacity) return;
      normals[kept] = o.normal;
      bodies[kept] = o.body;
      values[kept++] = own;
    });
    if constexpr (has_memory) {
      if (what == meeting::in_step) keep(i, kept, normals, bodies, values);
    }
    if constexpr (Effects::keeps_mesh_kicks) kicks.store(state, i);
    store(i, p, self);
  }

  /// f(overlap, what it remembers) for each contact, the nearest first.
  template <class Seen, class F>
  COLLIDE_HD_INLINE void for_each_contact(Triangles const& open, [[maybe_unused]] std::size_t i, Seen const& self,
                                          overlap_list const& near, [[maybe_unused]] int before, F const& f) const {
    [[maybe_unused]] unsigned used = 0;
    COLLIDE_NO_UNROLL
    for (std::uint32_t k = 0; k < near.size; ++k) {
      if (!near[k].is_minimum || near.is_hidden(k)) continue;
      mesh_overlap<S> const o = overlap_of(open, self, near, k);
      values_type own;
      bool is_known = false;
      if constexpr (has_memory) is_known = remember(i, o, before, used, own);
      if (Effects::farther > 0 && !is_known && !(o.overlap > 0)) continue;
      f(o, own);
    }
  }

  /// Calls the effects, and tells them what the mesh has given.
  COLLIDE_HD_INLINE bool meet(integrated& p, integrated self, mesh_overlap<S> const& o, values_type& values, S elapsed,
                              [[maybe_unused]] kicks_by_mesh<S, Effects>& kicks) const {
    integrated const before = p;
    bool const goes_on = effects.on_mesh_overlap(p, self, o, values, elapsed, dt);
    if (o.overlap > 0 || goes_on) mark_contact(p);
    if constexpr (has_moving_mesh<Triangles> && contains<typename integrated::list, slow_steps>) {
      if (o.body != no_id && triangles.mesh.frames[o.body + 1].moves) p[slow_steps{}] = carried_by_moving;
    }
    if constexpr (Effects::any_mesh_impulse) {
      vec3<S> const none(S(0), S(0), S(0));
      vec3<S> turned = none;
      if constexpr (contains<typename integrated::list, angular_velocity>)
        turned = p[angular_velocity{}] - before[angular_velocity{}];
      mesh_impulse<S> given{
          p[velocity{}] - before[velocity{}], turned, self[position{}], none, p[velocity{}], o.triangle, o.body};
      if constexpr (Effects::keeps_mesh_kicks) kicks.add(given, 1 / dt);
      if (what != meeting::in_step) return goes_on;
      keep_support(*this, p, given);
      constexpr S fraction = Effects::keeps_mesh_kicks ? S(Effects::integrator::kick_after) : S(1);
      given.change *= fraction;
      given.spin_change *= fraction;
      effects.on_mesh_impulse(p, given, dt);
    }
    return goes_on;
  }

  template <class Seen>
  COLLIDE_HD_INLINE mesh_overlap<S> overlap_of(Triangles const& open, Seen const& self, overlap_list const& near,
                                               std::uint32_t k) const {
    overlap_item const& item = near[k];
    sphere<S> const shape{self[position{}], self.the_radius};
    nearest_of_triangle const n = nearest_to(open.mesh[item.triangle], seen_from(open, item.frame, shape).centre);
    vec3<double> const normal = in_world(open, item.frame, n.normal);
    vec3<double> surface(0, 0, 0);
    if constexpr (has_moving_mesh<Triangles>) {
      auto const& f = open.mesh.frames[item.frame];
      vec3<double> const point = self[position{}].template cast<double>() - scaled(normal, n.distance);
      if (item.frame != 0) {
        surface = velocity_at(f.moving, f.now, point) + f.conveyor_velocity;
      } else if (open.mesh.vertex_velocities != nullptr) {
        surface = open.mesh.velocity_of(item.triangle, rounded_to<S>(point));
      }
    }
    double const radius = static_cast<double>(shape.radius);
    mesh_overlap<S> o{rounded_to<S>(normal), static_cast<S>(radius - n.distance), rounded_to<S>(surface),
                      item.triangle,         body_of_frame(item.frame),           rounded_to<S>(normal),
                      mesh_overlap<S>::apart};
    if constexpr (has_moving_mesh<Triangles>) {
      if (item.frame != 0) o.surface_turning = rounded_to<S>(vector_of(open.mesh.frames[item.frame].moving.angular));
    }
    if (item.has_saddle) {
      vec3<double> const p = near.saddle_of(item, [&](overlap_item const& of) { return corners_of(open, shape, of); });
      double const distance = sqrt_rn(dot(p, p));
      o.saddle_overlap = static_cast<S>(radius - max(distance, n.distance));
      if (distance > n.distance) o.saddle_normal = rounded_to<S>(scaled(p, -div_rn(1.0, distance)));
    }
    return o;
  }

  /// Finds what a contact remembers among what the particle's contacts were before, that of the same body first; false
  /// if it is new. One that appears in a surface that is touched already begins with what is remembered there.
  COLLIDE_HD_INLINE bool remember(std::size_t i, mesh_overlap<S> const& o, int before, unsigned& used,
                                  values_type& values) const {
    int best = -1, shared = -1;
    S best_match = S(0.5), shared_match = S(0.5);
    COLLIDE_NO_UNROLL
    for (int k = 0; k < before; ++k) {
      auto const& r = memory.record(i, k);
      S const cosine = dot(vec3<S>(r.normal[0], r.normal[1], r.normal[2]), o.normal);
      S const match = r.body == o.body ? cosine + S(1e-3) : cosine;
      if (match > shared_match) shared_match = match, shared = k;
      if ((used >> k & 1) == 0 && match > best_match) best_match = match, best = k;
    }
    if (best < 0 && o.has_saddle()) best = shared;
    if (best < 0) return false;
    used |= 1u << best;
    values = memory.record(i, best).record.values();
    return true;
  }

  COLLIDE_HD_INLINE void keep(std::size_t i, int kept, vec3<S> const* normals, id const* bodies,
                              values_type const* values) const {
    COLLIDE_NO_UNROLL
    for (int k = 0; k < kept; ++k) {
      auto& r = memory.record(i, k);
      r.record.set(values[k]);
      for (int c = 0; c < 3; ++c) r.normal[c] = normals[k][c];
      r.body = bodies[k];
    }
    memory.counts[i] = static_cast<std::uint8_t>(kept);
  }

  COLLIDE_HD_INLINE void store(std::size_t i, integrated& p, integrated const& self) const {
    if constexpr (Effects::keeps_pair_forces) {
      p[pair_acceleration{}] += (p[velocity{}] - self[velocity{}]) * (1 / dt);
      if constexpr (Effects::keeps_pair_torques)
        p[pair_angular_acceleration{}] += (p[angular_velocity{}] - self[angular_velocity{}]) * (1 / dt);
    }
    if (what != meeting::in_step) {
      state.store(p, i, typename Effects::interaction_kicks{});
    } else {
      state.store(p, i, typename Effects::overlap_writes{});
    }
  }

  /// A direction in a body's frame, as it is in the world.
  static COLLIDE_HD_INLINE vec3<double> in_world(Triangles const& open, int frame, vec3<double> const& x) {
    if constexpr (has_moving_mesh<Triangles>) {
      if (frame != 0) return open.mesh.frames[frame].now.rotated(x);
    }
    (void)open, (void)frame;
    return x;
  }
};

/// Kernel functor of `for_each` over particles: found[i] = f(particle, overlap, what it remembers), summed over the
/// contacts of particle i with the mesh where it is now. Nothing is changed.
template <class S, class Effects, class Triangles, class Memory, class F, class Sum>
struct sum_over_mesh_contacts : press_on_mesh<S, Effects, Triangles, Memory> {
  F f;
  Sum* found;

  COLLIDE_HD void operator()(std::size_t i) const {
    Triangles const open = this->triangles.opened();
    particle<S, typename Effects::overlap_reads> self;
    this->state.load(self, i);
    sphere<S> const shape{self[position{}], self.the_radius};
    overlap_list near(this->tolerance_of(shape));
    if (is_finite(shape.centre) && !open.empty(sphere<S>{shape.centre, reach_of<Effects>(shape.radius)}))
      this->find(open, shape, near);
    int before = 0;
    if constexpr (Effects::remembered::size != 0) before = this->memory.counts[i];
    Sum sum{};
    this->for_each_contact(open, i, self, near, before,
                           [&](mesh_overlap<S> const& o, auto& values) { sum += f(self, o, values); });
    found[i] = sum;
  }
};

}  // namespace collide::detail
