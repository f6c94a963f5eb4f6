/// Walls of granular contact are surfaces: their force is that of the smooth surface that they stand for, the same for
/// every division into triangles, and makes no energy. Instantiated by test_surfaces.cpp and test_surfaces_cuda.cpp.
#pragma once

#include <string>

#include <collide/effects/bounds.hpp>

#include "simulation/granular.hpp"

namespace tests {

using point = std::array<double, 3>;

/// Balls on walls that may be bodies.
template <class Space, class S, class Cohesion = none>
using on_walls = collide::simulation<meets_mesh<Space, collide::karabassi<>, S>, gravity,
                                     granular_contact<hertz, mindlin, none, Cohesion>, collide::reaction,
                                     velocity_verlet, moving_bodies<>>;

struct ball_and_wall {
  double radius = 0.01, young = 1e7, restitution = 1, friction = 0, energy_density = 0, down = 0;

  double mass() const { return 2500 * 4.0 / 3 * pi * radius * radius * radius; }
  /// Hertz: of a ball on a plane of the same solid.
  double force(double overlap) const {
    return 4.0 / 3 * (young / (2 * (1 - 0.04))) * std::sqrt(radius) * std::pow(overlap, 1.5);
  }
};

/// A simulation of a world, with what bodies get.
template <class Space, class S, class Cohesion = none>
class balls_on_walls {
 public:
  using simulation = on_walls<Space, S, Cohesion>;
  using law = granular_contact<hertz, mindlin, none, Cohesion>;

  balls_on_walls(Space const& space, ball_and_wall const& of, world<S> const& w, std::vector<body> const& bodies = {})
      : sums(space, bodies.size(), of.mass() * 1e-12),
        made(space, w, bodies, gravity{0, 0, -of.down},
             law{collide::one_material({of.young, 0.2, 2500}, {of.restitution, of.friction, 0, of.energy_density})},
             sums.effect(2500), velocity_verlet{}, moving_bodies<>{}) {}

  /// The force on a ball at rest whose centre is here.
  point force_at(ball_and_wall const& of, point const& centre) {
    world<S> w;
    w.radius = S(of.radius);
    w.particle(centre[0], centre[1], centre[2]);
    made.place(w);
    double const dt = 1e-7;
    made.simulation.step(S(dt));
    auto const v = made.velocities();
    return {double(v[0]) * of.mass() / dt, double(v[1]) * of.mass() / dt, double(v[2]) * of.mass() / dt};
  }

  collide::reaction_sums sums;
  running_bodies<simulation> made;
};

inline double distance_of(point const& a, point const& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }
inline double length_of(point const& a) { return distance_of(a, {0, 0, 0}); }
inline point plus(point const& a, double t, point const& b) {
  return {a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]};
}

/// Where facets are shorter than the patch of contact, the force is within 2 % of the smooth surface's: `at(u, v)` is a
/// point of it, and `height` the distance from it of a point inside. The reference is Hertz' closed form, along the
/// gradient of `height`.
template <class Space, class Surface, class Height>
void check_smooth_surface(Space const& space, Surface const& at, Height const& height) {
  ball_and_wall const of;
  double const half = 4e-3, turn = 0.4;
  int const n = 24;
  world<double> w;
  w.radius = of.radius;
  auto const corner = [&](int i, int k) {
    double const u = half * (2.0 * i / n - 1), v = half * (2.0 * k / n - 1);
    return at(u * std::cos(turn) - v * std::sin(turn), u * std::sin(turn) + v * std::cos(turn));
  };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) add_quad(w, corner(i, k), corner(i + 1, k), corner(i + 1, k + 1), corner(i, k + 1));
  w.particle(0, 0, 1);
  balls_on_walls<Space, double> balls(space, of, w);
  std::mt19937 engine(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 12; ++trial) {
    point const on = at(0.3 * half * uniform(engine), 0.3 * half * uniform(engine));
    double const overlap = 1e-4 * (1 + 0.5 * uniform(engine)), step = 1e-6;
    point inwards{};
    for (std::size_t c = 0; c < 3; ++c) {
      point a = on, b = on;
      a[c] -= step;
      b[c] += step;
      inwards[c] = (height(b) - height(a)) / (2 * step);
    }
    CHECK(length_of(inwards) == doctest::Approx(1).epsilon(1e-6));
    point const centre = plus(on, of.radius - overlap, inwards);
    CHECK(height(centre) == doctest::Approx(of.radius - overlap).epsilon(1e-6));
    double const right = of.force(overlap);
    double const off = distance_of(balls.force_at(of, centre), plus({0, 0, 0}, right, inwards)) / right;
    CHECK(off < 0.02);
  }
}

