/// \file
/// Particles that move, and collide with a mesh and with each other: a detector and the effects that a scene names.
#pragma once

#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <collide/broad/detail/grid/mesh_statistics.hpp>
#include <collide/detector.hpp>
#include <collide/effects/detail/check_effect.hpp>
#include <collide/effects/detail/host_members.hpp>
#include <collide/simulation/detail/arguments.hpp>
#include <collide/simulation/detail/bodies/body_memory.hpp>
#include <collide/simulation/detail/neighbours/verlet_list.hpp>
#include <collide/simulation/detail/step/clump_motion.hpp>
#include <collide/simulation/detail/step/lookup_space.hpp>
#include <collide/simulation/detail/step/particle_kernels.hpp>
#include <collide/simulation/detail/step/step.hpp>
#include <collide/simulation/detail/walls/mesh_overlaps.hpp>
#if defined(COLLIDE_COMPILED)
#include <collide/simulation/detail/step/compiled_search.hpp>
#endif

namespace collide {

/// Particles, a mesh, and what happens to the particles in a step: only what the scene names.
///
/// \tparam Detector  `detector<BroadPhase, NarrowPhase, ExecutionSpace, Scalar>`: how particles meet the mesh. With
///                   `karabassi` a step ends where a particle is, and it touches what it then overlaps: one that moves
///                   farther than its radius in a step may pass through. With `karabassi_swept` it stops at each impact
///                   on its way, and passes through nothing.
/// \tparam Effect    what happens to a particle (effect.hpp, docs/simulation.md), in the order of the list. An
///                   integrator may be in the list too (integrators.hpp).
///
/// The state is in memory of the execution space, in columns: an array for each thing that is known of a particle.
/// There are exactly the columns that the effects name, and `position` and `velocity`. A simulation without effects
/// moves particles in straight lines, and nothing else.
///
/// `step` allocates nothing and never waits: it puts one kernel on the stream of a CUDA space (more with
/// `on_pair_contact` or `begin_step`), and can be captured in a CUDA graph, which is good until the next `set`,
/// `set_mesh` or `assign<radius>`. On the host it may make room for what contacts remember: see `to_host`. The same
/// steps give the same bits on every run, in every space (nvcc needs -fmad=false). O(particles + candidates) per step.
/// A simulation is for one thread at a time.
template <class Detector, class... Effect>
class simulation {
  static_assert(detail::is_detector<Detector>,
                "collide: the first parameter of a simulation is a detector, such as detector<bucket>");

 public:
  using detector_type = Detector;                               ///< the first parameter
  using execution_space = typename Detector::execution_space;   ///< that of the detector
  using scalar = typename Detector::scalar;                     ///< type of all numbers: float or double
  using effects_type = detail::effect_list<scalar, Effect...>;  ///< the effects with their parameters, for kernels

 private:
  using S = scalar;
  using broad_phase = typename Detector::broad_phase;
  using narrow_phase = typename Detector::narrow_phase;
  using index = typename broad_phase::template index<S>;
  using bodies_memory = detail::bodies_of<S, Effect...>;
  static constexpr bool has_bodies = bodies_memory::exist;
  static constexpr bool asks_mesh = effects_type::any_mesh_contact || effects_type::overlaps;

  static_assert(detail::check_effects<execution_space, S, Effect...>());
  static_assert(detail::check_clumps<execution_space, S, effects_type, Effect...>());
  static_assert(!effects_type::overlaps || detail::is_discrete<narrow_phase, S>,
                "collide: granular_contact, and other effects that press on the mesh by forces, see it where a step "
                "ends: take karabassi, and steps in which nothing moves farther than its radius");
  static_assert(
      !asks_mesh || detail::has_triangle_ref<index>::value,
      "collide: effects that touch the mesh need a broad phase whose index has a member mesh_lookup(), such as "
      "bucket or all_pairs");

 public:
  /// The state that a particle has.
  using columns = typename effects_type::all;
  /// Bytes of state of each particle: its columns; `bytes()` is what all takes.
  static constexpr std::size_t bytes_per_particle = detail::column_buffers<S, columns>::bytes_per_particle;
  /// Pointers to all columns, for kernels; see effects/detail/particle.hpp.
  using state_type = detail::particle_state<S, columns>;

  /// Without particles, with effects as they are by default. Stream and resource of the space must outlive it.
  explicit simulation(execution_space space = execution_space(), broad_phase options = broad_phase())
      : space_(std::move(space)), options_(std::move(options)), effects_(Effect()...) {}

