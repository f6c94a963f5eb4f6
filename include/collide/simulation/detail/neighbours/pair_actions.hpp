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

#include <collide/core/memory.hpp>
#include <collide/effects/detail/sphere_action.hpp>
#include <collide/exact/detail/numeric/pack.hpp>
#include <collide/simulation/detail/neighbours/pair_interaction.hpp>
#include <collide/spaces/detail/algorithms.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace collide::detail {

/// The effects of a scene, as lists of neighbours see them that remember nothing, and keep only spheres.
template <class Effects>
struct without_memory : Effects {
  using remembered = columns<>;
  using interaction_copies = columns<>;
  static constexpr bool may_be_reordered = true;
  explicit without_memory(Effects const& e) : Effects(e) {}
};

/// The places of two particles on each other's list, the first of which comes first.
struct listed_pair {
  std::uint32_t place, other;
};

/// The contacts of lists of neighbours: those of the particle at place i with others behind it are
/// firsts[i] .. firsts[i + 1].
template <class S, class Effects>
struct pair_items {
  using record = contact_record<S, typename Effects::remembered>;
  using action = stored_action<S, Effects::action_width>;

  static constexpr std::uint8_t remembers = 1, acts = 2, meets = 4, is_upward = 8;

  std::uint32_t* firsts;
  listed_pair* pairs;
  std::uint8_t* marks;  ///< of these: `remembers` something, `acts` in this step, and any is seen as in contact;
                        ///< `is_upward`: the first of the two has the larger number
  record* records;
  action* actions;
  stored_motion<S>* motions;  ///< by places
  /// The contacts of the particle at place i are entries from entry_firsts[i] on, in the order of the others' numbers:
  /// twice the item, and 1 where the particle is the second of the pair.
  std::uint32_t* entry_firsts;
  std::uint32_t* entries;
};

/// Kernel functor of `for_each` over places: how particles move that meet.
template <class S, class Effects>
struct store_motions {
  particle_state<S, typename Effects::all> state;
  sorted_particles<S, without_memory<Effects>> order;
  stored_motion<S>* motions;
  Effects const& effects;

  void operator()(std::size_t i) const {
    if (i >= order.header->count) return;
    interaction p;
    state.load(p, order.numbers[i]);
    effects.for_mutual([&](auto const& effect) { store(effect, p, motions[i]); });
  }

 private:
  using interaction = particle<S, typename Effects::interaction>;

