/// Walls that move, as bodies with motions of one's own and as meshes that are set again, in a space; instantiated by
/// test_moving_walls.cpp and test_bodies_cuda.cpp.
#pragma once

#include "simulation/bodies.hpp"

namespace tests {

/// A wall that is set again a little farther on before each step pushes what friction holds on the floor.
template <class NarrowPhase, class S, class Space>
void check_wall_set_again(Space const& space, double speed) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, gravity, bounce, friction>;
  world<S> w;
  w.radius = S(0.1);
  add_floor(w, 5, 3);
  add_quad(w, {0, -5, -5}, {0, 5, -5}, {0, 5, 5}, {0, -5, 5});
  w.particle(0.1, 0.2, 0.1);
  w.particle(0.3, -0.7, 0.1);
  running<simulation> made(space, w, gravity{}, bounce{0}, friction{0.5, 0.5});
  double const dt = 1e-3;
  double x = 0;
  placed<S> mesh(space, w.corners);
  for (int k = 0; k < 1000; ++k) {
    x += speed * dt;
    for (std::size_t i = w.corners.size() - 18; i < w.corners.size(); i += 3) w.corners[i] = S(x);
    mesh = placed<S>(space, w.corners);
    made.simulation.set_mesh(collide::triangle_soup(mesh.data(), mesh.size() / 9));
    made.simulation.step(S(dt));
    made.simulation.space().synchronize();
  }
  auto const found = made.positions();
  CHECK(double(found[0]) == doctest::Approx(x + 0.1).epsilon(1e-3));
  CHECK(double(found[3]) == doctest::Approx(std::max(x + 0.1, 0.3)).epsilon(1e-3));
  for (std::size_t const i : {std::size_t{2}, std::size_t{5}})
    CHECK(double(found[i]) == doctest::Approx(0.1).epsilon(1e-3));
}

/// A body that moves slowly pushes what friction holds on the floor.
template <class NarrowPhase, class S, class Space>
void check_slow_wall(Space const& space, double speed) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, gravity, bounce, friction, moving_bodies<>>;
  world<S> w;
  w.radius = S(0.1);
  add_floor(w, 5, 3);
  std::size_t const floor = triangles_of(w);
  add_quad(w, {0, -5, -5}, {0, 5, -5}, {0, 5, 5}, {0, -5, 5});
  w.particle(0.1, 0.2, 0.1);
  body_motion wall;
  wall.velocity[0] = speed;
  running_bodies<simulation> made(space, w, {body{floor, 2, wall}}, gravity{}, bounce{0}, friction{0.5, 0.5},
                                  moving_bodies<>{});
  made.simulation.steps(1000, S(1e-3));
  CHECK(double(made.positions()[0]) == doctest::Approx(speed + 0.1).epsilon(1e-3));
}

/// Motions of one's own: body k goes its own way.
struct own_motion {
  body_motion of_first;

  COLLIDE_HD collide::body_state operator()(std::size_t k, double time) const {
    if (k == 0) return of_first(time);
    collide::body_state s;
    s.at.position[0] = 0.1 * static_cast<double>(k) * time;
    s.moving.linear[0] = 0.1 * static_cast<double>(k);
    return s;
  }
};

/// A function object gives the motion of each body, and in the same bits as the family if it says the same.
template <class NarrowPhase, class Space>
void check_own_motion(Space const& space) {
  world<double> w;
  w.radius = 0.1;
  std::vector<body> bodies;
  for (int k = 0; k < 4; ++k) {
    w.triangle({0, 2.0 * k - 0.5, -0.5, 0, 2.0 * k + 0.5, -0.5, 0, 2.0 * k, 1});
    bodies.push_back({std::size_t(k), 1, {}});
    w.particle(0.102, 2.0 * k, 0);
  }
  own_motion own;
  own.of_first.amplitude[0] = 0.03;
  own.of_first.frequency = 1;
  own.of_first.axis[0] = 1;
  own.of_first.rate = 0.3;
  using detector = meets_mesh<Space, NarrowPhase, double>;
  using with_own = collide::simulation<detector, bounce, moving_bodies<own_motion>>;
  running_bodies<with_own> made(space, w, bodies, bounce{1}, moving_bodies<own_motion>{own});
  made.simulation.steps(1000, 1e-3);
  auto const v = made.velocities();
  for (std::size_t k = 1; k < 4; ++k) CHECK(v[3 * k] == doctest::Approx(0.2 * double(k)).epsilon(1e-9));
  CHECK(made.bodies()[3].at.position[0] == doctest::Approx(0.3));

  bodies[0].motion = own.of_first;
  for (std::size_t k = 1; k < 4; ++k) bodies[k].motion.velocity[0] = 0.1 * double(k);
  using with_family = collide::simulation<detector, bounce, moving_bodies<>>;
  running_bodies<with_family> family(space, w, bodies, bounce{1}, moving_bodies<>{});
  family.simulation.steps(1000, 1e-3);
  CHECK(family.velocities()[0] == v[0]);
  CHECK(v[0] > 0.1);
}

