/// \file
/// Particles that meet once a pair, on a CPU, where all that acts between them is one effect whose particles do the
/// opposite to each other.
///
/// Each pair of the lists of neighbours is an item of the particle that comes first in the order. In a step the pairs
/// that touch are looked for, then the effect says of some of them at a time, on the lanes of the vector unit, what the
/// two do to each other. That is kept at the item, with what the contact remembers; then each particle sums up, in the
/// order of numbers. So the sums have the bits that they have where each of two particles asks for itself
/// (pair_interaction.hpp).
///
/// Such an effect has members `see`, `act` and `give`, as `granular_contact` has.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <collide/effects/detail/sphere_action.hpp>
#include <collide/exact/detail/numeric/pack.hpp>
#include <collide/simulation/detail/neighbours/pair_interaction.hpp>
#include <collide/spaces/detail/algorithms.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace collide::detail {

/// The effects of a scene, as lists of neighbours see them that remember nothing.
template <class Effects>
struct without_memory : Effects {
  using remembered = columns<>;
  explicit without_memory(Effects const& e) : Effects(e) {}
};

/// The contacts of lists of neighbours: those of the particle at place i with others behind it are
/// firsts[i] .. firsts[i + 1].
template <class S, class Effects>
struct pair_items {
  using record = contact_record<S, typename Effects::remembered>;
  using action = stored_action<S, Effects::action_width>;

  static constexpr std::uint8_t remembers = 1, acts = 2, meets = 4;

  std::uint32_t* firsts;
  std::uint32_t* others;  ///< places
  std::uint8_t* marks;    ///< of these: `remembers` something, `acts` in this step, and any is seen as in contact
  record* records;
  action* actions;
};

/// Entries of the lists of neighbours: twice the item, and 1 where the particle is the second of the pair. In place of
/// the number of a place, once all pairs have items.
inline constexpr std::uint32_t no_entry = 0xfffffffeu;

/// Calls f(entry) for all entries of the list of the particle at a place.
template <class Order, class F>
COLLIDE_HD_INLINE void for_each_entry(Order const& order, std::size_t i, F const& f) {
  if (order.list(0, i) != order.overflow_mark) {
    for (std::uint32_t k = 0; k < Order::listed && order.list(k, i) != no_entry; ++k) f(order.list(k, i));
  } else {
    std::uint32_t const first = order.list(1, i), size = order.list(2, i);
    for (std::uint32_t k = first; k < first + size; ++k) f(order.runs[k]);
  }
}

/// Functor over ranges of places: finds what touches, and asks the effect.
template <class S, class Effects>
struct meet_once {
  using listed = without_memory<Effects>;
  using ordered = sorted_particles<S, listed>;
  using remembered = typename Effects::remembered;
  ordered order;
  pair_items<S, Effects> items;
  Effects effects;
  S dt;
  meeting what;

  COLLIDE_AS_O3 void operator()(std::size_t begin, std::size_t end) const {
    touching_pair found[capacity];
    std::uint32_t size = 0;
    std::uint32_t const last_item = items.firsts[order.header->count] - 1;
    for (std::size_t i = begin; i < end; ++i) {
      packed_sphere<S> const own = order.spheres[i];
      std::uint32_t const last = items.firsts[i + 1];
      for (std::uint32_t k = items.firsts[i]; k < last; ++k) {
        std::uint32_t const other = items.others[k];
        prefetch(order.spheres + items.others[min(k + 16, last_item)]);
        bool const overlap = order.within_skin(own, order.spheres[other], S(0));
        auto const was = static_cast<std::uint8_t>(items.marks[k] & items.remembers);
        found[size] = {static_cast<std::uint32_t>(i), other, k};
        items.marks[k] = static_cast<std::uint8_t>(was | (overlap ? items.meets : 0));
        size += overlap || was != 0;
        if (size == capacity) {
          meet(found, size);
          size = 0;
        }
      }
    }
    meet(found, size);
  }

 private:
  using interaction = typename ordered::interaction;
  using P = pack_of<S>;
  static constexpr std::uint32_t capacity = 1024;  ///< for pairs that touch

  struct touching_pair {
    std::uint32_t place, other, item;
  };

