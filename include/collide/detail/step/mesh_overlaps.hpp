/// \file
/// Kernel bodies in which particles press on the mesh that they overlap: contacts with forces, and with memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/detail/bodies/bodies_ref.hpp>
#include <collide/detail/narrow_phase/intersects.hpp>
#include <collide/detail/particles/contact_memory.hpp>
#include <collide/detail/particles/effect_list.hpp>
#include <collide/detail/step/mesh_kicks.hpp>
#include <collide/detail/step/mesh_ledger.hpp>
#include <collide/detail/step/overlap_list.hpp>

// the numbers of elements of small arrays are int
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-conversion"

namespace collide::detail {

/// The memory of a contact with the mesh, and its key: a sphere that slides over a surface goes from
/// triangle to triangle, and its contact goes on; that of another wall has another normal.
template <class S, class List>
struct surface_record {
  contact_record<S, List> record;
  S normal[3];
  id body;
};

/// The memory of contacts with the mesh, by numbers of particles.
template <class S, class List>
struct surface_memory_ref {
  static constexpr int room = 4;  ///< contacts of a particle that are remembered: the deepest

  surface_record<S, List>* records;  ///< contact k of particle i is at k * capacity + i
  std::uint8_t* counts;
  std::size_t capacity;
};
template <class S, class List>
class surface_memory {
 public:
  void reserve(std::pmr::memory_resource* resource, std::size_t n) {
    records_.reserve(resource, n * surface_memory_ref<S, List>::room);
    counts_.reserve(resource, n);
  }
  template <class Space>
  void clear(Space& space, std::size_t n) {
    if (n != 0) space.fill(counts_.data(), 0, n);
  }
  std::size_t bytes() const { return records_.bytes() + counts_.bytes(); }
  surface_memory_ref<S, List> ref(std::size_t n) const { return {records_.data(), counts_.data(), n}; }

  /// For a checkpoint: the contacts of each of `n` particles; the others are bodies. Waits.
  template <class Space>
  saved_contacts<S> save_contacts(Space const& space, std::size_t n) const {
    std::vector<surface_record<S, List>> records(room * n);
    std::vector<std::uint8_t> counts(n);
    if (n != 0) space.copy_to_host(records.data(), records_.data(), records.size());
    if (n != 0) space.copy_to_host(counts.data(), counts_.data(), n);
    saved_contacts<S> saved;
    for (std::size_t i = 0; i < n; ++i) {
      saved.counts.push_back(counts[i]);
      for (std::size_t k = 0; k < counts[i]; ++k) {
        auto const& r = records[k * n + i];
        saved.others.push_back(r.body);
        saved.values.insert(saved.values.end(), r.normal, r.normal + 3);
        saved.values.insert(saved.values.end(), r.record.numbers, r.record.numbers + width);
      }
    }
    return saved;
  }
  /// May wait.
  template <class Space>
  void restore_contacts(Space& space, saved_contacts<S> const& saved) {
    std::size_t const n = saved.counts.size();
    std::vector<surface_record<S, List>> records(room * n);
    std::vector<std::uint8_t> counts;
    std::size_t at = 0;
    for (std::size_t i = 0; i < n; ++i) {
      counts.push_back(static_cast<std::uint8_t>(saved.counts[i]));
      for (std::size_t k = 0; k < saved.counts[i]; ++k, ++at) {
        auto& r = records[k * n + i];
        S const* from = saved.values.data() + at * std::size_t(saved_width);
        r.body = saved.others[at];
        for (int c = 0; c < 3; ++c) r.normal[c] = *from++;
        for (int c = 0; c < width; ++c) r.record.numbers[c] = *from++;
      }
    }
    if (n == 0) return;
    space.copy_from_host(records_.data(), records.data(), records.size());
    space.copy_from_host(counts_.data(), counts.data(), n);
  }
  static constexpr int width = contact_values<S, List>::width, saved_width = width + 3;

