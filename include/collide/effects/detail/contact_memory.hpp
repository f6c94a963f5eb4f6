/// \file
/// The memory of contacts from step to step: of those between particles, beside the lists of neighbours, and of those
/// with the mesh.
///
/// Both particles that touch have it, each in its own sign. Values lie where the neighbour is in the list, so a step
/// reads and writes those of particles that touch, and nothing else. When lists are made anew, values are kept by the
/// numbers of the two particles, and put into the new lists. See `contact_columns` in columns.hpp.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/core/memory.hpp>
#include <collide/effects/detail/particle.hpp>

namespace collide::detail {

/// In place of a lookup, if nothing asks.
struct absent {};

template <class C, class S>
struct contact_value {
  static_assert(std::is_same<column_element<C, S>, S>::value, "collide: a contact remembers vec3<S> or S");
  column_value<C, S> value = initial_of<C, S>();
};

/// The memory of a contact, by columns.
template <class S, class List>
struct contact_values;
template <class S, class... C>
struct contact_values<S, columns<C...>> : contact_value<C, S>... {
  using list = columns<C...>;
  static constexpr int width = (column_layout<C, S>::width + ... + 0);

  /// f(number, k, sign) for all numbers of all columns, number k; the sign is -1 of what has the opposite sign for the
  /// other particle, where both remember the same.
  template <class F>
  COLLIDE_HD_INLINE void for_each_number([[maybe_unused]] F const& f) {
    [[maybe_unused]] int n = 0;
    (for_each_of<C>(n, f), ...);
  }

  template <class D>
  COLLIDE_HD_INLINE column_value<D, S>& operator[](D) {
    return static_cast<contact_value<D, S>&>(*this).value;
  }
  template <class D>
  COLLIDE_HD_INLINE column_value<D, S> const& operator[](D) const {
    return static_cast<contact_value<D, S> const&>(*this).value;
  }

 private:
  template <class D, class F>
  COLLIDE_HD_INLINE void for_each_of(int& n, F const& f) {
    using layout = column_layout<D, S>;
    for (int k = 0; k < layout::width; ++k) f(layout::at((*this)[D{}], k), n++, layout::width == 3 ? -1 : 1);
  }
};

/// The memory of a contact as it is stored.
template <class S, class List>
struct contact_numbers {
  S numbers[contact_values<S, List>::width > 0 ? contact_values<S, List>::width : 1];

  COLLIDE_HD_INLINE contact_values<S, List> values() const {
    contact_values<S, List> v;
    v.for_each_number([&](S& x, int k, int) { x = numbers[k]; });
    return v;
  }
  COLLIDE_HD_INLINE void set(contact_values<S, List> v) {
    v.for_each_number([&](S& x, int k, int) { numbers[k] = x; });
  }
};
/// To be read at once.
template <class S, class List>
struct alignas(contact_values<S, List>::width > 2 ? 4 * sizeof(S) : sizeof(S)) contact_record
    : contact_numbers<S, List> {};

/// The kept contacts of a particle, in the order of the numbers of the others; of two that do the opposite to each
/// other the one with the smaller number has theirs.
struct kept_range {
  std::uint32_t first, count;
};

/// The memory of a contact where its numbers are apart.
template <class S, class List>
struct contact_slot {
  S* first;
  std::size_t apart;

  COLLIDE_HD_INLINE contact_values<S, List> values() const {
    contact_values<S, List> v;
    v.for_each_number([&](S& x, int k, int) { x = first[std::size_t(k) * apart]; });
    return v;
  }
  COLLIDE_HD_INLINE void set(contact_values<S, List> v) const {
    v.for_each_number([&](S& x, int k, int) { first[std::size_t(k) * apart] = x; });
  }
};

/// The memory of contacts, for kernels. Item k of the list of the particle at place i is `k * capacity + i`; those of
/// runs are behind.
template <class S, class List>
struct contact_memory_ref {
  S* numbers;
  std::size_t items_apart, numbers_apart;
  std::uint32_t* touching;         ///< of the particle at each place, a bit for each item of its list
  std::uint8_t* run_touching;      ///< of each item of runs
  contact_numbers<S, List>* kept;  ///< contacts while lists are made anew,
  id* kept_others;                 ///< numbers of the other particles in these
  kept_range* kept_of;             ///< of each particle, by its number
  std::size_t kept_capacity;       ///< contacts for which there is room