  /// Pairs of the same two solids are together.
  void meet(touching_pair* found, std::uint32_t size) const {
    effects.for_mutual([&](auto const& effect) {
      constexpr unsigned kinds = std::decay_t<decltype(effect.made_of)>::pairs;
      if constexpr (kinds == 1) {
        meet_alike(effect, found, size, 0);
      } else {
        std::uint32_t ends[kinds + 1] = {};
        std::uint16_t kind_of[capacity];
        touching_pair sorted[capacity];
        for (std::uint32_t k = 0; k < size; ++k) {
          interaction a = order.load(found[k].place), b = order.load(found[k].other);
          kind_of[k] = static_cast<std::uint16_t>(effect.made_of.pair_of(seen(effect, a), seen(effect, b)));
          ++ends[kind_of[k] + 1];
        }
        for (unsigned kind = 0; kind < kinds; ++kind) ends[kind + 1] += ends[kind];
        std::uint32_t begin = 0;
        for (std::uint32_t k = 0; k < size; ++k) sorted[ends[kind_of[k]]++] = found[k];
        for (unsigned kind = 0; kind < kinds; ++kind) {
          meet_alike(effect, sorted + begin, ends[kind] - begin, static_cast<int>(kind));
          begin = ends[kind];
        }
      }
    });
  }

  template <class Effect>
  static COLLIDE_HD_INLINE particle_access<Effect, interaction> seen(Effect const&, interaction& p) {
    return particle_access<Effect, interaction>(p);
  }

  template <class Effect>
  void meet_alike(Effect const& effect, touching_pair const* found, std::uint32_t size, int kind) const {
    multiversioned([&, this] { meet_together(effect, found, size, effect.made_of.of_pair(kind)); });
  }

  template <class Effect, class Material>
  COLLIDE_HD_INLINE void meet_together(Effect const& effect, touching_pair const* found, std::uint32_t size,
                                       Material const& of) const {
    constexpr unsigned lanes = lanes_of<P>;
    contact_values<S, remembered> initial;
    S at_first[contact_values<S, remembered>::width + 1];
    initial.for_each_number([&](S& x, int c, int) { at_first[c] = x; });
    for (std::uint32_t first = 0; first < size; first += lanes) {
      std::uint32_t const last = size - 1;
      touching_pair pairs[lanes];
      S const* remembers[lanes];
      S upward[lanes], since[lanes];
      interaction self[lanes], other[lanes];
      for (std::uint32_t l = 0; l < lanes; ++l) {
        touching_pair const& pair = pairs[l] = found[min(first + l, last)];  // the last fill their pack
        touching_pair const& soon = found[min(first + 3 * lanes + l, last)];
        order.fetch(soon.other);
        prefetch<true>(items.actions + soon.item);
        if constexpr (remembered::size != 0) prefetch<true>(items.records + soon.item);
        self[l] = order.load(pair.place), other[l] = order.load(pair.other);
        if constexpr (Effects::repeats) order.space.bring_together(self[l][position{}], other[l][position{}]);
        bool const was = (items.marks[pair.item] & items.remembers) != 0;
        remembers[l] = was ? items.records[pair.item].numbers : at_first;
        upward[l] = self[l].number < other[l].number ? S(-1) : S(1);
        since[l] = what != meeting::in_step && !was ? S(0) : dt;
      }
      using from = from_lanes<P>;
      auto const a = effect.template see<P>([&](int l) { return seen(effect, self[l]); });
      auto const b = effect.template see<P>([&](int l) { return seen(effect, other[l]); });
      contact_values<P, remembered> values;
      values.for_each_number([&](P& x, int c, int) { x = from::of([&](int l) { return remembers[l][c]; }); });
      contact_access<remembered, contact_values<P, remembered>, P> const memory(
          values, from::of([&](int l) { return since[l]; }));
      sphere_action<P> action = effect.act(a, b, from::of([&](int l) { return upward[l]; }), of, memory);
      for (std::uint32_t l = 0; l < lanes && first + l < size; ++l)
        keep(pairs[l].item, action, values, static_cast<int>(l));
    }
  }