  /// With parameters of all effects, in the order of the list.
  template <class... E, class = std::enable_if_t<detail::are_all_of<std::tuple<Effect...>, E...>>>
  explicit simulation(execution_space space, E... effects)
      : space_(std::move(space)), effects_(std::move(effects)...) {}
  /// With options of the broad phase, and parameters of all effects, in the order of the list.
  template <class... E, class = std::enable_if_t<detail::are_all_of<std::tuple<Effect...>, E...>>>
  simulation(execution_space space, broad_phase options, E... effects)
      : space_(std::move(space)), options_(std::move(options)), effects_(std::move(effects)...) {}

  // Other arguments end here, with a sentence instead of a list of candidates.
  template <class First, class... Argument,
            class = std::enable_if_t<
                !std::is_base_of<simulation, std::decay_t<First>>::value &&
                !detail::makes_simulation<execution_space, broad_phase, std::tuple<Effect...>, First, Argument...>>>
  explicit simulation(First&&, Argument&&...) : simulation() {
    static_assert(sizeof(First) == 0,
                  "collide: a simulation is made of a space, the options of the broad phase if there are any, and the "
                  "parameters of all effects, in the order of its list");
  }

  /// Copies particles from memory of the space: centres, radii, and three packed coordinates of velocity each (length
  /// per time), or null for particles that rest. The other columns get their initial values. `capacity` is for how many
  /// there is room, if an effect makes more; more than 2^32 - 2 are refused (`error`), as is room that no effect of the
  /// scene fills, and radii that differ without `polydisperse` in the scene. O(particles). Allocates; may wait.
  COLLIDE_COLD void set(sphere_view<S> const& particles, S const* velocities = nullptr, std::size_t capacity = 0) {
    std::size_t const n = particles.size(), places = detail::max(n, capacity);
    S const own = effects_.source_radius();
    detail::check_particles<columns>(particles.one_radius(), n, places, own, particles.common_radius());
    place(particles, velocities, places);
    radii_ = {particles.common_radius(), particles.common_radius(), S(0)};
    if (!particles.one_radius()) radii_ = detail::radius_range_of(*this);
    check_radii("set");
    radii_ = radii_.with(own);
    if constexpr (effects_type::any_pair_contact) neighbours_.clear(space_, places, radii_);
    if constexpr (effects_type::overlaps) surfaces_.clear(space_, places);
    know_smallest();
    prepare();
  }

  /// Makes room for up to so many particles, so that a later `set` takes no memory for them. There are none until
  /// then. More than 2^32 - 2 are refused (`error`).
  COLLIDE_COLD void reserve(std::size_t particles) {
    detail::check_places(particles);
    state_ = {};
    is_set_ = false;
    auto* const resource = space_.resource();
    memory_.reserve(resource, detail::padded_size(particles));
    if constexpr (has_begin_step) device_time_.reserve(resource, detail::clock_size);
    if constexpr (may_be_made) was_there_.reserve(resource, particles);
    if constexpr (effects_type::any_mesh_contact) {
      using kernel_type = detail::step_kernel<step_context<decltype(mesh_ref(S{}))>>;
      if constexpr (kernel_type::template has_many_tiles<typename execution_space::template block<kernel_type>>) {
        overflow_.reserve(resource, detail::padded_size(particles));
      }
    }
    if constexpr (effects_type::any_pair_contact) neighbours_.reserve(space_, particles);
    if constexpr (effects_type::overlaps) {
      surfaces_.reserve(resource, particles);
      pressing_.reserve(resource, particles);
      pressing_counts_.reserve(resource, 3);
      space_.fill(pressing_counts_.data(), 0, 3 * sizeof(std::uint32_t));
      if constexpr (!execution_space::host_accessible)
        overlaps_.reserve(resource, detail::max(particles, detail::overlap_pool::min_items));
    }
  }

  /// The mesh that particles touch, not copied: it must stay as it is while it is used. Call it again when the mesh has
  /// moved. An empty one is a mesh, too. Allocates if the mesh has grown; may wait. O(triangles).
  ///
  /// Only with `moving_bodies` in the scene (bodies.hpp): `bodies`, parts of the mesh that move, and `velocities` of
  /// all vertices (packed, in memory of the space) where the rest deforms: at the end of the next step, as the mesh is.
  /// `error` if there are more than 64 bodies, triangles not in the mesh or in two, or a motion is not finite.
  COLLIDE_COLD void set_mesh(mesh_view<S> mesh, std::vector<body> const& bodies = {}, S const* velocities = nullptr) {
    bodies_.check(bodies, mesh.size(), velocities);
    (detail::check_walls_of<Effect>(effects_, space_, mesh.size(), bodies.size()), ...);
    mesh_ = {};
    has_mesh_ = false;
    detail::lookup_space<execution_space> there(space_);
    if (mesh.size() != 0) detail::build_index(index_, there, options_, mesh);
    bodies_.build(space_, mesh, bodies, velocities);
    mesh_ = mesh;
    has_mesh_ = true;
    if constexpr (sweeps) {
      min_radius_ = 8 * std::numeric_limits<S>::epsilon() * detail::largest_coordinate(space_, mesh, mesh_summary_);
    }
    wake_all();  // what slept may have lost its support
    prepare();
    if (is_set_) release_stuck();
  }

