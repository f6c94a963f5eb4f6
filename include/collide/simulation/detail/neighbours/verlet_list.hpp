/// \file
/// Which particles overlap each other: lists of neighbours, which are kept while nothing has moved far.
///
/// A list has what is within reach of a particle or a little farther away: by the skin, of which each of two particles
/// may cross a half before something can be missing (L. Verlet, "Computer experiments on classical fluids I", Physical
/// Review 159(1), 1967). Until then a step only copies the particles' columns in the order of the last grid, and tries
/// what is listed. It is found out on the device whether that is so: kernels that renew the lists end at once if not.
/// If a particle has come, or moved far, all lists are rebuilt. Particles that are no longer there are left out.
///
/// Lists are made from a grid of the particles. Cells are as wide as the largest particle with the skin. Where the
/// largest is more than twice as large as the small ones, which are up to twice as large as the smallest, these are in
/// a second grid of narrower cells, so that they do not pay for it: each looks into both grids, and a larger one into
/// all cells of the small ones that it reaches (C. Ericson, "Real-Time Collision Detection", 2005, 7.2). Cells lie in a
/// table of fixed size: cubes of 16 x 16 x 16 cells are spread over it by a hash function, so that any scene fits; in
/// these, blocks of 16 x 2 x 2 cells follow a curve, so that near cells are near in memory. Particles are counted into
/// the cells, each block takes as much of the order as it has particles, and each particle looks into the 27 cells
/// around it, in a box that repeats also around its images. What has too many neighbours for its list does so in each
/// step.
///
/// Distances must be such that their squares neither overflow nor vanish: with floats, radii from 1e-17 to 1e18.
///
/// Neighbours meet in the order of their numbers: so sums over them do not depend on which thread was first, nor on
/// when the lists were made.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <collide/core/memory.hpp>
#include <collide/effects/detail/host_members.hpp>
#include <collide/effects/detail/particle.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>
#include <collide/simulation/detail/neighbours/births.hpp>
#include <collide/simulation/detail/neighbours/build_lists.hpp>
#include <collide/simulation/detail/neighbours/pair_actions.hpp>
#include <collide/simulation/detail/neighbours/pair_interaction.hpp>
#include <collide/simulation/detail/neighbours/particle_order.hpp>
#include <collide/spaces/detail/algorithms.hpp>
#include <collide/spaces/detail/host_array.hpp>

namespace collide::detail {

/// The lists, the grid and their memory.
///
/// \tparam Once  particles meet once a pair; see pair_actions.hpp
template <class S, class Scene, bool Once = false>
class verlet_list {
  using Effects = std::conditional_t<Once, without_memory<Scene>, Scene>;
  using state_type = particle_state<S, typename Effects::all>;

 public:
  /// Takes all memory that steps of up to `n` particles need, and as much as is asked for as `room`.
  template <class Space>
  void reserve(Space const& space, std::size_t n, [[maybe_unused]] std::size_t room_bytes) {
    std::pmr::memory_resource* const resource = space.resource();
    header_.reserve(resource, 1);
    std::size_t const blocks = cells::blocks_for(n);
    if constexpr (Once) {
      pairs_.reserve(resource, n, blocks * cells::stride, blocks);
      pairs_.room(resource, room_bytes);
    } else {
      if constexpr (works_alone<Space>) curve_.reserve(resource, blocks);
      ends_.reserve(resource, blocks * cells::stride);
      lists_.reserve(resource, order::listed * n);
    }
    numbers_.reserve(resource, n);
    memory_.reserve(resource, n);
    spheres_.reserve(resource, n);
    references_.reserve(resource, n);
    if constexpr (order::has_absent) known_.reserve(resource, n);
    if constexpr (order::on_ranks) is_at_border_.reserve(resource, n);
    runs_.reserve(resource, n);
    contacts_.reserve(resource, n, order::listed, runs_.capacity(), !Space::host_accessible);
  }