  COLLIDE_HD_INLINE void keep(std::uint32_t item, sphere_action<P>& action, contact_values<P, remembered>& values,
                              int l) const {
    bool const acts = lane_of_mask(action.is_there, l);
    std::uint8_t& mark = items.marks[item];
    if (acts) mark = static_cast<std::uint8_t>(mark | items.acts | items.meets);
    if (acts) items.actions[item].set(action, l);
    if (remembered::size == 0 || what != meeting::in_step) return;
    mark = static_cast<std::uint8_t>((mark & ~items.remembers) | (acts ? items.remembers : 0));
    if constexpr (remembered::size != 0) {
      auto& record = items.records[item];
      values.for_each_number([&](P& x, int c, int) { record.numbers[c] = lane(x, l); });
    }
  }
};

/// Functor of `for_each` over places: a particle sums up what others do to it.
template <class S, class Effects>
struct sum_actions : pair_interaction<S, without_memory<Effects>> {
  pair_items<S, Effects> items;

  /// True if all items of the particle at place i are from number `first` on.
  COLLIDE_HD_INLINE bool is_alone(std::size_t i, std::uint32_t first) const {
    bool alone = true;
    for_each_entry(this->order, i, [&](std::uint32_t entry) { alone = alone && entry >> 1 >= first; });
    return alone;
  }

  COLLIDE_AS_O3 void operator()(std::size_t i) const {
    auto const& places = this->order;
    fetch_kicks(min(i + 24, std::size_t{places.header->count} - 1), typename Effects::interaction_kicks{});
    std::size_t const soon = min(i + 6, std::size_t{places.header->count} - 1);
    if (places.list(0, soon) != places.overflow_mark)
      for_each_entry(places, soon, [&](std::uint32_t entry) { prefetch(items.actions + (entry >> 1)); });
    pair_state p(places.load(i));
    std::uint32_t entries[64], size = 0;
    this->effects.for_mutual([&](auto const& effect) {
      using effect_type = std::decay_t<decltype(effect)>;
      auto const own = as_met(effect, p);
      vec3<S> v = own.velocity, spin = own.spin;
      particle_access<effect_type, interaction> const seen(p.self);
      S const impulse = this->dt * effect_type::template of_clump<S>(seen) / effect_type::mass_of(own);
      auto const take = [&] {
        for (std::uint32_t k = 0; k < size; ++k) {
          std::uint32_t const item = entries[k] >> 1;
          if ((items.marks[item] & items.acts) == 0) continue;
          effect.give(v, spin, items.actions[item].on((entries[k] & 1) != 0), own.radius, impulse);
        }
        p.met = p.met || size != 0;
        size = 0;
      };
      for_each_entry(places, i, [&](std::uint32_t entry) {
        entries[size] = entry;
        size += (items.marks[entry >> 1] & items.meets) != 0;
        if (size == 64) take();
      });
      take();
      p.changed[velocity{}] = v;
      if constexpr (effect_type::turns) p.changed[angular_velocity{}] = spin;
    });
    if (p.met) mark_contact(p.changed);
    this->store(p);
  }

 private:
  using base = pair_interaction<S, without_memory<Effects>>;
  using interaction = typename base::interaction;
  using pair_state = typename base::pair_state;

  template <class Effect>
  static COLLIDE_HD_INLINE meeting_sphere<S> as_met(Effect const& effect, pair_state& p) {
    return effect.template see<S>([&](int) { return particle_access<Effect, interaction>(p.self); });
  }

  /// Asks for memory that is written soon.
  template <class... Kick>
  void fetch_kicks([[maybe_unused]] std::size_t i, columns<Kick...>) const {
    (prefetch<true>(this->state.at(Kick{}) + 3 * std::size_t{this->order.numbers[i]}), ...);
  }
};

/// In place of `pair_actions`.
struct no_pair_actions {
  static std::size_t bytes() { return 0; }
};

/// The contacts of lists of neighbours, and those that lists had before, until new ones are made.
template <class S, class Effects>
class pair_actions {
  using remembered = typename Effects::remembered;
  using record = contact_record<S, remembered>;
  using order = sorted_particles<S, without_memory<Effects>>;
  static constexpr bool has_memory = remembered::size != 0;
  static constexpr std::uint32_t none = order::overflow_mark;
  static constexpr std::size_t usual = 4;  ///< items a particle: in a packed bed there are fewer

 public:
  void reserve(std::pmr::memory_resource* resource, std::size_t n) {
    for (kept* k : {&now_, &before_}) {
      k->firsts.reserve(resource, n + 1);
      k->reserve(resource, usual * n);
    }
    actions_.reserve(resource, usual * n);
    place_before_.reserve(resource, n);
  }
  /// There are no contacts.
  void clear() { was_saved_ = has_before_ = false; }