template <class Space>
void check_smooth_surfaces(Space const& space) {
  double const r = 0.03, alpha = 0.6, far = 0.05;  // of the cylinder and the sphere; of the cone, where it is met
  check_smooth_surface(
      space,
      [](double u, double v) {
        return point{u, v, 0.1 * u};
      },
      [](point const& p) { return (p[2] - 0.1 * p[0]) / std::sqrt(1.01); });
  check_smooth_surface(
      space,
      [=](double u, double v) {
        return point{r * std::sin(u / r), v, -r * std::cos(u / r)};
      },
      [=](point const& p) { return r - std::hypot(p[0], p[2]); });
  check_smooth_surface(
      space,
      [=](double u, double v) {
        double const along = far + v, rho = along * std::sin(alpha), turn = u / (far * std::sin(alpha));
        return point{rho * std::sin(turn), -rho * std::cos(turn), along * std::cos(alpha)};
      },
      [=](point const& p) { return p[2] * std::sin(alpha) - std::hypot(p[0], p[1]) * std::cos(alpha); });
  check_smooth_surface(
      space,
      [=](double u, double v) {
        return point{r * std::sin(u / r) * std::cos(v / r), r * std::sin(v / r),
                     -r * std::cos(u / r) * std::cos(v / r)};
      },
      [=](point const& p) { return r - length_of(p); });
}

/// Two half planes that meet in the y axis, turned up by half of the angle each; triangles of 8 m.
template <class S>
void add_fold(world<S>& w, double half, double angle) {
  double const up = half * std::tan(angle / 2);
  add_quad(w, {-half, -4, up}, {0, -4, 0}, {0, 4, 0}, {-half, 4, up});
  add_quad(w, {0, -4, 0}, {half, -4, up}, {half, 4, up}, {0, 4, 0});
}

/// As its angle goes to 0 a fold gets the force, the restitution and, with jkr, the pull-off of the plane.
template <class Space>
void check_flat_folds(Space const& space) {
  for (double const angle : {0.0, 1e-5, 1e-4, 1e-3, 1e-2}) {
    ball_and_wall of;
    world<double> w;
    w.radius = of.radius;
    add_fold(w, 0.1, angle);
    w.particle(0, 0.3, 1);
    balls_on_walls<Space, double> balls(space, of, w);
    for (double const overlap : {1e-5, 1e-4, 1e-3}) {
      double const deeper = of.radius * angle * angle / (8 * overlap);  // by so much are the faces nearer than the edge
      for (double const aside : {0.0, 1e-6, 3e-5}) {
        double const z = (of.radius - overlap) / std::cos(angle / 2) + aside * std::tan(angle / 2);
        point const f = balls.force_at(of, {aside, 0.3, z});
        double const off = distance_of(f, {0, 0, of.force(overlap)}) / of.force(overlap);
        CHECK(off < 1e-6 + angle + 4 * deeper);
      }
    }

    of.restitution = 0.5;
    balls_on_walls<Space, double> falls(space, of, w);
    world<double> falling;
    falling.radius = of.radius;
    falling.particle(0, 0.3, 1.0001 * of.radius, 0, 0, -0.1);
    falls.made.place(falling);
    falls.made.simulation.steps(8000, 1e-6);
    CHECK(falls.made.velocities()[2] == doctest::Approx(0.05).epsilon(angle < 2e-3 ? 2e-3 : 2e-2).scale(0));

    // so heavy that it leaves with the speed that it has
    of = {};
    of.energy_density = 0.05;
    balls_on_walls<Space, double, collide::jkr> sticks(space, of, w);
    falling = {};
    falling.radius = of.radius;
    falling.particle(0, 0.3, of.radius - 2e-7, 0, 0, 2e-3);
    sticks.made.place(falling);
    double most = 0, before = 2e-3, dt = 2e-6;
    for (int k = 0; k < 400; ++k) {
      sticks.made.simulation.step(dt);
      double const now = sticks.made.velocities()[2];
      most = std::max(most, (before - now) * of.mass() / dt);
      before = now;
    }
    CHECK(most / (3 * pi * 0.05 * of.radius) == doctest::Approx(1).epsilon(0.01).scale(0));
  }
}