  // Other scalar types end here.
  template <class T, class V = T, class = std::enable_if_t<!(std::is_same<T, S>::value && std::is_same<V, S>::value)>>
  void set(sphere_view<T> const&, V const* = nullptr, std::size_t = 0) {
    detail::reject_scalar<T>();
  }
  template <class T, class = std::enable_if_t<!std::is_same<T, S>::value>>
  void set_mesh(mesh_view<T>, std::vector<body> const& = {}, T const* = nullptr) {
    detail::reject_scalar<T>();
  }

  /// Advances by the time `dt`. Throws `error` if `dt` is not above 0 and finite, or longer than an effect allows
  /// (`largest_time_step` is shorter), if an effect's parameter makes no sense, before `set`, and before `set_mesh` if
  /// an effect touches the mesh; `cuda_error` if a kernel cannot be launched. Does not wait; allocates nothing, but on
  /// the host for neighbours beyond the room of `reserve`. O(n) for n particles, and their contacts.
  void step(S dt) {
    check_step(dt);
    if (!knows_pair_forces()) meet(state_, dt);
    time_ += static_cast<double>(dt);
    begin_step(dt);
    if (state_.size == 0) return;
    meet(state_, dt);
    end_step(dt);
  }

  /// Advances `n` times by `dt`; throws what `step` throws, and `error` if `n` was negative.
  void steps(std::size_t n, S dt) {
    if (n > std::numeric_limits<std::size_t>::max() / 2)
      throw error("collide: simulation: the number of steps is negative");
    while (n-- > 0) step(dt);
  }

  /// The sum of the steps since `set`. Steps of a CUDA graph that replays them do not count.
  double time() const { return time_; }

  /// Bytes of memory for the particles: columns, room for more, what steps need, such as lists of neighbours, and what
  /// is known of bodies: a byte a triangle, about 700 bytes a body. What is prepared of the mesh is not in it.
  std::size_t bytes() const {
    std::size_t lists = 0;
    if constexpr (effects_type::any_pair_contact) lists = neighbours_.bytes();
    if constexpr (effects_type::overlaps) lists += surfaces_.bytes() + pressing_.bytes() + overlaps_.bytes();
    return memory_.bytes() + device_time_.bytes() + was_there_.bytes() + overflow_.bytes() + bodies_.bytes() + lists;
  }

  /// Number of particles, or of places for them, if an effect makes or removes some; see `alive`.
  std::size_t size() const { return state_.size; }

  /// A column in memory of the space: three coordinates a particle, or one number. Valid until the next `set`. Kernels
  /// on the space's stream read and write it between steps; for the host there is `to_host<Column>()`.
  template <class Column>
  detail::column_element<Column, S>* data() const {
    check<Column>();
    return state_.at(Column{});
  }

  /// A copy of a column. Waits. Throws `error` on a GPU if contacts have found no room for what they remember: lists of
  /// more than sixteen neighbours have room for as many as there are particles, or were in the largest `reserve`. The
  /// host makes more room.
  template <class Column>
  std::vector<detail::column_element<Column, S>> to_host() const {
    check<Column>();
    check_contacts();
    std::vector<detail::column_element<Column, S>> copy(numbers<Column>());
    space_.copy_to_host(copy.data(), state_.at(Column{}), copy.size());
    return copy;
  }

  /// Gives all particles a column's values, from memory of the space, in the order of the stream. Waits if that is
  /// `radius` or `material`. If it says where particles are, how they move, what they are, or which there are, all that
  /// sleeps is woken, as by what accelerates it; what adhered and does not touch the mesh any more is free. What is
  /// written by way of `data` wakes nothing. Throws `error` if a radius is not finite, or 0 where particles touch a
  /// mesh.
  template <class Column>
  void assign(detail::column_element<Column, S> const* values) {
    check<Column>();
    space_.for_each(numbers<Column>(),
                    detail::copy_values<detail::column_element<Column, S>>{values, state_.at(Column{})});
    if constexpr (std::is_same<Column, radius>::value) {
      S const largest = radii_.largest;  // effects may let particles grow up to it
      radii_ = detail::radius_range_of(*this);
      radii_.largest = detail::max(radii_.largest, largest);
      check_radii("assign");
      if constexpr (effects_type::any_pair_contact) {
        if (is_set_) neighbours_.fit(space_, state_.size, radii_);
      }
      prepare_index();
    }
    if constexpr (effects_type::has_clumps) assign_clumps<Column>();
    if constexpr (std::is_same<Column, radius>::value || std::is_same<Column, material>::value) know_smallest();
    constexpr bool moves = detail::contains<collide::columns<velocity, angular_velocity>, Column> ||
                           detail::contains<typename effects_type::acceleration_reads, Column>;
    constexpr bool meets_others = detail::contains<
        collide::columns<position, radius, material, alive, clump_centre, clump_rotation, clump_offset, in_clump>,
        Column>;
    if constexpr (moves || meets_others) wake_all();
    if constexpr (meets_others) {
      next_meeting_ = effects_type::ends_after_meeting ? detail::meeting::of_all : detail::meeting::in_step;
      if (has_mesh_) release_stuck();
    }
  }