  /// For `n` particles, for which there is room, the last `copies` of them other ranks', which at most `border` meet:
  /// there are no lists yet.
  template <class Space>
  void clear(Space& space, std::size_t n, radius_range<S> const& radii, std::size_t copies = 0,
             std::size_t border = 0) {
    ensure_capacity(places_of_copies_, space.resource(), copies);
    ensure_capacity(border_, space.resource(), border);
    space.fill(header_.data(), 0, sizeof(state_of_lists));
    inside_is_done_ = false;
    fit(space, n, radii);
    if constexpr (order::has_absent) space.fill(known_.data(), 0, n * sizeof(*known_.data()));
    contacts_.clear(space, n);
    if constexpr (Once) pairs_.clear();
    places_ = n;
  }

  /// For the same `n` particles with such radii: lists are made anew. The smallest keep the skin so thin that small
  /// particles beside large ones have few neighbours: too many have no list.
  template <class Space>
  void fit(Space& space, std::size_t n, radius_range<S> const& radii) {
    blocks_ = cells::blocks_for(n);
    skin_ = skin_of(radii.largest, radii.smallest);
    cells_ = {1 / width_of(radii.largest, radii.smallest), static_cast<std::uint32_t>(blocks_ - 1)};
    small_ = {cells_, S(-1), S(0)};
    if (radii.has_small_apart(n, skin_)) {
      small_.cells.inverse_width = 1 / width_with(skin_, radii.small);
      small_.largest = radii.small;
      small_.reach = radii.small + skin_;
    }
    space.fill(&header_.data()->rebuild, 1, sizeof(list_state::rebuild));
    are_complete_ = false;
  }

  /// The skin: two particles may each cross a half of it before lists are made anew.
  S skin() const { return skin_; }

  /// How wide cells are: a bit wider than what is listed, so that rounding separates no pair by more than a cell, in
  /// floats up to 2^15 cells away from the origin.
  static S width_of(S radius, S smallest) { return width_with(skin_of(radius, smallest), radius); }

  /// The memory of contacts of the first `n` particles, by the numbers by which neighbours meet, for a checkpoint.
  /// Waits.
  template <class Space>
  saved_contacts<S> save_contacts(Space const& space, std::size_t n) const {
    if constexpr (Once) {
      return pairs_.saved(*header_.data(), numbers_.data(), n);
    } else {
      return save_listed(space, n);
    }
  }
  /// After `clear`: lists that are made have what was saved. May wait.
  template <class Space>
  void restore_contacts(Space& space, saved_contacts<S> const& saved) {
    if constexpr (Once) {
      pairs_.restore(space.resource(), saved, places_, blocks_ * cells::stride, blocks_);
    } else {
      contacts_.restore(space, saved);
    }
  }

  /// Memory taken from the resource.
  std::size_t bytes() const {
    return header_.bytes() + curve_.bytes() + ends_.bytes() + lists_.bytes() + numbers_.bytes() + spheres_.bytes() +
           references_.bytes() + known_.bytes() + memory_.bytes() + runs_.bytes() + places_of_copies_.bytes() +
           is_at_border_.bytes() + border_.bytes() + contacts_.bytes() + pairs_.bytes();
  }

  /// The first part of `renew`: finds out whether lists are to be made anew for particles where they now are, except
  /// for copies of other ranks', which may not yet be there.
  template <class Space>
  void check(Space& space, state_type const& state, typename Effects::space_type const& around) {
    if (!(around == around_)) space.fill(&header_.data()->rebuild, 1, sizeof(list_state::rebuild));
    around_ = around;
    listed_ = state.size;
    space.for_each(state.size, update_and_check_skin<S, Effects>{state, order_of(state), largest_move()});
  }
  /// After `check`: the same for the copies.
  template <class Space>
  void check_copies(Space const& space, state_type const& state) {
    if constexpr (order::on_ranks)
      space.for_each(state.size - state.own, update_copies<S, Effects>{{state, order_of(state), largest_move()}});
  }
  /// After both: true if lists are to be made anew. If not, the next `renew` has nothing to do. Waits.
  template <class Space>
  bool must_rebuild(Space const& space) {
    state_of_lists const header = space.read(header_.data());
    are_complete_ = header.rebuild == 0;
    at_border_ = header.at_border;
    return !are_complete_;
  }