/// The flight of a screw around the x axis, and the trough that it turns in.
template <class S>
void add_screw(world<S>& w, double pitch, double radius, int turns) {
  constexpr int parts = 64;
  auto const at = [&](int i, double r) {
    double const u = 2 * pi * i / parts;
    return std::array<double, 3>{pitch * i / parts, r * std::cos(u), r * std::sin(u)};
  };
  for (int i = -parts; i < turns * parts; ++i)
    add_quad(w, at(i, 0.05), at(i, radius), at(i + 1, radius), at(i + 1, 0.05));
}
template <class S>
void add_trough(world<S>& w, double radius, double end) {
  constexpr int parts = 48;
  for (int i = 0; i < parts; ++i) {
    double const a = pi * (1 + double(i) / parts), b = pi * (1 + double(i + 1) / parts);
    double const ya = radius * std::cos(a), za = radius * std::sin(a), yb = radius * std::cos(b),
                 zb = radius * std::sin(b);
    add_quad(w, {-1, ya, za}, {end, ya, za}, {end, yb, zb}, {-1, yb, zb});
  }
}

/// A screw moves what lies in its trough by its pitch in each turn, less what that slips.
template <class NarrowPhase, class Space>
void check_screw(Space const& space) {
  world<double> w;
  w.radius = 0.05;
  double const pitch = 0.4, dt = 1e-3, rate = 3;
  add_screw(w, pitch, 0.5, 5);
  std::size_t const flight = triangles_of(w);
  add_trough(w, 0.51, 4);
  for (int k = 0; k < 3; ++k) w.particle(0.15 + pitch * k, 0, -0.459);
  body_motion turning;
  turning.axis[0] = 1, turning.axis[2] = 0;
  turning.rate = -rate;
  using simulation =
      collide::simulation<meets_mesh<Space, NarrowPhase, double>, gravity, bounce, friction, moving_bodies<>>;
  for (double const mu : {0.1, 0.3}) {
    running_bodies<simulation> made(space, w, {body{0, flight, turning}}, gravity{}, bounce{0}, friction{mu, mu},
                                    moving_bodies<>{});
    auto const turn = static_cast<std::size_t>(2 * pi / rate / dt);
    made.simulation.steps(turn, dt);  // each has come to the flight behind it
    auto const before = made.positions();
    made.simulation.steps(2 * turn, dt);
    auto const after = made.positions();
    for (std::size_t i = 0; i < 3; ++i) {
      double const moved = after[3 * i] - before[3 * i];
      CHECK(moved < 2.02 * pitch);
      CHECK(moved > 1.95 * pitch);
    }
  }
}

/// The work of the bodies, of what `reaction` has summed and their velocities, is that on the particles: they are
/// elastic.
template <class NarrowPhase, class Space>
void check_work(Space const& space) {
  world<double> w;
  w.radius = 0.05;
  add_box(w, 1);
  std::size_t const box = triangles_of(w);
  add_quad(w, {-0.7, 0, -0.7}, {0.7, 0, -0.7}, {0.7, 0, 0.7}, {-0.7, 0, 0.7});  // a paddle that turns
  add_quad(w, {-0.9, -2, -2}, {-0.9, 2, -2}, {-0.9, 2, 2}, {-0.9, -2, 2});      // a piston
  std::mt19937 engine(11);
  std::uniform_real_distribution<double> uniform(0.1, 0.7);
  for (int i = 0; i < 50; ++i) w.particle(uniform(engine), uniform(engine), uniform(engine) - 0.4, uniform(engine));
  body_motion paddle, piston;
  paddle.rate = 0.8;
  piston.velocity[0] = 0.1;
  double const density = 3, mass = density * 4 / 3 * pi * std::pow(0.05, 3);
  using simulation =
      collide::simulation<meets_mesh<Space, NarrowPhase, double>, bounce, collide::reaction, moving_bodies<>>;
  collide::reaction_sums sums(space, 2, 1e-15);
  running_bodies<simulation> made(space, w, {body{box, 2, paddle}, body{box + 2, 2, piston}}, bounce{1},
                                  sums.effect(density), moving_bodies<>{});
  made.simulation.steps(3000, 1e-3);
  auto const energy = [&](std::vector<double> const& v) {
    double sum = 0;
    for (double const c : v) sum += mass / 2 * c * c;
    return sum;
  };
  auto const got = sums.read(made.simulation.space());
  double const by_paddle = -got[0].angular[2] * paddle.rate, by_piston = -got[1].linear[0] * piston.velocity[0];
  double const gained = energy(made.velocities()) - energy(w.velocities);
  CHECK(std::abs(by_paddle) > 0.2 * gained);
  CHECK(by_piston > 0.02 * gained);
  CHECK(by_paddle + by_piston == doctest::Approx(gained).epsilon(2e-3));
}