  /// Gives all particles a column's values, from a container such as std::vector or thrust::device_vector, whose memory
  /// is that of the space. Throws `error` if it has another size than the column.
  template <class Column, class Container, class = decltype(std::declval<Container const&>().size())>
  void assign(Container const& values) {
    if (std::size_t(values.size()) != numbers<Column>())
      throw error("collide: simulation: assign: there are " + std::to_string(values.size()) + " values for " +
                  std::to_string(numbers<Column>()) + " numbers of the column");
    assign<Column>(detail::raw_pointer(values.data()));
  }

  /// The particles as spheres, for a query. They move with the steps; valid until the next `set`.
  sphere_view<S> spheres() const {
    S const* const xyz = state_.at(position{});
    if constexpr (detail::contains<columns, radius>) {
      return spheres_xyz(xyz, state_.size, static_cast<S const*>(state_.at(radius{})));
    } else {
      return spheres_xyz(xyz, state_.size, state_.common_radius);
    }
  }

  /// The parameters of an effect, to be changed between steps. All that sleeps is woken, as what holds it may be
  /// another then; but not by a source, or by `moving_bodies`, which wake what they touch. O(1), or with `sleep`
  /// O(particles); does not wait. With both `sleep` and `velocity_verlet` particles then meet once more in the next
  /// step, and on ranks may migrate.
  template <class E>
  E& effect() {
    check_effect<E>();
    if constexpr (!detail::is_source<E> && !detail::is_moving_bodies<E>) wake_all();
    return effects_.template of<E>();
  }
  /// The parameters of an effect, to be read.
  template <class E>
  E const& effect() const {
    check_effect<E>();
    return effects_.template of<E>();
  }

  /// Counts of a source since `set`; see `birth_counts`. Waits.
  birth_counts births() const {
    static_assert(effects_type::makes, "collide: simulation: births: no effect of the scene makes particles");
    double clock[detail::clock_size] = {};
    if (state_.time != nullptr) space_.copy_to_host(clock, state_.time, detail::clock_size);
    return detail::births_of(clock);
  }

  /// The bodies of the mesh, in a scene with `moving_bodies`: where they are; see `body_memory`.
  bodies_memory const& bodies() const { return bodies_; }

  state_type const& state() const { return state_; }       ///< pointers to all columns, valid until the next `set`
  execution_space& space() { return space_; }              ///< for work of your own on its stream, and to wait
  execution_space const& space() const { return space_; }  ///< the space

 private:
  friend class detail::checkpoint<Detector, Effect...>;
  friend class detail::part_of_simulation<simulation>;
  template <class D, class... E>
  friend struct detail::mesh_contacts_of;
  template <class D, class... E>
  friend double largest_time_step(simulation<D, E...> const&);

  static constexpr bool sweeps = effects_type::any_mesh_contact && !detail::is_discrete<narrow_phase, S>;
  static constexpr bool has_begin_step = (detail::has_begin_step<Effect, execution_space, state_type, S> || ...);
  /// Effects other than sources that may make particles in their `begin_step`.
  template <class E>
  static constexpr bool may_make = !detail::is_source<E> && detail::has_begin_step<E, execution_space, state_type, S> &&
                                   detail::contains<detail::writes_of<E>, alive>;
  static constexpr bool may_be_made = (may_make<Effect> || ...);
  template <class Triangles>
  using step_context = detail::step_context<S, narrow_phase, Triangles, effects_type>;
  /// True if each pair is evaluated once: where a thread is alone in its block, as on a CPU.
  static constexpr bool meets_once = effects_type::meets_once && detail::works_alone<execution_space>;
  using neighbour_lists = std::conditional_t<effects_type::any_pair_contact,
                                             detail::verlet_list<S, effects_type, meets_once>, detail::absent>;
  using surface_memory =
      std::conditional_t<effects_type::overlaps, detail::surface_memory<S, typename effects_type::remembered>,
                         detail::absent>;
  /// The triangles near a particle, for a step that `Asks` for them.
  template <bool Asks = effects_type::any_mesh_contact>
  auto mesh_ref([[maybe_unused]] S dt) const {
    if constexpr (Asks) {
      auto const whole = mesh_.size() != 0 ? index_.mesh_lookup() : std::decay_t<decltype(index_.mesh_lookup())>{};
      return bodies_.ref(whole, mesh_, dt);
    } else {
      return detail::absent{};
    }
  }

