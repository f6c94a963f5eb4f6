/// Bodies that move in a space, against closed forms; instantiated by test_bodies.cpp and test_bodies_cuda.cpp.
#pragma once

#include <collide/effects/adhesion.hpp>
#include <collide/effects/bodies.hpp>
#include <collide/effects/friction.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/effects/sleep.hpp>
#include <collide/effects/spin.hpp>

#include "simulation/simulation.hpp"

namespace tests {

using collide::body;
using collide::body_motion;
using collide::bounce;
using collide::friction;
using collide::gravity;
using collide::moving_bodies;
using collide::spin;

constexpr double pi = 3.141592653589793;

/// A simulation in which the world and its bodies have been placed.
template <class Simulation>
class running_bodies : public running<Simulation> {
 public:
  using S = typename Simulation::scalar;

  template <class... Effect>
  running_bodies(typename Simulation::execution_space space, world<S> const& w, std::vector<body> const& bodies,
                 Effect... effects)
      : running<Simulation>(space, w, effects...), mesh_(space, w.corners) {
    this->simulation.set_mesh(collide::triangle_soup(mesh_.data(), mesh_.size() / 9), bodies);
  }

  std::vector<collide::body_state> bodies() const {
    return this->simulation.bodies().to_host(this->simulation.space());
  }
  collide::body_report report() const { return this->simulation.bodies().report(this->simulation.space()); }

 private:
  placed<S> mesh_;
};

template <class S>
std::size_t triangles_of(world<S> const& w) {
  return w.corners.size() / 9;
}

/// All triangles, with a motion.
template <class S>
std::vector<body> one_body(world<S> const& w, body_motion const& motion) {
  return {body{0, triangles_of(w), motion}};
}

template <class S>
void add_quad(world<S>& w, std::array<double, 3> a, std::array<double, 3> b, std::array<double, 3> c,
              std::array<double, 3> d) {
  w.triangle({a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]});
  w.triangle({a[0], a[1], a[2], c[0], c[1], c[2], d[0], d[1], d[2]});
}

/// A closed box |x|, |y|, |z| <= half.
template <class S>
void add_box(world<S>& w, double h) {
  add_quad(w, {-h, -h, -h}, {h, -h, -h}, {h, h, -h}, {-h, h, -h});
  add_quad(w, {-h, -h, h}, {h, -h, h}, {h, h, h}, {-h, h, h});
  add_quad(w, {-h, -h, -h}, {h, -h, -h}, {h, -h, h}, {-h, -h, h});
  add_quad(w, {-h, h, -h}, {h, h, -h}, {h, h, h}, {-h, h, h});
  add_quad(w, {-h, -h, -h}, {-h, h, -h}, {-h, h, h}, {-h, -h, h});
  add_quad(w, {h, -h, -h}, {h, h, -h}, {h, h, h}, {h, -h, h});
}

/// A cylinder around the y axis, without ends.
template <class S>
void add_drum(world<S>& w, double radius, double half, int sides) {
  for (int i = 0; i < sides; ++i) {
    double const a = 2 * pi * i / sides, b = 2 * pi * (i + 1) / sides;
    std::array<double, 3> const p{radius * std::cos(a), -half, radius * std::sin(a)};
    std::array<double, 3> const q{radius * std::cos(b), -half, radius * std::sin(b)};
    add_quad(w, p, q, {q[0], half, q[2]}, {p[0], half, p[2]});
  }
}

