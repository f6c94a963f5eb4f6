/// \file
/// Kernel bodies that keep the neighbour lists: what has moved far, cells, lists.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/effects/detail/effect_list.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>
#include <collide/simulation/detail/neighbours/particle_order.hpp>
#include <collide/spaces/detail/algorithms.hpp>
#include <collide/spaces/detail/atomic.hpp>

namespace collide::detail {

/// Kernel functor of `for_each` over particles, and places in the order: copies what particles must know of each other,
/// and asks for new lists if these may lack something: where a particle has come, or has moved too far; or have too
/// much: where a source has made a particle in place of another. Not for copies of other ranks' particles.
template <class S, class Effects>
struct update_and_check_skin {
  particle_state<S, typename Effects::all> state;
  sorted_particles<S, Effects> order;
  S limit;  ///< that a particle may have moved

  using ordered = sorted_particles<S, Effects>;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (!order.is_of_another(i)) check_births(i);
    if (i >= order.header->count) return;
    id const number = order.numbers[i];
    if (!order.is_of_another(number)) update(i, number);
  }

 protected:
  COLLIDE_HD_INLINE void check_births([[maybe_unused]] std::size_t i) const {
    if constexpr (ordered::has_absent) {
      std::uint8_t const mark = state.at(alive{})[i];
      if (mark >= newborn || (mark != 0 && order.known[i] == 0)) order.ask_to_rebuild();
    }
  }

  COLLIDE_HD_INLINE void update(std::size_t i, id number) const {
    if constexpr (ordered::has_absent) {
      if (!is_there(number)) return order.deactivate(i);
    }
    typename ordered::interaction p;
    state.load(p, number);
    if (!is_finite(p[position{}])) return order.deactivate(i);
    packed_sphere<S> const now = order.store(i, p);
    auto const before = order.references[i];
    vec3<S> const moved = order.between(before, now);
    S const left = limit - before.growth(now);
    bool const stayed = dot(moved, moved) < mul_rn(left, left) && left > 0;
    if (!stayed) order.ask_to_rebuild();
  }

 private:
  COLLIDE_HD_INLINE bool is_there(std::size_t number) const { return state.at(alive{})[number] != 0; }
};

/// Kernel functor of `for_each` over copies of other ranks' particles: as `update_and_check_skin`.
template <class S, class Effects>
struct update_copies : update_and_check_skin<S, Effects> {
  COLLIDE_HD void operator()(std::size_t i) const {
    std::size_t const number = this->order.own + i;
    this->check_births(number);
    std::uint32_t const place = this->order.places_of_copies[i];
    if (place < this->order.header->count) this->update(place, static_cast<id>(number));
  }
};

/// Kernel functor of `for_each_if_nonzero` over the table, which it empties, and over places in the old order: keeps
/// what contacts remember, by numbers.
template <class S, class Effects>
struct clear_cells {
  using ordered = sorted_particles<S, Effects>;
  ordered order;
  std::size_t in_table;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (i < in_table) order.ends[i] = 0;
    if constexpr (ordered::has_memory) {
      if (i < order.header->count) keep(static_cast<std::uint32_t>(i));
    }
  }

 private:
  COLLIDE_HD_INLINE void keep(std::uint32_t place) const {
    auto const& m = order.memory;
    std::uint32_t touching = 0;
    order.for_each_remembered(place, [&](std::uint32_t other, std::size_t) { touching += order.keeps(place, other); });
    std::uint32_t const first = fetch_add(&order.header->kept, touching);
    if (first + std::size_t{touching} > m.kept_capacity) touching = 0;  // where lists have found no room
    m.kept_of[order.numbers[place]] = {first, touching};
    if (touching == 0) return;
    std::uint32_t n = first;
    order.for_each_remembered(place, [&](std::uint32_t other, std::size_t item) {
      if (!order.keeps(place, other)) return;
      m.kept[n].set(m.slot(item).values());
      m.kept_others[n++] = order.number_at(other);
    });
  }
};