  COLLIDE_HD_INLINE contact_slot<S, List> slot(std::size_t item) const {
    return {numbers + item * items_apart, numbers_apart};
  }
};
template <class S>
struct contact_memory_ref<S, columns<>> {};

/// The memory of contacts, for a checkpoint: how many contacts each particle has, the numbers of the others, by rising
/// numbers, and the values of each contact.
template <class S>
struct saved_contacts {
  std::vector<std::uint32_t> counts;
  std::vector<id> others;
  std::vector<S> values;
};

/// The memory of a contact, as the other of two particles that do the opposite to each other has it.
template <class S, class List>
COLLIDE_HD_INLINE contact_values<S, List> turned_round(contact_values<S, List> values) {
  values.for_each_number([](S& x, int, int sign) { x = sign < 0 ? 0 - x : x; });
  return values;
}

/// Contacts that are known once a pair, for a checkpoint.
template <class S, class List>
class contacts_by_number {
 public:
  explicit contacts_by_number(std::size_t particles) : of_(particles) {}

  /// The contact of two particles, as the first has it.
  void add(id first, id second, contact_numbers<S, List> const& as_first) {
    contact_numbers<S, List> as_second = as_first;
    as_second.set(turned_round(as_first.values()));
    of_[first].push_back({second, as_first});
    of_[second].push_back({first, as_second});
  }
  saved_contacts<S> sorted() {
    saved_contacts<S> all;
    for (auto& contacts : of_) {
      std::sort(contacts.begin(), contacts.end(), [](contact const& a, contact const& b) { return a.other < b.other; });
      all.counts.push_back(static_cast<std::uint32_t>(contacts.size()));
      for (contact const& c : contacts) {
        all.others.push_back(c.other);
        all.values.insert(all.values.end(), c.own.numbers, c.own.numbers + contact_values<S, List>::width);
      }
    }
    return all;
  }

 private:
  struct contact {
    id other;
    contact_numbers<S, List> own;
  };
  std::vector<std::vector<contact>> of_;
};

/// An array with room for more than another, and the first `n` values of that, on the host.
template <class Space, class T>
buffer<T> grown(Space const& space, buffer<T> const& from, std::size_t n, std::size_t more) {
  buffer<T> longer;
  std::copy_n(from.data(), n, longer.reserve(space.resource(), from.capacity() + more));
  return longer;
}

/// The memory of contacts. On the host the numbers of an item are together, on a device those of items side by side.
///
/// \tparam Mutual  two particles do the opposite to each other
template <class S, class List, bool Mutual>
class contact_memory {
 public:
  static constexpr int width = contact_values<S, List>::width;

  struct on_host {
    std::vector<S> numbers;
    std::size_t items_apart, numbers_apart;
    std::vector<std::uint32_t> touching;
    std::vector<std::uint8_t> run_touching;