/// Dropped on a belt, what does not bounce has its speed after v / (mu g), to one step, and keeps it.
template <class NarrowPhase, class S, class Space>
void check_belt(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, gravity, bounce, friction, moving_bodies<>>;
  world<S> w;
  w.radius = S(0.1);
  add_floor(w, 20, 5);
  w.particle(0.123, 0.234, 0.1);
  double const v = 1.5, mu = 0.4, dt = 1e-3;
  body_motion belt;
  belt.belt[0] = v;
  running_bodies<simulation> made(space, w, one_body(w, belt), gravity{}, bounce{0}, friction{mu, mu},
                                  moving_bodies<>{});
  auto const steps = static_cast<std::size_t>(v / (mu * 9.81) / dt);
  made.simulation.steps(steps - 1, S(dt));
  CHECK(double(made.velocities()[0]) < v - 0.5 * mu * 9.81 * dt);
  compared<S>("dropped on a belt", "v = mu g t", double(made.velocities()[0]), mu * 9.81 * double(steps - 1) * dt);
  made.simulation.steps(2, S(dt));
  CHECK(double(made.velocities()[0]) == doctest::Approx(v).epsilon(1e-6));
  S const x = made.positions()[0];
  made.simulation.steps(1000, S(dt));
  CHECK(double(made.velocities()[0]) == doctest::Approx(v).epsilon(1e-6));
  CHECK(double(made.positions()[0] - x) == doctest::Approx(v * 1000 * dt).epsilon(1e-4));
  CHECK(double(made.positions()[2]) == doctest::Approx(0.1).epsilon(1e-5));
}

/// A piston gives what it hits elastically 2 u, and what it hits plastically u.
template <class NarrowPhase, class S, class Space>
void check_piston(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, bounce, moving_bodies<>>;
  world<S> w;
  w.radius = S(0.1);
  w.triangle({0, -5, -5, 0, 5, -5, 0, 0, 9});
  w.particle(1, 0, 0);
  w.particle(1, 1, 0, -1);
  double const u = 2;
  body_motion moving;
  moving.velocity[0] = u;
  for (double const e : {1.0, 0.0}) {
    running_bodies<simulation> made(space, w, one_body(w, moving), bounce{e}, moving_bodies<>{});
    made.simulation.steps(1000, S(1e-3));
    CHECK(double(made.velocities()[0]) == doctest::Approx((1 + e) * u).epsilon(1e-5));
    compared<S>("hit by a piston", "v = (1 + e) u", double(made.velocities()[0]), (1 + e) * u);
    CHECK(double(made.velocities()[3]) == doctest::Approx((1 + e) * u + e * 1).epsilon(1e-5));
    CHECK(made.report().fast_steps == 0);
    CHECK(made.bodies()[0].at.position[0] == doctest::Approx(u).epsilon(1e-6));
  }
}

/// A body far from what it turns around goes far even in steps of small angles, and hits what is in its way.
template <class Space>
void check_small_angles(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi_swept<>, double>, bounce, moving_bodies<>>;
  double const arm = 1e9;
  for (double const angle : {1e-9, 1e-8, 2e-8, 5e-8, 1e-6}) {
    for (double const before : {0.0, 0.7}) {  // turns
      world<double> w;
      w.radius = 0.1;
      w.triangle({arm - 1, 0, -1, arm + 1, 0, -1, arm, 0, 1});
      double const cosine = std::cos(2 * pi * before), sine = std::sin(2 * pi * before), y = 0.5 * angle * arm;
      w.particle(arm * cosine - y * sine, arm * sine + y * cosine, 0);
      body_motion turning;
      turning.rate = angle;
      turning.swing = 2 * pi * before;
      turning.phase = 0.25;  // so it is `swing` in the beginning, and stays so
      running_bodies<simulation> made(space, w, one_body(w, turning), bounce{1}, moving_bodies<>{});
      made.simulation.steps(1, 1.0);
      auto const v = made.velocities();
      CHECK(std::hypot(double(v[0]), double(v[1])) == doctest::Approx(2 * angle * arm).epsilon(1e-3));
    }
  }
}

/// A mesh with more bodies than there are sums is refused, and nothing is lost.
template <class Space>
void check_bodies_without_sums(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi<>, float>, bounce, collide::reaction, moving_bodies<>>;
  world<float> w;
  w.radius = 0.1f;
  for (double const x : {-9.0, 0.0}) w.triangle({x, -5, -5, x, 5, -5, x, 0, 9});
  w.particle(0.05, 0, 0, -1);
  collide::reaction_sums sums(space, 1, 1e-9, 1);
  running_bodies<simulation> made(space, w, {{0, 1, {}}, {1, 1, {}}}, bounce{1}, sums.effect(1000), moving_bodies<>{});
  CHECK_THROWS_WITH_AS(made.simulation.step(1e-3f),
                       doctest::Contains("the mesh has more bodies than reaction_sums was made for"), collide::error);
  CHECK(double(made.velocities()[0]) == doctest::Approx(-1));
  CHECK(sums.counts(space) == std::vector<std::int64_t>(12, 0));
  placed<float> const mesh(space, w.corners);
  made.simulation.set_mesh(collide::triangle_soup(mesh.data(), 2), {{0, 2, {}}});
  made.simulation.step(1e-3f);
  CHECK(double(made.velocities()[0]) == doctest::Approx(1));
}