  /// Makes the lists complete for particles where they now are, in a space that may have changed. They hold until
  /// something moves.
  template <class Space>
  void renew(Space& space, state_type const& state, typename Effects::space_type const& around) {
    if (are_complete_) {
      are_complete_ = false;
      return;
    }
    check(space, state, around);
    check_copies(space, state);
    std::size_t const n = state.size, in_table = blocks_ * cells::stride;
    std::uint32_t const* const rebuild = &header_.data()->rebuild;
    if constexpr (Once) {
      are_new_ = *rebuild != 0;
      if (are_new_) pairs_.keep(space, order_of(state), in_table, blocks_);
    }
    order const o = order_of(state);
    for_each_if_nonzero(space, rebuild, std::max(n, in_table), clear_cells<S, Effects>{o, in_table});
    for_each_if_nonzero(space, rebuild, n, count_or_scatter<S, Effects, false>{state, o});
    if constexpr (works_alone<Space>) {
      if (*rebuild != 0) scan_along_curve(o);
    } else {
      for_each_if_nonzero(space, rebuild, blocks_, scan_cells{o.ends, &o.header->count});
    }
    for_each_if_nonzero(space, rebuild, n, count_or_scatter<S, Effects, true>{state, o});
    for_each_if_nonzero(space, rebuild, n, build_lists<S, Effects>{o, skin_});
    if constexpr (Once || (order::has_memory && Space::host_accessible)) {
      if (header_.data()->in_runs > runs_.capacity()) grow_runs(space, state);
    }
    if constexpr (Once) {
      if (*rebuild != 0) pairs_.build(space, order_of(state));
    }
  }

  /// From `renew` until particles meet: not 0 in memory of the space if lists were made anew.
  std::uint32_t const* rebuild() const { return &header_.data()->rebuild; }
  /// True if the last `renew` has made the lists anew; where particles meet once a pair.
  bool are_new() const { return are_new_; }

  /// The places in memory of the lists' particles, in the order of cells. On the host; null if there are no lists.
  id* in_order() const { return header_.capacity() != 0 && header_.data()->count != 0 ? numbers_.data() : nullptr; }
  /// Until particles meet again: memory for anything, where they meet once a pair.
  std::byte* room(std::pmr::memory_resource* resource, std::size_t bytes) { return pairs_.room(resource, bytes); }

  /// True if there was no room for what some contact remembers. Waits.
  template <class Space>
  bool has_forgotten(Space const& space) const {
    return order::has_memory && header_.capacity() != 0 && copied(space, header_.data(), 1)[0].forgotten != 0;
  }

  /// After `renew`: counts what a source has made in this step where something is; if `refuse`, it is not born.
  template <class Space>
  void settle_births(Space& space, state_type const& state, bool refuse) {
    order const o = order_of(state);
    space.for_each(state.size, find_crowded_births<S, Effects>{state, o});
    space.for_each(state.size, detail::settle_births<S, Effects>{state, o.header, refuse});
    if (refuse) space.for_each(state.size, leave_out_unborn<S, Effects>{state, o});
  }

  /// Before copies of other ranks' particles are there, if lists are not to be made anew: those meet that need no copy,
  /// and `interact` leaves them out.
  template <class Space>
  void interact_inside(Space& space, state_type const& state, Effects const& effects, S dt) {
    if (!are_complete_ || at_border_ > border_.capacity()) return;
    space.for_each(state.size,
                   detail::interact_inside<S, Effects>{{{state, order_of(state), effects, dt, meeting::in_step}}});
    inside_is_done_ = true;
  }