    void append(std::vector<S>& to, std::size_t item) const {
      for (std::size_t k = 0; k < std::size_t(width); ++k)
        to.push_back(numbers[item * items_apart + k * numbers_apart]);
    }
  };
  template <class Space>
  on_host copied(Space const& space, std::size_t places, std::size_t in_runs) const {
    on_host all{std::vector<S>(numbers_.capacity()), items_apart(), numbers_apart(), std::vector<std::uint32_t>(places),
                std::vector<std::uint8_t>(in_runs)};
    space.copy_to_host(all.numbers.data(), numbers_.data(), all.numbers.size());
    space.copy_to_host(all.touching.data(), touching_.data(), places);
    if (in_runs != 0) space.copy_to_host(all.run_touching.data(), run_touching_.data(), in_runs);
    return all;
  }
  /// Contacts that wait for lists to be made.
  template <class Space>
  saved_contacts<S> saved_for_lists(Space const& space, std::size_t n) const {
    std::vector<kept_range> ranges(n);
    if (n != 0) space.copy_to_host(ranges.data(), kept_of_.data(), n);
    std::size_t all = 0;
    for (auto const& r : ranges) all = r.first + r.count > all ? r.first + r.count : all;
    std::vector<contact_numbers<S, List>> kept(all);
    std::vector<id> others(all);
    if (all != 0) space.copy_to_host(kept.data(), kept_.data(), all);
    if (all != 0) space.copy_to_host(others.data(), kept_others_.data(), all);
    if constexpr (Mutual) {
      contacts_by_number<S, List> of(n);
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = ranges[i].first; k < std::size_t{ranges[i].first} + ranges[i].count; ++k)
          of.add(static_cast<id>(i), others[k], kept[k]);
      return of.sorted();
    }
    saved_contacts<S> saved;
    for (auto const& r : ranges) {
      saved.counts.push_back(r.count);
      for (std::size_t k = r.first; k < std::size_t{r.first} + r.count; ++k) {
        saved.others.push_back(others[k]);
        saved.values.insert(saved.values.end(), kept[k].numbers, kept[k].numbers + width);
      }
    }
    return saved;
  }
  template <class Space>
  void restore(Space& space, saved_contacts<S> const& saved) {
    std::vector<kept_range> ranges;
    std::vector<contact_numbers<S, List>> kept;
    std::vector<id> others;
    std::size_t at = 0;
    for (std::uint32_t const count : saved.counts) {
      auto const first = static_cast<std::uint32_t>(kept.size());
      for (std::size_t const end = at + count; at < end; ++at) {
        if (Mutual && saved.others[at] < ranges.size()) continue;
        others.push_back(saved.others[at]);
        kept.emplace_back();
        std::copy_n(saved.values.data() + at * std::size_t(width), width, kept.back().numbers);
      }
      ranges.push_back({first, static_cast<std::uint32_t>(kept.size()) - first});
    }
    if (!ranges.empty()) space.copy_from_host(kept_of_.data(), ranges.data(), ranges.size());
    reserve_kept(space.resource(), kept.size());
    if (kept.empty()) return;
    space.copy_from_host(kept_.data(), kept.data(), kept.size());
    space.copy_from_host(kept_others_.data(), others.data(), kept.size());
  }

  void reserve(std::pmr::memory_resource* resource, std::size_t particles, std::size_t listed, std::size_t in_runs,
               bool side_by_side) {
    std::size_t const items = listed * particles + in_runs;
    numbers_.reserve(resource, std::size_t(width) * items);
    are_side_by_side_ = side_by_side;
    reserve_kept(resource, kept_of(items));
    touching_.reserve(resource, particles);
    kept_of_.reserve(resource, particles);
    run_touching_.reserve(resource, in_runs);
  }
  /// Makes room for more items of runs than were there `before`, behind so many of lists, on the host: those stay.
  template <class Space>
  void grow(Space const& space, std::size_t in_lists, std::size_t before, std::size_t more) {
    numbers_ = grown(space, numbers_, std::size_t(width) * (in_lists + before), std::size_t(width) * more);
    run_touching_ = grown(space, run_touching_, before, more);
  }
  /// Makes room to keep more, once nothing is kept.
  template <class Space>
  void grow_kept(Space const& space, std::size_t more) {
    reserve_kept(space.resource(), kept_.capacity() + kept_of(more));
  }
  template <class Space>
  void clear(Space& space, std::size_t n) {
    space.fill(kept_of_.data(), 0, n * sizeof(kept_range));
  }
  std::size_t bytes() const {
    return numbers_.bytes() + kept_.bytes() + kept_others_.bytes() + touching_.bytes() + kept_of_.bytes() +
           run_touching_.bytes();
  }
  contact_memory_ref<S, List> ref() const {
    return {numbers_.data(), items_apart(),       numbers_apart(), touching_.data(), run_touching_.data(),
            kept_.data(),    kept_others_.data(), kept_of_.data(), kept_.capacity()};
  }

 private:
  /// How many contacts there may be to keep in so many items of lists.
  static std::size_t kept_of(std::size_t items) { return Mutual ? (items + 1) / 2 : items; }
  void reserve_kept(std::pmr::memory_resource* resource, std::size_t contacts) {
    kept_.reserve(resource, contacts);
    kept_others_.reserve(resource, contacts);
  }
  std::size_t items_apart() const { return are_side_by_side_ ? 1 : std::size_t(width); }
  std::size_t numbers_apart() const { return are_side_by_side_ ? numbers_.capacity() / std::size_t(width) : 1; }

