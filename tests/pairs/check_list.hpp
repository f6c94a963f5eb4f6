/// What must hold of any list of effects: all numbers are finite, and the same on the host, as blocks of threads go, on
/// one rank and on three, and through save and load in the middle; where nothing else takes momentum, what particles
/// lose bodies get, and where nothing brings energy, it does not grow.
#pragma once

#include <sstream>

#include <collide/checkpoint.hpp>
#include <collide/energy.hpp>
#include <collide/ranks/thread_ranks.hpp>

#include "execution/lockstep.hpp"
#include "scene.hpp"

namespace tests::pairs {

template <class T, class... Among>
inline constexpr bool is_among = (std::is_same<T, Among>::value || ...);

/// The particles and the mesh of a list, in memory of a space, and how the mesh moves. Simulations on ranks are used
/// like others.
template <surface Surface, class Space, class S>
class moving_scene {
 public:
  moving_scene(Space const& space, bool several_sizes)
      : w_{grains<S>(several_sizes)}, at_{w_.corners}, rates_(w_.corners.size()), particles_(space, w_) {}

  std::size_t size() const { return w_.size(); }

  /// Sets the mesh, and a part of the particles.
  template <class Simulation>
  void begin(Simulation& made, range part, std::size_t capacity) {
    if constexpr (Surface == surface::deforming) {
      deform(made, 0);
    } else {
      std::vector<collide::body> bodies;
      if (Surface != surface::at_rest) bodies.push_back({0, w_.corners.size() / 9, motion()});
      particles_.set_mesh(made, bodies);
    }
    particles_.set(made, part, capacity);
  }

  /// Steps from one number of steps to another.
  template <class Simulation>
  void play(Simulation& made, std::size_t from, std::size_t to) {
    if constexpr (Surface == surface::at_rest || Surface == surface::body) return made.steps(to - from, S(dt));
    for (std::size_t k = from; k < to; ++k) {
      double const time = dt * static_cast<double>(k + 1);
      if constexpr (Surface == surface::driven_body) drive(made, time);
      if constexpr (Surface == surface::deforming) deform(made, time);
      made.step(S(dt));
    }
  }

 private:
  static collide::body_motion motion() {
    collide::body_motion m;
    m.amplitude[0] = 0.01;
    m.amplitude[2] = 0.02;
    m.frequency = 2;
    m.swing = 0.05;
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
    collide::body_state const now = motion()(time);
    made.space().copy_from_host(local(made).bodies().states(), &now, 1);
  }
  /// The floor goes up and down like a sheet that is shaken, and the walls with it.
  template <class Simulation>
  void deform(Simulation& made, double time) {
    for (std::size_t i = 0; i < at_.size(); i += 3) {
      double const turns = 12 * time + 3 * double(w_.corners[i]);
      at_[i + 2] = S(double(w_.corners[i + 2]) + 0.01 * std::sin(turns));
      rates_[i + 2] = S(0.12 * std::cos(turns));
    }
    made.set_mesh(collide::triangle_soup(at_.data(), at_.size() / 9), {}, rates_.data());
  }

  world<S> w_;
  std::vector<S> at_, rates_;
  world_in<Space, S> particles_;
};

/// A list of effects in its scene, in a space.
template <class List>
class checked_list;
template <surface Surface, class NarrowPhase, class S, class... Effect>
class checked_list<scene_list<Surface, NarrowPhase, S, Effect...>> {
  template <class Space>
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, Effect...>;
  using host = collide::host;
  static constexpr bool has_sizes = is_among<collide::polydisperse, Effect...>;
  static constexpr bool has_source = is_among<collide::emit, Effect...>;
  using values = values_of<simulation<host>>;

 public:
  /// What the list makes of its scene on the host, with one thread.
  checked_list() {
    given_ = play_on(host(1), middle_, end_);
    check_finite(end_);
  }