  /// Gives the spheres of clumps what has been assigned to these.
  template <class Column>
  void assign_clumps() {
    static_assert(!detail::contains<collide::columns<position, velocity, angular_velocity, radius>, Column>,
                  "collide: assign: in a scene with clumps set_clumps says where spheres are, and how they move");
    if constexpr (detail::contains<detail::union_of<typename clumps::writes, collide::columns<material>>, Column>)
      space_.for_each(state_.size, detail::place_clumps<S, effects_type>{state_, effects_.space()});
    if constexpr (std::is_same<Column, in_clump>::value) {
      if (is_set_) neighbours_.fit(space_, state_.size, radii_);
    }
  }

  /// Finds out by which radii effects limit steps. A source's particles are of material 0. May wait.
  COLLIDE_COLD void know_smallest() {
    constexpr bool changes_materials = (detail::contains<detail::writes_of<Effect>, material> || ...);
    smallest_ = detail::smallest_radii_of(*this, radii_, !changes_materials);
    if (double const own = static_cast<double>(effects_.source_radius()); own > 0)
      smallest_.of_material[0] = detail::min(smallest_.of_material[0], own);
  }

  /// Puts particles into new columns, with places for more.
  COLLIDE_COLD void place(sphere_view<S> const& particles, S const* velocities, std::size_t places) {
    reserve(places);
    state_ = memory_.state(places, particles.size(), particles.common_radius());
    if constexpr (has_begin_step) {
      state_.time = device_time_.data();
      space_.fill(state_.time, 0, detail::clock_size * sizeof(double));
    }
    time_ = 0;
    next_meeting_ = effects_type::ends_after_meeting ? detail::meeting::of_all : detail::meeting::in_step;
    space_.for_each(detail::padded_size(places), detail::initial(state_, particles, velocities, effects_));
    is_set_ = true;
  }

  /// The part of a step before particles meet.
  void begin_step(S dt) {
    (begin_step_of<Effect>(dt), ...);
    if constexpr (effects_type::makes && effects_type::remembers_surfaces) {
      if (effects_.due(static_cast<double>(dt)) > 0)
        space_.for_each(state_.size,
                        detail::forget_surfaces<effects_type, state_type>{state_, surfaces_.ref(state_.size).counts});
    }
    effects_.prepare(dt);
    if constexpr (effects_type::keeps_mesh_kicks)
      space_.for_each(state_.size,
                      detail::record_first_kicks<S, effects_type>{state_, effects_, dt, mesh_.size(), bodies_.size()});
    advance_bodies(static_cast<double>(dt), false);
    if constexpr (has_begin_step)
      space_.for_each(1, detail::advance_time{state_.time, double(dt), effects_.due(static_cast<double>(dt))});
    if constexpr (effects_type::ends_after_meeting) move(dt);
    if constexpr (effects_type::has_clumps)
      space_.for_each(state_.size, detail::move_clumps<S, effects_type>{state_, effects_, effects_.space(), dt});
    wake_by_bodies(dt);
    wake_where_others_went(dt);
  }

  /// Lets an effect begin a step. What it makes begins anew in all that it does not write.
  template <class E>
  void begin_step_of(S dt) {
    if constexpr (may_make<E>)
      space_.for_each(state_.size, detail::copy_values<std::uint8_t>{state_.at(alive{}), was_there_.data()});
    detail::begin_step_of<E>(effects_, space_, state_, dt);
    if constexpr (may_make<E>) begin_anew<detail::writes_of<E>>();
  }
  template <class Written>
  void begin_anew() {
    using kept = detail::union_of<Written, collide::columns<position, velocity, radius, global_number>>;
    using initial = detail::difference_of<columns, kept>;
    std::uint8_t* surfaces = nullptr;
    if constexpr (effects_type::remembers_surfaces) surfaces = surfaces_.ref(state_.size).counts;
    space_.for_each(state_.size, detail::begin_anew<S, effects_type, initial>{state_, was_there_.data(), surfaces});
  }

