/// \file
/// The particles that a rank has of a simulation: its own, and copies of others' that may meet them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include <collide/ranks/detail/device_exchange_buffer.hpp>
#include <collide/ranks/detail/divided_mesh.hpp>
#include <collide/ranks/detail/particle_places.hpp>
#include <collide/ranks/detail/particle_rows.hpp>
#include <collide/ranks/detail/send_plan.hpp>
#include <collide/simulation.cuh>

namespace collide::detail {

/// The radii of the particles of all ranks in the beginning.
template <class S>
struct radii_of_all {
  S common;  ///< of those that have none of their own
  radius_range<S> range;
  S widest;  ///< the largest one without its sign
};

/// Runs the simulation of a rank. Its own particles come first in memory, in any order: neighbours meet by their
/// numbers among all.
template <class Simulation>
class part_of_simulation {
 public:
  using S = typename Simulation::scalar;
  using space_type = typename Simulation::execution_space;
  using state_type = typename Simulation::state_type;

 private:
  using state_of_all = std::decay_t<decltype(std::declval<Simulation&>().internals())>;

  state_of_all& data() { return simulation_.internals(); }
  state_of_all const& data() const { return simulation_.internals(); }
  auto phases() { return step_phases(data()); }
  auto prepare() { return preparation(data()); }

 public:
  using effects_type = typename Simulation::effects_type;
  using all_columns = typename Simulation::columns;
  using around_type = typename effects_type::space_type;
  /// Columns of copies: all that is read of a particle that another one meets.
  using seen_columns =
      union_of<typename effects_type::interaction, intersection_of<columns<radius, alive>, all_columns>>;
  template <class List>
  using rows = std::vector<particle_row<S, List>>;

  static constexpr bool any_pair_contact = effects_type::any_pair_contact;
  static constexpr bool has_absent = contains<all_columns, alive>;

  using remembered = typename effects_type::remembered;
  static constexpr std::size_t contact_width =
      remembered::size != 0 ? std::size_t(contact_values<S, remembered>::width) : 1;
  static constexpr bool remembers_pairs = remembered::size != 0 && any_pair_contact;
  static constexpr bool remembers_surfaces = effects_type::remembers_surfaces;
  /// The memory of contacts, by numbers among all.
  struct contact_rows {
    std::vector<contact_row<S, contact_width>> pairs;
    std::vector<contact_row<S, contact_width + 3>> surfaces;
  };

  template <class... Argument>
  explicit part_of_simulation(Argument&&... arguments) : simulation_(std::forward<Argument>(arguments)...) {}

  Simulation& simulation() { return simulation_; }
  Simulation const& simulation() const { return simulation_; }
  space_type& space() { return data().space; }
  std::size_t own() const { return data().particles.own; }

  void set(sphere_view<S> const& particles, S const* velocities, global_counts const& all,
           radii_of_all<S> const& radii) {
    std::size_t const n = particles.size();
    capacity_ = max(n + static_cast<std::size_t>(all.free_size), std::size_t{1});
    prepare().place(particles, velocities, capacity_);
    start(n, all, radii);
    prepare().know_smallest();
    prepare().bodies_and_index();
  }

  /// The part of a checkpoint of all ranks besides columns, effects and bodies.
  template <class Numbers>
  Numbers saved_numbers_of_all(bool reverse_order) const {
    Numbers numbers(data(), data().particles.all_size, data().particles.all_placed);
    numbers.reverse_order = reverse_order;
    return numbers;
  }
  std::size_t triangles() const { return data().mesh.size(); }
  effects_type const& effects() const { return data().effects; }