  template <class Effect>
  static COLLIDE_HD_INLINE void store(Effect const& effect, interaction& p, stored_motion<S>& to) {
    particle_access<Effect, interaction> const seen(p);
    to.set(effect.template see<S>([&](int) { return seen; }), effect.made_of.solid_of(seen));
  }
};

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
    multiversioned([&, this] { meet(begin, end); });
  }

 private:
  using P = pack_of<S>;
  static constexpr std::uint32_t capacity = 1024;  ///< for pairs that touch

  static constexpr unsigned lanes = lanes_of<P>;

  void meet(std::size_t begin, std::size_t end) const {
    std::uint32_t found[capacity + lanes];
    std::uint32_t const last = items.firsts[end];
    for (std::uint32_t first = items.firsts[begin]; first < last; first += capacity)
      meet_sorted(found, find(first, min(first + capacity, last), found));
  }

  /// The items of those that touch, or have something to remember; returns how many they are.
  COLLIDE_HD_INLINE std::uint32_t find(std::uint32_t first, std::uint32_t last, std::uint32_t* found) const {
    std::uint32_t size = 0;
    std::uint32_t const last_item = items.firsts[order.header->count] - 1;
    for (std::uint32_t k = first; k < last; k += lanes) {
      listed_pair pairs[lanes];
      for (std::uint32_t l = 0; l < lanes; ++l) {
        pairs[l] = items.pairs[min(k + l, last - 1)];
        std::uint32_t const soon = items.pairs[min(k + l + 16, last_item)].other;
        prefetch(order.spheres + soon);
        prefetch(items.motions + soon);
      }
      vec3<P> a, b;
      P a_radius, b_radius;
      load_spheres(pairs, a, a_radius, b, b_radius);
      vec3<P> const apart = a - b;
      P const reach = a_radius + b_radius;
      mask_of<P> const overlaps = dot(apart, apart) < reach * reach;
      for (std::uint32_t l = 0; l < lanes && k + l < last; ++l) {
        unsigned const meets = bits_of_lane(overlaps, int(l)) & items.meets;  // no branch: it cannot be foreseen
        unsigned const mark = (items.marks[k + l] & unsigned(items.remembers | items.is_upward)) | meets;
        items.marks[k + l] = static_cast<std::uint8_t>(mark);
        found[size] = k + l;
        size += (mark | mark / items.meets) & items.remembers;
      }
    }
    return size;
  }

  /// Pairs of the same two solids are together.
  void meet_sorted(std::uint32_t* found, std::uint32_t size) const {
    effects.for_mutual([&](auto const& effect) {
      auto const& made_of = effect.made_of;
      constexpr unsigned kinds = std::decay_t<decltype(made_of)>::pairs;
      std::uint32_t ends[kinds + 1] = {0, size};
      std::uint32_t sorted[kinds == 1 ? 1 : capacity];
      if constexpr (kinds != 1) {
        std::uint16_t kind_of[capacity];
        ends[1] = 0;
        for (std::uint32_t k = 0; k < size; ++k) {
          listed_pair const& pair = items.pairs[found[k]];
          kind_of[k] = static_cast<std::uint16_t>(
              made_of.pair_of(items.motions[pair.place].solid(), items.motions[pair.other].solid()));
          ++ends[kind_of[k] + 1];
        }
        for (unsigned kind = 0; kind < kinds; ++kind) ends[kind + 1] += ends[kind];
        std::uint32_t begins[kinds];
        std::copy_n(ends, kinds, begins);
        for (std::uint32_t k = 0; k < size; ++k) sorted[begins[kind_of[k]]++] = found[k];
        found = sorted;
      }
      for (unsigned kind = 0; kind < kinds; ++kind)
        meet_together(effect, found + ends[kind], ends[kind + 1] - ends[kind], made_of.of_pair(static_cast<int>(kind)));
    });
  }

  static constexpr unsigned remembered_width = unsigned(contact_values<S, remembered>::width);
  /// Numbers of a record as they are read: it is as wide as a multiple of four if it has more than two.
  static constexpr unsigned record_width = remembered_width > 2    ? (remembered_width + 3) / 4 * 4
                                           : remembered_width == 0 ? 1
                                                                   : remembered_width;

  template <class Effect, class Material>
  COLLIDE_HD_INLINE void meet_together(Effect const& effect, std::uint32_t const* found, std::uint32_t size,
                                       Material const& of) const {
    contact_values<S, remembered> initial;
    S at_first[record_width] = {};
    initial.for_each_number([&](S& x, int c, int) { at_first[c] = x; });
    for (std::uint32_t first = 0; first < size; first += lanes) {
      std::uint32_t item[lanes];
      listed_pair pairs[lanes];
      S const* remembers[lanes];
      std::uint8_t marks[lanes];
      for (std::uint32_t l = 0; l < lanes; ++l) {
        item[l] = found[min(first + l, size - 1)];  // the last fill their pack
        pairs[l] = items.pairs[item[l]];
        marks[l] = items.marks[item[l]];
        remembers[l] = at_first;
        if constexpr (remembered_width != 0)
          remembers[l] = (marks[l] & items.remembers) != 0 ? items.records[item[l]].numbers : at_first;
      }
      // no arrays of numbers: a pack that is read from what was just written by parts waits for it
      auto const by_mark = [&](std::uint8_t bit, S without, S with) {
        S const either_of[2] = {without, with};
        return from_lanes<P>::of([&](int l) { return either_of[(marks[l] & bit) != 0]; });
      };
      P const since = what == meeting::in_step ? P(dt) : by_mark(items.remembers, S(0), dt);
      meeting_sphere<P> a, b;
      load(pairs, a, b);
      contact_values<P, remembered> values;
      if constexpr (remembered_width != 0) {
        P columns[record_width];
        load_rows(columns, [&](int l) { return remembers[l]; });
        values.for_each_number([&](P& x, int c, int) { x = columns[c]; });
      }
      contact_access<remembered, contact_values<P, remembered>, P> const memory(values, since);
      sphere_action<P> const action = effect.act(a, b, by_mark(items.is_upward, S(-1), S(1)), of, memory);
      keep(item, action, values);
    }
  }

  COLLIDE_HD_INLINE void load(listed_pair const (&pairs)[lanes], meeting_sphere<P>& a, meeting_sphere<P>& b) const {
    load_spheres(pairs, a.position, a.radius, b.position, b.radius);
    P motion[stored_motion<S>::width];
    load_rows(motion, [&](int l) { return items.motions[pairs[l].place].numbers; });
    stored_motion<S>::get(motion, a);
    load_rows(motion, [&](int l) { return items.motions[pairs[l].other].numbers; });
    stored_motion<S>::get(motion, b);
  }
  /// Centres and radii of spheres, where they meet: across a side of the box, if space repeats.
  COLLIDE_HD_INLINE void load_spheres(listed_pair const (&pairs)[lanes], vec3<P>& a, P& a_radius, vec3<P>& b,
                                      P& b_radius) const {
    [[maybe_unused]] packed_sphere<S> near[2][lanes];
    if constexpr (Effects::repeats) {
      for (unsigned l = 0; l < lanes; ++l) {
        packed_sphere<S> const &s = order.spheres[pairs[l].place], &t = order.spheres[pairs[l].other];
        vec3<S> x(s.x, s.y, s.z), y(t.x, t.y, t.z);
        order.space.bring_together(x, y);
        near[0][l] = {x.x(), x.y(), x.z(), s.radius}, near[1][l] = {y.x(), y.y(), y.z(), t.radius};
      }
    }
    P columns[4];
    load_rows(columns, [&](int l) { return Effects::repeats ? &near[0][l].x : &order.spheres[pairs[l].place].x; });
    a = {columns[0], columns[1], columns[2]}, a_radius = columns[3];
    load_rows(columns, [&](int l) { return Effects::repeats ? &near[1][l].x : &order.spheres[pairs[l].other].x; });
    b = {columns[0], columns[1], columns[2]}, b_radius = columns[3];
  }

  COLLIDE_HD_INLINE void keep(std::uint32_t const (&item)[lanes], sphere_action<P> action,
                              contact_values<P, remembered>& values) const {
    constexpr unsigned width = Effects::action_width, padded = (width + 3) / 4 * 4;
    P numbers[padded];
    for (unsigned n = width; n < padded; ++n) numbers[n] = 0;
    action.template for_each_number<width>([&](P& x, unsigned n) { numbers[n] = x; });
    store_rows<width>(numbers, [&](int l) { return items.actions[item[l]].numbers; });
    bool const in_step = what == meeting::in_step;
    for (unsigned l = 0; l < lanes; ++l) {
      std::uint8_t& mark = items.marks[item[l]];
      unsigned const kept = in_step ? mark & unsigned(items.is_upward | items.meets) : mark;
      unsigned const now = items.acts | items.meets | (in_step && remembered_width != 0 ? items.remembers : 0u);
      mark = static_cast<std::uint8_t>(kept | (bits_of_lane(action.is_there, int(l)) & now));
    }
    if constexpr (remembered_width != 0) {
      if (!in_step) return;
      P columns[record_width];
      values.for_each_number([&](P& x, int c, int) { columns[c] = x; });
      for (unsigned c = remembered_width; c < record_width; ++c) columns[c] = 0;
      store_rows<remembered_width>(columns, [&](int l) { return items.records[item[l]].numbers; });
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
    for (std::uint32_t k = items.entry_firsts[i]; k < items.entry_firsts[i + 1]; ++k)
      alone = alone && items.entries[k] >> 1 >= first;
    return alone;
  }

  COLLIDE_AS_O3 void operator()(std::size_t i) const {
    auto const& places = this->order;
    std::size_t const last_place = std::size_t{places.header->count} - 1;
    fetch_kicks(min(i + 24, last_place), typename Effects::interaction_kicks{});
    pair_state p(own(i));
    std::uint32_t const end = items.entry_firsts[i + 1], last_entry = items.entry_firsts[last_place + 1] - 1;
    std::uint32_t acting[64], size = 0;
    std::uint8_t marks = 0;
    this->effects.for_mutual([&](auto const& effect) {
      using effect_type = std::decay_t<decltype(effect)>;
      S const* const motion = items.motions[i].numbers;
      row_of<S> v = load_row(motion), spin = load_row(motion + 4);
      [[maybe_unused]] row_of<S> slide, slide_by;
      if constexpr (tells_slide) {
        constexpr S zero[4] = {};
        slide = slide_by = load_row(zero);
      }
      meeting_sphere<S> self;
      self.radius = places.spheres[i].radius, self.density = motion[3];
      particle_access<effect_type, interaction> const seen(p.self);
      S const impulse = this->dt * effect_type::template of_clump<S>(seen) / effect_type::mass_of(self);
      auto const take = [&] {
        for (std::uint32_t k = 0; k < size; ++k) {
          auto const& action = items.actions[acting[k] >> 1];
          bool const second = (acting[k] & 1) != 0;
          auto const by = action.on(second);
          effect.give(v, spin, by, self.radius, impulse);
          if constexpr (tells_slide)
            effect.give_aside(slide, slide_by, action.aside_on(second), by, self.radius, impulse);
        }
        size = 0;
      };
      for (std::uint32_t k = items.entry_firsts[i]; k < end; ++k) {
        prefetch(items.actions + (items.entries[min(k + 48, last_entry)] >> 1));
        acting[size] = items.entries[k];
        std::uint8_t const mark = items.marks[acting[size] >> 1];
        marks |= mark;
        size += (mark & items.acts) != 0;
        if (size == 64) take();
      }
      take();
      p.changed[velocity{}] = vector_of(v);
      if constexpr (effect_type::turns) p.changed[angular_velocity{}] = vector_of(spin);
      if constexpr (tells_slide)
        p.changed[slide_push{}] = vector_of(slide), p.changed[slide_turn{}] = vector_of(slide_by);
    });
    p.met = (marks & items.meets) != 0;
    if (p.met) mark_contact(p.changed);
    this->store(p);
  }

 private:
  using base = pair_interaction<S, without_memory<Effects>>;
  using interaction = typename base::interaction;
  using pair_state = typename base::pair_state;
  static constexpr bool tells_slide = Effects::action_width > 10;  ///< to `contact_work`

  /// A particle, as far as `store` asks.
  COLLIDE_HD_INLINE interaction own(std::size_t i) const {
    interaction p = this->order.load(i);
    S const* const numbers = items.motions[i].numbers;
    p[velocity{}] = vec3<S>(numbers[0], numbers[1], numbers[2]);
    if constexpr (contains<typename interaction::list, clump_mass>)
      p[clump_mass{}] = this->state.at(clump_mass{})[this->order.numbers[i]];
    if constexpr (contains<typename interaction::list, angular_velocity>)
      p[angular_velocity{}] = vec3<S>(numbers[4], numbers[5], numbers[6]);
    return p;
  }

  /// Asks for memory that is written soon.
  template <class... Kick>
  void fetch_kicks([[maybe_unused]] std::size_t i, columns<Kick...>) const {
    (prefetch<true>(this->state.at(Kick{}) + 3 * std::size_t{this->order.numbers[i]}), ...);
  }
};