/// Kernel functor of `for_each_if_nonzero` over particles: counts them into cells, or, once blocks have their share of
/// the order, copies them there.
template <class S, class Effects, bool Fill>
struct count_or_scatter {
  particle_state<S, typename Effects::all> state;
  sorted_particles<S, Effects> order;

  using ordered = sorted_particles<S, Effects>;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (!Fill && i == 0) begin();
    using placing = union_of<columns<position>, intersection_of<columns<alive, radius>, typename Effects::all>>;
    particle<S, placing> p;
    state.load(p, i);
    if constexpr (contains<placing, alive>) {
      if constexpr (Fill) order.known[i] = p[alive{}];
      if (p[alive{}] == 0) {
        if constexpr (ordered::has_memory) order.memory.kept_of[i].count = 0;
        if constexpr (Fill) {
          order.keep_place(i, order.overflow_mark);
          forget_kicks<Effects>(state, i);
        }
        return;
      }
    }
    vec3<S> const c = order.inside(p[position{}]);
    S own = 0;
    if constexpr (contains<placing, radius>) own = p[radius{}];
    std::uint32_t const place = order.place_in_table(c, own), slot = fetch_add(order.ends + place + 1, 1u);
    if constexpr (!Fill) order.keep_on_curve(place, c);
    if constexpr (Fill) {
      order.numbers[slot] = static_cast<id>(i);
      order.keep_place(i, slot);
      typename ordered::interaction whole;
      state.load(whole, i);
      order.references[slot].set(order.store(slot, whole));
    }
  }

 private:
  COLLIDE_HD_INLINE void begin() const {
    auto& h = *order.header;
    h.count = h.in_runs = h.kept = 0;
    if constexpr (ordered::on_ranks) h.at_border = 0;
  }
};