/// Divides a triangle at random again and again, one without its neighbours, so that corners hang in their edges.
/// `jitter` moves each corner within the plane, `step` each triangle out of it.
class random_division {
 public:
  random_division(unsigned seed, double jitter, double step) : engine_(seed), jitter_{jitter}, step_{step} {}

  template <class S>
  void add(world<S>& w, point const& a, point const& b, point const& c, double longest) {
    double const ab = distance_of(a, b), bc = distance_of(b, c), ca = distance_of(c, a);
    if (bc > ab || ca > ab) return bc > ca ? add(w, b, c, a, longest) : add(w, c, a, b, longest);
    if (ab > longest * (1 + 0.5 * uniform_(engine_))) {
      double const t = 0.5 + 0.2 * uniform_(engine_);
      point const cut{a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), 0};
      add(w, a, cut, c, longest);
      return add(w, cut, b, c, longest);
    }
    double const z = step_ * uniform_(engine_);
    bool const is_turned = uniform_(engine_) > 0;
    for (auto const* p : {&a, is_turned ? &c : &b, is_turned ? &b : &c})
      for (double const x : {(*p)[0] + jitter_ * uniform_(engine_), (*p)[1] + jitter_ * uniform_(engine_), z})
        w.corners.push_back(S(x));
  }
  template <class S>
  void add_rectangle(world<S>& w, double from, double to, double half, double longest) {
    add(w, {from, -half, 0}, {to, -half, 0}, {to, half, 0}, longest);
    add(w, {from, -half, 0}, {to, half, 0}, {from, half, 0}, longest);
  }

 private:
  std::mt19937 engine_;
  std::uniform_real_distribution<double> uniform_{-1, 1};
  double jitter_, step_;
};

/// One flat wall, |x|, |y| < 0.1, in pieces.
template <class S>
struct wall_in_pieces {
  std::string name;
  world<S> w;
  std::vector<body> bodies;
  double steps = 0;     ///< of its triangles out of the plane
  double velocity = 0;  ///< along x, of all
};

template <class S>
std::vector<wall_in_pieces<S>> walls_in_pieces(double radius) {
  std::vector<wall_in_pieces<S>> all;
  auto const add = [&](char const* name) -> wall_in_pieces<S>& {
    all.push_back({name, {}, {}});
    all.back().w.radius = S(radius);
    return all.back();
  };
  double const tolerance = 1e-6 * radius, fine = 4e-3;
  add_divided_floor(add("two triangles").w, 0.1, 1);
  random_division(1, 0, 0).add_rectangle(add("corners that hang in edges").w, -0.1, 0.1, 0.1, fine);
  random_division(2, 0.3 * tolerance, 0).add_rectangle(add("cracks").w, -0.1, 0.1, 0.1, fine);
  auto& stepped = add("cracks and steps");
  stepped.steps = 0.3 * tolerance;
  random_division(3, 0.3 * tolerance, stepped.steps).add_rectangle(stepped.w, -0.1, 0.1, 0.1, fine);
  auto& twice = add("twice").w;
  random_division(4, 0, 0).add_rectangle(twice, -0.1, 0.1, 0.1, fine);
  random_division(4, 0, 0).add_rectangle(twice, -0.1, 0.1, 0.1, fine);
  auto& plates = add("plates that overlap").w;
  random_division(5, 0, 0).add_rectangle(plates, -0.1, 0.003, 0.1, 4 * fine);
  random_division(6, 0, 0).add_rectangle(plates, -0.004, 0.1, 0.1, 4 * fine);
  for (double const velocity : {0.0, 0.2}) {
    auto& two = add(velocity == 0 ? "two bodies" : "two bodies that move as one");
    random_division(7, 0, 0).add_rectangle(two.w, -0.1, 0, 0.1, 4 * fine);
    std::size_t const first = triangles_of(two.w);
    random_division(8, 0, 0).add_rectangle(two.w, 0, 0.1, 0.1, 4 * fine);
    body_motion motion;
    motion.velocity[0] = two.velocity = velocity;
    two.bodies = {{0, first, motion}, {first, triangles_of(two.w) - first, motion}};
  }
  auto& beside = add("a body beside the mesh");
  beside.w = all[all.size() - 2].w;
  beside.bodies = {all[all.size() - 2].bodies[0]};
  beside.bodies[0].motion.velocity[0] = 0;
  return all;
}