struct no_pair_actions {
  static std::size_t bytes() { return 0; }
};

/// Contacts that lists of neighbours had before others are made.
template <class S, class Record>
struct contacts_before {
  std::uint32_t* firsts;  ///< by places: those of each particle with particles behind it
  std::uint32_t* others;  ///< their places
  Record* records;
  std::uint32_t* place_of;  ///< of each particle, by numbers

  static constexpr std::uint32_t none = 0xffffffffu;
  /// The contact of two places, the first of which comes first.
  std::uint32_t find(std::uint32_t first, std::uint32_t second) const {
    for (std::uint32_t k = firsts[first]; k < firsts[first + 1]; ++k)
      if (others[k] == second) return k;
    return none;
  }
};

/// The contacts of lists of neighbours, and those that lists had before, until new ones are made. The lists themselves,
/// the cells from which they are made, and the contacts before are needed only until each pair has its item: so they
/// have the memory in which the step then keeps forces and motions.
template <class S, class Effects>
class pair_actions {
  using remembered = typename Effects::remembered;
  using items_type = pair_items<S, Effects>;
  using record = typename items_type::record;
  using action = typename items_type::action;
  using order = sorted_particles<S, without_memory<Effects>>;
  static constexpr bool has_memory = remembered::size != 0;
  static constexpr std::uint32_t none = order::overflow_mark;