  buffer<S> numbers_;
  bool are_side_by_side_ = false;
  buffer<contact_numbers<S, List>> kept_;
  buffer<id> kept_others_;
  buffer<std::uint32_t> touching_;
  buffer<kept_range> kept_of_;
  buffer<std::uint8_t> run_touching_;
};
template <class S, bool Mutual>
class contact_memory<S, columns<>, Mutual> {
 public:
  void reserve(std::pmr::memory_resource*, std::size_t, std::size_t, std::size_t, bool) {}
  template <class Space>
  void clear(Space&, std::size_t) {}
  std::size_t bytes() const { return 0; }
  contact_memory_ref<S, columns<>> ref() const { return {}; }
};

/// The memory of a contact with the mesh, and its key: a sphere that slides over a surface goes from triangle to
/// triangle, maybe to that of another body, and its contact goes on; that of another wall has another normal.
template <class S, class List>
struct surface_record {
  contact_numbers<S, List> record;
  S normal[3];
  id body;
};

template <class S, class List>
struct surface_memory_ref {
  static constexpr int max_contacts = 4;  ///< contacts of a particle that are remembered: the deepest

  surface_record<S, List>* records;
  std::uint8_t* counts;       ///< by numbers of particles
  std::uint32_t const* rows;  ///< by numbers: the row of records that a particle has, if it has any; null: its number
  std::size_t contacts_apart, rows_apart;

  COLLIDE_HD_INLINE surface_record<S, List>& record(std::size_t i, int k) const {
    std::size_t const row = rows != nullptr ? rows[i] : i;
    return records[std::size_t(k) * contacts_apart + row * rows_apart];
  }
};
/// Room on the host for those of n particles that are at a wall: others get it when they come.
inline std::size_t few_at_walls(std::size_t n) { return std::min(n, n / 16 + 64); }

/// On a device each particle has a row of records; on the host only those have one that may press on the mesh.
template <class S, class List>
class surface_memory {
  using ref_type = surface_memory_ref<S, List>;

 public:
  void reserve(std::pmr::memory_resource* resource, std::size_t n, bool on_host) {
    are_few_ = on_host;
    records_.reserve(resource, max_contacts * (on_host ? few_at_walls(n) : n));
    counts_.reserve(resource, n);
    if (on_host) rows_.reserve(resource, n);
  }
  template <class Space>
  void clear(Space& space, std::size_t n) {
    used_ = 0;
    if (n == 0) return;
    space.fill(counts_.data(), 0, n);
    if (are_few_) std::fill_n(rows_.data(), n, none);
  }
  /// On the host: gives rows to `listed` particles of `n`. May allocate.
  template <class Space, class Pressing>
  void give_rows(Space const& space, std::size_t n, Pressing const* listed, std::size_t size) {
    auto const lacking = [&] {
      return static_cast<std::size_t>(
          std::count_if(listed, listed + size, [&](Pressing const& p) { return rows_.data()[p.number] == none; }));
    };
    if (used_ + lacking() > rows()) {
      take_rows_back(n);
      if (used_ + lacking() > rows()) grow(space, used_ + lacking());
    }
    for (std::size_t k = 0; k < size; ++k) {
      std::uint32_t& row = rows_.data()[listed[k].number];
      if (row == none) row = used_++;
    }
  }
  std::size_t bytes() const { return records_.bytes() + counts_.bytes() + rows_.bytes(); }
  ref_type ref(std::size_t n) const { return ref_of(records_.data(), counts_.data(), rows_.data(), n); }

  /// f(array with a value of each particle) for all that is kept by their numbers; on the host.
  template <class F>
  void for_each_array(F const& f) const {
    f(rows_.data());
    f(counts_.data());
  }
  static constexpr std::size_t widest = sizeof(std::uint32_t);  ///< bytes of a value of an array