/// The force of a flat wall does not depend on its pieces, and nothing is sideways.
template <class Space>
void check_force_at_seams(Space const& space) {
  ball_and_wall const of;
  std::mt19937 engine(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (auto& wall : walls_in_pieces<double>(of.radius)) {
    CAPTURE(wall.name);
    wall.w.particle(0, 0, 1);
    balls_on_walls<Space, double> balls(space, of, wall.w, wall.bodies);
    for (int trial = 0; trial < 24; ++trial) {
      double const overlap = of.radius * std::pow(10, -2 + uniform(engine)), spread = trial % 2 == 0 ? 1e-2 : 1e-6;
      point const f = balls.force_at(of, {spread * uniform(engine), spread * uniform(engine), of.radius - overlap});
      double const right = of.force(overlap);
      CHECK(distance_of(f, {0, 0, right}) < right * (1e-5 + 1.6 * wall.steps / overlap));
    }
  }
}

/// Balls slide and roll over a flat wall as if it were of one piece: springs are kept from piece to piece. What they
/// lose the bodies get.
template <class Space>
void check_motion_over_seams(Space const& space) {
  ball_and_wall of;
  of.restitution = 0.5;
  of.friction = 0.3;
  of.down = 9.81;
  double const dt = 2e-5;
  int const n = 6;
  std::vector<double> of_one;
  for (auto& wall : walls_in_pieces<double>(of.radius)) {
    CAPTURE(wall.name);
    for (int k = 0; k < n; ++k)
      wall.w.particle(-0.02 + 1e-3 * k, 0.03 * k - 0.07, of.radius - 2e-6, 0.6 + 0.1 * k + wall.velocity, 0.01 * k, 0);
    balls_on_walls<Space, double> balls(space, of, wall.w, wall.bodies);
    auto const steps = 1500u;
    balls.made.simulation.steps(steps, dt);
    std::vector<double> found = balls.made.positions();
    double gained = 0;
    auto const v = balls.made.velocities();
    for (std::size_t k = 0; k < v.size(); k += 3) {
      found[k] -= wall.velocity * dt * steps;
      gained += v[k] - wall.w.velocities[k];
      for (std::size_t c = 0; c < 3; ++c) found.push_back(v[k + c] - (c == 0 ? wall.velocity : 0));
    }
    for (double const turn : balls.made.simulation.template to_host<angular_velocity>()) found.push_back(turn);
    if (of_one.empty()) of_one = found;
    double off = 0;
    for (std::size_t k = 0; k < found.size(); ++k)
      off = std::max(off, std::abs(found[k] - of_one[k]) / (k < 6 * n ? 1.0 : 1 / of.radius));
    CHECK(off < (wall.steps > 0 ? 1e-4 : 1e-6));
    if (wall.bodies.size() != 2) continue;
    auto const given = balls.sums.read(space);
    CHECK(given[0].linear[0] + given[1].linear[0] == doctest::Approx(-gained * of.mass()).epsilon(1e-6).scale(0));
    CHECK(given[0].linear[0] * given[1].linear[0] > 0);
  }
}

/// A fan of triangles around a point, in a plane.
template <class S>
void add_fan(world<S>& w, double radius, int n) {
  for (int k = 0; k < n; ++k) {
    double const a = 2 * pi * k / n, b = 2 * pi * (k + 1) / n;
    w.triangle({0, 0, 0, radius * std::cos(a), radius * std::sin(a), 0, radius * std::cos(b), radius * std::sin(b), 0});
  }
}

/// All triangles below a ball count, however many, and are one wall; a second wall that is touched less counts, too.
template <class Space>
void check_fan(Space const& space, int n) {
  ball_and_wall const of;
  world<double> w, two;
  w.radius = two.radius = of.radius;
  add_divided_floor(two, 0.05, 1);
  add_fan(w, 0.05, n);
  for (auto* both : {&two, &w}) {
    add_quad(*both, {0.0098, -1, -1}, {0.0098, 1, -1}, {0.0098, 1, 1}, {0.0098, -1, 1});
    both->particle(0, 0, 1);
  }
  balls_on_walls<Space, double> on_fan(space, of, w), on_two(space, of, two);
  for (point const& at : {point{0, 0, 0.0099}, point{1e-4, -2e-4, 0.0095}, point{-5e-4, 1e-9, 0.0097}}) {
    point const right = on_two.force_at(of, at), found = on_fan.force_at(of, at);
    CHECK(std::abs(right[2] / of.force(of.radius - at[2]) - 1) < 1e-6);
    CHECK((std::abs(right[0]) > 1e-2) == (at[0] > -2e-4));
    CHECK(distance_of(found, right) < 1e-12 * right[2]);
  }
}

/// At e = 1 an impact anywhere on or beside a concave fold keeps its energy, the better the shorter the step.
template <class Space>
void check_energy_in_folds(Space const& space, int balls_each) {
  ball_and_wall of;
  of.radius = 0.005;
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (double const angle : {1e-3, 0.02, 0.3, 1.0}) {
    CAPTURE(angle);
    world<double> w;
    w.radius = of.radius;
    add_fold(w, 0.1, angle);
    double const up = angle / 2, impact = 0.1;
    for (int i = 0; i < balls_each; ++i) {
      // above the face at the left, flying to it and along it
      double const foot = -0.006 * uniform(engine), along = 0.05 + uniform(engine);
      double const x = foot + std::sin(up) * of.radius, gap = 1.0001 * of.radius;
      double const z = (gap + std::abs(x) * std::sin(up)) / std::cos(up);
      w.particle(x, 0.02 * i - 3, z, along * std::cos(up) - impact * std::sin(up), 0,
                 -along * std::sin(up) - impact * std::cos(up));
    }
    balls_on_walls<Space, double> balls(space, of, w);
    for (double const part : {4.0, 16.0}) {
      balls.made.place(w);
      double const dt = collide::largest_time_step(balls.made.simulation) / part;
      balls.made.simulation.steps(std::size_t(0.02 / dt), dt);
      auto const v = balls.made.velocities(), x = balls.made.positions();
      double most = 0;
      int risen = 0;
      for (std::size_t k = 0; k < v.size(); k += 3) {
        // a ball that has come to the other face just now has part of its energy in the contact
        if (x[k + 2] * std::cos(up) - std::abs(x[k]) * std::sin(up) < of.radius) continue;
        double before = 0, now = 0;
        for (std::size_t c = k; c < k + 3; ++c) {
          before += w.velocities[c] * w.velocities[c];
          now += v[c] * v[c];
        }
        risen += v[k + 2] > 0;
        most = std::max(most, std::abs(now - before) / (impact * impact));
      }
      CHECK(risen > balls_each / 2);
      CHECK(most < (part == 4 ? 0.01 : 0.001));
    }
  }
}

/// A ball that rolls and hops in a trough of flat facets keeps its energy.
template <class Space>
void check_energy_in_troughs(Space const& space, double seconds) {
  ball_and_wall of;
  of.radius = 0.005;
  of.friction = 5;
  of.down = 9.81;
  double const trough = 0.1, side = 0.2, arm = trough - of.radius;
  for (int const facets : {40, 400}) {
    world<double> w;
    w.radius = of.radius;
    add_drum(w, trough, 0.05, facets);
    w.particle(arm * std::sin(side), 0.0013, -arm * std::cos(side));
    balls_on_walls<Space, double> balls(space, of, w);
    double const dt = collide::largest_time_step(balls.made.simulation) / 4;
    auto const energy = [&] { return collide::energy(balls.made.simulation).total() + of.mass() * of.down * trough; };
    double const start = energy();
    for (int k = 0; k < 5; ++k) {
      balls.made.simulation.steps(std::size_t(seconds / 5 / dt), dt);
      CHECK(energy() == doctest::Approx(start).epsilon(0.01).scale(0));
    }
    CHECK(std::abs(balls.made.positions()[0] - w.centres[0]) > 1e-3);
  }
}

/// Grains of two sizes, some across the sides of a box that repeats, come to rest, and to sleep, on bodies in pieces as
/// they do on one wall, and press with their weight.
template <class Space>
void check_features_on_pieces(Space const& space) {
  using law = granular_contact<hertz, mindlin, collide::epsd>;
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, double>, collide::polydisperse, collide::periodic_box,
                          collide::sleep, gravity, law, collide::reaction, velocity_verlet, moving_bodies<>>;
  double const radius = 0.01, small = 0.006, half = 0.08, dt = 1e-4, mass = ball_and_wall{}.mass();
  int const n = 12;
  std::vector<double> of_one;
  for (auto& wall : walls_in_pieces<double>(small)) {
    bool const is_plain = wall.bodies.empty() && wall.steps == 0;
    if (wall.velocity != 0 || (is_plain && !of_one.empty())) continue;
    CAPTURE(wall.name);
    double all = 0;
    for (int k = 0; k < n; ++k) {
      double const r = k % 2 == 0 ? radius : small, x = k % 4 == 0 ? half - 0.001 : 0.022 * (k % 4) - 0.04;
      wall.w.particle(x, 0.03 * (k / 4) - 0.03, r, 0.1, 0.02 * k - 0.1, 0);
      wall.w.radii.push_back(r);
      all += mass * std::pow(r / radius, 3);
    }
    if (wall.bodies.empty()) wall.bodies = one_body(wall.w, {});
    collide::reaction_sums sums(space, wall.bodies.size(), mass * 1e-12);
    running_bodies<simulation> made(
        space, wall.w, wall.bodies, collide::polydisperse{}, collide::periodic_box{{-half, -half, -1}, {half, half, 1}},
        collide::sleep{1e-3, 100}, gravity{}, law{collide::one_material({1e7, 0.2, 2500}, {0.2, 0.5, 0.1})},
        sums.effect(2500), velocity_verlet{}, moving_bodies<>{});
    made.simulation.steps(2500, dt);
    for (auto const slow : made.simulation.template to_host<collide::slow_steps>()) CHECK(int(slow) >= 100);
    auto const x = made.positions();
    if (of_one.empty()) of_one = x;
    double off = 0;
    for (std::size_t k = 0; k < x.size(); ++k) off = std::max(off, std::abs(x[k] - of_one[k]));
    CHECK(off < (wall.steps > 0 ? 1e-4 : 1e-7));
    sums.clear(space);
    made.simulation.steps(200, dt);
    double given = 0;
    for (auto const& of : sums.read(space)) given += of.linear[2];
    CHECK(given == doctest::Approx(-all * 9.81 * 200 * dt).epsilon(0.02).scale(0));
  }
}

/// Grains over folds, fans and plates that overlap: a few triangles to many below each, a few steps.
template <class S>
world<S> grains_on_pieces(int n, int triangles) {
  world<S> w;
  w.radius = S(0.01);
  add_fold(w, 0.05, 0.02);
  add_fan(w, 0.05, triangles);
  random_division(9, 1e-9, 1e-9).add_rectangle(w, -0.03, 0.03, 0.05, 0.02);
  for (int k = 0; k < n; ++k)
    w.particle(0.021 * (k % 4) - 0.03, 0.021 * (k / 4) - 0.02, 0.0098 + 1e-5 * k, 0.5, 0.3, -1);
  return w;
}

/// Grains on a wall of pieces have the same bits in every space.
template <class S, class Space>
void check_same_surfaces(Space const& space, int n, int triangles, std::size_t steps) {
  ball_and_wall of;
  of.friction = 0.5;
  of.restitution = 0.5;
  of.down = 9.81;
  auto const w = grains_on_pieces<S>(n, triangles);
  std::vector<body> const bodies{{2, 2, {}}};
  balls_on_walls<collide::host, S> here(collide::host(1), of, w, bodies);
  balls_on_walls<Space, S> there(space, of, w, bodies);
  here.made.simulation.steps(steps, S(1e-5));
  there.made.simulation.steps(steps, S(1e-5));
  auto const x = here.made.positions(), y = there.made.positions();
  auto const turn = here.made.simulation.template to_host<angular_velocity>(),
             turned = there.made.simulation.template to_host<angular_velocity>();
  CHECK(x != w.centres);
  CHECK(std::memcmp(x.data(), y.data(), x.size() * sizeof(S)) == 0);
  CHECK(std::memcmp(turn.data(), turned.data(), turn.size() * sizeof(S)) == 0);
}

}  // namespace tests