 private:
  static constexpr std::size_t room = surface_memory_ref<S, List>::room;
  buffer<surface_record<S, List>> records_;
  buffer<std::uint8_t> counts_;
};
template <class S>
class surface_memory<S, columns<>> {
 public:
  void reserve(std::pmr::memory_resource*, std::size_t) {}
  template <class Space>
  void clear(Space&, std::size_t) {}
  std::size_t bytes() const { return 0; }
  null_ref ref(std::size_t) const { return {}; }
};

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
    if (!triangles.without_overflown_grids().is_left_alone(here)) state.at(slow_steps{})[i] = 0;
  }
};

/// Which particles may press on the mesh, in any order.
struct pressing_list {
  std::uint32_t* count;
  id* numbers;
};

/// Kernel functor of `for_each` over particles: lists those that may press on the mesh. These are few, and much work.
template <class S, class Effects, class Triangles, class Memory>
struct list_pressing {
  particle_state<S, typename Effects::all> state;
  Effects effects;
  Triangles triangles;
  Memory memory;
  pressing_list found;
  meeting what;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (what == meeting::of_woken && !(is_just_woken(state, i) && has_no_mesh_kicks(state, i))) return;
    forget_mesh_kicks(state, i);
    if constexpr (Effects::any_inactive) {
      particle<S, typename Effects::inactive_reads> p;
      state.load(p, i);
      if (effects.is_inactive(p)) return;
    }
    particle<S, union_of<columns<position>, intersection_of<columns<radius>, typename Effects::all>>> p;
    state.load(p, i);
    sphere<S> const shape{p[position{}], reach_of<Effects>(p.the_radius)};
    if (is_finite(shape.centre) && !triangles.without_overflown_grids().empty(shape)) {
      found.numbers[fetch_add(found.count, 1u)] = static_cast<id>(i);
    } else if constexpr (Effects::remembered::size != 0) {
      if (what == meeting::in_step && memory.counts[i] != 0) memory.counts[i] = 0;
    }
  }
};

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
  S dt;
  meeting what;

  COLLIDE_HD void operator()(std::size_t k) const {
    if (k < *pressing.count) press_with(pressing.numbers[k]);
  }

 protected:
  using integrated = particle<S, typename Effects::overlap_reads>;
  using values_type = contact_values<S, remembered>;
  static constexpr int most = surface_memory_ref<S, remembered>::room;

  COLLIDE_HD_INLINE void press_with(std::size_t i) const {
    S const* const x = state.at(position{}) + 3 * i;
    vec3<S> const centre(x[0], x[1], x[2]);
    Triangles const open = triangles.without_overflown_grids();
    overlap_list near;
    find(open, sphere<S>{centre, reach_of<Effects>(state.radius_at(i))}, near);
    int before = 0;
    if constexpr (has_memory) before = memory.counts[i];
    if (near.size != 0) return press(open, i, near, before);
    if constexpr (has_memory) {
      if (what == meeting::in_step && before != 0) memory.counts[i] = 0;
    }
  }

  COLLIDE_HD void find(Triangles const& open, sphere<S> const& shape, overlap_list& near) const {
    auto cursor = open.begin(shape);
    candidate_range range{};
    while (next(open, shape, cursor, range)) {
      int frame = 0;
      if constexpr (has_moving_mesh<Triangles>) frame = cursor.frame_of_last;
      sphere<S> const seen = seen_from(open, frame, shape);
      COLLIDE_NO_UNROLL
      for (std::uint32_t k = 0; k < range.count; k += together) {
        id triangles_near[together];
        bool overlaps[together];
        for (std::uint32_t j = 0; j < together; ++j) {  // all are on their way at once
          cell_item const e = range.at(min(k + j, range.count - 1));
          triangles_near[j] = e.triangle;
          overlaps[j] = k + j < range.count && range.passes_coverage(e) &&
                        triangle_aabb_of(open.mesh[e.triangle]).overlaps(seen.centre, seen.radius);
        }
        COLLIDE_NO_UNROLL
        for (std::uint32_t j = 0; j < together; ++j)
          if (overlaps[j]) add(open, triangles_near[j], frame, seen, near);
      }
    }
  }
  static constexpr std::uint32_t together = 4;

  COLLIDE_HD_INLINE void add(Triangles const& open, id triangle, int frame, sphere<S> const& seen,
                             overlap_list& near) const {
    if constexpr (has_moving_mesh<Triangles>) {
      if (open.mesh.frame_of(triangle) != frame) return;
    }
    // of triangles that are near in their boxes only, such as thin ones that meet in a point, there may be very many
    if (filter_exact(open.mesh[triangle], seen).verdict == verdict::miss) return;
    nearest_of_triangle const n = nearest_to(open.mesh[triangle], seen.centre);
    if (n.distance < static_cast<double>(seen.radius)) near.add({n.distance, triangle, frame, n.kind, n.index});
  }

  COLLIDE_HD void press(Triangles const& open, std::size_t i, overlap_list const& near, int before) const {
    integrated p;
    state.load(p, i);
    integrated const self = p;
    vec3<S> normals[overlap_list::room] = {};
    id bodies[overlap_list::room] = {};
    values_type values[most] = {};
    bool kept[most] = {};
    kicks_by_mesh<S, Effects> kicks;
    S const elapsed = what == meeting::in_step || before != 0 ? dt : S(0);
    int const size = for_each_contact(open, i, self, near, before, normals, bodies,
                                      [&](int n, mesh_overlap<S> const& o, values_type& own) {
                                        bool const goes_on = meet(p, self, o, own, elapsed, kicks);
                                        if (n < most) values[n] = own, kept[n] = goes_on;
                                      });
    if constexpr (has_memory) {
      if (what == meeting::in_step) keep(i, size, normals, bodies, values, kept);
    }
    kicks.store(state, i);
    store(i, p, self);
  }

  /// f(n, overlap, what it remembers) for each contact n. Returns how many there are.
  template <class Seen, class F>
  COLLIDE_HD_INLINE int for_each_contact(Triangles const& open, [[maybe_unused]] std::size_t i, Seen const& self,
                                         overlap_list const& near, [[maybe_unused]] int before, vec3<S>* normals,
                                         id* bodies, F const& f) const {
    int size = 0;
    [[maybe_unused]] unsigned used = 0;
    COLLIDE_NO_UNROLL
    for (int k = 0; k < near.size; ++k) {
      overlap_list::item const& item = near.items[k];
      if (!near.is_contact(k, [&](int n) { return open.mesh[near.items[n].triangle]; })) continue;
      mesh_overlap<S> const o = overlap_of(open, self, item);
      bool merged = false;
      for (int n = 0; n < size; ++n)
        merged = merged || (bodies[n] == o.body && dot(normals[n], o.normal) > S(1 - same_normal));
      if (merged) continue;
      values_type own;
      bool is_known = false;
      if constexpr (has_memory) is_known = remember(i, o, before, used, own);
      if (Effects::farther > 0 && !is_known && !(o.overlap > 0)) continue;
      normals[size] = o.normal;
      bodies[size] = o.body;
      f(size++, o, own);
    }
    return size;
  }

  static constexpr double same_normal = 5e-7;  ///< 1 - cosine of the angle up to which contacts of a body are one

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
      constexpr S part = Effects::keeps_mesh_kicks ? S(Effects::integrator::kick_after) : S(1);
      given.change *= part;
      given.spin_change *= part;
      effects.on_mesh_impulse(p, given, dt);
    }
    return goes_on;
  }

  template <class Seen>
  COLLIDE_HD_INLINE mesh_overlap<S> overlap_of(Triangles const& open, Seen const& self,
                                               overlap_list::item const& item) const {
    sphere<S> const shape{self[position{}], self.the_radius};
    nearest_of_triangle const n = nearest_to(open.mesh[item.triangle], seen_from(open, item.frame, shape).centre);
    vec3<double> normal = n.normal, still(0, 0, 0);
    vec3<double> surface = still;
    if constexpr (has_moving_mesh<Triangles>) {
      auto const& f = open.mesh.frames[item.frame];
      vec3<double> const centre = self[position{}].template cast<double>();
      if (item.frame != 0) normal = f.now.rotated(normal);
      vec3<double> const point = centre - scaled(normal, n.distance);
      if (item.frame != 0) {
        surface = velocity_at(f.moving, f.now, point) + f.conveyor_velocity;
      } else if (open.mesh.vertex_velocities != nullptr) {
        surface = open.mesh.velocity_of(item.triangle, rounded_to<S>(point));
      }
    }
    S const overlap = static_cast<S>(static_cast<double>(shape.radius) - n.distance);
    return {rounded_to<S>(normal), overlap, rounded_to<S>(surface), item.triangle, body_of_frame(item.frame)};
  }

  /// Finds what a contact remembers among what the particle's contacts were before; false if it is new.
  COLLIDE_HD_INLINE bool remember(std::size_t i, mesh_overlap<S> const& o, int before, unsigned& used,
                                  values_type& values) const {
    int best = -1;
    S best_cosine = S(0.5);
    COLLIDE_NO_UNROLL
    for (int k = 0; k < before; ++k) {
      auto const& r = memory.records[std::size_t(k) * memory.capacity + i];
      if ((used >> k & 1) != 0 || r.body != o.body) continue;
      S const cosine = dot(vec3<S>(r.normal[0], r.normal[1], r.normal[2]), o.normal);
      if (cosine > best_cosine) best_cosine = cosine, best = k;
    }
    if (best < 0) return false;
    used |= 1u << best;
    values = memory.records[std::size_t(best) * memory.capacity + i].record.values();
    return true;
  }

  COLLIDE_HD_INLINE void keep(std::size_t i, int size, vec3<S> const* normals, id const* bodies,
                              values_type const (&values)[most], bool const (&kept)[most]) const {
    int n = 0;
    COLLIDE_NO_UNROLL
    for (int k = 0; k < size && k < most; ++k) {
      if (!kept[k]) continue;
      auto& r = memory.records[std::size_t(n++) * memory.capacity + i];
      r.record.set(values[k]);
      for (int c = 0; c < 3; ++c) r.normal[c] = normals[k][c];
      r.body = bodies[k];
    }
    memory.counts[i] = static_cast<std::uint8_t>(n);
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

  static COLLIDE_HD_INLINE sphere<S> seen_from(Triangles const& open, int frame, sphere<S> const& s) {
    if constexpr (has_moving_mesh<Triangles>) {
      return open.mesh.seen_from(frame, s, 1);
    } else {
      (void)open, (void)frame;
      return s;
    }
  }
  template <class Cursor>
  static COLLIDE_HD_INLINE bool next(Triangles const& open, sphere<S> const& s, Cursor& cursor,
                                     candidate_range& range) {
    constexpr std::uint32_t all = 1u << 30;
    if constexpr (has_moving_mesh<Triangles>) {
      return open.next(s, 1, cursor, all, range);
    } else {
      return open.next(s, cursor, all, range);
    }
  }
};