 public:
  /// For `n` particles, the table of whose cells has so many numbers and blocks.
  void reserve(std::pmr::memory_resource* resource, std::size_t n, std::size_t in_table, std::size_t blocks) {
    reserve_items(resource, usual_items(n));
    firsts_.reserve(resource, n + 1);
    entry_firsts_.reserve(resource, n + 1);
    give_to_lists(resource, n, in_table, blocks, usual_items(n));
    give_to_step(resource, n, usual_items(n));
  }
  /// There are no contacts.
  void clear() { was_saved_ = has_before_ = false; }

  std::uint32_t *curve = nullptr, *ends = nullptr, *lists = nullptr;  ///< while lists are made; see `sorted_particles`

  items_type items() const {
    return {firsts_.data(), pairs_.data(), marks_.data(),        records_.data(),
            actions_,       motions_,      entry_firsts_.data(), entries_.data()};
  }

  /// Before places change, and before lists are made: keeps what contacts remember of `n` particles.
  template <class Space>
  void keep(Space const& space, order const& o, std::size_t in_table, std::size_t blocks) {
    if (was_saved_) return;  // and they have room
    std::uint32_t const count = has_memory ? o.header->count : 0;
    items_type const now = items();
    auto const for_each_contact = [&](std::size_t i, auto const& f) {
      for (std::uint32_t k = now.firsts[i]; k < now.firsts[i + 1]; ++k)
        if ((now.marks[k] & now.remembers) != 0) f(k);
    };
    std::size_t all = 0;
    for (std::uint32_t k = 0, end = count == 0 ? 0 : now.firsts[count]; k < end; ++k)
      all += now.marks[k] & now.remembers;
    give_to_lists(space.resource(), o.capacity, in_table, blocks, all);
    has_before_ = count != 0;
    if (!has_before_) return;
    space.for_each(count, [&](std::size_t i) {
      std::uint32_t n = 0;
      for_each_contact(i, [&](std::uint32_t) { ++n; });
      before_.firsts[i] = n;
    });
    before_.firsts[count] = 0;
    exclusive_scan(space, before_.firsts, count + 1);
    std::fill_n(before_.place_of, o.capacity, none);
    space.for_each(count, [&](std::size_t i) {
      std::uint32_t at = before_.firsts[i];
      for_each_contact(i, [&](std::uint32_t k) {
        before_.others[at] = now.pairs[k].other;
        before_.records[at++] = now.records[k];
      });
      before_.place_of[o.numbers[i]] = static_cast<std::uint32_t>(i);
    });
  }

