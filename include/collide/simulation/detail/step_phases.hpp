/// \file
/// The phases of a simulation's step, each of which is a list of kernels.
#pragma once

#include <algorithm>
#include <string>
#include <type_traits>

#include <collide/effects/clumps.hpp>
#include <collide/simulation/detail/simulation_state.hpp>
#include <collide/simulation/detail/step/clump_motion.hpp>
#include <collide/simulation/detail/step/particle_kernels.hpp>
#include <collide/simulation/detail/step/step.hpp>

namespace collide::detail {

/// The triangles near a particle of a simulation, for a step that `Asks` for them.
template <bool Asks, class State>
auto mesh_ref([[maybe_unused]] State const& s, [[maybe_unused]] typename State::S dt) {
  if constexpr (Asks) {
    auto const whole = s.mesh.size() != 0 ? s.index.mesh_lookup() : std::decay_t<decltype(s.index.mesh_lookup())>{};
    return s.bodies.ref(whole, s.mesh, dt);
  } else {
    return absent{};
  }
}

/// By how much farther than its radius a particle sees the mesh that is listed for some steps.
template <class State>
auto margin_near_mesh([[maybe_unused]] State const& s) {
  if constexpr (State::knows_near_mesh) return (State::has_bodies ? 2 : 1) * s.neighbours.skin();
  return typename State::S(0);
}

/// Room for the overlaps of particles that have many.
template <class State>
overlap_pool overlap_pool_of(State const& s) {
  return {s.overlaps.data(), static_cast<std::uint32_t>(s.overlaps.capacity()), s.pressing_counts.data() + 1,
          s.pressing_counts.data() + 2};
}

/// The phases of a step, in this order: `check_step`, `begin_step`, `meet`, `end_step`; and, between steps, those that
/// wake or free particles. A view of a simulation's data, which it changes.
template <class Detector, class... Effect>
class step_phases {
 public:
  using state_type = simulation_state<Detector, Effect...>;
  using execution_space = typename state_type::execution_space;
  using S = typename state_type::S;
  using effects_type = typename state_type::effects_type;
  using columns = typename state_type::columns;
  using particles_type = typename state_type::particles_type;

  step_phases(state_type& all) : s_(all) {}

  /// Throws `error` if a step cannot be made: see `simulation::step`.
  COLLIDE_COLD void check_step(S dt) const {
    if (!s_.is_set) throw error("collide: simulation: step needs particles: call set before it");
    if (state_type::asks_mesh && !s_.has_mesh)
      throw error("collide: simulation: an effect of the scene touches the mesh: call set_mesh before step");
    if (!(dt > 0) || !is_finite(dt)) throw error("collide: simulation: the time dt of a step is finite and above 0");
    ((check_part(effect<Effect>()), check_bodies_of(effect<Effect>(), s_.bodies.size()),
      check_materials_of(effect<Effect>(), s_.smallest)),
     ...);
    (check_box_of<Effect>(), ...);
    if constexpr (effects_type::repeats) check_sides();
    [[maybe_unused]] double const time = static_cast<double>(dt);
    (check_time_step(time, longest_step_of(effect<Effect>(), s_.smallest), s_.smallest), ...);
    if ((!effects_type::any_pair_contact || effects_type::has_clumps) && s_.effects.makes_only_where_free())
      throw error(
          "collide: emit: only_where_free needs an effect by which particles meet, such as sphere_contact, and does "
          "not know clumps");
  }

  void begin_step(S dt) {
    (begin_step_of<Effect>(dt), ...);
    if constexpr (effects_type::makes && effects_type::remembers_surfaces) {
      if (s_.effects.due(static_cast<double>(dt)) > 0)
        for_each(
            forget_surfaces<effects_type, particles_type>{s_.particles, s_.surfaces.ref(s_.particles.size).counts});
    }
    s_.effects.prepare(dt);
    if constexpr (effects_type::keeps_mesh_kicks)
      for_each(record_first_kicks<S, effects_type>{s_.particles, s_.effects, dt, s_.mesh.size(), s_.bodies.size()});
    advance_bodies(static_cast<double>(dt), false);
    if constexpr (state_type::has_begin_step)
      s_.space.for_each(1, advance_time{s_.particles.time, double(dt), s_.effects.due(static_cast<double>(dt))});
    if constexpr (effects_type::ends_after_meeting) move(dt);
    if constexpr (effects_type::has_clumps)
      for_each(step_clumps<S, effects_type, false>{s_.particles, s_.effects, s_.effects.space(), dt});
    wake_by_bodies(dt);
    wake_where_others_went(dt);
  }

