/// Checks that hold of any list of effects: all numbers are finite, and the same on the host, as blocks of threads go,
/// on one rank and on three, and through save and load in the middle; where nothing else takes momentum, what particles
/// lose bodies get; where nothing brings energy, it does not grow; what rests keeps its bits, and presses with its
/// weight.
#pragma once

#include <algorithm>
#include <limits>
#include <sstream>

#include <collide/ranks/distributed_clumps.hpp>
#include <collide/ranks/thread_ranks.hpp>
#include <collide/simulation/checkpoint.hpp>
#include <collide/simulation/energy.hpp>

#include "execution/lockstep.hpp"
#include "scene.hpp"

namespace tests::pairs {

template <class T, class... Among>
inline constexpr bool is_among = (std::is_same<T, Among>::value || ...);

/// The particles and the mesh of a list, in memory of a space, and how the mesh moves. Simulations on ranks are used
/// like others.
template <mesh_kind Kind, class Space, class S>
class moving_scene {
 public:
  moving_scene(Space const& space, trial const& t, world<S> w)
      : trial_{t}, w_{std::move(w)}, at_{w_.corners}, rates_(w_.corners.size()), particles_(space, w_) {
    corners_of_sheet_.reserve(space.resource(), at_.size());
    rates_of_sheet_.reserve(space.resource(), at_.size());
  }

  std::size_t size() const { return w_.size(); }
  /// An even part of the grains, or of pairs of them.
  range part_of_rank(bool of_pairs, int rank, int ranks) const {
    if (!of_pairs) return part_of(size(), split::evenly, rank, ranks);
    range const pairs = part_of((size() + 1) / 2, split::evenly, rank, ranks);
    std::size_t const first = std::min(2 * pairs.first, size());
    return {first, std::min(first + 2 * pairs.size, size()) - first};
  }
  void stand_still() { size_of_motion_ = 0; }

  /// Sets the mesh, and a part of the particles.
  template <class Simulation>
  void begin(Simulation& made, range part, std::size_t capacity) {
    if (trial_.how == surface::deforming) {
      deform(made, 0);
    } else {
      std::vector<collide::body> bodies;
      if (trial_.how != surface::at_rest) bodies.push_back({0, w_.corners.size() / 9, motion()});
      particles_.set_mesh(made, bodies);
    }
    if constexpr (collide::detail::contains<typename Simulation::columns, collide::in_clump>) {
      set_dumbbells(made, part);
    } else {
      particles_.set(made, part, capacity);
    }
  }

  /// Steps from one number of steps to another.
  template <class Simulation>
  void play(Simulation& made, std::size_t from, std::size_t to) {
    bool const is_sheet = trial_.how == surface::deforming, is_driven = trial_.how == surface::driven_body;
    std::size_t const at_a_time = !is_sheet && !is_driven ? to - from : size_of_motion_ > 0 ? 1 : 20;
    for (std::size_t k = from; k < to; k += at_a_time) {
      double const time = trial_.dt() * static_cast<double>(k + 1);
      if (is_driven) drive(made, time);
      if (is_sheet) deform(made, time);
      made.steps(std::min(at_a_time, to - k), S(trial_.dt()));
    }
  }

 private:
  /// Each two grains are a clump.
  template <class Simulation>
  void set_dumbbells(Simulation& made, range part) {
    std::vector<collide::clump_shape> shapes;
    std::vector<collide::placed_clump> all;
    for (std::size_t i = part.first; i < part.first + part.size; i += 2) {
      std::vector<collide::sphere<double>> spheres;
      for (std::size_t k = i; k < std::min(i + 2, part.first + part.size); ++k)
        spheres.push_back({{double(w_.centres[3 * k]), double(w_.centres[3 * k + 1]), double(w_.centres[3 * k + 2])},
                           double(w_.radii.empty() ? w_.radius : w_.radii[k])});
      shapes.push_back(collide::shape_of_clump(spheres));
      collide::placed_clump c;
      c.shape = all.size();
      for (std::size_t k = 0; k < 3; ++k) c.moving.linear[k] = double(w_.velocities[3 * i + k]);
      all.push_back(c);
    }
    collide::set_clumps(made, shapes, all);
  }