/// Kernel functor of `for_each` over particles: found[i] = f(particle, overlap, what it remembers), summed over the
/// contacts of particle i with the mesh where it is now. Nothing is changed.
template <class S, class Effects, class Triangles, class Memory, class F, class Sum>
struct sum_over_mesh_contacts : press_on_mesh<S, Effects, Triangles, Memory> {
  F f;
  Sum* found;

  COLLIDE_HD void operator()(std::size_t i) const {
    Triangles const open = this->triangles.without_overflown_grids();
    particle<S, typename Effects::overlap_reads> self;
    this->state.load(self, i);
    sphere<S> const shape{self[position{}], reach_of<Effects>(self.the_radius)};
    overlap_list near;
    if (is_finite(shape.centre) && !open.empty(shape)) this->find(open, shape, near);
    int before = 0;
    if constexpr (Effects::remembered::size != 0) before = this->memory.counts[i];
    vec3<S> normals[overlap_list::room] = {};
    id bodies[overlap_list::room] = {};
    Sum sum{};
    this->for_each_contact(open, i, self, near, before, normals, bodies,
                           [&](int, mesh_overlap<S> const& o, auto& values) { sum += f(self, o, values); });
    found[i] = sum;
  }
};

}  // namespace collide::detail

#pragma GCC diagnostic pop
