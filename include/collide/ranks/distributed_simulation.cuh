/// \file
/// A simulation on many ranks: each has some of the particles, and all have the mesh.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include <collide/core/error.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/ranks/detail/particle_exchange.hpp>
#include <collide/ranks/distributed.hpp>
#include <collide/ranks/ranks.hpp>
#include <collide/simulation.cuh>

namespace collide {

namespace detail {

/// The sums over all ranks of the counts that `read()` returns, as many on each. Throws what that throws, and `error`
/// if a sum does not fit into 64 bits, on all ranks.
template <class Ranks, class Read>
std::vector<std::int64_t> rank_reduction(Ranks const& ranks, Read const& read) {
  constexpr std::uint64_t low = 0xffffffffu;
  std::vector<std::int64_t> counts;
  std::vector<std::uint64_t> mine, all;  // of each count its upper half, with its sign, and its lower half
  together(ranks, [&] {
    counts = read();
    for (std::int64_t const n : counts) {
      mine.push_back(static_cast<std::uint64_t>(n >> 32));
      mine.push_back(static_cast<std::uint64_t>(n) & low);
    }
    all.resize(mine.size());
  });
  ranks.reduce(mine.data(), all.data(), all.size(), reduction::sum);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    auto const upper = static_cast<std::int64_t>(all[2 * i]) + static_cast<std::int64_t>(all[2 * i + 1] >> 32);
    if (upper != static_cast<std::int32_t>(upper)) throw error("collide: a sum over ranks does not fit into 64 bits");
    counts[i] = static_cast<std::int64_t>(static_cast<std::uint64_t>(upper) << 32 | (all[2 * i + 1] & low));
  }
  return counts;
}

/// Saves and restores a simulation on ranks; see distributed_checkpoint.hpp.
template <class Distributed>
class distributed_checkpoint;

}  // namespace detail

/// A simulation on many ranks, which gives the bits of one rank, on any number of them. Each rank puts some particles
/// into it; from then on the library moves them to where their neighbours are. The mesh is the same on every rank. All
/// ranks call all members, in the same order, with the same parameters of effects and the same `dt`. What one throws
/// makes all throw: see `together`; then `set` begins anew.
///
/// If particles meet each other, each rank has the particles of a subdomain of space, and copies of those that are near
/// it. All tell each other in each step where copies are, and whether a particle has moved so far that some may be
/// missing: then particles change ranks, and where many more are on one rank than on others, new subdomains are cut. So
/// a step waits for the other ranks, and with CUDA for the device. Where particles do not meet, they stay where they
/// are.
///
/// \tparam Detector  that of the simulation
/// \tparam Effect    those of the simulation. An effect of your own with a member `begin_step` sees the places of one
///                   rank: it says `static constexpr bool begins_on_ranks = true` if that is enough.
/// \tparam Ranks     `one_rank`, `thread_ranks` or `mpi_ranks`
template <class Detector, class... Effect, class Ranks>
class distributed<simulation<Detector, Effect...>, Ranks> {
  static_assert(detail::check_ranks<Ranks>());

 public:
  using scalar = typename Detector::scalar;                    ///< type of all numbers: float or double
  using execution_space = typename Detector::execution_space;  ///< that of the detector
  using simulation_type = simulation<Detector, Effect..., detail::with_global_numbers>;  ///< what each rank runs
  using columns = typename simulation<Detector, Effect...>::columns;  ///< the state that a particle has
  static constexpr std::size_t bytes_per_particle = simulation_type::bytes_per_particle;  ///< of state, on its rank

 private:
  using S = scalar;
  using part_type = detail::part_of_simulation<simulation_type>;
  using broad_phase = typename Detector::broad_phase;
  static constexpr bool any_pair_contact = part_type::any_pair_contact;
  static_assert((detail::check_on_ranks<Effect, execution_space, typename simulation_type::state_type, S>() && ...));

 public:
  /// With effects as they are by default.
  explicit distributed(Ranks ranks = Ranks(), execution_space space = execution_space(), broad_phase options = {})
      : ranks_(std::move(ranks)), part_(std::move(space), std::move(options)) {}

  /// With parameters of all effects, in the order of the list.
  template <class... E, class = std::enable_if_t<detail::are_all_of<std::tuple<Effect...>, E...>>>
  distributed(Ranks ranks, execution_space space, E... effects)
      : ranks_(std::move(ranks)), part_(std::move(space), std::move(effects)..., detail::with_global_numbers()) {}