  /// Particles meet, among them copies of other ranks' in `with_copies`.
  void meet([[maybe_unused]] state_type const& with_copies, [[maybe_unused]] S dt) {
    [[maybe_unused]] detail::meeting const what = next_meeting_;
    next_meeting_ = detail::meeting::in_step;
    if (state_.size == 0) return;
    if (what != detail::meeting::in_step && !bodies_.are_placed())
      advance_bodies(0, true);  // those that the caller drives, to where they begin
    bool const keeps_kicks = what == detail::meeting::of_woken;
    if constexpr (effects_type::any_pair_contact) {
      if (!keeps_kicks || !effects_type::keeps_support) {
        neighbours_.renew(space_, with_copies, effects_.space());
        settle_births(with_copies, dt);
        neighbours_.interact(space_, with_copies, effects_, dt, what);
      }
    } else if (!keeps_kicks) {
      forget_pair_kicks();
    }
    if constexpr (effects_type::overlaps) {
      auto const memory = surfaces_.ref(state_.size);
      auto const triangles = mesh_ref<true>(dt);
      using mesh_type = std::decay_t<decltype(triangles)>;
      using memory_type = std::decay_t<decltype(memory)>;
      detail::pressing_list const pressing{pressing_counts_.data(), pressing_.data()};
      clear_overlap_pool();
      using list_type = detail::list_pressing<S, effects_type, mesh_type, memory_type>;
      std::uint32_t const lanes = list_type::template lanes_for<execution_space>(state_.size);
      space_.for_each(lanes * state_.size, list_type{state_, effects_, triangles, memory, pressing, what, lanes});
      std::size_t const threads = execution_space::host_accessible ? 0 : std::size_t{1} << 15;  // of a large device
      space_.for_each(detail::max(state_.size, threads),
                      detail::press_on_mesh<S, effects_type, mesh_type, memory_type>{
                          state_, effects_, triangles, memory, pressing, overlap_pool(), dt, what, threads});
    }
  }
  /// Before copies are there, if lists of neighbours are not to be made anew, particles meet that need none.
  void meet_inside(state_type const& with_copies, S dt) {
    neighbours_.interact_inside(space_, with_copies, effects_, dt);
  }
  detail::overlap_pool overlap_pool() const {
    return {overlaps_.data(), static_cast<std::uint32_t>(overlaps_.capacity()), pressing_counts_.data() + 1,
            pressing_counts_.data() + 2};
  }
  /// Empties the pool, and the list of those that press on the mesh.
  void clear_overlap_pool() const { space_.fill(pressing_counts_.data(), 0, 2 * sizeof(std::uint32_t)); }
  /// Says which of those that a source has made overlap others, once the lists are renewed.
  void settle_births([[maybe_unused]] state_type const& with_copies, [[maybe_unused]] S dt) {
    if constexpr (effects_type::makes) {
      if (effects_.due(static_cast<double>(dt)) > 0)
        neighbours_.settle_births(space_, with_copies, effects_.makes_only_where_free());
    }
    if constexpr (may_be_made && effects_type::remembered::size != 0)
      space_.for_each(state_.size, detail::take_marks_off{state_.at(alive{})});
  }
  void forget_pair_kicks() {
    if constexpr (effects_type::keeps_pair_forces) forget_pair_kicks(typename effects_type::interaction_kicks{});
  }
  template <class... Kick>
  void forget_pair_kicks(collide::columns<Kick...>) {
    (space_.fill(state_.at(Kick{}), 0, 3 * state_.size * sizeof(S)), ...);
  }

  /// The part of a step after particles have met.
  void end_step(S dt) {
    if constexpr (effects_type::has_clumps)
      space_.for_each(state_.size, detail::end_clumps<S, effects_type>{state_, effects_, effects_.space(), dt});
    if constexpr (effects_type::ends_after_meeting) {
      space_.for_each(state_.size, detail::end_particles<S, effects_type>{state_, effects_, dt});
    } else {
      move(dt);
    }
  }

  /// Moves particles, and resolves their contacts with the mesh.
  void move(S dt) {
    if (state_.size == 0) return;
    using kernel_type = detail::step_kernel<step_context<decltype(mesh_ref(dt))>>;
    kernel_type const kernel{{state_, effects_, mesh_ref(dt), overflow_.data(), dt, reverse_order_, min_radius_},
                             kernel_type::grid_size(space_, state_.size)};
    reverse_order_ = !reverse_order_;
    space_.launch(kernel.blocks, kernel);
  }