/// A floor that is shaken throws what lies on it if and only if A w^2 > g.
template <class NarrowPhase, class Space>
void check_vibrated_floor(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, double>, gravity, bounce, moving_bodies<>>;
  world<double> w;
  w.radius = 0.1;
  add_floor(w, 5, 6);
  for (int i = 0; i < 20; ++i) w.particle(-3 + 0.3 * i, 0.21 * (i % 7), 0.1);
  double const hz = 5, dt = 1e-4, rate = 2 * pi * hz;
  for (double const strength : {0.9, 1.2}) {
    body_motion shaken;
    shaken.amplitude[2] = strength * 9.81 / (rate * rate);
    shaken.frequency = hz;
    running_bodies<simulation> made(space, w, one_body(w, shaken), gravity{}, bounce{0.3}, moving_bodies<>{});
    made.simulation.steps(2000, dt);  // it has begun with a jerk, as the floor has a velocity at once
    double highest = 0, lowest = 1;
    for (int k = 0; k < 60; ++k) {
      made.simulation.steps(100, dt);
      double const floor = made.bodies()[0].at.position[2];
      auto const x = made.positions();
      for (std::size_t i = 0; i < w.size(); ++i) {
        highest = std::max(highest, x[3 * i + 2] - floor - 0.1);
        lowest = std::min(lowest, x[3 * i + 2] - floor - 0.1);
      }
    }
    CHECK(lowest > -1e-4);
    if (strength < 1) {
      CHECK(highest < 1e-4);
    } else {
      CHECK(highest > 5e-4);
    }
  }
}

/// On a turntable, what lies at r flies off if and only if w^2 r > mu g, and rides along else.
template <class NarrowPhase, class Space>
void check_turntable(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, NarrowPhase, double>, gravity, bounce, friction, moving_bodies<>>;
  world<double> w;
  w.radius = 0.05;
  add_floor(w, 8, 5);
  double const mu = 0.5, rate = 2, limit = mu * 9.81 / (rate * rate), dt = 1e-3;
  for (double const part : {0.3, 0.9, 0.97, 1.03, 1.2, 2.0}) {
    double const r = part * limit;
    w.particle(0, r, 0.05, -rate * r);  // with the table
  }
  body_motion turning;
  turning.rate = rate;
  running_bodies<simulation> made(space, w, one_body(w, turning), gravity{}, bounce{0}, friction{mu, mu},
                                  moving_bodies<>{});
  made.simulation.steps(1000, dt);
  auto const x = made.positions();
  for (std::size_t i = 0; i < w.size(); ++i) {
    double const r0 = w.centres[3 * i + 1], r = std::hypot(x[3 * i], x[3 * i + 1]);
    if (i < 3) {
      CHECK(r == doctest::Approx(r0).epsilon(1e-5));
      double const angle = std::atan2(-x[3 * i], x[3 * i + 1]);
      CHECK(angle == doctest::Approx(rate * 1000 * dt).epsilon(1e-3));
      compared<double>("rides on a turntable", "angle = w t", angle, rate * 1000 * dt);
      compared<double>("stays at its place on a turntable", "r = r0 if w² r <= mu g", r, r0);
    } else {
      CHECK(r > r0 * 1.01);
    }
  }
}

