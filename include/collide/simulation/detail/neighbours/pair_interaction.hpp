/// \file
/// Kernel bodies in which particles that overlap each other meet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include <collide/effects/detail/effect_list.hpp>
#include <collide/simulation/detail/neighbours/particle_order.hpp>

namespace collide::detail {

template <class S, class Effects>
struct pair_interaction {
  particle_state<S, typename Effects::all> state;
  sorted_particles<S, Effects> order;
  Effects effects;
  S dt;
  meeting what;

 protected:
  using interaction = typename sorted_particles<S, Effects>::interaction;

  struct pair_state {
    interaction self, changed;
    bool met = false, woken = false;
    COLLIDE_HD_INLINE explicit pair_state(interaction const& p) : self(p), changed(p) {}
  };

  /// True of the place of a particle that meets nothing: it is another rank's, or does not ask for forces.
  COLLIDE_HD_INLINE bool is_left_out(std::size_t place) const {
    std::size_t const number = order.numbers[place];
    return order.is_of_another(number) || (what == meeting::of_woken && !is_just_woken(state, number));
  }

  COLLIDE_HD_INLINE bool is_inactive(interaction& p) const {
    if constexpr (Effects::any_inactive) return effects.is_inactive(p);
    return false;
  }

  COLLIDE_HD_INLINE void interact(pair_state& p, std::uint32_t place) const {
    interaction other = order.load(place);
    bool const is_active = takes_part(p.self), is_other = !is_inactive(other);
    side_by_side(p, other, [&]() COLLIDE_HOT {
      if (p.woken ? is_other : is_active) effects.on_pair_contact(p.changed, p.self, other, dt);
      mark_contact(p.changed);
      if (is_other && !p.woken) effects.try_wake(p.changed, other);
    });
    p.met = p.met || is_active || is_other;
  }
  /// True once if a particle has been woken that took no part: then it meets those that were awake again, which have
  /// got their part of what the two do to each other.
  COLLIDE_HD_INLINE bool must_meet_again(pair_state& p) const {
    if constexpr (Effects::any_inactive && !Effects::keeps_support) {
      p.woken = !p.woken && p.met && is_inactive(p.self) && !is_inactive(p.changed);
    }
    return p.woken;
  }

  /// A meeting with what the contact remembers in `record`, if it `was` there. True if there is something to remember.
  template <class Record>
  COLLIDE_HD_INLINE bool interact(pair_state& p, std::uint32_t place, bool overlap, bool was, Record record) const {
    interaction other = order.load(place);
    bool const is_active = takes_part(p.self), is_awake = !is_inactive(other), is_other = overlap && is_awake;
    bool goes_on = was;
    side_by_side(p, other, [&]() COLLIDE_HOT {
      if (p.woken ? is_other : is_active) {
        contact_values<S, typename Effects::remembered> values;
        if (was) values = record.values();
        bool const stays = !is_awake && is_inactive(p.self);  // of two that sleep the contact is as it was
        S const elapsed = stays || (what != meeting::in_step && !was) ? S(0) : dt;
        goes_on = effects.on_pair_contact(p.changed, p.self, other, overlap, values, elapsed, dt);
        if (overlap || goes_on) mark_contact(p.changed);
        if (what != meeting::in_step) {
          goes_on = was;
        } else if (goes_on) {
          record.set(values);
        }
      }
      if (is_other && !p.woken) effects.try_wake(p.changed, other);
    });
    p.met = p.met || is_active || is_other;
    return goes_on;
  }

  /// Keeps what others do to a particle: nothing, if none is there.
  COLLIDE_HD_INLINE void store(pair_state& p) const {
    // of one that is gone, what is known is old
    bool const met = p.met && p.self[position{}].x() != std::numeric_limits<S>::max();
    bool is_asleep = false;
    if constexpr (Effects::keeps_support) is_asleep = is_inactive(p.self) && is_inactive(p.changed);
    if (met && what == meeting::in_step && !is_asleep) {
      state.store(p.changed, p.self.number, typename Effects::interaction_writes{});
      store_changes(p);
    }
    if (!met) {
      forget_kicks<Effects>(state, p.self.number);
    } else if constexpr (Effects::keeps_pair_forces) {
      particle<S, typename Effects::interaction_kicks> kicks;
      kicks[pair_acceleration{}] = (p.changed[velocity{}] - p.self[velocity{}]) * (1 / dt);
      if constexpr (Effects::keeps_pair_torques) {
        kicks[pair_angular_acceleration{}] = (p.changed[angular_velocity{}] - p.self[angular_velocity{}]) * (1 / dt);
      }
      state.store(kicks, p.self.number, typename Effects::interaction_kicks{});
    }
  }