  collide::body_motion motion() const {
    collide::body_motion m;
    m.amplitude[0] = size_of_motion_ * trial_.draw(0.01, 0.001, 0.02, 40);
    m.amplitude[2] = size_of_motion_ * trial_.draw(0.02, 0.001, 0.03, 41);
    m.frequency = trial_.draw(2, 0.2, 4, 42);
    m.swing = size_of_motion_ * trial_.draw(0.05, 0.001, 0.1, 43);
    return m;
  }
  template <class Simulation>
  static auto const& local(Simulation const& made) {
    if constexpr (has_local<Simulation>::value) {
      return made.local();
    } else {
      return made;
    }
  }
  template <class T, class = void>
  struct has_local : std::false_type {};
  template <class T>
  struct has_local<T, std::void_t<decltype(std::declval<T const&>().local())>> : std::true_type {};

  template <class Simulation>
  void drive(Simulation& made, double time) {
    if constexpr (Kind == mesh_kind::driven) {
      collide::body_state const now = motion()(time);
      made.space().copy_from_host(local(made).bodies().states(), &now, 1);
      made.space().synchronize();
    }
  }
  /// The floor goes up and down like a sheet that is shaken, and the walls with it.
  template <class Simulation>
  void deform(Simulation& made, double time) {
    if constexpr (Kind != mesh_kind::fixed) {
      double const size = size_of_motion_ * trial_.draw(0.01, 0.001, 0.015, 44), rate = trial_.draw(12, 1, 20, 45);
      for (std::size_t i = 0; i < at_.size(); i += 3) {
        double const turns = rate * time + 3 * double(w_.corners[i]);
        at_[i + 2] = S(double(w_.corners[i + 2]) + size * std::sin(turns));
        rates_[i + 2] = S(size * rate * std::cos(turns));
      }
      made.space().copy_from_host(corners_of_sheet_.data(), at_.data(), at_.size());
      made.space().copy_from_host(rates_of_sheet_.data(), rates_.data(), rates_.size());
      made.space().synchronize();
      S const* const corners = corners_of_sheet_.data();
      made.set_mesh(collide::triangle_soup(corners, at_.size() / 9), {}, rates_of_sheet_.data());
    }
  }

  trial trial_;
  world<S> w_;
  std::vector<S> at_, rates_;
  collide::buffer<S> corners_of_sheet_, rates_of_sheet_;
  world_in<Space, S> particles_;
  double size_of_motion_ = 1;
};

/// A list of effects in its scene.
template <class List>
class checked_list;
template <mesh_kind Kind, class NarrowPhase, class S, class... Effect>
class checked_list<scene_list<Kind, NarrowPhase, S, Effect...>> {
  template <class Space>
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, Effect...>;
  using host = collide::host;
  template <class Space>
  using scene_in = moving_scene<Kind, Space, S>;
  static constexpr bool has_sizes = is_among<collide::polydisperse, Effect...>;
  static constexpr bool has_source = is_among<collide::emit, Effect...>;
  using values = values_of<simulation<host>>;

 public:
  /// The surfaces that its mesh can be.
  static std::vector<surface> surfaces() {
    if (Kind == mesh_kind::fixed) return {surface::at_rest};
    return {surface::at_rest, Kind == mesh_kind::moving ? surface::body : surface::driven_body, surface::deforming};
  }

  /// Runs the list in a space, as the reference of all others.
  template <class Space>
  checked_list(trial const& t, Space const& space) : trial_{t} {
    given_ = play_on(space, middle_, end_);
    check_finite(end_);
  }

  /// The same in another space.
  template <class Space>
  void check_space(Space const& space) const {
    values middle, end;
    auto const given = play_on(space, middle, end);
    CHECK(equal_bytes(given, given_));
    CHECK(equal(middle, middle_));
    CHECK(equal(end, end_));
  }

  /// The same on ranks.
  void check_ranks() const {
    for (int const n : {1, 3}) {
      std::vector<complaints> wrong(static_cast<std::size_t>(n));
      collide::thread_ranks::run(n, [&](collide::thread_ranks const& ranks) {
        check_rank(ranks, wrong[static_cast<std::size_t>(ranks.rank())]);
      });
      for (auto const& w : wrong) CHECK(w.text() == "");
    }
  }

