/// \file
/// Particles that move, and collide with a mesh and with each other: a detector and the effects that a scene names.
#pragma once

#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <collide/detector.hpp>
#include <collide/effects/detail/check_effect.hpp>
#include <collide/simulation/detail/preparation.hpp>
#include <collide/simulation/detail/step_phases.hpp>
#if defined(COLLIDE_COMPILED)
#include <collide/simulation/detail/step/compiled_search.hpp>
#endif

namespace collide {

namespace detail {

/// True if `E` are the parameters of all effects, of which there are some.
template <class Effects, class... E>
inline constexpr bool are_all_of = sizeof...(E) > 0 && std::is_same<std::tuple<E...>, Effects>::value;

/// True if `Rest` is nothing, or the parameters of all effects.
template <class Effects, class... Rest>
inline constexpr bool are_parameters = sizeof...(Rest) == 0 || std::is_same<std::tuple<Rest...>, Effects>::value;

/// True if the arguments after the space are the options of the broad phase, and then the parameters of all effects or
/// nothing.
template <class Options, class Effects, class... Argument>
inline constexpr bool starts_with_options = false;
template <class Options, class Effects, class First, class... Rest>
inline constexpr bool starts_with_options<Options, Effects, First, Rest...> =
    std::is_convertible<First, Options>::value&& are_parameters<Effects, std::decay_t<Rest>...>;

/// True for the arguments of a constructor of a simulation with such a space, options of the broad phase and effects.
template <class Space, class Options, class Effects, class First, class... Argument>
inline constexpr bool makes_simulation = std::is_convertible<First, Space>::value &&
                                         (are_parameters<Effects, std::decay_t<Argument>...> ||
                                          starts_with_options<Options, Effects, Argument...>);

/// Refuses another scalar type than the simulation's.
template <class T>
constexpr void reject_scalar() {
  static_assert(sizeof(T) == 0,
                "collide: particles, their velocities and the mesh must have the scalar type of the simulation's "
                "detector, its fourth parameter: nothing is narrowed silently");
}

}  // namespace detail

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
  using state_of_all = detail::simulation_state<Detector, Effect...>;
  using bodies_memory = detail::bodies_of<S, Effect...>;

  static_assert(detail::check_effects<execution_space, S, Effect...>());
  static_assert(detail::check_clumps<execution_space, S, effects_type, Effect...>());
  static_assert(!effects_type::overlaps || detail::is_discrete<narrow_phase, S>,
                "collide: granular_contact, and other effects that press on the mesh by forces, see it where a step "
                "ends: take karabassi, and steps in which nothing moves farther than its radius");
  static_assert(
      !(effects_type::any_mesh_contact || effects_type::overlaps) ||
          detail::is_valid<detail::index_mesh_lookup, typename broad_phase::template index<S>>,
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
      : all_{std::move(space), std::move(options), effects_type(Effect()...)} {}

  /// With parameters of all effects, in the order of the list.
  template <class... E, class = std::enable_if_t<detail::are_all_of<std::tuple<Effect...>, E...>>>
  explicit simulation(execution_space space, E... effects)
      : all_{std::move(space), broad_phase(), effects_type(std::move(effects)...)} {}
  /// With options of the broad phase, and parameters of all effects, in the order of the list.
  template <class... E, class = std::enable_if_t<detail::are_all_of<std::tuple<Effect...>, E...>>>
  simulation(execution_space space, broad_phase options, E... effects)
      : all_{std::move(space), std::move(options), effects_type(std::move(effects)...)} {}

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
    S const own = all_.effects.source_radius();
    detail::check_particles<columns>(particles.one_radius(), n, places, own, particles.common_radius());
    prepare().place(particles, velocities, places);
    all_.radii = {particles.common_radius(), particles.common_radius(), S(0)};
    if (!particles.one_radius()) all_.radii = prepare().radii_of_particles();
    prepare().check_radii("set");
    all_.radii = all_.radii.with(own);
    if constexpr (effects_type::any_pair_contact) all_.neighbours.clear(all_.space, places, all_.radii);
    if constexpr (effects_type::overlaps) all_.surfaces.clear(all_.space, places);
    prepare().know_smallest();
    prepare().bodies_and_index();
  }

  /// Makes room for up to so many particles, so that a later `set` takes no memory for them. There are none until
  /// then. More than 2^32 - 2 are refused (`error`).
  COLLIDE_COLD void reserve(std::size_t particles) { prepare().reserve(particles); }