/// In a drum that turns slowly, what has no spin is carried up to arctan(mu) and slides there; what spins rolls at the
/// bottom.
template <class NarrowPhase, class Space>
void check_drum(Space const& space) {
  world<double> w;
  w.radius = 0.05;
  add_drum(w, 1, 0.5, 720);
  w.particle(-0.949 * std::sin(0.34), 0, -0.949 * std::cos(0.34));  // on its way up
  body_motion turning;
  turning.axis[1] = 1, turning.axis[2] = 0;
  double const mu = 0.4, dt = 1e-3;
  auto const angle_of = [](auto& made) {
    auto const x = made.positions();
    return std::atan2(-x[0], -x[2]) * 180 / pi;  // the bottom moves towards -x
  };
  using detector = meets_mesh<Space, NarrowPhase, double>;
  using sliding = collide::simulation<detector, gravity, bounce, friction, moving_bodies<>>;
  turning.rate = 0.01;  // stick and slip: it swings by about rate / sqrt(g / r)
  running_bodies<sliding> slides(space, w, one_body(w, turning), gravity{}, bounce{0}, friction{mu, mu},
                                 moving_bodies<>{});
  slides.simulation.steps(10000, dt);
  CHECK(angle_of(slides) == doctest::Approx(std::atan(mu) * 180 / pi).epsilon(0.5 / 21.8));
  compared<double>("carried up in a drum", "angle = arctan mu", angle_of(slides) * pi / 180, std::atan(mu));
  using rolling = collide::simulation<detector, gravity, bounce, friction, spin, moving_bodies<>>;
  turning.rate = 0.5;
  w.centres = {0, 0, -0.949};
  running_bodies<rolling> rolls(space, w, one_body(w, turning), gravity{}, bounce{0}, friction{mu, mu}, spin{},
                                moving_bodies<>{});
  rolls.simulation.steps(6000, dt);
  CHECK(std::abs(angle_of(rolls)) < 6);
}

/// Axes of any length turn a body alike.
template <class Space>
void check_axes(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space>, moving_bodies<>>;
  world<float> w;
  add_box(w, 1);
  body_motion turning;
  turning.rate = 0.7;
  auto const poses = [&](double x, double z) {
    turning.axis[0] = x, turning.axis[2] = z;
    running_bodies<simulation> made(space, w, one_body(w, turning), moving_bodies<>{});
    made.simulation.steps(10, 0.125f);
    CHECK(made.simulation.bodies().report(space).refused_poses == 0);
    auto const at = made.bodies()[0].at;
    return std::vector<double>(at.rotation, at.rotation + 4);
  };
  auto const as_usual = poses(3, 4);
  CHECK(as_usual[0] == doctest::Approx(std::cos(0.7 * 1.25 / 2)));
  CHECK(as_usual[1] == doctest::Approx(0.6 * std::sin(0.7 * 1.25 / 2)));
  for (double const unit : {0x1p-1060, 0x1p-700, 0x1p-20, 0x1p30, 0x1p700, 0x1p1020})
    CHECK((poses(3 * unit, 4 * unit) == as_usual));
  for (double const unit : {1e-170, 1e170, 1e-300, 1e300, 5e-324})
    CHECK(poses(0, unit)[3] == doctest::Approx(std::sin(0.7 * 1.25 / 2)));
  CHECK(poses(0, 0)[0] == 1);
}

/// How a box turns and shakes.
inline body_motion shaking(double speed) {
  body_motion m;
  m.axis[0] = 0.3, m.axis[1] = -0.5, m.axis[2] = 1;
  m.rate = 3 * speed;
  m.amplitude[0] = 0.1 * speed, m.amplitude[2] = 0.2 * speed;
  m.frequency = 2;
  m.pivot[0] = 0.2;
  return m;
}