  /// Momentum that grains lose goes to bodies and to the mesh at rest, and gravity gives it, to sleeping grains too; so
  /// with their angular momentum about the vertical, to which gravity gives nothing.
  void check_momentum() const {
    if constexpr (momentum_closes) {
      host const space(1);
      list_sums const sums(space, unit);
      simulation<host> made(space, parameters<Effect>(trial_, sums, has_sizes)...);
      scene_in<host> scene(space, trial_, falling_grains<S>(trial_, has_sizes));
      scene.begin(made, {0, scene.size()}, 0);
      momentum const before = momentum_of(made);
      vec const weight = weight_of(made);
      scene.play(made, 0, steps);
      momentum given = momentum::Zero();
      for (auto const& one : sums.read(space))
        given += momentum(one.linear[0], one.linear[1], one.linear[2], one.angular[2]);
      momentum pulled = momentum::Zero();
      pulled.template head<3>() = weight * (trial_.dt() * double(steps));
      momentum missing = before + pulled - momentum_of(made) - given;
      if (!angular_momentum_closes) missing[3] = 0;
      CHECK(sums.refused(space) == 0);
      if (has<collide::gravity> && has<collide::bounce> && trial_.seed == 0) CHECK(given.norm() > 0.1);
      CHECK(missing.norm() < (before.norm() + pulled.norm()) * (sizeof(S) == 4 ? 4e-6 : 4e-12));
    }
  }

  /// Energy does not grow where nothing brings any. Without losses it stays what it was, to the bound of velocity
  /// Verlet for springs: (pi dt / duration of a collision)^2 / 8, 0.14 % with the usual numbers. Semi-implicit Euler is
  /// of first order: what is drawn may be off by pi dt / duration, and by what gravity gives in half a step.
  void check_energy() const {
    if (energy_falls && trial_.how == surface::at_rest) {
      host const space(1);
      list_sums const sums(space, unit);
      simulation<host> made(space, parameters<Effect>(trial_, sums, has_sizes)...);
      scene_in<host> scene(space, trial_, falling_grains<S>(trial_, has_sizes));
      if constexpr (energy_stays) {
        made.template effect<collide::bounce>().restitution = 1;
        auto& contact = made.template effect<collide::sphere_contact>();
        contact.damping = contact.friction = 0;
      }
      scene.begin(made, {0, scene.size()}, 0);
      double const before = collide::energy(made, density).total();
      scene.play(made, 0, steps);
      double const after = collide::energy(made, density).total();
      double part = 0.0014;
      if (trial_.seed != 0) {
        double const phase = 6.283185307179586 * trial_.dt() / trial_.duration();  // small grains collide faster
        part = has<collide::velocity_verlet> ? phase * phase / 8 : phase / 2;
        if (has<collide::gravity>) part += 9.81 * trial_.dt() / 2;  // for a speed of 1, in halves of it
      }
      CHECK(after < before * (1 + part));
      if (energy_stays) CHECK(after > before * (1 - part));
    }
  }

  /// Grains on a mesh that stands still keep their bits for 1e4 steps, and press with their weight.
  void check_rest() const {
    if constexpr (comes_to_rest) {
      host const space(1);
      list_sums sums(space, unit);
      simulation<host> made(space, parameters<Effect>(trial_, sums, has_sizes)...);
      scene_in<host> scene(space, trial_, lying_grains<S>(has_sizes));
      scene.stand_still();
      scene.begin(made, {0, scene.size()}, 0);
      scene.play(made, 0, 3000);
      auto const x = made.template to_host<position>(), v = made.template to_host<velocity>();
      sums.clear(space);
      scene.play(made, 3000, 3200);
      double const weight = -weight_of(made)[2] * part_that_presses(), close = sizeof(S) == 4 ? 1e-5 : 1e-9;
      if constexpr (has<collide::reaction>) {
        double pressed = 0;
        for (auto const& one : sums.read(space)) pressed -= one.linear[2];
        CHECK(pressed == doctest::Approx(weight * 200 * trial_.dt()).epsilon(close));
      }
      if constexpr (has<collide::mesh_forces>) {
        double pressed = 0;
        for (std::size_t i = 0; i < made.size(); ++i)
          pressed += double(made.template to_host<collide::mesh_force>()[3 * i + 2]);
        CHECK(pressed == doctest::Approx(weight).epsilon(close));
      }
      scene.play(made, 3200, 13000);
      CHECK(equal_bytes(made.template to_host<position>(), x));
      CHECK(equal_bytes(made.template to_host<velocity>(), v));
    }
  }