  /// Copies this rank's particles, perhaps none, as `simulation::set`. One after the other, the ranks' particles have
  /// the numbers of all. `capacity` is for how many particles there is room on all ranks together: the same number on
  /// each. There are at most 2^32 - 2 on all ranks.
  void set(sphere_view<S> const& mine, S const* velocities = nullptr, std::size_t capacity = 0) {
    set(mine, velocities, capacity, [](simulation_type&) {});
  }
  /// `set`, and a call of `then` with the simulation of this rank, for code that sets more of particles, as
  /// `set_clumps` does; no part of the interface.
  template <class F>
  void set(sphere_view<S> const& mine, S const* velocities, std::size_t capacity, F const& then) {
    detail::global_counts all{count_before(ranks_, mine.size()), 0, 0, 0, 0};
    std::uint64_t const n = mine.size();
    ranks_.reduce(&n, &all.placed, 1, reduction::sum);
    all.size = std::max(all.placed, std::uint64_t{capacity});
    share_free(all, [](std::uint64_t number) { return number; });
    S const own = part_.effects().source_radius();
    detail::radii_of_all<S> radii = find_radii(mine);
    radii.range = radii.range.with(own);
    radii.widest = std::max(radii.widest, own);
    together(ranks_, [&] { detail::check_particles<columns>(true, all.placed, all.size, own, radii.common); });
    is_sound_ = false;
    exchange_.clear();
    together(ranks_, [&] {
      starts_.resize(static_cast<std::size_t>(ranks_.size()) + 1);
      part_.set(mine, velocities, all, radii);
      then(part_.simulation());
    });
    ranks_.all_gather(&all.first, sizeof all.first, starts_.data());
    starts_.back() = all.placed;
    is_sound_ = true;
  }

  /// The mesh, with its bodies and the velocities of its vertices, which is the same on every rank; see
  /// `simulation::set_mesh`.
  void set_mesh(mesh_view<S> mesh, std::vector<body> const& bodies = {}, S const* velocities = nullptr) {
    together(ranks_, [&] { part_.simulation().set_mesh(mesh, bodies, velocities); });
  }

  /// Advances by the time `dt`; throws what `simulation::step` throws. If it throws after the step has begun somewhere,
  /// particles may be lost, and nothing works until the next `set` or `load`.
  void step(S dt) { steps(1, dt); }

  /// Advances `n` times by `dt`; throws what `step` throws. Ranks wait for each other once a step, and once more in the
  /// end.
  void steps(std::size_t n, S dt) {
    check_sound();
    if (n != 0 && !part_.knows_pair_forces()) meet_first(dt);
    std::exception_ptr failure;  // of the last step: the others hear of it when the next one begins, or in the end
    for (std::size_t k = 0; k < n; ++k) failure = try_step(dt, failure);
    agree(ranks_, failure);
    is_sound_ = true;
  }

  /// The sum of the steps since `set`.
  double time() const { return part_.simulation().time(); }
  /// Number of particles on all ranks, or of places for them.
  std::size_t size() const { return part_.all_size(); }

  /// A column of the particles that this rank has `set`, in their order, wherever they are. The last rank gets behind
  /// them those that effects have made. One after the other, the ranks' columns are that of one rank. Waits.
  template <class Column>
  std::vector<detail::column_element<Column, S>> to_host() {
    std::vector<detail::column_element<Column, S>> values;
    bring_home(local().template data<Column>(), detail::column_bytes<Column, S>, values);
    return values;
  }

  /// Counts of the source on all ranks; see `birth_counts`. All ranks call it. Waits.
  birth_counts births() const {
    birth_counts all;
    together(ranks_, [&] { all = local().births(); });
    std::uint64_t const mine[2] = {all.overlapping, all.not_born};
    std::uint64_t sums[2] = {0, 0};
    ranks_.reduce(mine, sums, 2, reduction::sum);
    return {all.due, sums[0], sums[1]};
  }
  /// The sums of all ranks for each body; see `reaction_sums::read`. Waits.
  std::vector<body_impulse> total(reaction_sums const& mine) const {
    return impulses(mine, [&] { return mine.counts(local().space()); });
  }
  /// The sums of all ranks for each triangle; see `reaction_sums::read_triangles`. Waits.
  std::vector<body_impulse> total_of_triangles(reaction_sums const& mine) const {
    return impulses(mine, [&] { return mine.triangle_counts(local().space()); });
  }
  /// How many contacts of all ranks are in no sum; see `reaction_sums::refused`. Waits.
  std::uint64_t total_refused(reaction_sums const& mine) const {
    std::uint64_t own = 0, all = 0;
    together(ranks_, [&] { own = mine.refused(local().space()); });
    ranks_.reduce(&own, &all, 1, reduction::sum);
    return all;
  }