  /// For a checkpoint: the contacts of each of `n` particles; the others are bodies. Waits.
  template <class Space>
  saved_contacts<S> save_contacts(Space const& space, std::size_t n) const {
    std::vector<surface_record<S, List>> records(are_few_ ? 0 : max_contacts * n);
    std::vector<std::uint8_t> counts(n);
    if (!records.empty()) space.copy_to_host(records.data(), records_.data(), records.size());
    if (n != 0) space.copy_to_host(counts.data(), counts_.data(), n);
    ref_type const all = are_few_ ? ref(n) : ref_of(records.data(), counts.data(), nullptr, n);
    saved_contacts<S> saved;
    for (std::size_t i = 0; i < n; ++i) {
      saved.counts.push_back(counts[i]);
      for (int k = 0; k < counts[i]; ++k) {
        auto const& r = all.record(i, k);
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
    if (n == 0) return;
    std::vector<std::uint8_t> const counts(saved.counts.begin(), saved.counts.end());
    std::vector<surface_record<S, List>> records(are_few_ ? 0 : max_contacts * n);
    if (are_few_) {
      used_ = 0;
      std::fill_n(rows_.data(), rows_.capacity(), none);
      for (std::size_t i = 0; i < n; ++i)
        if (counts[i] != 0) rows_.data()[i] = used_++;
      records_.reserve(space.resource(), max_contacts * used_);
    }
    ref_type const all = are_few_ ? ref(n) : ref_of(records.data(), nullptr, nullptr, n);
    std::size_t at = 0;
    for (std::size_t i = 0; i < n; ++i) {
      for (int k = 0; k < counts[i]; ++k, ++at) {
        auto& r = all.record(i, k);
        S const* from = saved.values.data() + at * std::size_t(saved_width);
        r.body = saved.others[at];
        for (int c = 0; c < 3; ++c) r.normal[c] = *from++;
        for (int c = 0; c < width; ++c) r.record.numbers[c] = *from++;
      }
    }
    if (!are_few_) space.copy_from_host(records_.data(), records.data(), records.size());
    space.copy_from_host(counts_.data(), counts.data(), n);
  }
  static constexpr int width = contact_values<S, List>::width, saved_width = width + 3;

 private:
  static constexpr std::size_t max_contacts = ref_type::max_contacts;
  static constexpr std::uint32_t none = 0xffffffffu;

  std::size_t rows() const { return records_.capacity() / max_contacts; }
  ref_type ref_of(surface_record<S, List>* records, std::uint8_t* counts, std::uint32_t const* rows,
                  std::size_t n) const {
    return {records, counts, rows, rows != nullptr ? 1 : n, rows != nullptr ? max_contacts : 1};
  }

  /// Particles that remember nothing have no row any more, and the others the first ones.
  void take_rows_back(std::size_t n) {
    std::vector<std::uint32_t> owners(used_, none);
    for (std::uint32_t i = 0; i < n; ++i) {
      std::uint32_t& row = rows_.data()[i];
      if (row == none) continue;
      if (counts_.data()[i] == 0) {
        row = none;
      } else {
        owners[row] = i;
      }
    }
    used_ = 0;
    for (std::size_t row = 0; row < owners.size(); ++row) {
      if (owners[row] == none) continue;
      auto const* const from = records_.data() + max_contacts * row;
      std::copy_n(from, max_contacts, records_.data() + max_contacts * used_);
      rows_.data()[owners[row]] = used_++;
    }
  }
  template <class Space>
  void grow(Space const& space, std::size_t rows) {
    auto longer = grown(space, records_, max_contacts * used_, max_contacts * (rows + rows / 8 - this->rows()));
    records_ = std::move(longer);
  }

  buffer<surface_record<S, List>> records_;
  buffer<std::uint8_t> counts_;
  buffer<std::uint32_t> rows_;
  bool are_few_ = false;
  std::uint32_t used_ = 0;  ///< rows
};
template <class S>
class surface_memory<S, columns<>> {
 public:
  static constexpr std::size_t widest = 0;
  template <class F>
  void for_each_array(F const&) const {}
  void reserve(std::pmr::memory_resource*, std::size_t, bool) {}
  template <class Space, class Pressing>
  void give_rows(Space const&, std::size_t, Pressing const*, std::size_t) {}
  template <class Space>
  void clear(Space&, std::size_t) {}
  std::size_t bytes() const { return 0; }
  absent ref(std::size_t) const { return {}; }
};

/// The memory of a contact as an effect sees it: the columns that it names.
template <class Named, class Values, class S>
class contact_access {
 public:
  COLLIDE_HD_INLINE contact_access(Values& values, S elapsed) : values_{values}, elapsed_{elapsed} {}

  template <class C>
  COLLIDE_HD_INLINE auto& operator[](C) const {
    static_assert(contains<Named, C>, "collide: a contact remembers for an effect what that names in `remembers`");
    return values_[C{}];
  }
  /// The time since the contact was looked at before; 0 where it is new and forces are only asked for.
  COLLIDE_HD_INLINE S elapsed() const { return elapsed_; }
  /// All that the contact remembers.
  COLLIDE_HD_INLINE Values& values() const { return values_; }

 private:
  Values& values_;
  S elapsed_;
};

}  // namespace collide::detail