  /// Sleepers wake. What others do to them is known where they press on what they lie on, but not what walls do by
  /// forces. Those that are awake know all.
  void wake_all() {
    if constexpr (detail::contains<columns, slow_steps>) {
      if (state_.size == 0) return;
      constexpr bool asks_forces =
          effects_type::ends_after_meeting && (effects_type::overlaps || !effects_type::keeps_support);
      if constexpr (asks_forces && detail::contains<columns, in_contact>) {
        space_.for_each(state_.size, detail::wake_between_steps<S, effects_type>{state_, effects_});
        if (knows_pair_forces()) next_meeting_ = detail::meeting::of_woken;
      } else {
        space_.fill(data<slow_steps>(), 0, state_.size);
      }
    }
  }
  bool knows_pair_forces() const { return next_meeting_ == detail::meeting::in_step; }

  /// Wakes particles that sleep where a body that moves may touch them: before ranks tell each other what is awake, and
  /// before lists of neighbours copy it.
  void wake_by_bodies([[maybe_unused]] S dt) {
    if constexpr (effects_type::overlaps && has_bodies &&
                  detail::contains<typename effects_type::inactive_reads, slow_steps>) {
      auto const triangles = mesh_ref<true>(dt);
      using mesh_type = std::decay_t<decltype(triangles)>;
      space_.for_each(state_.size, detail::wake_by_bodies<S, effects_type, mesh_type>{state_, effects_, triangles});
    }
  }

  /// A source whose places have all been filled takes some from others, on which something may sleep: all of that is
  /// woken. Where half of a step is over by then, what held it has held it so long: so it is with what is awake.
  void wake_where_others_went([[maybe_unused]] S dt) {
    if constexpr (effects_type::makes && effects_type::any_pair_contact && detail::contains<columns, slow_steps>) {
      if (effects_.due(static_cast<double>(dt)) > 0 && !effects_.makes_only_where_free())
        space_.for_each(state_.size, detail::wake_where_others_went<state_type>{state_});
    }
  }

  /// Frees particles that stick to the mesh and do not touch it any more.
  void release_stuck() {
    if constexpr (effects_type::adheres) {
      space_.for_each(state_.size, detail::release_stuck{state_, mesh_ref(S(0)), bodies_.are_driven(), bodies_.size()});
    }
  }

  /// Moves the bodies on by `dt`, or, if they start, to where they are at this time.
  void advance_bodies(double dt, bool start) {
    if constexpr (has_bodies) {
      if (state_.time == nullptr) return;
      auto const& motion = effects_.template of<moving_bodies<typename bodies_memory::motion>>().motion;
      bodies_.advance(space_, motion, state_.time, dt, radii_.smallest, sweeps, start);
    }
  }

  template <class E>
  static constexpr void check_effect() {
    static_assert((std::is_same<E, Effect>::value || ...),
                  "collide: effect<E>() gives the parameters of an effect that is in the simulation's list");
  }
  template <class Column>
  static constexpr void check() {
    static_assert(detail::contains<columns, Column>,
                  "collide: no effect of this simulation names the column, so it does not have it");
  }

  template <class Column>
  std::size_t numbers() const {
    return state_.size * std::size_t(detail::column_layout<Column, S>::width);
  }

  COLLIDE_COLD void check_radii(char const* member) const {
    if (asks_mesh && state_.placed != 0 && radii_.smallest == 0)
      throw error(std::string("collide: simulation: ") + member + ": radii of particles that touch a mesh are above 0");
    if (detail::contains<columns, radius> && state_.placed != 0 && !detail::is_finite(radii_.largest))
      throw error(std::string("collide: simulation: ") + member + ": radii are finite");
  }

  COLLIDE_COLD void prepare() {
    advance_bodies(0, true);
    prepare_index();
  }
  COLLIDE_COLD void prepare_index() {
    if constexpr (asks_mesh) {
      constexpr bool is_part = detail::contains<columns, global_number>;  // others come from other ranks
      std::size_t const n = detail::max(state_.size, std::size_t{is_part});
      if (mesh_.size() == 0 || n == 0 || !is_set_) return;
      detail::lookup_space<execution_space> there(space_);
      S const margin = sweeps || detail::contains<columns, radius> ? S(0) : S(bodies_.margin());
      S const reached = detail::reach_of<effects_type>(detail::max(radii_.largest, min_radius_)) + margin;
      bool const wider = is_part || (radii_.largest >= 0 && radii_.largest < reached);
      detail::prepare_index(index_, there, options_,
                            wider ? spheres_xyz(state_.at(position{}), n, reached) : spheres());
    }
  }