  /// Takes particles, time, effects and bodies of a checkpoint: `mine` particles, and free places. One rank of all
  /// `has_sums`: counts of all ranks.
  template <class Checkpoint>
  void restore(Checkpoint const& saved, std::size_t mine, global_counts const& all, bool has_sums) {
    auto const& numbers = saved.numbers();
    S largest = max(numbers.largest_radius, numbers.common_radius), widest = largest < 0 ? -largest : largest;
    if constexpr (contains<all_columns, radius>) {
      S const* const radii = saved.template column<radius>();
      for (std::uint64_t i = 0; i < numbers.places; ++i) {
        largest = max(largest, radii[i]);
        widest = max(widest, radii[i] < 0 ? -radii[i] : radii[i]);
      }
    }
    auto const free = static_cast<std::size_t>(all.free_size);
    capacity_ = max(mine + free, std::size_t{1});
    prepare().place({}, nullptr, capacity_);
    start(mine, all, {numbers.common_radius, {numbers.smallest_radius, largest, S(0)}, widest});
    auto const& state = data().particles;
    saved.restore_columns(space(), state, 0, static_cast<std::size_t>(all.first), mine);
    saved.restore_columns(space(), state, mine, static_cast<std::size_t>(all.first_free), free);
    double clock[clock_size];
    for (std::size_t k = 0; k < clock_size; ++k) clock[k] = numbers.clock[k];
    if (!has_sums) clock[clock_overlapping] = clock[clock_not_born] = 0;
    saved.restore_rest(data(), clock);
    if constexpr (remembers_pairs || remembers_surfaces) {
      contact_rows contacts;
      std::vector<id> const every = first_ids(static_cast<std::size_t>(all.size));
      if constexpr (remembers_pairs)
        contacts.pairs = rows_of<contact_row<S, contact_width>>(saved.pair_contacts(), every);
      if constexpr (remembers_surfaces)
        contacts.surfaces = rows_of<contact_row<S, contact_width + 3>>(saved.surface_contacts(), every);
      set_contacts(contacts);
    }
    space().synchronize();
  }

  bool is_set() const { return data().is_set; }
  std::size_t all_size() const { return data().particles.all_size; }

  /// How far from its own subdomain, as it was at the last exchange, a rank must know particles.
  double reach() const {
    auto const widest = static_cast<double>(widest_);
    double farthest = widest;
    if constexpr (effects_type::has_clumps) farthest = max(widest, effects().template of<clumps>().reach);
    return widest > 0 ? (widest + farthest + static_cast<double>(skin_)) * (1 + 0x1p-8) : 0;
  }

  void check_step(S dt) { phases().check_step(dt); }

  /// The first part of a step, before particles meet.
  void begin_step(S dt) {
    data().time += static_cast<double>(dt);
    phases().begin_step(dt);
  }
  /// After `begin_step`, while copies are under way: looks for what has moved. Lists of neighbours that are complete
  /// have all within the skin, so one kernel looks for both, where the skins are the same.
  void check_own() {
    if constexpr (any_pair_contact) {
      if (own() == 0) return;
      if (lists_tell_) {
        data().neighbours.check(space(), with_copies(), around_);
      } else {
        look_for_moved();
      }
    }
  }
  /// True if there are copies of all that this rank's own particles meet, as long as nothing has moved far. All ranks
  /// know it alike.
  bool knows_others() const { return knows_others_ && effects().space() == around_; }
  /// After `check_own`: true if copies may be missing. Other ranks look at those that are here. Waits.
  template <class Ranks>
  bool has_moved([[maybe_unused]] Ranks const& ranks) {
    if constexpr (any_pair_contact) {
      if (!knows_others()) return true;
      if (own() == 0) return false;
      wait_for_messages(ranks, space());
      return lists_tell_ ? data().neighbours.must_rebuild(space()) : space().read(flag_.data()) != 0;
    } else {
      return false;
    }
  }

  /// Particles meet that need no copies, while those are under way, where that is the same.
  void meet_inside([[maybe_unused]] S dt) {
    if constexpr (any_pair_contact && !effects_type::makes) {
      if (lists_tell_ && own() != 0) phases().meet_inside(with_copies(), dt);
    }
  }

  void end_step(S dt) {
    meet(dt);
    if (own() != 0) phases().end_step(dt);
  }
  void meet(S dt) { phases().meet(with_copies(), dt); }
  /// True if particles of a source may not be born, which others must know before particles meet.
  bool refuses_births(S dt) const {
    return any_pair_contact && effects().due(static_cast<double>(dt)) > 0 && effects().makes_only_where_free();
  }
  /// Says which of those that a source has made here are not born.
  void settle_births(S dt) {
    if constexpr (any_pair_contact) {
      if (own() == 0) return;
      data().neighbours.renew(space(), with_copies(), effects().space());
      phases().settle_births(with_copies(), dt);
    }
  }
  /// True if the next step knows what particles do to each other where it begins.
  bool knows_pair_forces() { return phases().knows_pair_forces(); }