  /// After `renew`: one pass of `on_pair_contact` over all pairs.
  template <class Space>
  void interact(Space& space, state_type const& state, Scene const& effects, S dt, meeting what) {
    order const o = order_of(state);
    std::size_t const n = state.size;
    if constexpr (Once) {
      pairs_.begin_meeting(space.resource(), n);
      space.for_each(n, store_motions<S, Scene>{state, o, pairs_.items().motions, effects});
      pairs_.interact(space, meet_once<S, Scene>{o, pairs_.items(), effects, dt, what},
                      sum_actions<S, Scene>{{state, o, Effects(effects), dt, what}, pairs_.items()});
      o.header->rebuild = 0;  // not read again in this step
    } else if constexpr (order::on_ranks) {
      if (inside_is_done_) {
        inside_is_done_ = false;
        space.for_each(at_border_, interact_at_border<S, Effects>{{{state, o, effects, dt, what}}});
      } else {
        space.for_each(n, interact_listed<S, Effects>{{state, o, effects, dt, what}});
      }
    } else {
      space.for_each(n, interact_listed<S, Effects>{{state, o, effects, dt, what}});
    }
  }

 private:
  using order = sorted_particles<S, Effects>;
  using cells = spatial_hash<S>;
  using state_of_lists = typename order::state_of_lists;

  static constexpr S skin_fraction = S(0.1);
  static S skin_of(S radius, S smallest) {
    return skin_fraction * 2 * (smallest > 0 ? min(radius, 2 * smallest) : radius);
  }

  static S width_with(S skin, S radius) {
    return max((2 * radius + skin) * (1 + S(0.00390625)), std::numeric_limits<S>::min());
  }

  template <class Space>
  saved_contacts<S> save_listed(Space const& space, std::size_t n) const {
    saved_contacts<S> saved;
    saved.counts.assign(n, 0);
    list_state const header = copied(space, header_.data(), 1)[0];
    if (header.count == 0) return contacts_.saved_for_lists(space, n);  // there are no lists since it was restored

    std::size_t const all = listed_;  // copies of other ranks' particles are behind
    auto const numbers = copied(space, numbers_.data(), header.count);
    auto others = numbers;
    if constexpr (contains<typename Effects::interaction_copies, global_number>)
      others = copied(space, memory_.state(all, all, S(0)).at(global_number{}), header.count);
    auto const lists = copied(space, lists_.data(), order::listed * all),
               runs = copied(space, runs_.data(), runs_.capacity());
    auto const memory = contacts_.copied(space, header.count, runs.size());
    std::vector<std::uint32_t> place_of(all, order::overflow_mark);
    for (std::uint32_t i = 0; i < header.count; ++i) place_of[numbers[i]] = i;
    for (std::size_t number = 0; number < n; ++number) {
      std::uint32_t const i = place_of[number];
      if (i == order::overflow_mark) continue;
      auto const add = [&](std::uint32_t place, std::size_t item) {
        saved.others.push_back(others[place]);
        memory.append(saved.values, item);
        ++saved.counts[number];
      };
      if (lists[i] != order::overflow_mark) {
        for (std::uint32_t k = 0; k < order::listed; ++k)
          if ((memory.touching[i] >> k & 1) != 0) add(lists[k * all + i], k * all + i);
      } else if (lists[all + i] != order::overflow_mark) {
        std::size_t const first = lists[all + i], size = lists[2 * all + i];
        for (std::size_t k = first; k < first + size; ++k)
          if (memory.run_touching[k] != 0) add(runs[k], order::listed * all + k);
      }
    }
    return saved;
  }