  /// The same when it is saved in the middle, and another simulation goes on.
  void check_checkpoint() const {
    host const space(1);
    list_sums const sums(space, unit), others(space, unit);
    simulation<host> first(space, parameters<Effect>(trial_, sums, has_sizes)...),
        second(space, parameters<Effect>(trial_, others, has_sizes)...);
    scene_in<host> scene(space, trial_, falling_grains<S>(trial_, has_sizes));
    scene.begin(first, {0, scene.size()}, capacity(scene.size()));
    scene.play(first, 0, steps / 2);
    std::stringstream file;
    collide::save(first, file);
    scene.begin(second, {0, 1}, capacity(1));
    collide::load(second, file);
    values found;
    found.read(second);
    CHECK(equal(found, middle_));
    scene.play(second, steps / 2, steps);
    found.read(second);
    CHECK(equal(found, end_));
  }

 private:
  static constexpr double unit = 1e-14;  ///< of impulse

  using vec = Eigen::Vector3d;
  template <class... E>
  static constexpr bool has = (is_among<E, Effect...> || ...);
  static constexpr bool turns =
      collide::detail::contains<typename simulation<host>::columns, collide::angular_velocity>;
  static constexpr bool momentum_closes =
      has<collide::reaction> && !has<collide::drag, collide::wind<>, stirs, collide::box_walls, collide::emit,
                                     collide::absorb, collide::absorbing_box>;
  /// Without rotation, what friction between grains would turn is lost.
  static constexpr bool angular_momentum_closes =
      !has<collide::periodic_box> && (turns || !simulation<host>::effects_type::any_pair_contact);
  static constexpr bool energy_falls =
      !has<collide::wind<>, stirs, collide::emit> && !(has<collide::gravity> && has<collide::periodic_box>);
  static constexpr bool energy_stays = energy_falls && has<collide::velocity_verlet> && has<collide::gravity> &&
                                       has<collide::sphere_contact> && has<collide::bounce> &&
                                       !has<collide::friction, collide::adhesion, collide::drag, collide::sleep,
                                            collide::absorb, collide::absorbing_box, collide::box_walls>;

  static constexpr bool comes_to_rest =
      has<collide::gravity> && has<collide::bounce> && !has<collide::wind<>, stirs, collide::emit, collide::absorb>;

  /// Momentum, and angular momentum about the vertical.
  using momentum = Eigen::Vector4d;

  /// Momentum of all grains, with the second half kick of those that the mesh held, which is part of the next step.
  momentum momentum_of(simulation<host> const& made) const {
    double const dt = trial_.dt();
    using columns = typename simulation<host>::columns;
    auto const x = made.template to_host<position>(), v = made.template to_host<velocity>();
    std::vector<S> turning(3 * made.size()), pulls(3 * made.size()), torques(3 * made.size());
    std::vector<std::uint8_t> held(made.size());
    auto const read = [&](auto column, auto& to) {
      using column_type = decltype(column);
      if constexpr (collide::detail::contains<columns, column_type>) to = made.template to_host<column_type>();
    };
    read(collide::angular_velocity{}, turning);
    read(collide::held{}, held);
    read(collide::pair_acceleration{}, pulls);
    read(collide::pair_angular_acceleration{}, torques);
    vec const g(0, 0, has<collide::gravity> ? -9.81 : 0);
    momentum sum = momentum::Zero();
    for (std::size_t i = 0; i < made.size(); ++i) {
      double const late = held[i] == 1 ? dt / 2 : 0;
      double const radius = double(made.spheres()[i].radius), m = mass(made, i);
      vec const y = at(x, i), u = at(v, i) + late * (g + at(pulls, i)), w = at(turning, i) + late * at(torques, i);
      double const angular = y[0] * u[1] - y[1] * u[0] + 0.4 * radius * radius * w[2];
      sum += m * momentum(u[0], u[1], u[2], angular);
    }
    return sum;
  }
  /// The part of its weight with which a grain at rest presses: in each step it falls until the mesh holds it, and drag
  /// slows that.
  double part_that_presses() const {
    if constexpr (has<collide::drag>) {
      auto const by = parameters<collide::drag>(trial_, list_sums(host(1), unit), has_sizes);
      constexpr int parts = 10'000;
      double const dt = trial_.dt() / parts;
      auto const rate = [&](double v) { return 9.81 - (by.linear + by.quadratic * v) * v; };
      double v = 0;
      for (int i = 0; i < parts; ++i) v += dt * rate(v + dt / 2 * rate(v));
      return v / (9.81 * trial_.dt());
    } else {
      return 1;
    }
  }
  static vec at(std::vector<S> const& of, std::size_t i) {
    return vec(double(of[3 * i]), double(of[3 * i + 1]), double(of[3 * i + 2]));
  }
  static vec weight_of(simulation<host> const& made) {
    return vec(0, 0, has<collide::gravity> ? -9.81 * total_mass(made) : 0);
  }
  static double total_mass(simulation<host> const& made) {
    double sum = 0;
    for (std::size_t i = 0; i < made.size(); ++i) sum += mass(made, i);
    return sum;
  }
  static double mass(simulation<host> const& made, std::size_t i) {
    return collide::detail::sphere_mass(density, double(made.spheres()[i].radius));
  }