  /// The memory of contacts of the rank's own particles. Waits.
  contact_rows contacts() const {
    contact_rows found;
    if constexpr (remembers_pairs || remembers_surfaces) {
      std::vector<id> const numbers = on_host<global_number>();
      if constexpr (remembers_pairs)
        found.pairs =
            rows_of<contact_row<S, contact_width>>(data().neighbours.save_contacts(data().space, own()), numbers);
      if constexpr (remembers_surfaces)
        found.surfaces =
            rows_of<contact_row<S, contact_width + 3>>(data().surfaces.save_contacts(data().space, own()), numbers);
    }
    return found;
  }
  /// Takes over what contacts remember, if lists of neighbours are to be made, and each place has its particle.
  void set_contacts([[maybe_unused]] contact_rows const& from) {
    if constexpr (remembers_pairs || remembers_surfaces) {
      std::vector<id> const numbers = on_host<global_number>();
      if constexpr (remembers_pairs) data().neighbours.restore_contacts(space(), contacts_of(from.pairs, numbers));
      if constexpr (remembers_surfaces) data().surfaces.restore_contacts(space(), contacts_of(from.surfaces, numbers));
      space().synchronize();
    }
  }

  /// A column of the rank's own particles on the host.
  template <class Column>
  std::vector<column_element<Column, S>> on_host() const {
    return simulation_.template to_host<Column>();
  }

  /// How many of its particles are somewhere: there, and at a point that is finite. Waits.
  std::uint64_t count_somewhere() {
    std::uint64_t* const count = count_.reserve(space().resource(), 1);
    space().fill(count, 0, sizeof *count);
    space().for_each((own() + count_group - 1) / count_group, detail::count_somewhere<S, state_type>{state(), count});
    return space().read(count);
  }

  /// Centres of the particles that are somewhere, on the host. Waits.
  std::vector<S> centres_somewhere() const {
    std::vector<S> centres = on_host<position>();
    std::vector<std::uint8_t> there;
    if constexpr (has_absent) there = on_host<alive>();
    std::size_t n = 0;
    for (std::size_t i = 0; i < centres.size() / 3; ++i) {
      S const* const x = centres.data() + 3 * i;
      if (!(there.empty() || there[i] != 0) || !is_finite(x[0]) || !is_finite(x[1]) || !is_finite(x[2])) continue;
      for (std::size_t k = 0; k < 3; ++k) centres[3 * n + k] = x[k];
      ++n;
    }
    centres.resize(3 * n);
    return centres;
  }

  /// Finds the particles that are to be on other ranks than `self`. Waits.
  void find_leaving(subdomain_lookup const& subdomains, int self, int ranks, send_plan& found) {
    detail::find_leaving<S, state_type, around_type> const leaving{state(), effects().space(), subdomains, self, ranks,
                                                                   {}};
    found.find(space(), leaving, own(), own(), ranks);
  }
  /// Finds the particles of which other ranks than `self` must have copies. Waits.
  void find_copied(subdomain_lookup const& subdomains, int self, int ranks, send_plan& found) {
    detail::find_copied<S, state_type, around_type> const copied{state(), effects().space(), subdomains, reach(), self,
                                                                 {}};
    found.find(space(), copied, own(), own(), ranks);
  }

  /// Numbers of particles that leave, which rise, and where they go. Waits.
  std::vector<std::pair<id, int>> new_ranks(send_plan const& leaving) const {
    std::vector<pair> listed(leaving.size());
    if (!listed.empty()) data().space.copy_to_host(listed.data(), leaving.data(), listed.size());
    std::vector<id> const numbers = on_host<global_number>();
    std::vector<std::pair<id, int>> found;
    for (pair const& route : listed) found.emplace_back(numbers[item_of(route)], rank_of(route));
    std::sort(found.begin(), found.end());
    return found;
  }

  void pack_all(send_plan const& leaving, device_exchange_buffer<particle_row<S, all_columns>>& to) {
    to.counts = leaving.counts();
    detail::pack_particles(space(), state(), routed_places{leaving.data()}, leaving.size(), to.resize(space()));
  }