  /// The parameters of an effect, which may be changed between steps, on all ranks alike.
  template <class E>
  E& effect() {
    return part_.simulation().template effect<E>();
  }

  /// The ranks.
  Ranks const& ranks() const { return ranks_; }
  /// The simulation of this rank, to look at: its `size()` particles are those that are on this rank now, in any order;
  /// the column `global_number` tells which.
  simulation_type const& local() const { return part_.simulation(); }
  /// The space of this rank.
  execution_space& space() { return part_.space(); }

 private:
  friend class detail::distributed_checkpoint<distributed>;

  /// All ranks know it alike.
  void check_sound() const {
    if (!is_sound_) {
      throw error("collide: simulation: the last step, set or load has failed on some rank: call set or load");
    }
  }

  /// The sums over all ranks of the counts that read() gives, as impulses.
  template <class Read>
  std::vector<body_impulse> impulses(reaction_sums const& mine, Read const& read) const {
    std::vector<std::int64_t> const counts = detail::rank_reduction(ranks_, read);
    std::vector<body_impulse> found;
    together(ranks_, [&] { found = mine.impulses(counts); });
    return found;
  }

  /// Brings a column, of so many bytes of each particle, to the ranks that have set these.
  void bring_home(void const* column, std::size_t bytes, detail::any_vector const& values) {
    std::vector<id> numbers;
    std::vector<unsigned char> rows;
    check_sound();
    together(ranks_, [&] {
      if (!part_.is_set()) throw error("collide: simulation: to_host needs particles: call set before it");
      numbers = part_.template on_host<global_number>();
      rows = detail::bytes_on_host(part_.space(), column, numbers.size() * bytes);
    });
    detail::bring_home(ranks_, starts_, numbers, rows, bytes, values);
  }

  /// Particles meet where they begin.
  void meet_first(S dt) {
    together(ranks_, [&] { part_.check_step(dt); });
    exchange_.exchange(ranks_, part_);
    exchange_.send(ranks_, part_);
    exchange_.receive(ranks_, part_);
    together(ranks_, [&] {
      exchange_.unpack(ranks_, part_);
      part_.meet(dt);
    });
  }

  /// The part of a step before ranks agree, in which copies are sent to others also where something has gone wrong:
  /// `mine` is what a rank tells the others. What has `failed` is from the last step, or this one.
  void begin_step(S dt, std::exception_ptr& failed, std::uint64_t* mine) {
    bool const sends = any_pair_contact && part_.knows_others();
    detail::first_failure failure;
    failure.attempt([&] {
      if (failed) std::rethrow_exception(failed);
      part_.check_step(dt);
      mine[1] = 1;
      part_.begin_step(dt);
      if (sends) exchange_.pack(ranks_, part_, [&] { part_.check_own(); });
    });
    if (sends) failure.attempt([&] { exchange_.send(ranks_, part_); });
    if (!failure.get()) {
      failure.attempt([&] {
        if (sends && !exchange_.is_under_way(ranks_, part_)) exchange_.unpack(ranks_, part_);
        mine[0] = part_.has_moved(ranks_) ? 1 : 0;
      });
    }
    if (sends && failure.get()) failure.attempt([&] { exchange_.abandon(part_); });
    failed = failure.get();
    if (failed) mine[0] = 2;
  }

  /// Waits for copies that are under way, of which none is missing. Meanwhile those meet that need none.
  void receive(S dt) {
    detail::first_failure failure;
    failure.attempt([&] { part_.meet_inside(dt); });
    exchange_.receive(ranks_, part_);
    failure.rethrow();
    exchange_.unpack(ranks_, part_);
  }