  /// The mesh that particles touch, not copied: it must stay as it is while it is used. Call it again when the mesh has
  /// moved. An empty one is a mesh, too. Allocates if the mesh has grown; may wait. O(triangles).
  ///
  /// Only with `moving_bodies` in the scene (bodies.hpp): `bodies`, parts of the mesh that move, and `velocities` of
  /// all vertices (packed, in memory of the space) where the rest deforms: at the end of the next step, as the mesh is.
  /// `error` if there are more than 64 bodies, triangles not in the mesh or in two, or a motion is not finite.
  COLLIDE_COLD void set_mesh(mesh_view<S> mesh, std::vector<body> const& bodies = {}, S const* velocities = nullptr) {
    all_.bodies.check(bodies, mesh.size(), velocities);
    (detail::check_walls_of(all_.effects.template of<Effect>(), all_.space, mesh.size(), bodies.size()), ...);
    all_.mesh = {};
    all_.has_mesh = all_.is_pressing_known = false;
    detail::lookup_space<execution_space> there{all_.space};
    if (mesh.size() != 0) detail::build_index(all_.index, there, all_.options, mesh);
    all_.bodies.build(all_.space, mesh, bodies, velocities);
    all_.mesh = mesh;
    all_.has_mesh = true;
    if constexpr (state_of_all::sweeps) {
      all_.min_radius =
          8 * std::numeric_limits<S>::epsilon() * detail::largest_coordinate(all_.space, mesh, all_.mesh_summary);
    }
    phases().wake_all();  // what slept may have lost its support
    prepare().bodies_and_index();
    if (all_.is_set) phases().release_stuck();
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
  /// the host beyond the room of `reserve`. O(n) for n particles, and their contacts.
  void step(S dt) {
    auto happens = phases();
    happens.check_step(dt);
    if (!happens.knows_pair_forces()) happens.meet(all_.particles, dt);
    all_.time += static_cast<double>(dt);
    happens.begin_step(dt);
    if (all_.particles.size == 0) return;
    happens.meet(all_.particles, dt);
    happens.end_step(dt);
  }

  /// Advances `n` times by `dt`; throws what `step` throws, and `error` if `n` was negative.
  void steps(std::size_t n, S dt) {
    if (n > std::numeric_limits<std::size_t>::max() / 2)
      throw error("collide: simulation: the number of steps is negative");
    constexpr std::size_t fewest = 16;  // for which another order pays
    struct in_cell_order {
      detail::step_phases<Detector, Effect...> of;
      bool is_taken;
      ~in_cell_order() {
        if (is_taken) of.leave_cell_order();
      }
    } const order{phases(), all_.is_set && n >= fewest};
    if (order.is_taken) phases().take_cell_order();
    while (n-- > 0) step(dt);
  }

  /// The sum of the steps since `set`. Steps of a CUDA graph that replays them do not count.
  double time() const { return all_.time; }

  /// Bytes of memory for the particles: columns, room for more, what steps need, such as lists of neighbours, and what
  /// is known of bodies: a byte a triangle, about 700 bytes a body. What is prepared of the mesh is not in it.
  std::size_t bytes() const {
    std::size_t lists = 0;
    if constexpr (effects_type::any_pair_contact) lists = all_.neighbours.bytes();
    if constexpr (effects_type::overlaps)
      lists += all_.surfaces.bytes() + all_.pressing.bytes() + all_.overlaps.bytes();
    return all_.memory.bytes() + all_.device_time.bytes() + all_.was_there.bytes() + all_.overflow.bytes() +
           all_.bodies.bytes() + all_.order.names.bytes() + lists;
  }

  /// Number of particles, or of places for them, if an effect makes or removes some; see `alive`.
  std::size_t size() const { return all_.particles.size; }

  /// A column in memory of the space: three coordinates a particle, or one number. Valid until the next `set`. Kernels
  /// on the space's stream read and write it between steps; for the host there is `to_host<Column>()`.
  template <class Column>
  detail::column_element<Column, S>* data() const {
    check<Column>();
    return all_.particles.at(Column{});
  }

  /// A copy of a column. Waits. Throws `error` on a GPU if contacts have found no room for what they remember: lists of
  /// more than sixteen neighbours have room for as many as there are particles, or were in the largest `reserve`. The
  /// host makes more room.
  template <class Column>
  std::vector<detail::column_element<Column, S>> to_host() const {
    check<Column>();
    return detail::column_on_host<Column>(all_);
  }

  /// Gives all particles a column's values, from memory of the space, in the order of the stream. Waits if that is
  /// `radius` or `material`. If it says where particles are, how they move, what they are, or which there are, all that
  /// sleeps is woken, as by what accelerates it; what adhered and does not touch the mesh any more is free. What is
  /// written by way of `data` wakes nothing. Throws `error` if a radius is not finite, or 0 where particles touch a
  /// mesh.
  template <class Column>
  void assign(detail::column_element<Column, S> const* values) {
    check<Column>();
    all_.space.for_each(numbers<Column>(),
                        detail::copy_values<detail::column_element<Column, S>>{values, all_.particles.at(Column{})});
    if constexpr (std::is_same<Column, radius>::value) {
      S const largest = all_.radii.largest;  // effects may let particles grow up to it
      all_.radii = prepare().radii_of_particles();
      all_.radii.largest = detail::max(all_.radii.largest, largest);
      prepare().check_radii("assign");
      if constexpr (effects_type::any_pair_contact) {
        if (all_.is_set) all_.neighbours.fit(all_.space, all_.particles.size, all_.radii);
      }
      prepare().index();
    }
    if constexpr (effects_type::has_clumps) prepare().template assign_clumps<Column>();
    if constexpr (std::is_same<Column, radius>::value || std::is_same<Column, material>::value)
      prepare().know_smallest();
    constexpr bool moves = detail::contains<collide::columns<velocity, angular_velocity>, Column> ||
                           detail::contains<typename effects_type::acceleration_reads, Column>;
    constexpr bool meets_others = detail::contains<
        collide::columns<position, radius, material, alive, clump_centre, clump_rotation, clump_offset, in_clump>,
        Column>;
    if constexpr (moves || meets_others) phases().wake_all();
    if constexpr (meets_others) {
      all_.next_meeting = effects_type::ends_after_meeting ? detail::meeting::of_all : detail::meeting::in_step;
      if (all_.has_mesh) phases().release_stuck();
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
  sphere_view<S> spheres() const { return detail::spheres_of(all_.particles); }

  /// The parameters of an effect, to be changed between steps. All that sleeps is woken, as what holds it may be
  /// another then; but not by a source, or by `moving_bodies`, which wake what they touch. O(1), or with `sleep`
  /// O(particles); does not wait. With both `sleep` and `velocity_verlet` particles then meet once more in the next
  /// step, and on ranks may migrate.
  template <class E>
  E& effect() {
    check_effect<E>();
    if constexpr (!detail::is_source<E> && !detail::is_moving_bodies<E>) phases().wake_all();
    return all_.effects.template of<E>();
  }
  /// The parameters of an effect, to be read.
  template <class E>
  E const& effect() const {
    check_effect<E>();
    return all_.effects.template of<E>();
  }

  /// Counts of a source since `set`; see `birth_counts`. Waits.
  birth_counts births() const {
    static_assert(effects_type::makes, "collide: simulation: births: no effect of the scene makes particles");
    double clock[detail::clock_size] = {};
    if (all_.particles.time != nullptr) all_.space.copy_to_host(clock, all_.particles.time, detail::clock_size);
    return detail::births_of(clock);
  }

  /// The bodies of the mesh, in a scene with `moving_bodies`: where they are; see `body_memory`.
  bodies_memory const& bodies() const { return all_.bodies; }

  state_type const& state() const { return all_.particles; }   ///< pointers to all columns, valid until the next `set`
  execution_space& space() { return all_.space; }              ///< for work of your own on its stream, and to wait
  execution_space const& space() const { return all_.space; }  ///< the space

  /// All data, for code that saves or divides a simulation, as checkpoints and ranks do; no part of the interface.
  state_of_all& internals() { return all_; }
  /// All data, as above, of a simulation that does not change.
  state_of_all const& internals() const { return all_; }

 private:
  detail::preparation<Detector, Effect...> prepare() { return {all_}; }
  detail::step_phases<Detector, Effect...> phases() { return {all_}; }

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
    return all_.particles.size * std::size_t(detail::column_layout<Column, S>::width);
  }

  state_of_all all_;
};

/// A step that is good for springs between particles: a twentieth of the shortest time in which two collide, with
/// `hertz` a quarter of the time in which a wave crosses a particle; infinite if no effect limits steps. In a dense bed
/// under load, where each is pressed by several, take a quarter of it again. Materials that only walls have do not
/// count; those of particles are known from `set` and `assign`. O(effects); it does not wait. See
/// `sphere_contact::longest_step`, `granular_contact::longest_step`.
template <class Detector, class... Effect>
double largest_time_step(simulation<Detector, Effect...> const& of) {
  double longest = std::numeric_limits<double>::infinity();
  ((longest = detail::min(longest, detail::longest_step_of(of.template effect<Effect>(), of.internals().smallest) / 4)),
   ...);
  return longest;
}

}  // namespace collide