  static std::size_t capacity(std::size_t n) { return has_source ? n + newborns : 0; }

  /// Returns what bodies have got, in scenes with `reaction`.
  template <class Space>
  std::vector<collide::body_impulse> play_on(Space space, values& middle, values& end) const {
    list_sums const sums(space, unit);
    simulation<Space> made(space, parameters<Effect>(trial_, sums, has_sizes)...);
    scene_in<Space> scene(space, trial_, falling_grains<S>(trial_, has_sizes));
    scene.begin(made, {0, scene.size()}, capacity(scene.size()));
    scene.play(made, 0, steps / 2);
    middle.read(made);
    scene.play(made, steps / 2, steps);
    end.read(made);
    return sums.read(space);
  }

  void check_rank(collide::thread_ranks const& ranks, complaints& wrong) const {
    wrong.in(std::to_string(ranks.size()) + " ranks");
    host const space(1);
    list_sums const sums(space, unit);
    collide::distributed<simulation<host>, collide::thread_ranks> parts(ranks, space,
                                                                        parameters<Effect>(trial_, sums, has_sizes)...);
    scene_in<host> scene(space, trial_, falling_grains<S>(trial_, has_sizes));
    range own = scene.part_of_rank(has<collide::clumps>, ranks.rank(), ranks.size());
    scene.begin(parts, own, capacity(scene.size()));
    if (has_source && ranks.rank() + 1 == ranks.size()) own.size += newborns;
    values found;
    scene.play(parts, 0, steps / 2);
    found.read(parts);
    wrong.expect(equal(found, middle_.part(own.first, own.size)), "in the middle");
    scene.play(parts, steps / 2, steps);
    found.read(parts);
    wrong.expect(equal(found, end_.part(own.first, own.size)), "in the end");
    wrong.expect(equal_bytes(parts.total(sums), given_), "what bodies have got");
  }

  /// No number of any particle is NaN or infinite.
  static void check_finite(values const& columns) {
    std::size_t bad = 0;
    for (auto const& column : columns.of) {
      std::vector<S> numbers(column.is_scalar ? column.bytes.size() / sizeof(S) : 0);
      if (!numbers.empty()) std::memcpy(numbers.data(), column.bytes.data(), column.bytes.size());
      for (S const x : numbers) bad += !std::isfinite(x);
    }
    CHECK(bad == 0);
  }

  trial trial_;
  values middle_, end_;
  std::vector<collide::body_impulse> given_;
};

/// Checks a list in a scene.
template <class List>
void check_list(trial const& t) {
  checked_list<List> const list(t, collide::host(1));
  list.check_momentum();
  list.check_energy();
  list.check_rest();
  list.check_checkpoint();
  list.check_space(lockstep<64, true>());
  list.check_ranks();
}

/// Checks a list on all surfaces that its mesh can be.
template <class List>
void check_list() {
  for (surface const how : checked_list<List>::surfaces()) {
    CAPTURE(int(how));
    check_list<List>(trial{how, 0});
  }
}

}  // namespace tests::pairs