  pair_items<S, Effects> items() const {
    return {now_.firsts.data(), now_.others.data(), now_.marks.data(), now_.records.data(), actions_.data()};
  }

  /// Before places change: keeps what contacts remember.
  void keep(order const& o) {
    if (!has_memory || was_saved_) return;
    has_before_ = o.header->count != 0;
    std::swap(now_, before_);
    std::fill_n(place_before_.data(), o.capacity, none);
    for (std::uint32_t i = 0; i < o.header->count; ++i) place_before_.data()[o.numbers[i]] = i;
  }

  /// Once lists are made: each pair gets an item, with what it remembers.
  template <class Space>
  void build(Space const& space, order const& o) {
    std::size_t const count = o.header->count;
    std::uint32_t* const firsts = now_.firsts.data();
    space.for_each(count, [&](std::size_t i) {
      std::uint32_t behind = 0;
      for_each_place(o, i, [&](std::uint32_t& place) { behind += place > i; });
      firsts[i] = behind;
    });
    firsts[count] = 0;
    exclusive_scan(space, firsts, count + 1);
    ensure_capacity(space, firsts[count]);
    space.for_each(count, [&](std::size_t i) {
      std::uint32_t item = firsts[i];
      for_each_place(o, i, [&](std::uint32_t& place) {
        if (place <= i) return;
        now_.others.data()[item] = place;
        restore(o, static_cast<std::uint32_t>(i), place, item);
        ++item;
      });
    });
    space.for_each(count, [&](std::size_t i) {
      std::uint32_t item = firsts[i], size = 0;
      for_each_place(o, i, [&](std::uint32_t& place) {
        ++size;
        place = place > i ? 2 * item++ : 2 * now_.find(place, static_cast<std::uint32_t>(i)) + 1;
      });
      if (size < order::listed && o.list(0, i) != order::overflow_mark) o.list(size, i) = no_entry;
    });
    was_saved_ = has_before_ = false;
  }

  /// Particles meet, and sum up. All items of a particle are known once those of the places before it are: so it sums
  /// up while they are in the cache, except for what other threads know.
  template <class Space>
  void interact(Space const& space, meet_once<S, Effects> const& meet, sum_actions<S, Effects> const& sum) const {
    constexpr std::size_t places = 256;  // that meet before they sum up
    std::size_t const count = meet.order.header->count, parts = space.saturating_blocks();
    std::size_t const share = (count + parts - 1) / parts;
    auto const is_alone = [&](std::size_t i) {
      return parts == 1 || sum.is_alone(i, now_.firsts.data()[i / share * share]);
    };
    for_each_block(space, parts, [&](std::size_t part) {
      std::size_t const end = std::min(count, (part + 1) * share);
      for (std::size_t first = part * share; first < end; first += places) {
        std::size_t const last = std::min(first + places, end);
        meet(first, last);
        for (std::size_t i = first; i < last; ++i)
          if (is_alone(i)) sum(i);
      }
    });
    if (parts == 1) return;
    space.for_each(count, [&](std::size_t i) {
      if (!is_alone(i)) sum(i);
    });
  }