  /// Particles meet, among them copies of other ranks' in `with_copies`.
  void meet([[maybe_unused]] particles_type const& with_copies, [[maybe_unused]] S dt) {
    [[maybe_unused]] meeting const what = s_.next_meeting;
    s_.next_meeting = meeting::in_step;
    if (s_.particles.size == 0) return;
    if (what != meeting::in_step && !s_.bodies.are_placed())
      advance_bodies(0, true);  // those that the caller drives, to where they begin
    bool const keeps_kicks = what == meeting::of_woken;
    if constexpr (effects_type::any_pair_contact) {
      if (!keeps_kicks || !effects_type::keeps_support) {
        s_.neighbours.renew(s_.space, with_copies, s_.effects.space());
        if constexpr (state_type::meets_once) follow_lists();
        settle_births(with_copies, dt);
        if constexpr (state_type::lists_near_mesh) list_near_mesh(dt, what);
        s_.neighbours.interact(s_.space, with_copies, s_.effects, dt, what);
      }
    } else if (!keeps_kicks) {
      forget_pair_kicks();
    }
    if constexpr (effects_type::overlaps) press(dt, what);
  }
  /// Before copies are there, if lists of neighbours are not to be made anew, particles meet that need none.
  void meet_inside(particles_type const& with_copies, S dt) {
    s_.neighbours.interact_inside(s_.space, with_copies, s_.effects, dt);
  }
  /// Says which of those that a source has made overlap others, once the lists are renewed.
  void settle_births([[maybe_unused]] particles_type const& with_copies, [[maybe_unused]] S dt) {
    if constexpr (effects_type::makes) {
      if (s_.effects.due(static_cast<double>(dt)) > 0)
        s_.neighbours.settle_births(s_.space, with_copies, s_.effects.makes_only_where_free());
    }
    if constexpr (state_type::may_be_made && effects_type::remembered::size != 0)
      for_each(take_marks_off{s_.particles.at(alive{})});
  }

  void end_step(S dt) {
    if constexpr (effects_type::has_clumps)
      for_each(step_clumps<S, effects_type, true>{s_.particles, s_.effects, s_.effects.space(), dt});
    if constexpr (effects_type::ends_after_meeting) {
      for_each(end_particles<S, effects_type>{s_.particles, s_.effects, dt});
    } else {
      move(dt);
    }
  }

  /// Sleepers wake. What others do to them is known where they press on what they lie on, but not what walls do by
  /// forces. Those that are awake know all.
  void wake_all() {
    if constexpr (contains<columns, slow_steps>) {
      if (s_.particles.size == 0) return;
      constexpr bool asks_forces =
          effects_type::ends_after_meeting && (effects_type::overlaps || !effects_type::keeps_support);
      if constexpr (asks_forces && contains<columns, in_contact>) {
        for_each(wake_between_steps<S, effects_type>{s_.particles, s_.effects});
        if (knows_pair_forces()) s_.next_meeting = meeting::of_woken;
      } else {
        s_.space.fill(s_.particles.at(slow_steps{}), 0, s_.particles.size);
      }
    }
  }
  bool knows_pair_forces() const { return s_.next_meeting == meeting::in_step; }

  /// Particles lie in the order of the cells of their lists, if there are any, until `leave_cell_order`.
  void take_cell_order() {
    if constexpr (state_type::has_cell_order) {
      s_.is_in_cell_order = true;
      id* const places = s_.neighbours.in_order();
      if (places == nullptr) return;
      s_.order.take(s_.space, s_.particles, s_.surfaces, places, room_to_move());
      for_each([=](std::size_t i) { places[i] = static_cast<id>(i); });
      s_.is_pressing_known = false;
    }
  }
  std::byte* room_to_move() {
    return s_.neighbours.room(s_.space.resource(), s_.particles.size * state_type::widest_moved);
  }
  void leave_cell_order() {
    if constexpr (state_type::has_cell_order) {
      s_.is_in_cell_order = false;
      if (s_.particles.names == nullptr) return;
      std::copy_n(s_.particles.names, s_.particles.size, s_.neighbours.in_order());
      s_.order.put_back(s_.space, s_.particles, s_.surfaces, room_to_move());
      s_.is_pressing_known = false;
    }
  }

  /// Frees particles that stick to the mesh and do not touch it any more.
  void release_stuck() {
    if constexpr (effects_type::adheres) {
      auto const triangles = mesh_ref<effects_type::any_mesh_contact>(s_, S(0));
      for_each(detail::release_stuck<particles_type, std::decay_t<decltype(triangles)>>{
          s_.particles, triangles, s_.bodies.are_driven(), s_.bodies.size()});
    }
  }