/// A closed box that turns and shakes keeps what is in it.
template <class NarrowPhase, class S, class Space>
void check_turning_box(Space const& space, double speed, double dt, std::size_t particles, std::size_t steps) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, S>, gravity, bounce, friction, moving_bodies<>>;
  world<S> w;
  w.radius = S(0.05);
  add_box(w, 1);
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(-0.9, 0.9);
  for (std::size_t i = 0; i < particles; ++i) {
    w.particle(uniform(engine), uniform(engine), uniform(engine), uniform(engine), uniform(engine), uniform(engine));
  }
  running_bodies<simulation> made(space, w, one_body(w, shaking(speed)), gravity{}, bounce{0.5}, friction{0.3, 0.3},
                                  moving_bodies<>{});
  std::size_t outside = 0;
  for (int part = 0; part < 10; ++part) {
    made.simulation.steps(steps / 10, S(dt));
    auto const at = collide::detail::frame_pose_of(made.bodies()[0].at);
    auto const x = made.positions();
    for (std::size_t i = 0; i < particles; ++i) {
      collide::vec3<double> const own =
          at.to_local(collide::vec3<double>(double(x[3 * i]), double(x[3 * i + 1]), double(x[3 * i + 2])));
      outside += own.cwiseAbs().maxCoeff() > 1;
    }
  }
  CHECK(outside == 0);
}

/// Balls in a corner of a box stay there while it turns by a third of a radian in a step, and hits them several times:
/// where friction holds them is a place on the box, which goes on between two of these hits. Where such a ball was
/// seen that got out.
template <class S, class Space>
void check_corner_of_turning_box(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, collide::karabassi_swept<>, S>, gravity, bounce, friction, moving_bodies<>>;
  using vector = collide::vec3<double>;
  constexpr std::size_t balls = 2000;
  world<S> w;
  w.radius = S(0.05);
  add_box(w, 1);
  for (std::size_t i = 0; i < balls; ++i) w.particle(0, 0, 0);
  running_bodies<simulation> made(space, w, one_body(w, shaking(10)), gravity{}, bounce{0.5}, friction{0.3, 0.3},
                                  moving_bodies<>{});
  made.simulation.step(S(0.94));
  std::mt19937 engine(11);
  std::normal_distribution<double> normal;
  std::vector<S> centres, velocities;
  auto const before = collide::detail::frame_pose_of(made.bodies()[0].at);
  for (std::size_t i = 0; i < balls; ++i) {
    vector const own(0.949992526, 0.950000024, -0.949972961), velocity(19.9148178, -28.1422405, 0.162010446);
    vector const at = before.to_world(own);
    for (int k = 0; k < 3; ++k) {
      centres.push_back(S(at[k] + 1e-5 * normal(engine)));
      velocities.push_back(S(velocity[k] + 1e-2 * normal(engine)));
    }
  }
  placed<S> const x(space, centres), v(space, velocities);
  made.simulation.template assign<collide::position>(x.data());
  made.simulation.template assign<collide::velocity>(v.data());
  made.simulation.step(S(1e-2));
  auto const after = collide::detail::frame_pose_of(made.bodies()[0].at);
  auto const found = made.positions();
  std::size_t outside = 0;
  for (std::size_t i = 0; i < found.size(); i += 3)
    outside += after.to_local(vector(found[i], found[i + 1], found[i + 2])).cwiseAbs().maxCoeff() > 1;
  CHECK(outside == 0);
}

/// A ball that a falling plate carries down is caught by the floor that the plate falls through. The plate was above
/// the floor when they touched, but is below it when the ball gets there.
template <class S, class Space>
void check_floor_below_falling_plate(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, collide::karabassi_swept<>, S>, bounce, moving_bodies<>>;
  world<S> w;
  w.radius = S(0.05);
  add_quad(w, {0, -1, 0}, {1, -1, 0}, {1, 1, 0}, {0, 1, 0});
  std::size_t const plate = triangles_of(w);
  add_quad(w, {-1, -1, -0.3}, {1, -1, -0.3}, {1, 1, -0.3}, {-1, 1, -0.3});
  body_motion falling, slow;
  falling.velocity[2] = -80;
  slow.velocity[0] = 0.1;
  for (double const x : {0.3, 0.5}) w.particle(x, 0.1, 0.1, 0, 0, -100);
  for (bool const floor_moves : {false, true}) {
    std::vector<body> bodies{body{0, plate, falling}};
    if (floor_moves) bodies.push_back(body{plate, 2, slow});
    running_bodies<simulation> made(space, w, bodies, bounce{0}, moving_bodies<>{});
    made.simulation.step(S(1e-2));
    auto const x = made.positions();
    for (std::size_t const i : {std::size_t{2}, std::size_t{5}})
      CHECK(double(x[i]) == doctest::Approx(-0.25).epsilon(1e-3));
  }
}