  COLLIDE_COLD void check_step(S dt) const {
    if (!is_set_) throw error("collide: simulation: step needs particles: call set before it");
    if (asks_mesh && !has_mesh_)
      throw error("collide: simulation: an effect of the scene touches the mesh: call set_mesh before step");
    if (!(dt > 0) || !detail::is_finite(dt))
      throw error("collide: simulation: the time dt of a step is finite and above 0");
    ((detail::check_parameters_of<Effect>(effects_), detail::check_bodies_of<Effect>(effects_, bodies_.size()),
      detail::check_materials_of<Effect>(effects_, smallest_)),
     ...);
    (check_box_of<Effect>(), ...);
    if constexpr (effects_type::repeats) check_sides();
    ((detail::check_time_step_of<Effect>(effects_, dt, smallest_)), ...);
    if (!effects_type::any_pair_contact && effects_.makes_only_where_free())
      throw error("collide: emit: only_where_free needs an effect by which particles meet, such as sphere_contact");
  }

  /// Nothing goes on in silence without what contacts should remember.
  void check_contacts() const {
    if constexpr (effects_type::any_pair_contact && effects_type::remembered::size != 0 &&
                  !execution_space::host_accessible) {
      if (is_set_ && neighbours_.has_forgotten(space_))
        throw error(
            "collide: simulation: contacts have found no room for what they remember, as many particles have "
            "more than 16 neighbours: call reserve with several times as many particles before set, and begin "
            "anew");
    }
    if constexpr (effects_type::overlaps && !execution_space::host_accessible) {
      if (is_set_ && space_.read(pressing_counts_.data() + 2) != 0)
        throw error(
            "collide: simulation: particles that overlap more than 16 triangles each have found no room for all of "
            "them: call reserve with several times as many particles before set, and begin anew");
    }
  }

  /// Rounded to numbers of this type, the bounds of a box that repeats are bounds, too.
  template <class E>
  COLLIDE_COLD void check_box_of() const {
    if constexpr (detail::repeats_space<E>) {
      auto const& box = effects_.template of<E>();
      for (int k = 0; k < 3; ++k) {
        S const low = static_cast<S>(box.lower[k]), high = static_cast<S>(box.upper[k]);
        detail::check_parameter(detail::is_finite(low) && detail::is_finite(high) && low < high,
                                "periodic_box: the bounds are finite and differ in the simulation's type of numbers");
      }
    }
  }

  /// Two particles must not meet on both sides at once.
  COLLIDE_COLD void check_sides() const {
    auto shortest = 2 * static_cast<double>(neighbour_lists::width_of(radii_.largest, radii_.smallest));
    if constexpr (effects_type::has_clumps)
      shortest = detail::max(shortest, 2.1 * effects_.template of<clumps>().reach);
    auto const space = effects_.space();
    for (int k = 0; k < 3; ++k) {
      if (space.length(k) >= shortest) continue;
      throw error("collide: periodic_box: particles meet across its sides, and so each must be at least " +
                  std::to_string(shortest) +
                  " long, two diameters of the largest with the skin of its neighbours, or a clump: make " +
                  "the box larger, or the particles smaller");
    }
  }

  execution_space space_;
  broad_phase options_;
  effects_type effects_;
  mesh_view<S> mesh_;
  index index_;
  detail::column_buffers<S, columns> memory_;
  state_type state_{};
  bool is_set_ = false, has_mesh_ = false, reverse_order_ = false;  ///< the last one is of the next step
  detail::meeting next_meeting_ = detail::meeting::in_step;  ///< between steps, if the next begins with unknown forces
  double time_ = 0;
  buffer<double> device_time_;      ///< for effects with a member begin_step
  buffer<std::uint8_t> was_there_;  ///< `alive` when a step begins, for effects that make particles
  detail::radius_range<S> radii_;
  smallest_radii smallest_;
  S min_radius_ = 0;
  buffer<detail::mesh_statistics<S>> mesh_summary_;
  neighbour_lists neighbours_;
  surface_memory surfaces_;
  buffer<id> overflow_;
  buffer<detail::pressing_particle> pressing_;  ///< particles that may press on the mesh, and how many they are
  buffer<std::uint32_t> pressing_counts_;       ///< of those, of used `overlaps_`, and whether they were too few
  buffer<detail::overlap_item> overlaps_;       ///< of a device, for particles that overlap many triangles
  bodies_memory bodies_;
};

/// A step that is good for springs between particles: a twentieth of the shortest time in which two collide, with
/// `hertz` a quarter of the time in which a wave crosses a particle; infinite if no effect limits steps. In a dense bed
/// under load, where each is pressed by several, take a quarter of it again. Materials that only walls have do not
/// count; those of particles are known from `set` and `assign`. O(effects); it does not wait. See
/// `sphere_contact::longest_step`, `granular_contact::longest_step`.
template <class Detector, class... Effect>
double largest_time_step(simulation<Detector, Effect...> const& of) {
  double longest = std::numeric_limits<double>::infinity();
  ((longest = detail::min(longest, detail::longest_step_of<Effect>(of.effects_, of.smallest_) / 4)), ...);
  return longest;
}

}  // namespace collide