  /// Moves the bodies on by `dt`, or, if they start, to where they are at this time.
  void advance_bodies(double dt, bool start) {
    if constexpr (state_type::has_bodies) {
      if (s_.particles.time == nullptr) return;
      auto const& motion = s_.effects.template of<moving_bodies<typename state_type::bodies_type::motion>>().motion;
      s_.bodies.advance(s_.space, motion, s_.particles.time, dt, s_.radii.smallest, state_type::sweeps, start);
    }
  }

 private:
  template <class Kernel>
  void for_each(Kernel const& kernel) {
    s_.space.for_each(s_.particles.size, kernel);
  }

  template <class E>
  E const& effect() const {
    return s_.effects.template of<E>();
  }

  /// Rounded to numbers of this type, the bounds of a box that repeats are bounds, too.
  template <class E>
  COLLIDE_COLD void check_box_of() const {
    if constexpr (repeats_space<E>) {
      auto const& box = s_.effects.template of<E>();
      for (int k = 0; k < 3; ++k) {
        S const low = static_cast<S>(box.lower[k]), high = static_cast<S>(box.upper[k]);
        check_parameter(is_finite(low) && is_finite(high) && low < high,
                        "periodic_box: the bounds are finite and differ in the simulation's type of numbers");
      }
    }
  }

  /// Two particles must not meet on both sides at once.
  COLLIDE_COLD void check_sides() const {
    auto shortest = 2 * static_cast<double>(state_type::neighbour_lists::width_of(s_.radii.largest, s_.radii.smallest));
    if constexpr (effects_type::has_clumps) shortest = max(shortest, 2.1 * s_.effects.template of<clumps>().reach);
    auto const space = s_.effects.space();
    for (int k = 0; k < 3; ++k) {
      if (space.length(k) >= shortest) continue;
      throw error("collide: periodic_box: particles meet across its sides, and so each must be at least " +
                  std::to_string(shortest) +
                  " long, two diameters of the largest with the skin of its neighbours, or a clump: make " +
                  "the box larger, or the particles smaller");
    }
  }

  /// Lets an effect begin a step. What it makes begins anew in all that it does not write.
  template <class E>
  void begin_step_of(S dt) {
    if constexpr (state_type::template may_make<E>)
      for_each(copy_values<std::uint8_t>{s_.particles.at(alive{}), s_.was_there.data()});
    detail::begin_step_of<E>(s_.effects, s_.space, s_.particles, dt);
    if constexpr (state_type::template may_make<E>) begin_anew<writes_of<E>>();
  }
  template <class Written>
  void begin_anew() {
    using kept = union_of<Written, collide::columns<position, velocity, radius, global_number>>;
    using initial = difference_of<columns, kept>;
    std::uint8_t* surfaces = nullptr;
    if constexpr (effects_type::remembers_surfaces) surfaces = s_.surfaces.ref(s_.particles.size).counts;
    for_each(detail::begin_anew<S, effects_type, initial>{s_.particles, s_.was_there.data(), surfaces});
  }

  /// Wakes particles that sleep where a body that moves may touch them: before ranks tell each other what is awake, and
  /// before lists of neighbours copy it.
  void wake_by_bodies([[maybe_unused]] S dt) {
    if constexpr (effects_type::overlaps && state_type::has_bodies &&
                  contains<typename effects_type::inactive_reads, slow_steps>) {
      auto const triangles = mesh_ref<true>(s_, dt);
      using mesh_type = std::decay_t<decltype(triangles)>;
      for_each(detail::wake_by_bodies<S, effects_type, mesh_type>{s_.particles, s_.effects, triangles});
    }
  }

  /// A source whose places have all been filled takes some from others, on which something may sleep: all of that is
  /// woken. Where half of a step is over by then, what held it has held it so long: so it is with what is awake.
  void wake_where_others_went([[maybe_unused]] S dt) {
    if constexpr (effects_type::makes && effects_type::any_pair_contact && contains<columns, slow_steps>) {
      if (s_.effects.due(static_cast<double>(dt)) > 0 && !s_.effects.makes_only_where_free())
        for_each(detail::wake_where_others_went<particles_type>{s_.particles});
    }
  }