/// Particles that stick to a drum go round with it, until it turns so fast that nothing holds them.
template <class NarrowPhase, class Space>
void check_riding(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, NarrowPhase, double>, gravity, bounce, collide::adhesion, moving_bodies<>>;
  world<double> w;
  w.radius = 0.05;
  add_drum(w, 1, 0.5, 64);
  w.particle(0, 0, -0.95);
  double const dt = 1e-3, rate = 2;
  for (double const hold : {30.0, 5.0}) {
    body_motion turning;
    turning.axis[1] = 1, turning.axis[2] = 0;
    turning.rate = rate;
    running_bodies<simulation> made(space, w, one_body(w, turning), gravity{}, bounce{0}, collide::adhesion{hold},
                                    moving_bodies<>{});
    made.simulation.steps(10, dt);
    auto const from = made.positions();
    auto const begin = collide::detail::frame_pose_of(made.bodies()[0].at);
    made.simulation.steps(static_cast<std::size_t>(2 * pi / rate / dt), dt);
    auto const to = made.positions();
    auto const end = collide::detail::frame_pose_of(made.bodies()[0].at);
    using vector = collide::vec3<double>;
    double const slip =
        (begin.to_local(vector(from[0], from[1], from[2])) - end.to_local(vector(to[0], to[1], to[2]))).norm();
    if (hold > 20) {
      CHECK(slip < 1e-6);
    } else {
      CHECK(slip > 1e-2);  // on its way up the weight pulls along the wall, by 9.81
    }
  }
}

/// A body that moves wakes what it may touch, and nothing else.
template <class NarrowPhase, class Space>
void check_waking(Space const& space) {
  using simulation =
      collide::simulation<meets_mesh<Space, NarrowPhase, float>, collide::sleep, gravity, bounce, moving_bodies<>>;
  world<float> w;
  w.radius = 0.1f;
  add_floor(w, 8, 8);
  std::size_t const floor = triangles_of(w);
  w.triangle({-4, -1, 0, -4, 1, 0, -4, 0, 2});  // a blade
  w.particle(0, 0, 0.1);
  w.particle(-3, 0.1, 0.1);
  w.particle(0, 5, 0.1);
  body_motion blade;
  blade.velocity[0] = 1;
  running_bodies<simulation> made(space, w, {body{floor, 1, blade}}, collide::sleep{0.05, 20}, gravity{}, bounce{0},
                                  moving_bodies<>{});
  made.simulation.steps(500, 1e-3f);
  for (std::uint8_t const slow : made.simulation.template to_host<collide::slow_steps>()) CHECK(slow >= 20);
  made.simulation.steps(1500, 1e-3f);
  auto const slow = made.simulation.template to_host<collide::slow_steps>();
  auto const x = made.positions();
  CHECK(slow[0] >= 20);
  CHECK(x[0] == 0);
  CHECK(slow[1] == 0);
  CHECK(double(x[3]) == doctest::Approx(-2 + 0.1).epsilon(1e-3));
  CHECK(slow[2] >= 20);
}

/// Some bodies: each moves its own triangles, what is in no body rests.
template <class NarrowPhase, class Space>
void check_several_bodies(Space const& space) {
  using simulation = collide::simulation<meets_mesh<Space, NarrowPhase, double>, bounce, moving_bodies<>>;
  world<double> w;
  w.radius = 0.1;
  std::vector<body> bodies;
  w.triangle({3, -500, -500, 3, 500, -500, 3, 0, 900});  // rests
  for (int k = 0; k < 64; ++k) {
    w.triangle({0, 1.0 * k, -0.2, 0, 1.0 * k + 0.3, -0.2, 0, 1.0 * k + 0.15, 0.4});
    body_motion m;
    m.velocity[0] = 0.01 * (k + 1);
    bodies.push_back({std::size_t(k) + 1, 1, m});
    w.particle(0.102, k + 0.15, 0);
  }
  running_bodies<simulation> made(space, w, bodies, bounce{1}, moving_bodies<>{});
  made.simulation.steps(1000, 1e-3);
  auto const v = made.velocities();
  for (std::size_t k = 0; k < 64; ++k)
    CHECK(v[3 * k] == doctest::Approx(k == 0 || k == 1 ? v[3 * k] : 0.02 * double(k + 1)).epsilon(1e-9));
  made.simulation.steps(2500, 1e-3);
  auto const x = made.positions();
  for (std::size_t k = 0; k < 64; ++k) CHECK(x[3 * k] < 2.9 + 1e-9);
}