  /// The memory of contacts of the first `n` particles, by numbers.
  saved_contacts<S> saved(list_state const& header, id const* numbers, std::size_t n) const {
    struct contact {
      id other;
      std::uint32_t item;
      bool is_second;
    };
    std::vector<std::vector<contact>> of(n);
    bool const waits = header.count == 0;  // for lists
    kept const& from = waits ? before_ : now_;
    std::size_t const count = !waits ? header.count : was_saved_ ? saved_ : 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      for (std::uint32_t k = from.firsts.data()[i]; k < from.firsts.data()[i + 1]; ++k) {
        if ((from.marks.data()[k] & 1) == 0) continue;
        std::uint32_t const j = from.others.data()[k];
        id const a = waits ? i : numbers[i], b = waits ? j : numbers[j];
        of[a].push_back({b, k, false});
        of[b].push_back({a, k, true});
      }
    }
    saved_contacts<S> all;
    for (auto& contacts : of) {
      std::sort(contacts.begin(), contacts.end(), [](contact const& a, contact const& b) { return a.other < b.other; });
      all.counts.push_back(static_cast<std::uint32_t>(contacts.size()));
      for (contact const& c : contacts) {
        record const r = seen_from(c.is_second, from.records.data()[c.item]);
        all.others.push_back(c.other);
        all.values.insert(all.values.end(), r.numbers, r.numbers + contact_values<S, remembered>::width);
      }
    }
    return all;
  }

  /// After `clear`: lists that are made have what was saved, as if places had been numbers.
  void restore(std::pmr::memory_resource* resource, saved_contacts<S> const& from) {
    constexpr std::size_t width = contact_values<S, remembered>::width;
    before_.reserve(resource, from.others.size() / 2 + 1);
    was_saved_ = has_before_ = true;
    saved_ = from.counts.size();
    std::uint32_t item = 0;
    std::size_t at = 0;
    for (std::size_t a = 0; a < saved_; ++a) {
      before_.firsts.data()[a] = item;
      place_before_.data()[a] = static_cast<std::uint32_t>(a);
      for (std::size_t end = at + from.counts[a]; at < end; ++at) {
        if (from.others[at] <= a) continue;
        before_.others.data()[item] = from.others[at];
        before_.marks.data()[item] = 1;
        std::copy_n(from.values.begin() + std::ptrdiff_t(at * width), width, before_.records.data()[item++].numbers);
      }
    }
    before_.firsts.data()[saved_] = item;
  }

  std::size_t bytes() const { return now_.bytes() + before_.bytes() + place_before_.bytes() + actions_.bytes(); }

 private:
  struct kept {
    buffer<std::uint32_t> firsts, others;
    buffer<std::uint8_t> marks;
    buffer<record> records;

    void reserve(std::pmr::memory_resource* resource, std::size_t items) {
      others.reserve(resource, items);
      marks.reserve(resource, items);
      if constexpr (has_memory) records.reserve(resource, items);
    }
    std::size_t bytes() const { return firsts.bytes() + others.bytes() + marks.bytes() + records.bytes(); }
    /// The item of two places, the first of which comes first.
    std::uint32_t find(std::uint32_t first, std::uint32_t second) const {
      std::uint32_t const end = firsts.data()[first + 1];
      for (std::uint32_t k = firsts.data()[first]; k < end; ++k)
        if (others.data()[k] == second) return k;
      return none;
    }
  };

  template <class F>
  static void for_each_place(order const& o, std::size_t i, F const& f) {
    if (o.list(0, i) != order::overflow_mark) {
      for (std::uint32_t k = 0; k < order::listed && o.list(k, i) != i; ++k) f(o.list(k, i));
    } else {
      std::uint32_t const first = o.list(1, i), size = o.list(2, i);
      for (std::uint32_t k = first; k < first + size; ++k) f(o.runs[k]);
    }
  }

  /// A contact's memory, as the first or the second of the two has it.
  static record seen_from(bool second, record const& from) {
    record r = from;
    if (has_memory && second) {
      auto values = r.values();
      values.for_each_number([&](S& x, int, int sign) { x = sign < 0 ? 0 - x : x; });
      r.set(values);
    }
    return r;
  }

  void restore(order const& o, std::uint32_t i, std::uint32_t j, std::uint32_t item) {
    now_.marks.data()[item] = 0;
    if (!has_memory || !has_before_ || o.is_new(i) || o.is_new(j)) return;
    std::uint32_t const a = place_before_.data()[o.numbers[i]], b = place_before_.data()[o.numbers[j]];
    if (a == none || b == none) return;
    std::uint32_t const from = before_.find(min(a, b), max(a, b));
    if (from == none || (before_.marks.data()[from] & 1) == 0) return;
    now_.marks.data()[item] = 1;
    now_.records.data()[item] = seen_from(a > b, before_.records.data()[from]);
  }

  template <class Space>
  void ensure_capacity(Space const& space, std::size_t n) {
    std::size_t const capacity = n + n / 8 + 64;
    if (now_.others.capacity() < n) now_.reserve(space.resource(), capacity);
    if (actions_.capacity() < n) actions_.reserve(space.resource(), capacity);
  }

  kept now_, before_;
  buffer<std::uint32_t> place_before_;  ///< by numbers
  buffer<typename pair_items<S, Effects>::action> actions_;
  bool has_before_ = false, was_saved_ = false;
  std::size_t saved_ = 0;  ///< particles of which contacts were saved
};

}  // namespace collide::detail