  /// Once lists are made: each pair gets an item, with what it remembers.
  template <class Space>
  void build(Space const& space, order const& o) {
    std::size_t const count = o.header->count;
    std::uint32_t *const firsts = firsts_.data(), *const entry_firsts = entry_firsts_.data();
    space.for_each(count, [&](std::size_t i) {
      std::uint32_t behind = 0, all = 0;
      for_each_place(o, i, [&](std::uint32_t place) { behind += place > i, ++all; });
      firsts[i] = behind, entry_firsts[i] = all;
    });
    firsts[count] = entry_firsts[count] = 0;
    exclusive_scan(space, firsts, count + 1);
    exclusive_scan(space, entry_firsts, count + 1);
    if (pairs_.capacity() < firsts[count]) reserve_items(space.resource(), firsts[count] + firsts[count] / 16 + 64);
    space.for_each(count, [&](std::size_t i) {
      std::uint32_t item = firsts[i];
      for_each_place(o, i, [&](std::uint32_t place) {
        if (place <= i) return;
        pairs_.data()[item] = {static_cast<std::uint32_t>(i), place};
        restore(o, static_cast<std::uint32_t>(i), place, item);
        ++item;
      });
    });
    space.for_each(count, [&](std::size_t i) {
      std::uint32_t item = firsts[i], *entry = entries_.data() + entry_firsts[i];
      for_each_place(o, i, [&](std::uint32_t place) {
        *entry++ = place > i ? 2 * item++ : 2 * item_of(place, static_cast<std::uint32_t>(i)) + 1;
      });
    });
    was_saved_ = has_before_ = false;
  }