/// The same bits, whoever is first.
template <class NarrowPhase, class Space, class Other>
void check_same_bits(Space const& space, Other const& other) {
  world<float> w;
  w.radius = 0.05f;
  add_box(w, 1);
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(-0.9, 0.9);
  for (int i = 0; i < 200; ++i) w.particle(uniform(engine), uniform(engine), uniform(engine));
  body_motion m;
  m.axis[0] = 1;
  m.rate = 4;
  m.amplitude[1] = 0.2;
  m.frequency = 3;
  body_motion lid;
  lid.velocity[2] = -0.1;
  std::vector<body> const bodies = {{0, 10, m}, {10, 2, lid}};
  auto const after = [&](auto const& there) {
    using there_type = std::decay_t<decltype(there)>;
    using simulation = collide::simulation<meets_mesh<there_type, NarrowPhase, float>, gravity, bounce, friction, spin,
                                           moving_bodies<>>;
    running_bodies<simulation> made(there, w, bodies, gravity{}, bounce{0.5}, friction{0.4, 0.4}, spin{0.01},
                                    moving_bodies<>{});
    made.simulation.steps(500, 1e-3f);
    return made.positions();
  };
  CHECK(after(space) == after(other));
}

/// Bodies get all that particles lose, in the same bits however many lanes; particles that lie are weighed.
template <class Space, class Other>
void check_reaction(Space const& space, Other const& other) {
  world<double> w;
  w.radius = 0.1;
  add_floor(w, 5, 4);
  std::size_t const floor = triangles_of(w);
  w.triangle({1, -9, -9, 1, 9, -9, 1, 0, 20});
  for (int i = 0; i < 100; ++i) w.particle(-3 + 0.03 * i, 0.02 * i - 1, 0.1, 1 + 0.01 * i);
  body_motion wall;
  wall.velocity[0] = -0.5;
  double const density = 3, mass = density * 4 / 3 * pi * 1e-3, dt = 1e-3;
  auto const after = [&](auto const& there) {
    using simulation = collide::simulation<meets_mesh<std::decay_t<decltype(there)>, collide::karabassi<>, double>,
                                           gravity, bounce, friction, collide::reaction, moving_bodies<>>;
    collide::reaction_sums sums(there, 2, 1e-15);
    running_bodies<simulation> made(there, w, {body{0, floor, {}}, body{floor, 1, wall}}, gravity{}, bounce{0.5},
                                    friction{0.1, 0.1}, sums.effect(density), moving_bodies<>{});
    made.simulation.steps(4000, dt);
    auto const found = sums.read(made.simulation.space());
    auto const v = made.velocities();
    double gained[3] = {0, 0, 0};
    for (std::size_t i = 0; i < v.size(); ++i) gained[i % 3] += mass * (v[i] - w.velocities[i]);
    gained[2] += 100 * mass * 9.81 * 4000 * dt;
    for (int k = 0; k < 3; ++k) {
      double const given = found[0].linear[k] + found[1].linear[k] + found[2].linear[k];
      CHECK(given == doctest::Approx(-gained[k]).epsilon(1e-9).scale(mass));
    }
    CHECK(found[0].linear[2] < -0.99 * 100 * mass * 9.81 * 4000 * dt);  // friction at the wall bears the rest
    CHECK(found[1].linear[0] > 0.1 * mass);
    CHECK(found[2].linear[2] == 0);
    return found;
  };
  auto const a = after(space), b = after(other);
  CHECK(std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0);
}

}  // namespace tests