/// A mesh that deforms, set again before each step with the velocities of its vertices, hits and carries as they say.
template <class NarrowPhase, class S, class Space>
void check_deforming(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, bounce, friction, moving_bodies<>>;
  world<S> w;
  w.radius = S(0.05);
  add_quad(w, {0, -1, 0}, {1, -1, 0}, {1, 1, 0}, {0, 1, 0});
  w.particle(0.25, 0.1, 0.06);
  w.particle(0.75, -0.2, 0.06);
  double const rate = 0.5, dt = 1e-3;
  simulation made(space, bounce{1}, friction{0, 0}, moving_bodies<>{});
  placed<S> const centres(space, w.centres), speeds(space, w.velocities);
  made.set(collide::spheres_xyz(centres.data(), w.size(), w.radius), speeds.data());
  for (int k = 1; k <= 200; ++k) {  // one edge rises: z = rate t x
    std::vector<S> corners = w.corners, velocities(corners.size());
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      corners[i + 2] = S(rate * k * dt * double(corners[i]));
      velocities[i + 2] = S(rate * double(corners[i]));
    }
    placed<S> const mesh(space, corners), moving(space, velocities);
    made.set_mesh(collide::triangle_soup(mesh.data(), 2), {}, moving.data());
    made.step(S(dt));
    made.space().synchronize();
  }
  auto const v = made.template to_host<velocity>();
  CHECK(double(v[2]) == doctest::Approx(2 * rate * 0.25).epsilon(0.03));
  CHECK(double(v[5]) == doctest::Approx(2 * rate * 0.75).epsilon(0.03));

  using carried = collide::simulation<meets_mesh<Space, NarrowPhase, S>, gravity, bounce, friction, moving_bodies<>>;
  carried rubber(space, gravity{}, bounce{0}, friction{0.5, 0.5}, moving_bodies<>{});
  std::vector<S> lying = w.centres, still(6), stretching(w.corners.size());
  lying[2] = lying[5] = w.radius;
  for (std::size_t i = 1; i < stretching.size(); i += 3) stretching[i] = S(0.1 * double(w.corners[i - 1]));
  placed<S> const there(space, lying), none(space, still), shear(space, stretching), mesh(space, w.corners);
  rubber.set(collide::spheres_xyz(there.data(), w.size(), w.radius), none.data());
  rubber.set_mesh(collide::triangle_soup(mesh.data(), 2), {}, shear.data());
  rubber.steps(500, S(dt));
  auto const u = rubber.template to_host<velocity>();
  CHECK(double(u[1]) == doctest::Approx(0.025).epsilon(1e-4));
  CHECK(double(u[4]) == doctest::Approx(0.075).epsilon(1e-4));
  CHECK(std::abs(double(u[0])) < 1e-6);

  using plain = collide::simulation<meets_mesh<Space, NarrowPhase, S>, bounce>;
  plain no_effect(space, bounce{});
  CHECK_THROWS_AS(no_effect.set_mesh(collide::triangle_soup(mesh.data(), 2), {}, shear.data()), collide::error);
}

/// Swept particles in a box that turns far in a step: bodies get what particles lose, and each triangle its part.
template <class Space>
void check_momentum_of_turning_box(Space const& space) {
  world<double> w;
  w.radius = 0.05;
  add_box(w, 1);
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-0.9, 0.9);
  for (int i = 0; i < 100; ++i) w.particle(uniform(engine), uniform(engine), uniform(engine));
  body_motion turning;
  turning.axis[0] = 0.4;
  turning.rate = 5;
  turning.pivot[1] = 0.3;
  double const density = 3, mass = density * 4 / 3 * pi * std::pow(0.05, 3);
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi_swept<>, double>, bounce, friction,
                                         collide::reaction, moving_bodies<>>;
  collide::reaction_sums sums(space, 1, 1e-15, 12);
  running_bodies<simulation> made(space, w, one_body(w, turning), bounce{0.5}, friction{0.3, 0.3}, sums.effect(density),
                                  moving_bodies<>{});
  made.simulation.steps(50, 0.02);
  auto const v = made.velocities();
  auto const got = sums.read(made.simulation.space());
  auto const of_triangles = sums.read_triangles(made.simulation.space());
  CHECK(of_triangles.size() == 12);
  for (std::size_t k = 0; k < 3; ++k) {
    double lost = 0, of_all = 0, moment = 0, size = 0;
    for (std::size_t i = k; i < v.size(); i += 3) lost -= mass * v[i], size += mass * std::abs(v[i]);
    for (auto const& t : of_triangles) of_all += t.linear[k], moment += t.angular[k];
    CHECK(got[0].linear[k] == doctest::Approx(lost).epsilon(1e-9).scale(size));
    CHECK(of_all == doctest::Approx(got[0].linear[k]).epsilon(1e-12).scale(size));
    CHECK(moment == doctest::Approx(got[0].angular[k]).epsilon(1e-12).scale(size));
  }
}

}  // namespace tests
