/// \file
/// All data of a simulation, plain: `simulation` and the phases of its step work on it, checkpoints save it, and ranks
/// divide it.
#pragma once

#include <algorithm>
#include <type_traits>

#include <collide/broad/detail/grid/mesh_statistics.hpp>
#include <collide/detector.hpp>
#include <collide/effects/detail/host_members.hpp>
#include <collide/simulation/detail/bodies/body_memory.hpp>
#include <collide/simulation/detail/neighbours/cell_order.hpp>
#include <collide/simulation/detail/neighbours/verlet_list.hpp>
#include <collide/simulation/detail/step/step.hpp>
#include <collide/simulation/detail/walls/mesh_overlaps.hpp>

namespace collide::detail {

/// \tparam Detector, Effect  those of the simulation
template <class Detector, class... Effect>
struct simulation_state {
  using execution_space = typename Detector::execution_space;
  using S = typename Detector::scalar;
  using broad_phase = typename Detector::broad_phase;
  using narrow_phase = typename Detector::narrow_phase;
  using index_type = typename broad_phase::template index<S>;
  using effects_type = effect_list<S, Effect...>;
  using columns = typename effects_type::all;
  using particles_type = particle_state<S, columns>;
  using bodies_type = bodies_of<S, Effect...>;
  /// A thread that is alone in its block, as on a CPU, evaluates each pair once.
  static constexpr bool meets_once = effects_type::meets_once && works_alone<execution_space>;
  using neighbour_lists =
      std::conditional_t<effects_type::any_pair_contact, verlet_list<S, effects_type, meets_once>, absent>;
  using surfaces_type =
      surface_memory<S,
                     std::conditional_t<effects_type::overlaps, typename effects_type::remembered, collide::columns<>>>;
  template <class Triangles>
  using step_kernel_type = step_kernel<step_context<S, narrow_phase, Triangles, effects_type>>;

  static constexpr bool has_bodies = bodies_type::exist;
  static constexpr bool asks_mesh = effects_type::any_mesh_contact || effects_type::overlaps;
  static constexpr bool sweeps = effects_type::any_mesh_contact && !is_discrete<narrow_phase, S>;
  static constexpr bool has_begin_step = (detail::has_begin_step<Effect, execution_space, particles_type, S> || ...);
  /// Effects other than sources that may make particles in their `begin_step`.
  template <class E>
  static constexpr bool may_make =
      !is_source<E> && detail::has_begin_step<E, execution_space, particles_type, S> && contains<writes_of<E>, alive>;
  static constexpr bool may_be_made = (may_make<Effect> || ...);

  /// Particles near the mesh are listed anew with lists of neighbours, as a device finds out: where many threads work,
  /// and only particles move.
  static constexpr bool lists_near_mesh = effects_type::overlaps && effects_type::any_pair_contact &&
                                          !effects_type::repeats && !works_alone<execution_space> && !has_bodies &&
                                          !effects_type::any_inactive && !contains<columns, slow_steps> &&
                                          !contains<columns, global_number>;
  /// Lists of neighbours tell how long particles far from the mesh stay far from it.
  static constexpr bool knows_near_mesh =
      lists_near_mesh || (meets_once && effects_type::overlaps && !effects_type::repeats);
  /// Particles may lie in the order of the cells of their lists while some steps are made: no effect asks for places.
  static constexpr bool has_cell_order =
      meets_once && !effects_type::has_clumps && !contains<columns, alive> &&
      ((!detail::has_begin_step<Effect, execution_space, particles_type, S> || begins_on_ranks<Effect>)&&...);

  /// Bytes of a particle in what is moved then at a time.
  static constexpr std::size_t widest_moved =
      has_cell_order ? std::max(column_buffers<S, columns>::widest, surfaces_type::widest) : 0;

  execution_space space;
  broad_phase options;
  effects_type effects;

  column_buffers<S, columns> memory{};
  particles_type particles{};  ///< pointers into `memory`, and how many there are
  radius_range<S> radii{};
  smallest_radii smallest{};
  S min_radius = 0;  ///< swept particles are searched for as if they were at least so large

  bool is_set = false, has_mesh = false;
  bool reverse_order = false;               ///< of the next step
  meeting next_meeting = meeting::in_step;  ///< between steps, if the next begins with unknown forces
  double time = 0;
  buffer<double> device_time{};      ///< for effects with a member begin_step
  buffer<std::uint8_t> was_there{};  ///< `alive` when a step begins, for effects that make particles
  buffer<id> overflow{};             ///< see `step_context`

  mesh_view<S> mesh{};
  index_type index{};
  buffer<mesh_statistics<S>> mesh_summary{};
  bodies_type bodies{};

  neighbour_lists neighbours{};
  cell_order order{};
  bool is_in_cell_order = false;            ///< while some steps are made
  surfaces_type surfaces{};                 ///< what contacts with the mesh remember
  buffer<pressing_particle> pressing{};     ///< particles that may press on the mesh
  buffer<std::uint32_t> pressing_counts{};  ///< of those, of used `overlaps`, and whether they were too few
  bool is_pressing_known = false;           ///< for as long as these lists of neighbours hold
  buffer<overlap_item> overlaps{};          ///< of a device, for particles that overlap many triangles
};

}  // namespace collide::detail