  void begin_meeting(std::pmr::memory_resource* resource, std::size_t n) {
    if (actions_ == nullptr) give_to_step(resource, n, pairs_.capacity());
  }

  /// Particles meet, and sum up. All items of a particle are known once those of the places before it are: so it sums
  /// up while they are in the cache, except for what other threads know.
  template <class Space>
  void interact(Space const& space, meet_once<S, Effects> const& meet, sum_actions<S, Effects> const& sum) const {
    constexpr std::size_t places = 256;  // that meet before they sum up
    std::size_t const count = meet.order.header->count, parts = space.saturating_blocks();
    std::size_t const share = (count + parts - 1) / parts;
    auto const is_alone = [&](std::size_t i) {
      return parts == 1 || sum.is_alone(i, firsts_.data()[i / share * share]);
    };
    for_each_block(space, parts, [&](std::size_t part) {
      std::size_t const end = std::min(count, (part + 1) * share);
      for (std::size_t first = part * share; first < end; first += places) {
        std::size_t const last = std::min(first + places, end);
        meet(first, last);
        multiversioned([&] {
          for (std::size_t i = first; i < last; ++i)
            if (is_alone(i)) sum(i);
        });
      }
    });
    if (parts == 1) return;
    space.for_each(count, [&](std::size_t i) {
      if (!is_alone(i)) sum(i);
    });
  }

  /// Between meetings: memory of at least so many bytes, for anything.
  std::byte* room(std::pmr::memory_resource* resource, std::size_t bytes) {
    actions_ = nullptr;
    return room_.all(resource, bytes);
  }

  saved_contacts<S> saved(list_state const& header, id const* numbers, std::size_t n) const {
    contacts_by_number<S, remembered> of(n);
    if (header.count != 0) {
      items_type const now = items();
      for (std::uint32_t k = 0; k < now.firsts[header.count]; ++k)
        if ((now.marks[k] & now.remembers) != 0)
          of.add(numbers[now.pairs[k].place], numbers[now.pairs[k].other], now.records[k]);
    } else if (was_saved_) {  // and waits for lists
      for (std::uint32_t i = 0; i < saved_; ++i)
        for (std::uint32_t k = before_.firsts[i]; k < before_.firsts[i + 1]; ++k)
          of.add(i, before_.others[k], before_.records[k]);
    }
    return of.sorted();
  }