 private:
  /// For `contact_work`: by how much others change velocity and spin.
  COLLIDE_HD_INLINE void store_changes([[maybe_unused]] pair_state const& p) const {
    if constexpr (contains<typename Effects::all, pairs_push>) {
      particle<S, columns<pairs_push, pairs_turn>> by;
      set_initial_values(by);
      by[pairs_push{}] = p.changed[velocity{}] - p.self[velocity{}];
      if constexpr (contains<typename interaction::list, angular_velocity>)
        by[pairs_turn{}] = p.changed[angular_velocity{}] - p.self[angular_velocity{}];
      state.store(by, p.self.number, columns<pairs_push, pairs_turn>{});
    }
  }

  /// Calls f() while two particles are where they meet: across a side of the box, if space repeats. By how far it moves
  /// the one that changes is added to where that is.
  template <class F>
  COLLIDE_HD_INLINE void side_by_side(pair_state& p, [[maybe_unused]] interaction& other, F const& f) const {
    if constexpr (Effects::repeats) {
      vec3<S>&self = p.self[position{}], &changed = p.changed[position{}];
      vec3<S> const here = self, there = changed;
      order.space.bring_together(self, other[position{}]);
      changed = self;
      f();
      changed = there + (changed - self);
      self = here;
    } else {
      f();
    }
  }

  /// Particles that sleep are pressed by others too, where that is passed on to what they lie on.
  COLLIDE_HD_INLINE bool takes_part(interaction& p) const {
    if constexpr (Effects::keeps_support) {
      return effects.only_sleeps(p);  // or is awake
    } else {
      return !is_inactive(p);
    }
  }
};

/// Kernel functor of `for_each` over places in the order: a particle meets those on its list, or in its run, that
/// overlap it. Where there was no room for a run, all that overlap it are looked for, as many as can be held at a time,
/// by rising numbers.
template <class S, class Effects>
struct interact_listed : pair_interaction<S, Effects> {
  /// Waits for memory, mostly: 128 registers a thread.
  template <class>
  static constexpr int min_blocks_per_sm = 8;

  COLLIDE_AS_O3 COLLIDE_HD void operator()(std::size_t i) const {
    if (i == 0) this->order.header->rebuild = 0;  // not read again in this step
    if (i < this->order.header->count && !this->is_left_out(i)) meet_listed(static_cast<std::uint32_t>(i));
  }

 protected:
  using ordered = sorted_particles<S, Effects>;
  using pair_state = typename pair_interaction<S, Effects>::pair_state;

  COLLIDE_HD_INLINE void meet_listed(std::uint32_t self) const {
    auto const& places = this->order;
    bool const is_listed = places.list(0, self) != places.overflow_mark;
    pair_state p(places.load(self));
    if (is_listed && is_among_inactive(self, p)) return this->store(p);
    if constexpr (ordered::has_memory) {
      if (is_listed) fetch_records(self);
    }
    do {
      if (is_listed) {
        go_through_list(self, p);
      } else if (places.list(1, self) != places.overflow_mark) {
        go_through_run(self, p);
      } else {
        search(self, p);
      }
    } while (this->must_meet_again(p));
    this->store(p);
  }

 private:
  /// True of a particle that is inactive, as are all on its list: none of them does anything to it.
  COLLIDE_HD_INLINE bool is_among_inactive([[maybe_unused]] std::uint32_t self, [[maybe_unused]] pair_state& p) const {
    if constexpr (Effects::any_inactive && !Effects::keeps_support) {
      auto const& places = this->order;
      if (!this->is_inactive(p.self)) return false;
      for (std::uint32_t k = 0; k < ordered::listed && places.list(k, self) != self; ++k) {
        auto other = places.load(places.list(k, self));
        if (!this->is_inactive(other)) return false;
      }
      return true;
    }
    return false;
  }

  /// On a CPU: what the contacts of a particle remember comes into the cache all at a time.
  COLLIDE_HD_INLINE void fetch_records([[maybe_unused]] std::size_t i) const {
#if !defined(__CUDA_ARCH__)
    auto const& places = this->order;
    for (std::uint32_t left = places.memory.touching[i]; left != 0; left &= left - 1) {
      __builtin_prefetch(places.memory.slot(std::size_t(__builtin_ctz(left)) * places.capacity + i).first, 1);
    }
#endif
  }

  COLLIDE_HD_INLINE void go_through_list(std::uint32_t self, pair_state& p) const {
    auto const& places = this->order;
    if constexpr (ordered::has_memory) {
      std::uint32_t const before = places.memory.touching[self];
      std::uint32_t touching = 0;
      for_each_listed(self, before, [&](std::uint32_t place, bool overlap, std::uint32_t k) {
        auto const record = places.memory.slot(k * places.capacity + self);
        if (this->interact(p, place, overlap, (before >> k & 1) != 0, record)) touching |= 1u << k;
      });
      if ((touching | before) != 0) places.memory.touching[self] = touching;
    } else {
      for_each_listed(self, 0, [&](std::uint32_t place, bool, std::uint32_t) { this->interact(p, place); });
    }
  }