/// Kernel functor of `for_each_if_nonzero` over places in the order: lists what is near.
template <class S, class Effects>
struct build_lists {
  sorted_particles<S, Effects> order;
  S skin;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (i < order.header->count) list(static_cast<std::uint32_t>(i));
  }

 protected:
  using ordered = sorted_particles<S, Effects>;
  static constexpr std::uint32_t capacity = ordered::listed;

  COLLIDE_HD_INLINE void list(std::uint32_t i) const {
    std::uint32_t places[capacity], found = 0;
    std::uint8_t rows[capacity];
    order.for_each_overlapping(i, skin, [&](std::uint32_t k, int row) {
      if (found < capacity) {
        places[found] = k;
        rows[found] = static_cast<std::uint8_t>(row);
      }
      ++found;
    });
    if (found > capacity) {
      list_run(i, found);
      return;
    }
    first_neighbours<capacity> near;
    COLLIDE_NO_UNROLL
    for (std::uint32_t n = 0; n < found; ++n) {
      if (order.is_in_row(places[n], i, rows[n])) near.add(order.number_at(places[n]), places[n]);
    }
    COLLIDE_NO_UNROLL
    for (std::uint32_t n = 0; n < near.size; ++n) order.list(n, i) = near.places[n];
    if (near.size < capacity) order.list(near.size, i) = i;
    mark_border(i, near.places, near.size);
    if constexpr (ordered::has_memory) {
      std::uint32_t touching = 0;
      restore(i, near.places, near.size, [&](std::uint32_t n, auto const& values) {
        order.memory.slot(n * order.capacity + i).set(values);
        touching |= 1u << n;
      });
      order.memory.touching[i] = touching;
    }
  }

  /// Keeps whether any on a particle's list is another rank's; of those that have a run it is not asked.
  COLLIDE_HD_INLINE void mark_border([[maybe_unused]] std::uint32_t i, [[maybe_unused]] std::uint32_t const* places,
                                     [[maybe_unused]] std::uint32_t size) const {
    if constexpr (ordered::on_ranks) {
      bool meets = size > capacity;
      for (std::uint32_t n = 0; n < size && !meets; ++n) meets = order.is_of_another(order.numbers[places[n]]);
      meets = meets && !order.is_of_another(order.numbers[i]);
      order.is_at_border[i] = meets ? 1 : 0;
      if (!meets) return;
      std::uint32_t const k = fetch_add(&order.header->at_border, 1u);
      if (k < order.border_capacity) order.border[k] = i;
    }
  }

  /// A list of any length, as a run of its own.
  COLLIDE_HD void list_run(std::uint32_t i, std::uint32_t found) const {
    mark_border(i, nullptr, found);
    order.list(0, i) = order.overflow_mark;
    std::uint32_t const first = fetch_add(&order.header->in_runs, found);
    order.list(2, i) = first;
    if (first + std::size_t{found} > order.run_capacity) {
      order.list(1, i) = order.overflow_mark;
      return;
    }
    fill_run(i, first);
  }
  /// Lists at item `first` of the runs what is near.
  COLLIDE_HD void fill_run(std::uint32_t i, std::uint32_t first) const {
    std::uint32_t* const run = order.runs + first;
    std::uint32_t size = 0;
    order.for_each_overlapping(i, skin, [&](std::uint32_t k, int row) {
      if (order.is_in_row(k, i, row)) run[size++] = k;
    });
    heap_sort(run, size, [this](std::uint32_t a, std::uint32_t b) { return order.number_at(a) < order.number_at(b); });
    order.list(1, i) = first;
    order.list(2, i) = size = unique(run, size);
    if constexpr (ordered::has_memory) {
      auto const& m = order.memory;
      for (std::uint32_t n = 0; n < size; ++n) m.run_touching[first + n] = 0;
      restore(i, run, size, [&](std::uint32_t n, auto const& values) {
        m.slot(order.run_item(first + n)).set(values);
        m.run_touching[first + n] = 1;
      });
    }
  }

  /// write(n, values) for each kept contact of a particle with neighbour n of its list, which is at places[n]. What has
  /// just been born has not touched anything.
  template <class Write>
  COLLIDE_HD_INLINE void restore(std::uint32_t i, std::uint32_t const* places, std::uint32_t size,
                                 Write const& write) const {
    auto const& m = order.memory;
    COLLIDE_NO_UNROLL
    for (std::uint32_t n = 0; n < size; ++n) {
      bool const is_own = order.keeps(i, places[n]);
      std::uint32_t const keeper = is_own ? i : places[n];
      std::uint32_t const k = find_kept(order.numbers[keeper], order.number_at(is_own ? places[n] : i));
      if (k == ordered::overflow_mark || order.is_new(i) || order.is_new(places[n])) continue;
      write(n, is_own ? m.kept[k].values() : turned_round(m.kept[k].values()));
    }
  }
  /// The kept contact of a particle, by its number in memory, with another.
  COLLIDE_HD_INLINE std::uint32_t find_kept(id keeper, id other) const {
    auto const& m = order.memory;
    kept_range const kept = m.kept_of[keeper];
    std::uint32_t const end = kept.first + kept.count;
    std::uint32_t const k =
        first_not_before(kept.first, end, [&](std::uint32_t at) { return m.kept_others[at] < other; });
    return k < end && m.kept_others[k] == other ? k : ordered::overflow_mark;
  }

  COLLIDE_HD_INLINE std::uint32_t unique(std::uint32_t* run, std::uint32_t n) const {
    std::uint32_t size = 0;
    for (std::uint32_t k = 0; k < n; ++k) {
      if (size == 0 || run[size - 1] != run[k]) run[size++] = run[k];
    }
    return size;
  }
};

/// Kernel functor of `for_each` over places in the order: makes the runs for which there was no room, now that there
/// is.
template <class S, class Effects>
struct build_missing_runs : build_lists<S, Effects> {
  COLLIDE_HD void operator()(std::size_t i) const {
    auto const& places = this->order;
    if (i >= places.header->count || places.list(0, i) != places.overflow_mark) return;
    if (places.list(1, i) == places.overflow_mark) this->fill_run(static_cast<std::uint32_t>(i), places.list(2, i));
  }
};

}  // namespace collide::detail
