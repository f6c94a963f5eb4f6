/// \file
/// The particles that a rank has of a simulation: its own, and copies of others' that may meet them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include <collide/detail/ranks/divided_mesh.hpp>
#include <collide/detail/ranks/particle_places.hpp>
#include <collide/detail/ranks/particle_rows.hpp>
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
  using effects_type = typename Simulation::effects_type;
  using all_columns = typename Simulation::columns;
  /// What is known of copies: all that is read of a particle that another one meets.
  using seen_columns =
      union_of<typename effects_type::interaction, intersection_of<columns<radius, alive>, all_columns>>;
  template <class List>
  using rows = std::vector<particle_row<S, List>>;

  static constexpr bool meets = effects_type::meets;
  static constexpr bool has_absent = contains<all_columns, alive>;

  template <class... Argument>
  explicit part_of_simulation(Argument&&... arguments) : simulation_(std::forward<Argument>(arguments)...) {}

  Simulation& simulation() { return simulation_; }
  Simulation const& simulation() const { return simulation_; }
  space_type& space() { return simulation_.space_; }
  std::size_t own() const { return simulation_.state_.own; }

  void set(sphere_view<S> const& particles, S const* velocities, numbers_of_all const& all,
           radii_of_all<S> const& radii) {
    std::size_t const n = particles.size();
    capacity_ = larger(n + static_cast<std::size_t>(all.free_size), std::size_t{1});
    simulation_.place(particles, velocities, capacity_);
    start(n, all, radii);
    simulation_.prepare();
  }

  /// What a checkpoint has of the simulation of all, besides columns, effects and bodies.
  template <class Numbers>
  Numbers saved_numbers_of_all(bool reverse_order) const {
    auto const& s = simulation_;
    Numbers numbers{
        s.mesh_.size(), s.state_.all_size, s.state_.all_placed, s.state_.common_radius, S(0), S(0), s.time_, 0,
        reverse_order};
    if constexpr (meets || Simulation::sweeps || Simulation::has_bodies) {
      numbers.smallest_radius = s.radii_.smallest;
      numbers.largest_radius = s.radii_.largest;
    }
    if constexpr (Simulation::has_begin_step) numbers.device_time = s.space_.read(s.state_.time);
    return numbers;
  }
  std::size_t triangles() const { return simulation_.mesh_.size(); }
  effects_type const& effects() const { return simulation_.effects_; }

  /// Takes particles, time, effects and bodies of a checkpoint: `mine` particles, and free places.
  template <class Checkpoint>
  void restore(Checkpoint const& saved, std::size_t mine, numbers_of_all const& all) {
    auto const& numbers = saved.numbers();
    S largest = larger(numbers.largest_radius, numbers.common_radius), widest = largest < 0 ? -largest : largest;
    if constexpr (contains<all_columns, radius>) {
      for (S const r : saved.template column<radius>()) {
        largest = larger(largest, r);
        widest = larger(widest, r < 0 ? -r : r);
      }
    }
    auto const free = static_cast<std::size_t>(all.free_size);
    capacity_ = larger(mine + free, std::size_t{1});
    simulation_.place({}, nullptr, capacity_);
    start(mine, all, {numbers.common_radius, {numbers.smallest_radius, largest}, widest});
    auto const& state = simulation_.state_;
    saved.restore_columns(space(), state, 0, static_cast<std::size_t>(all.first), mine);
    saved.restore_columns(space(), state, mine, static_cast<std::size_t>(all.first_free), free);
    if constexpr (Simulation::has_begin_step) space().copy_from_host(state.time, &numbers.device_time, 1);
    saved.restore_parameters(simulation_);
    simulation_.time_ = numbers.time;
    simulation_.prepare();
    saved.restore_bodies(simulation_);
    space().synchronize();
  }

  bool is_set() const { return simulation_.is_set_; }
  std::size_t all_size() const { return simulation_.state_.all_size; }

  /// How far from its own brick, as it was at the last exchange, a rank must know particles.
  double reach() const { return reach_; }

  void check_step(S dt) const { simulation_.check_step(dt); }

  /// The first part of a step. True if copies of particles may be missing somewhere in it.
  bool begin_step(S dt) {
    simulation_.time_ += static_cast<double>(dt);
    simulation_.begin_step(dt);
    if constexpr (meets) {
      return has_moved();
    } else {
      return false;
    }
  }

  /// The rest of a step.
  void end_step(S dt) {
    if constexpr (meets) {
      state_type with_copies = simulation_.state_;
      with_copies.size += copies_;
      if (own() != 0) simulation_.neighbours_.interact(space(), with_copies, simulation_.effects_, dt);
    }
    if (own() != 0) simulation_.end_step(dt);
  }

  /// A column of the rank's own particles on the host.
  template <class Column>
  std::vector<column_element<Column, S>> on_host() const {
    return simulation_.template to_host<Column>();
  }

  /// The columns `List` of particles at places that the host knows.
  template <class List>
  void pack(std::vector<std::uint32_t> const& places, rows<List>& to) {
    row_carrier<S, List>().pack(space(), simulation_.state_, in_space(space(), places, place_memory_), 0, places.size(),
                                to);
  }

  /// Takes particles away from places, by rising number, and adds others.
  void replace(std::vector<std::uint32_t> const& leaving, rows<all_columns> const& coming) {
    knows_others_ = false;
    std::size_t const before = own(), after = before - leaving.size() + coming.size();
    make_room(after);
    std::vector<std::uint32_t> to(
        leaving.begin(), leaving.begin() + static_cast<std::ptrdiff_t>(smaller(leaving.size(), coming.size())));
    for (std::size_t i = before; to.size() < coming.size(); ++i) to.push_back(static_cast<std::uint32_t>(i));
    unpack(to, coming);
    if (coming.size() < leaving.size()) close_gaps(leaving, coming.size(), after);
    resize_own(after);
    space().synchronize();  // the rows go
  }

  /// Prepares for copies of so many particles of other ranks, and keeps where its own are.
  void expect_copies(std::size_t n) {
    make_room(own() + n);
    copies_ = n;
    if constexpr (meets) simulation_.neighbours_.clear(space(), own() + n, simulation_.radii_.largest);
    auto* const resource = space().resource();
    last_centres_.reserve(resource, 3 * capacity_);
    if constexpr (has_absent) last_there_.reserve(resource, capacity_);
    space().for_each(own(), keep_places<S, state_type>{simulation_.state_, last()});
    knows_others_ = true;
  }

  /// What others know of particles at these places, in memory of the space.
  void pack_seen(std::uint32_t const* places, std::size_t n, host_array<particle_row<S, seen_columns>>& to) {
    seen_.pack(space(), simulation_.state_, places, 0, n, to);
  }
  /// Takes over what is known of all copies.
  void unpack_seen(host_array<particle_row<S, seen_columns>> const& from) {
    seen_.unpack(space(), simulation_.state_, nullptr, own(), from);
  }

 private:
  static constexpr S skin_fraction = S(0.1);  ///< of the largest diameter

  void unpack(std::vector<std::uint32_t> const& places, rows<all_columns> const& from) {
    all_.unpack(space(), simulation_.state_, in_space(space(), places, place_memory_), 0, from);
  }

  /// Numbers the particles, of which `n` are this rank's, and free places behind them.
  void start(std::size_t n, numbers_of_all const& all, radii_of_all<S> const& radii) {
    std::size_t const room = n + static_cast<std::size_t>(all.free_size);
    describe(room, static_cast<std::size_t>(all.size), static_cast<std::size_t>(all.placed), radii.common);
    space().for_each(room, number_places<S, state_type>{simulation_.state_, n, all.first, all.first_free});
    S const widest = radii.widest;
    simulation_.radii_ = radii.range;
    skin_ = skin_fraction * 2 * widest;
    reach_ = widest > 0 ? (2 * static_cast<double>(widest) + static_cast<double>(skin_)) * (1 + 0x1p-8) : 0;
    copies_ = 0;
    knows_others_ = false;
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
    rows<all_columns> moved;
    pack<all_columns>(from, moved);
    unpack(to, moved);
  }

  /// Room for so many particles; the rank's own stay.
  void make_room(std::size_t n) {
    if (n <= capacity_) return;
    state_type const old = simulation_.state_;
    double const time = old.time != nullptr ? space().read(old.time) : 0;
    rows<all_columns> kept;
    all_.pack(space(), old, nullptr, 0, old.own, kept);
    std::size_t const room = n + n / 4;
    capacity_ = 0;
    simulation_.reserve(room);
    capacity_ = room;
    describe(old.own, old.all_size, old.all_placed, old.common_radius);
    if constexpr (Simulation::has_begin_step) {
      simulation_.state_.time = simulation_.device_time_.data();
      space().copy_from_host(simulation_.state_.time, &time, 1);
    }
    space().for_each(padded_size(room), init_particles<S, all_columns>{simulation_.state_, {}, nullptr});
    all_.unpack(space(), simulation_.state_, nullptr, 0, kept);
    space().synchronize();  // the rows go
    simulation_.is_set_ = true;
  }

  void describe(std::size_t own, std::size_t all_size, std::size_t all_placed, S common) {
    double* const time = simulation_.state_.time;
    simulation_.state_ = simulation_.memory_.state(own, own, common);
    simulation_.state_.time = time;
    simulation_.state_.own = own;
    simulation_.state_.all_size = all_size;
    simulation_.state_.all_placed = all_placed;
  }
  void resize_own(std::size_t n) { simulation_.state_.size = simulation_.state_.placed = simulation_.state_.own = n; }

  bool has_moved() {
    if (!knows_others_) return true;
    if (own() == 0) return false;
    std::uint32_t* const flag = flag_.reserve(space().resource(), 1);
    space().fill(flag, 0, sizeof *flag);
    // half of the skin, but for rounding
    space().for_each(own(), find_moved<S, state_type>{simulation_.state_, last(), S(0.495) * skin_, flag});
    return space().read(flag) != 0;
  }

  last_places<S> last() const { return {last_centres_.data(), last_there_.data()}; }

  Simulation simulation_;
  std::size_t capacity_ = 0, copies_ = 0;
  bool knows_others_ = false;  ///< there are copies of all that its own may meet, as long as nothing moves far
  S skin_ = 0;
  double reach_ = 0;
  row_carrier<S, all_columns> all_;
  row_carrier<S, seen_columns> seen_;
  buffer<S> last_centres_;
  buffer<std::uint8_t> last_there_;
  buffer<std::uint32_t> flag_, place_memory_;
};

}  // namespace collide::detail