  /// The same as blocks of threads go.
  void check_lockstep() const {
    values middle, end;
    auto const given = play_on(lockstep<64, true>(), middle, end);
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

  /// What grains lose of their momentum bodies and what rests get, and gravity gives.
  void check_momentum() const {
    if constexpr (momentum_closes) {
      host const space(1);
      collide::reaction_sums const sums(space, 1, unit);
      simulation<host> made(space, parameters<Effect>(sums, has_sizes)...);
      moving_scene<Surface, host, S> scene(space, has_sizes);
      scene.begin(made, {0, scene.size()}, 0);
      vec const before = momentum_of(made), weight = weight_of(made);
      scene.play(made, 0, steps);
      vec given = vec::Zero();
      for (auto const& one : sums.read(space)) given += vec(one.linear[0], one.linear[1], one.linear[2]);
      vec const missing = before + weight * (dt * double(steps)) - momentum_of(made) - given;
      CHECK(sums.refused(space) == 0);
      CHECK(given.norm() > 0.1);
      CHECK(missing.norm() < given.norm() * (sizeof(S) == 4 ? 1e-6 : 1e-12));
    }
  }

  /// Energy does not grow where nothing brings any. Without losses it stays what it was, to the bound of velocity
  /// Verlet for springs: (pi dt / duration of a collision)^2 / 8, 0.14 %.
  void check_energy() const {
    if constexpr (energy_falls) {
      host const space(1);
      collide::reaction_sums const sums(space, 1, unit);
      simulation<host> made(space, parameters<Effect>(sums, has_sizes)...);
      moving_scene<Surface, host, S> scene(space, has_sizes);
      if constexpr (energy_stays) {
        made.template effect<collide::bounce>().restitution = 1;
        auto& contact = made.template effect<collide::sphere_contact>();
        contact.damping = contact.friction = 0;
      }
      scene.begin(made, {0, scene.size()}, 0);
      double const before = collide::energy(made, density).total();
      scene.play(made, 0, steps);
      double const after = collide::energy(made, density).total();
      CHECK(after < before * 1.0014);
      if (energy_stays) CHECK(after > before * 0.9986);
    }
  }

  /// The same when it is saved in the middle, and another simulation goes on.
  void check_checkpoint() const {
    host const space(1);
    collide::reaction_sums const sums(space, 1, unit), others(space, 1, unit);
    simulation<host> first(space, parameters<Effect>(sums, has_sizes)...),
        second(space, parameters<Effect>(others, has_sizes)...);
    moving_scene<Surface, host, S> scene(space, has_sizes);
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
  static constexpr bool momentum_closes =
      has<collide::reaction> &&
      !has<collide::drag, collide::wind<>, collide::box_walls, collide::emit, collide::absorb, collide::absorbing_box>;
  static constexpr bool energy_falls = Surface == surface::at_rest && !has<collide::wind<>, collide::emit> &&
                                       !(has<collide::gravity> && has<collide::periodic_box>);
  static constexpr bool energy_stays = energy_falls && has<collide::velocity_verlet> && has<collide::gravity> &&
                                       has<collide::sphere_contact> && has<collide::bounce> &&
                                       !has<collide::friction, collide::adhesion, collide::drag, collide::sleep,
                                            collide::absorb, collide::absorbing_box, collide::box_walls>;

  /// That of all grains, with the second half kick of those that the mesh held, which is part of the next step.
  static vec momentum_of(simulation<host> const& made) {
    using columns = typename simulation<host>::columns;
    auto const v = made.template to_host<velocity>();
    vec const g(0, 0, has<collide::gravity> ? -9.81 : 0);
    vec sum = vec::Zero();
    for (std::size_t i = 0; i < made.size(); ++i) sum += mass(made, i) * at(v, i);
    if constexpr (collide::detail::contains<columns, collide::held>) {
      auto const held = made.template to_host<collide::held>();
      std::vector<S> pulls(3 * made.size());
      if constexpr (collide::detail::contains<columns, collide::pair_acceleration>)
        pulls = made.template to_host<collide::pair_acceleration>();
      for (std::size_t i = 0; i < made.size(); ++i) {
        if (held[i] == 1) sum += mass(made, i) * dt / 2 * (g + at(pulls, i));
      }
    }
    return sum;
  }
  static vec at(std::vector<S> const& of, std::size_t i) {
    return vec(double(of[3 * i]), double(of[3 * i + 1]), double(of[3 * i + 2]));
  }
  static vec weight_of(simulation<host> const& made) {
    double sum = 0;
    for (std::size_t i = 0; i < made.size(); ++i) sum += mass(made, i);
    return vec(0, 0, has<collide::gravity> ? -9.81 * sum : 0);
  }
  static double mass(simulation<host> const& made, std::size_t i) {
    return collide::detail::sphere_mass(density, double(made.spheres()[i].radius));
  }

  static std::size_t capacity(std::size_t n) { return has_source ? n + newborns : 0; }

  /// Returns what bodies have got, in scenes with `reaction`.
  template <class Space>
  static std::vector<collide::body_impulse> play_on(Space space, values& middle, values& end) {
    collide::reaction_sums const sums(space, 1, unit);
    simulation<Space> made(space, parameters<Effect>(sums, has_sizes)...);
    moving_scene<Surface, Space, S> scene(space, has_sizes);
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
    collide::reaction_sums const sums(space, 1, unit);
    collide::distributed<simulation<host>, collide::thread_ranks> parts(ranks, space,
                                                                        parameters<Effect>(sums, has_sizes)...);
    moving_scene<Surface, host, S> scene(space, has_sizes);
    range own = part_of(scene.size(), split::evenly, ranks.rank(), ranks.size());
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
  static void check_finite(values const& of) {
    std::size_t bad = 0;
    auto const count = [&](auto const& column) {
      if constexpr (std::is_floating_point<typename std::decay_t<decltype(column)>::value_type>::value)
        for (auto const x : column) bad += !std::isfinite(x);
    };
    std::apply([&](auto const&... all) { (count(all), ...); }, of.of);
    CHECK(bad == 0);
  }

  values middle_, end_;
  std::vector<collide::body_impulse> given_;
};

/// Checks a list.
template <class List>
void check_list() {
  checked_list<List> const list;
  list.check_momentum();
  list.check_energy();
  list.check_checkpoint();
  list.check_lockstep();
  list.check_ranks();
}

}  // namespace tests::pairs