  /// After `clear`, for `n` particles: lists that are made have what was saved, as if places had been numbers.
  void restore(std::pmr::memory_resource* resource, saved_contacts<S> const& from, std::size_t n, std::size_t in_table,
               std::size_t blocks) {
    constexpr std::size_t width = contact_values<S, remembered>::width;
    give_to_lists(resource, n, in_table, blocks, from.others.size() / 2 + 1);
    was_saved_ = has_before_ = true;
    saved_ = from.counts.size();
    std::fill_n(before_.place_of, n, none);
    std::uint32_t item = 0;
    std::size_t at = 0;
    for (std::size_t a = 0; a < saved_; ++a) {
      before_.firsts[a] = item;
      before_.place_of[a] = static_cast<std::uint32_t>(a);
      for (std::size_t end = at + from.counts[a]; at < end; ++at) {
        if (from.others[at] <= a) continue;
        before_.others[item] = from.others[at];
        std::copy_n(from.values.begin() + std::ptrdiff_t(at * width), width, before_.records[item++].numbers);
      }
    }
    before_.firsts[saved_] = item;
  }

  std::size_t bytes() const {
    return firsts_.bytes() + pairs_.bytes() + marks_.bytes() + records_.bytes() + entry_firsts_.bytes() +
           entries_.bytes() + room_.bytes();
  }

 private:
  /// In a packed bed there are hardly more.
  static std::size_t usual_items(std::size_t n) { return 3 * n + n / 2; }

  void reserve_items(std::pmr::memory_resource* resource, std::size_t n) {
    pairs_.reserve(resource, n);
    marks_.reserve(resource, n);
    if constexpr (has_memory) records_.reserve(resource, n);
    entries_.reserve(resource, 2 * n);
  }
  void give_to_lists(std::pmr::memory_resource* resource, std::size_t n, std::size_t in_table, std::size_t blocks,
                     std::size_t contacts) {
    room_.give(resource, in_room(curve, blocks), in_room(ends, in_table), in_room(lists, order::listed * n),
               in_room(before_.firsts, n + 1), in_room(before_.place_of, n), in_room(before_.others, contacts),
               in_room(before_.records, contacts));
    actions_ = nullptr;
  }
  void give_to_step(std::pmr::memory_resource* resource, std::size_t n, std::size_t pairs) {
    room_.give(resource, in_room(motions_, n), in_room(actions_, pairs + 1));  // one that is read, but not used
  }

  /// The item of two places, the first of which comes first.
  std::uint32_t item_of(std::uint32_t first, std::uint32_t second) const {
    std::uint32_t k = firsts_.data()[first];
    while (pairs_.data()[k].other != second) ++k;
    return k;
  }

  template <class F>
  static void for_each_place(order const& o, std::size_t i, F const& f) {
    if (o.list(0, i) != order::overflow_mark) {
      for (std::uint32_t k = 0; k < order::listed && o.list(k, i) != i; ++k) f(o.list(k, i));
    } else {
      std::uint32_t const first = o.list(1, i), size = o.list(2, i);
      for (std::uint32_t k = first; k < first + size; ++k) f(o.runs[k]);
    }
  }

  void restore(order const& o, std::uint32_t i, std::uint32_t j, std::uint32_t item) {
    std::uint8_t& mark = marks_.data()[item];
    mark = o.number_at(i) > o.number_at(j) ? items_type::is_upward : 0;
    if (!has_memory || !has_before_ || o.is_new(i) || o.is_new(j)) return;
    std::uint32_t const a = before_.place_of[o.numbers[i]], b = before_.place_of[o.numbers[j]];
    if (a == none || b == none) return;
    std::uint32_t const from = before_.find(min(a, b), max(a, b));
    if (from == none) return;
    mark |= items_type::remembers;
    auto const values = before_.records[from].values();
    records_.data()[item].set(a > b ? turned_round(values) : values);
  }

  buffer<std::uint32_t> firsts_, entry_firsts_, entries_;
  buffer<listed_pair> pairs_;
  buffer<std::uint8_t> marks_;
  buffer<record> records_;
  room_in_turn room_;
  contacts_before<S, record> before_{};
  action* actions_ = nullptr;            ///< in a step; else null
  stored_motion<S>* motions_ = nullptr;  ///< in a step, by places
  bool has_before_ = false, was_saved_ = false;
  std::size_t saved_ = 0;  ///< particles of which contacts were saved
};

}  // namespace collide::detail