  /// Takes particles away that have left, and adds others. Spheres of a clump follow each other, here and in a message.
  void replace(send_plan const& left, device_exchange_buffer<particle_row<S, all_columns>> const& coming) {
    knows_others_ = false;
    std::vector<std::uint32_t> const leaving = rising_places(left);
    std::size_t const before = own(), after = before - leaving.size() + coming.size();
    ensure_capacity(after);
    std::vector<std::uint32_t> to;
    if constexpr (effects_type::has_clumps) {
      close_up(leaving);
    } else {
      to.assign(leaving.begin(), leaving.begin() + static_cast<std::ptrdiff_t>(min(leaving.size(), coming.size())));
    }
    for (std::size_t i = after - (coming.size() - to.size()); to.size() < coming.size(); ++i)
      to.push_back(static_cast<std::uint32_t>(i));
    unpack(to, coming.data());
    if (!effects_type::has_clumps && coming.size() < leaving.size()) close_gaps(leaving, coming.size(), after);
    resize_own(after);
    space().synchronize();  // the rows go
  }

  /// Prepares for copies of so many particles of other ranks, where others have some of `border`, and keeps where its
  /// own are.
  void expect_copies(std::size_t n, std::size_t border) {
    ensure_capacity(own() + n);
    copies_ = n;
    if constexpr (any_pair_contact) {
      data().neighbours.clear(space(), own() + n, data().radii, n, border);
      lists_tell_ = skin_ > 0 && data().neighbours.skin() >= skin_;
    }
    around_ = effects().space();
    knows_others_ = true;
    if (lists_tell_) return;
    auto* const resource = space().resource();
    last_centres_.reserve(resource, 3 * capacity_);
    if constexpr (has_absent) last_there_.reserve(resource, capacity_);
    space().for_each(own(), keep_places<S, state_type>{data().particles, last()});
  }

  /// Writes what others know of particles.
  template <class Space>
  void pack_seen(Space const& on, send_plan const& copied, particle_row<S, seen_columns>* to) {
    detail::pack_particles(on, state(), routed_places{copied.data()}, copied.size(), to);
  }
  /// Takes over what is known of all copies.
  template <class Space>
  void unpack_seen(Space const& on, particle_row<S, seen_columns> const* from) {
    detail::unpack_particles(on, state(), places_from{own()}, copies_, from);
    if constexpr (any_pair_contact) {
      if (lists_tell_ && own() != 0) data().neighbours.check_copies(on, with_copies());
    }
  }

 private:
  static constexpr S skin_fraction = S(0.1);  ///< of the largest diameter

  state_type const& state() const { return data().particles; }
  state_type with_copies() const {
    state_type all = data().particles;
    if constexpr (any_pair_contact) all.size += copies_;
    return all;
  }

  /// Puts rows, in memory of the space, to places that the host knows.
  void unpack(std::vector<std::uint32_t> const& places, particle_row<S, all_columns> const* from) {
    listed_places const listed{in_space(space(), places, place_memory_)};
    detail::unpack_particles(space(), state(), listed, places.size(), from);
  }

  /// The places of particles that go to ranks, by rising number. Those that go to a rank are so already.
  std::vector<std::uint32_t> rising_places(send_plan const& of) {
    std::vector<pair> listed(of.size());
    if (!listed.empty()) space().copy_to_host(listed.data(), of.data(), listed.size());
    std::vector<std::uint32_t> places;
    places.reserve(listed.size());
    for (pair const& route : listed) places.push_back(item_of(route));
    std::uint64_t sorted = 0;
    for (std::uint64_t const more : of.counts()) {
      auto const middle = places.begin() + static_cast<std::ptrdiff_t>(sorted);
      std::inplace_merge(places.begin(), middle, middle + static_cast<std::ptrdiff_t>(more));
      sorted += more;
    }
    return places;
  }

  /// Numbers the particles, of which `n` are this rank's, and free places behind them.
  void start(std::size_t n, global_counts const& all, radii_of_all<S> const& radii) {
    std::size_t const capacity = n + static_cast<std::size_t>(all.free_size);
    describe(capacity, static_cast<std::size_t>(all.size), static_cast<std::size_t>(all.placed), radii.common);
    space().for_each(capacity, number_places<S, state_type>{data().particles, n, all.first, all.first_free,
                                                            data().effects.source_radius()});
    widest_ = radii.widest;
    data().radii = radii.range;
    skin_ = skin_fraction * 2 * widest_;
    copies_ = 0;
    knows_others_ = false;
    if constexpr (remembers_pairs) data().neighbours.clear(space(), capacity, radii.range);
    if constexpr (remembers_surfaces) data().surfaces.clear(space(), capacity);
  }