  /// Makes room for all runs, and then those for which there was none. Allocates, but only where a step waits anyhow.
  template <class Space>
  COLLIDE_COLD void grow_runs(Space& space, state_type const& state) {
    std::size_t const before = runs_.capacity(), in_runs = header_.data()->in_runs,
                      more = in_runs + in_runs / 4 - before;
    runs_ = grown(space, runs_, before, more);
    if constexpr (order::has_memory) contacts_.grow(space, order::listed * state.size, before, more);
    space.for_each(state.size, build_missing_runs<S, Effects>{{order_of(state), skin_}});
    if constexpr (order::has_memory) contacts_.grow_kept(space, more);
  }

  template <class Space, class T>
  static std::vector<T> copied(Space const& space, T const* from, std::size_t n) {
    std::vector<T> copy(n);
    if (n != 0) space.copy_to_host(copy.data(), from, n);
    return copy;
  }

  order order_of(state_type const& state) const {
    std::uint32_t *curve = curve_.data(), *ends = ends_.data(), *lists = lists_.data();
    if constexpr (Once) curve = pairs_.curve, ends = pairs_.ends, lists = pairs_.lists;
    return {around_,
            cells_,
            small_,
            curve,
            ends,
            header_.data(),
            numbers_.data(),
            state.names,
            spheres_.data(),
            references_.data(),
            known_.data(),
            memory_.state(state.size, state.placed, state.common_radius),
            lists,
            state.size,
            runs_.data(),
            runs_.capacity(),
            contacts_.ref(),
            own_of(state),
            places_of_copies_.data(),
            is_at_border_.data(),
            border_.data(),
            border_.capacity(),
            clumps_of(state)};
  }
  static id const* clumps_of([[maybe_unused]] state_type const& state) {
    if constexpr (order::has_clumps) return state.at(in_clump{});
    return nullptr;
  }
  static std::size_t own_of(state_type const& state) {
    if constexpr (order::on_ranks) return state.own;
    return state.size;
  }
  /// As `scan_cells`, for blocks one after the other along the curve.
  void scan_along_curve(order const& o) {
    auto const has_any = [&](std::uint32_t b) {
      std::uint32_t const* const counts = o.ends + b * cells::stride + 1;
      return std::any_of(counts, counts + cells::cells_per_block, [](std::uint32_t n) { return n != 0; });
    };
    along_.clear();
    for (std::uint32_t b = 0; b < blocks_; ++b)
      if (has_any(b)) along_.push_back(b);
    std::sort(along_.begin(), along_.end(), [&](auto a, auto b) { return o.curve[a] < o.curve[b]; });
    for (std::uint32_t const b : along_) scan_cells{o.ends, &o.header->count}(b);
  }
  S largest_move() const { return S(0.495) * skin_; }  ///< half of the skin, except for rounding

  typename Effects::space_type around_{};
  cells cells_{};
  small_cells<S> small_{};
  S skin_{};
  std::size_t blocks_ = 0, places_ = 0;          ///< of the table; of particles
  std::size_t listed_ = 0;                       ///< how many particles have lists
  bool are_new_ = false, are_complete_ = false;  ///< for particles where they are: `check` has just found that
  buffer<state_of_lists> header_;
  std::size_t at_border_ = 0;         ///< particles that copies of other ranks' may meet, while lists are complete
  bool inside_is_done_ = false;       ///< all others have met
  std::vector<std::uint32_t> along_;  ///< blocks that have particles
  buffer<std::uint32_t> curve_, ends_, lists_, runs_, places_of_copies_, border_;
  buffer<std::uint8_t> is_at_border_;
  buffer<id> numbers_;
  buffer<packed_sphere<S>> spheres_;
  buffer<reference<S, contains<typename Effects::all, radius>>> references_;
  buffer<column_element<alive, S>> known_;
  column_buffers<S, typename Effects::interaction_copies> memory_;
  contact_memory<S, typename Effects::remembered, Effects::meets_once> contacts_;
  std::conditional_t<Once, pair_actions<S, Scene>, no_pair_actions> pairs_;
};

}  // namespace collide::detail