  /// Particles press on the mesh. Where lists of neighbours tell who has moved, those far from the mesh are not asked
  /// again until lists are made anew, or a body has moved by their skin.
  void press(S dt, meeting what) {
    if constexpr (!state_type::lists_near_mesh) list_near_mesh(dt, what);
    auto const triangles = mesh_ref<true>(s_, dt);
    using mesh_type = std::decay_t<decltype(triangles)>;
    using memory_type = std::decay_t<decltype(s_.surfaces.ref(0))>;
    s_.space.for_each(execution_space::host_accessible ? *s_.pressing_counts.data() : s_.particles.size,
                      press_on_mesh<S, effects_type, mesh_type, memory_type>{
                          s_.particles, s_.effects, triangles, s_.surfaces.ref(s_.particles.size), pressing(),
                          overlap_pool_of(s_), dt, what});
  }
  void list_near_mesh(S dt, meeting what) {
    auto const memory = s_.surfaces.ref(s_.particles.size);
    auto const triangles = mesh_ref<true>(s_, dt);
    using list_type = list_pressing<S, effects_type, std::decay_t<decltype(triangles)>, std::decay_t<decltype(memory)>>;
    bool const stays_listed = state_type::knows_near_mesh && what == meeting::in_step;
    std::uint32_t const lanes = list_type::template lanes_for<execution_space>(s_.particles.size);
    auto const kernel = [&] {
      return list_type{s_.particles, s_.effects, triangles, memory,
                       pressing(),   what,       lanes,     stays_listed ? margin_near_mesh(s_) : S(0)};
    };
    std::size_t const threads = lanes * s_.particles.size;
    if (!stays_listed || !s_.is_pressing_known || has_body_moved()) {
      do {
        s_.space.fill(s_.pressing_counts.data(), 0, 2 * sizeof(std::uint32_t));  // and the pool is empty
        s_.space.for_each(threads, kernel());
      } while (must_list_again());
      if constexpr (state_type::knows_near_mesh && !state_type::lists_near_mesh) s_.bodies.mark();
    } else if constexpr (state_type::lists_near_mesh) {
      std::uint32_t const* const anew = s_.neighbours.rebuild();
      do {
        s_.space.for_each(1, begin_pressing{anew, s_.pressing_counts.data()});
        for_each_if_nonzero(s_.space, anew, threads, kernel());
      } while (must_list_again());
    }
    s_.is_pressing_known = stays_listed;
  }
  pressing_list pressing() const {
    return {s_.pressing_counts.data(), s_.pressing.data(), static_cast<std::uint32_t>(s_.pressing.capacity())};
  }
  /// On the host, once particles near the mesh are listed: makes room for them. True if there was too little.
  bool must_list_again() {
    if constexpr (execution_space::host_accessible) {
      std::size_t const count = *s_.pressing_counts.data();
      if (count > s_.pressing.capacity()) {
        s_.pressing.reserve(s_.space.resource(), count + count / 8);
        return true;
      }
      s_.surfaces.give_rows(s_.space, s_.particles.size, s_.pressing.data(), count);
    }
    return false;
  }
  /// True if a body may have come to particles that are not listed as near the mesh.
  bool has_body_moved() const {
    if constexpr (state_type::knows_near_mesh && !state_type::lists_near_mesh)
      return s_.bodies.moved() > 0.99 * static_cast<double>(s_.neighbours.skin());
    return false;
  }

  void follow_lists() {
    if (!s_.neighbours.are_new()) return;
    s_.is_pressing_known = false;
    if (s_.is_in_cell_order) take_cell_order();
  }

  void forget_pair_kicks() {
    if constexpr (effects_type::keeps_pair_forces) forget_pair_kicks(typename effects_type::interaction_kicks{});
  }
  template <class... Kick>
  void forget_pair_kicks(collide::columns<Kick...>) {
    (s_.space.fill(s_.particles.at(Kick{}), 0, 3 * s_.particles.size * sizeof(S)), ...);
  }

  /// A CPU reads memory ahead, and so always goes forwards.
  void move(S dt) {
    if (s_.particles.size == 0) return;
    auto const triangles = mesh_ref<effects_type::any_mesh_contact>(s_, dt);
    using kernel_type = typename state_type::template step_kernel_type<std::decay_t<decltype(triangles)>>;
    bool const reverse = s_.reverse_order && !works_alone<execution_space>;
    kernel_type const kernel{{s_.particles, s_.effects, triangles, s_.overflow.data(), dt, reverse, s_.min_radius},
                             kernel_type::grid_size(s_.space, s_.particles.size)};
    s_.reverse_order = !s_.reverse_order;
    s_.space.launch(kernel.blocks, kernel);
  }

  state_type& s_;
};

}  // namespace collide::detail