  /// Moves the last particles to the places of those that have left, from the `filled`-th on.
  void close_gaps(std::vector<std::uint32_t> const& leaving, std::size_t filled, std::size_t after) {
    std::vector<std::uint32_t> from, to;
    std::size_t gap = filled, end = leaving.size();
    for (std::size_t i = own(); i-- > after;) {
      if (end > gap && leaving[end - 1] == i) {
        --end;  // it has left, too
      } else {
        from.push_back(static_cast<std::uint32_t>(i));
        to.push_back(leaving[gap++]);
      }
    }
    move(from, to);
  }

  /// Moves particles to where others have left, in their order.
  void close_up(std::vector<std::uint32_t> const& leaving) {
    std::vector<std::uint32_t> from, to;
    std::size_t left = 0;
    for (std::size_t i = leaving.empty() ? own() : leaving.front(); i < own(); ++i) {
      if (left < leaving.size() && leaving[left] == i) {
        ++left;
      } else {
        from.push_back(static_cast<std::uint32_t>(i));
        to.push_back(static_cast<std::uint32_t>(i - left));
      }
    }
    move(from, to);
  }

  void move(std::vector<std::uint32_t> const& from, std::vector<std::uint32_t> const& to) {
    buffer<particle_row<S, all_columns>> moved;
    auto* const between = moved.reserve(space().resource(), from.size());
    listed_places const listed{in_space(space(), from, place_memory_)};
    detail::pack_particles(space(), state(), listed, from.size(), between);
    space().synchronize();  // the list goes
    unpack(to, between);
    space().synchronize();  // the rows go
  }

  /// Room for so many particles; the rank's own stay.
  void ensure_capacity(std::size_t n) {
    if (n <= capacity_) return;
    state_type const old = data().particles;
    double clock[clock_size] = {};
    if (old.time != nullptr) space().copy_to_host(clock, old.time, clock_size);
    rows<all_columns> kept;
    pack_on_host(space(), old, places_from{0}, old.own, kept);
    std::size_t const capacity = n + n / 4;
    capacity_ = 0;
    prepare().reserve(capacity);
    capacity_ = capacity;
    describe(old.own, old.all_size, old.all_placed, old.common_radius);
    if constexpr (state_of_all::has_begin_step) {
      data().particles.time = data().device_time.data();
      space().copy_from_host(data().particles.time, clock, clock_size);
    }
    space().for_each(padded_size(capacity), init_particles<S, all_columns>{data().particles, {}, nullptr, S(0)});
    unpack_from_host(space(), state(), places_from{0}, kept);
    data().is_set = true;
  }

  void describe(std::size_t own, std::size_t all_size, std::size_t all_placed, S common) {
    double* const time = data().particles.time;
    data().particles = data().memory.state(own, own, common);
    data().particles.time = time;
    data().particles.own = own;
    data().particles.all_size = all_size;
    data().particles.all_placed = all_placed;
  }
  void resize_own(std::size_t n) { data().particles.size = data().particles.placed = data().particles.own = n; }

  void look_for_moved() {
    std::uint32_t* const flag = flag_.reserve(space().resource(), 1);
    space().fill(flag, 0, sizeof *flag);
    // half of the skin, except for rounding
    find_moved<S, state_type, around_type> const moved{state(), effects().space(), last(), S(0.495) * skin_, flag};
    space().for_each(own(), moved);
  }

  last_places<S> last() const { return {last_centres_.data(), last_there_.data()}; }

  Simulation simulation_;
  std::size_t capacity_ = 0, copies_ = 0;
  around_type around_{};       ///< the space when ranks last exchanged some
  bool knows_others_ = false;  ///< there are copies of all that its own may meet, as long as nothing moves far
  bool lists_tell_ = false;    ///< lists of neighbours have as thick a skin, so they know when something has
  S skin_ = 0, widest_ = 0;
  buffer<S> last_centres_;
  buffer<std::uint8_t> last_there_;
  buffer<std::uint32_t> flag_, place_memory_;
  buffer<std::uint64_t> count_;
};

}  // namespace collide::detail