  /// A step, until this rank is done: what went wrong here then. All throw what goes wrong before, or has `failed` here
  /// in the last step.
  std::exception_ptr try_step(S dt, std::exception_ptr failed) {
    std::uint64_t mine[2] = {0, 0}, all[2];  // 1: particles must change ranks, 2: something is wrong; has it begun?
    bool const travels = any_pair_contact && part_.knows_others() && exchange_.is_under_way(ranks_, part_);
    begin_step(dt, failed, mine);
    ranks_.reduce(mine, all, 2, reduction::max);
    is_sound_ = is_sound_ && all[1] == 0;
    if (travels && all[0] != 0) exchange_.receive(ranks_, part_);
    if (all[0] == 2) agree(ranks_, failed);
    if (any_pair_contact && all[0] == 1) exchange_.exchange(ranks_, part_);
    try {
      if constexpr (any_pair_contact) {
        if (travels && all[0] == 0) receive(dt);
        if (all[0] == 1) {
          exchange_.send(ranks_, part_);
          exchange_.receive(ranks_, part_);
          exchange_.unpack(ranks_, part_);
        }
        if (part_.refuses_births(dt)) {
          part_.settle_births(dt);
          exchange_.pack(ranks_, part_, [] {});
          exchange_.send(ranks_, part_);
          exchange_.receive(ranks_, part_);
          exchange_.unpack(ranks_, part_);
        }
      }
      part_.end_step(dt);
    } catch (...) {
      failed = std::current_exception();
    }
    if (size() != 0) reverse_order_ = !reverse_order_;
    return failed;
  }

  /// Says with which free places this rank begins; begin_of(number) is where something whole begins that has it.
  template <class F>
  void share_free(detail::global_counts& all, F const& begin_of) const {
    auto const ranks = static_cast<std::uint64_t>(ranks_.size()), rank = static_cast<std::uint64_t>(ranks_.rank());
    std::uint64_t const capacity = all.size - all.placed;
    all.first_free = begin_of(all.placed + capacity * rank / ranks);
    all.free_size = begin_of(all.placed + capacity * (rank + 1) / ranks) - all.first_free;
  }

  /// Radii of the particles of all ranks. Throws `error` on all if there must be one, but there are several.
  detail::radii_of_all<S> find_radii(sphere_view<S> const& mine) const {
    using detail::to_ordered_bits;
    S smallest = std::numeric_limits<S>::infinity(), largest = mine.common_radius(), widest = 0;
    together(ranks_, [&] {
      buffer<S> memory;
      auto const& space = part_.simulation().space();
      std::vector<S> each;
      if (!mine.one_radius()) {
        each = detail::packed_on_host<S>(space, mine.size(), memory, [&](S* to) {
          space.for_each(mine.size(), detail::copy_radii<S>{mine, to});
        });
      }
      if (!each.empty()) largest = *std::max_element(each.begin(), each.end());
      widest = largest < 0 ? -largest : largest;
      if (mine.one_radius() && largest >= 0) smallest = largest;
      for (S const r : each) {
        if (!detail::is_finite(r)) throw error("collide: simulation: set: radii are finite");
        widest = std::max(widest, r < 0 ? -r : r);
        if (r >= 0) smallest = std::min(smallest, r);
      }
    });
    // a rank without particles has no say in this, unless no rank has any
    auto const ask = [&](S value, bool has_say) {
      std::uint64_t mine_bits[2] = {0, has_say ? to_ordered_bits(static_cast<double>(value)) : 0}, all[2];
      mine_bits[0] = has_say ? 1 : 0;
      ranks_.reduce(mine_bits, all, 2, reduction::max);
      return std::pair<bool, S>(all[0] != 0, static_cast<S>(detail::from_ordered_bits<double>(all[1])));
    };
    bool const has_any = ask(S(0), mine.size() != 0).first;
    bool const has_say = mine.size() != 0 || !has_any;
    S const largest_common = ask(mine.common_radius(), has_say).second,
            smallest_common = -ask(-mine.common_radius(), has_say).second;
    bool const several = ask(S(0), has_say && !mine.one_radius()).first ||
                         detail::to_bits(largest_common) != detail::to_bits(smallest_common);
    detail::check_particles<columns>(!several, 0, 0, S(0), S(0));
    S const smallest_of_all = -ask(-smallest, has_say).second;
    return {several ? S(0) : largest_common,
            {several ? smallest_of_all : largest_common, ask(largest, has_say).second, S(0)},
            ask(widest, has_say).second};
  }

  Ranks ranks_;
  part_type part_;
  detail::particle_exchange<part_type> exchange_;
  bool is_sound_ = true;               ///< no step, `set` or `load` has stopped half-way
  bool reverse_order_ = false;         ///< of one rank's next step, for checkpoints
  std::vector<std::uint64_t> starts_;  ///< numbers of the first particles that ranks have set, and one behind the last
};

}  // namespace collide