  COLLIDE_HD_INLINE void go_through_run(std::uint32_t self, pair_state& p) const {
    auto const& places = this->order;
    std::uint32_t const first = places.list(1, self), size = places.list(2, self);
    auto const place_of = [&](std::uint32_t k) { return k < size ? places.runs[first + k] : self; };
    if constexpr (ordered::has_memory) {
      std::uint8_t* const touching = places.memory.run_touching + first;
      auto const was = [&](std::uint32_t k) { return touching[k] != 0; };
      for_each_near(self, place_of, was, [&](std::uint32_t place, bool overlap, std::uint32_t k) {
        auto const record = places.memory.slot(places.run_item(first + k));
        touching[k] = this->interact(p, place, overlap, was(k), record);
      });
    } else {
      for_each_near(
          self, place_of, [](std::uint32_t) { return false; },
          [&](std::uint32_t place, bool, std::uint32_t) { this->interact(p, place); });
    }
  }

  COLLIDE_HD void search(std::uint32_t self, pair_state& p) const {
    auto const& places = this->order;
    if constexpr (ordered::has_memory) store_relaxed(&places.header->forgotten, 1u);
    id last = 0;
    for (bool first = true, complete = false; !complete; first = false) {
      first_neighbours<16> near;
      places.for_each_overlapping(self, S(0), [&](std::uint32_t k, int row) {
        id const number = places.number_at(k);
        if ((first || number > last) && places.is_in_row(k, self, row)) near.add(number, k);
      });
      COLLIDE_NO_UNROLL
      for (std::uint32_t k = 0; k < near.size; ++k) {
        if constexpr (ordered::has_memory) {
          contact_record<S, typename Effects::remembered> forgotten{};
          this->interact(p, near.places[k], true, false, forgotten);
        } else {
          this->interact(p, near.places[k]);
        }
      }
      complete = near.complete;
      if (!complete) last = near.numbers[near.size - 1];
    }
  }

  /// f(place, overlap, k) for the places place_of(k), from k = 0 until that is `self`, of those that overlap it, or for
  /// which was(k).
  template <class PlaceOf, class Was, class F>
  COLLIDE_HD_INLINE void for_each_near(std::uint32_t self, PlaceOf const& place_of, Was const& was, F const& f) const {
    auto const& places = this->order;
    packed_sphere<S> const own = places.spheres[self];
    // while one is looked at, the next and the place behind it are loaded
    std::uint32_t next = place_of(0), behind = next != self ? place_of(1) : self;
    packed_sphere<S> next_sphere = places.spheres[next];
    COLLIDE_NO_UNROLL
    for (std::uint32_t k = 0; next != self; ++k) {
      std::uint32_t const place = next;
      packed_sphere<S> const sphere = next_sphere;
      next = behind;
      next_sphere = places.spheres[next];
      behind = next != self ? place_of(k + 2) : self;
      bool const overlap = places.within_skin(own, sphere, S(0));
      if (overlap || was(k)) f(place, overlap, k);
    }
  }

  /// Calls f for those on the list of a particle, of which bit k of `before` says was(k).
  template <class F>
  COLLIDE_HD_INLINE void for_each_listed(std::uint32_t self, std::uint32_t before, F const& f) const {
    auto const& places = this->order;
#if defined(__CUDA_ARCH__)
    for_each_near(
        self, [&](std::uint32_t k) { return k < ordered::listed ? places.list(k, self) : self; },
        [&](std::uint32_t k) { return (before >> k & 1) != 0; }, f);
#else
    // first all are looked at, without a branch that a processor would have to guess
    packed_sphere<S> const own = places.spheres[self];
    std::uint32_t found = 0;
    for (std::uint32_t k = 0; k < ordered::listed && places.list(k, self) != self; ++k)
      found |= std::uint32_t{places.within_skin(own, places.spheres[places.list(k, self)], S(0))} << k;
    for (std::uint32_t left = found | before; left != 0; left &= left - 1) {
      auto const k = static_cast<std::uint32_t>(__builtin_ctz(left));
      f(places.list(k, self), (found >> k & 1) != 0, k);
    }
#endif
  }
};

/// Kernel functor of `for_each` over places in the order: the same for particles that meet none of other ranks.
template <class S, class Effects>
struct interact_inside : interact_listed<S, Effects> {
  COLLIDE_AS_O3 COLLIDE_HD void operator()(std::size_t i) const {
    auto const& places = this->order;
    if (i >= places.header->count || places.is_at_border[i] != 0 || this->is_left_out(i)) return;
    this->meet_listed(static_cast<std::uint32_t>(i));
  }
};
/// Kernel functor of `for_each` over the others.
template <class S, class Effects>
struct interact_at_border : interact_listed<S, Effects> {
  COLLIDE_AS_O3 COLLIDE_HD void operator()(std::size_t k) const { this->meet_listed(this->order.border[k]); }
};

}  // namespace collide::detail
