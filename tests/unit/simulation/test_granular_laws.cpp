/// Laws of granular contact on the host in double, against closed forms and an integrator of one contact that shares no
/// code with the library.
#include <collide/effects/lost_motion.hpp>
#include <collide/simulation/energy.hpp>

#include "simulation/granular.hpp"

namespace {

using collide::host;
using collide::one_material;
using tests::gravity;
using tests::pi;
using tests::running;
using tests::world;
template <class... Effect>
using simulation = collide::simulation<tests::meets_mesh<host, collide::karabassi<>, double>, Effect...>;

/// Two solids that meet: sphere 0 comes down onto sphere 1, or onto a wall.
struct impact {
  collide::solid solid;
  collide::surface_pair surfaces;
  double radius, other_radius;                                          ///< of the other: 0 is a wall
  double normal_speed, tangential_speed = 0, turn = 0, other_turn = 0;  ///< turns about y
};

/// The outcome of a collision: relative velocity of centres, turns; the largest overlap and the time of contact.
struct outcome {
  double normal, tangential, turn, other_turn, overlap = 0, duration = 0;
};

/// Effective numbers, written out once more.
struct effective {
  double radius, mass, young, shear, beta, own_mass, other_mass;

  explicit effective(impact const& of) {
    auto const mass_of = [&](double r) { return of.solid.density * 4 / 3 * pi * r * r * r; };
    bool const is_wall = of.other_radius == 0;
    own_mass = mass_of(of.radius), other_mass = mass_of(of.other_radius);
    radius = is_wall ? of.radius : 1 / (1 / of.radius + 1 / of.other_radius);
    mass = is_wall ? own_mass : 1 / (1 / own_mass + 1 / other_mass);
    young = of.solid.young / (2 * (1 - of.solid.poisson * of.solid.poisson));
    shear = of.solid.young / (4 * (1 + of.solid.poisson) * (2 - of.solid.poisson));
    double const log_e = std::log(of.surfaces.restitution);
    beta = -log_e / std::sqrt(log_e * log_e + pi * pi);
  }
  /// Of an elastic impact: (5 m* v^2 / (4 K))^(2/5), K = 4/3 E* sqrt(R*).
  double largest_overlap(double speed) const {
    return std::pow(5 * mass * speed * speed / (16.0 / 3 * young * std::sqrt(radius)), 0.4);
  }
  double duration(double speed) const { return 2.94327 * largest_overlap(speed) / speed; }
};

/// One contact with a normal that stays, by the midpoint rule: Hertz, Tsuji's damping, a tangential spring 8 G* a with
/// its dashpot, which slides at Coulomb's limit.
outcome integrated(impact const& of, int steps) {
  effective const e(of);
  double const dt = e.duration(of.normal_speed) / steps, r = of.radius, other_r = of.other_radius;
  double const factor = 2 * std::sqrt(5.0 / 6) * e.beta;
  double overlap = 0, closing = of.normal_speed, slide = of.tangential_speed, w = of.turn, other_w = of.other_turn,
         spring = 0;
  outcome found{};
  do {
    double const middle = std::max(overlap + closing * dt / 2, 0.0), a = std::sqrt(e.radius * middle);
    double const normal = 4.0 / 3 * e.young * a * middle + factor * std::sqrt(2 * e.young * a * e.mass) * closing;
    double const arm = middle / 2;  // to the middle of the overlap
    double const slip =
        slide - w * (r - arm) - other_w * (other_r - arm);  // turns about y move the lowest point by -w r
    spring += slip * dt;
    double const k = 8 * e.shear * a, limit = of.surfaces.friction * std::abs(normal);
    double tangential = k * spring + factor * std::sqrt(k * e.mass) * slip;
    if (k * std::abs(spring) > limit) {
      tangential = std::copysign(limit, spring);
      if (k > 0) spring = tangential / k;
    }
    closing -= normal / e.mass * dt;
    slide -= tangential / e.mass * dt;
    w += tangential * (r - arm) / (0.4 * e.own_mass * r * r) * dt;
    if (other_r > 0) other_w += tangential * (other_r - arm) / (0.4 * e.other_mass * other_r * other_r) * dt;
    overlap += closing * dt;
    found.overlap = std::max(found.overlap, overlap);
    found.duration += dt;
  } while (overlap > 0);
  found.normal = -closing, found.tangential = slide, found.turn = w, found.other_turn = other_w;
  return found;
}

/// The same in the library.
outcome simulated(impact const& of, int steps, collide::mindlin const& tangential = {}) {
  using law = collide::granular_contact<collide::hertz, collide::mindlin>;
  using made_of = simulation<collide::polydisperse, law, collide::velocity_verlet>;
  effective const e(of);
  bool const is_wall = of.other_radius == 0;
  double const dt = e.duration(of.normal_speed) / steps;
  world<double> w;
  if (is_wall) tests::add_divided_floor(w, 50 * of.radius, 3);
  w.particle(0, 0, of.radius + of.other_radius, of.tangential_speed, 0, -of.normal_speed);
  w.radii = {of.radius};
  if (!is_wall) w.particle(0, 0, 0), w.radii.push_back(of.other_radius);
  law by{one_material(of.solid, of.surfaces), {}, tangential};
  running<made_of> made(host(1), w, collide::polydisperse{}, by, collide::velocity_verlet{});
  std::vector<double> turns{0, of.turn, 0, 0, of.other_turn, 0};
  turns.resize(w.centres.size());
  made.simulation.assign<collide::angular_velocity>(turns);
  outcome found{};
  for (int k = 0; k < 3 * steps; ++k) {
    made.simulation.step(dt);
    auto const x = made.positions();
    double const z = is_wall ? 0 : x[5], dx = is_wall ? 0 : x[3] - x[0];
    double const overlap = of.radius + of.other_radius - std::sqrt((x[2] - z) * (x[2] - z) + dx * dx);
    found.overlap = std::max(found.overlap, overlap);
    found.duration += dt;
    if (!(overlap > 0)) break;
  }
  made.simulation.step(dt);
  auto const v = made.velocities(), turn = made.simulation.to_host<collide::angular_velocity>();
  found.normal = v[2] - (is_wall ? 0 : v[5]), found.tangential = v[0] - (is_wall ? 0 : v[3]);
  found.turn = turn[1], found.other_turn = is_wall ? 0 : turn[4];
  return found;
}

/// As the integrator says, to a part of the speeds. Where it slides all the time, as Coulomb says.
void check(impact const& of, double close = 2e-4) {
  CAPTURE(of.tangential_speed);
  CAPTURE(of.turn);
  outcome const found = simulated(of, 2000), expected = integrated(of, 200000);
  double const speed = of.normal_speed + std::abs(of.tangential_speed) + std::abs(of.turn * of.radius) +
                       std::abs(of.other_turn * of.other_radius);
  CHECK(std::abs(found.normal - expected.normal) < close * speed);
  CHECK(std::abs(found.tangential - expected.tangential) < close * speed);
  if (std::abs(expected.tangential) > 0.1 * speed)
    tests::compared<double>("tangential speed after impacts at an angle, `mindlin`", "an integrator of one contact",
                            found.tangential, expected.tangential);
  CHECK(std::abs(found.turn - expected.turn) * of.radius < close * speed);
  CHECK(std::abs(found.other_turn - expected.other_turn) * of.other_radius < close * speed);
  double const e = of.surfaces.restitution, slip = of.tangential_speed - of.turn * of.radius;
  double const given = of.surfaces.friction * (1 + e) * of.normal_speed;
  if (of.other_radius == 0 && std::abs(slip) > 2 * 3.5 * given && e > 0.9) {
    CHECK(found.tangential == doctest::Approx(of.tangential_speed - std::copysign(given, slip)).epsilon(3e-3));
    CHECK(found.turn * of.radius ==
          doctest::Approx(of.turn * of.radius + 2.5 * std::copysign(given, slip)).epsilon(1e-2));
  }
}

// Y. C. Chung and J. Y. Ooi, Granular Matter 13, 2011
constexpr collide::solid glass_beads{4.8e10, 0.2, 2800}, limestone{2.5e10, 0.25, 2500}, aluminium{7e10, 0.33, 2700},
    magnesium{4e10, 0.35, 1800}, alumina{3.8e11, 0.23, 4000}, steel_alloy{2.08e11, 0.3, 7850}, nylon{2.5e9, 0.4, 1000};

}  // namespace

TEST_CASE("granular laws: impacts of Chung and Ooi 1 and 2, elastic, along the normal") {
  for (impact const& of : {impact{glass_beads, {1, 0.35}, 0.01, 0.01, 20}, impact{limestone, {1, 0.35}, 0.01, 0.01, 20},
                           impact{aluminium, {1, 0.35}, 0.1, 0, 0.2}, impact{magnesium, {1, 0.35}, 0.1, 0, 0.2}}) {
    effective const e(of);
    outcome const found = simulated(of, 4000);
    CHECK(found.normal == doctest::Approx(of.normal_speed).epsilon(1e-6).scale(0));
    CHECK(found.overlap == doctest::Approx(e.largest_overlap(of.normal_speed)).epsilon(1e-5).scale(0));
    CHECK(found.duration == doctest::Approx(e.duration(of.normal_speed)).epsilon(1e-3).scale(0));
    tests::compared<double>("largest overlap, `hertz`", "d = (15 m v² / (16 E sqrt(R)))^(2/5)", found.overlap,
                            e.largest_overlap(of.normal_speed));
    tests::compared<double>("time of contact, `hertz`", "t = 2.94327 d / v", found.duration,
                            e.duration(of.normal_speed));
    CHECK(found.turn == 0);
  }
}

TEST_CASE("granular laws: impacts of Chung and Ooi 3, any restitution at any speed") {
  for (double const restitution : {0.1, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0})
    for (double const speed : {0.01, 3.9}) {
      double const normal = simulated({alumina, {restitution, 0}, 0.0025, 0, speed}, 4000).normal;
      CHECK(normal == doctest::Approx(restitution * speed).epsilon(2e-3).scale(0));
      tests::compared<double>("rebound from a wall, `hertz`", "v = e v0", normal, restitution * speed);
    }
}

TEST_CASE("granular laws: impacts of Chung and Ooi 4, a speed at all angles") {
  for (int degrees = 5; degrees < 90; degrees += 10) {
    double const angle = degrees * pi / 180;
    check({alumina, {0.98, 0.092}, 0.0025, 0, 3.9 * std::cos(angle), 3.9 * std::sin(angle)});
  }
}

TEST_CASE("granular laws: impacts of Chung and Ooi 5, a normal speed at all angles") {
  for (double const tangent : {0.05, 0.2, 0.5, 1.0, 2.0, 3.0, 6.0})
    check({steel_alloy, {0.999, 0.3}, 1e-5, 0, 5, 5 * tangent});
}

TEST_CASE("granular laws: impacts of Chung and Ooi 6 to 8, spheres that turn") {
  for (auto const& solid : {aluminium, nylon})
    for (double const turn : {0.175, 0.75, 2.0, 8.0, 24.0}) {
      check({solid, {0.5, 0.4}, 0.1, 0, 0.2, 0, turn});
      check({solid, {0.5, 0.4}, 0.1, 0.1, 0.2, 0, turn, turn});
      check({solid, {0.5, 0.4}, 0.1, 0.5, 0.2, 0, turn});
    }
}

TEST_CASE("granular laws: angles of rebound of Tsuji, Tanaka and Ishida, and of Thornton: from sticking to sliding") {
  // The slip of rebound is the same for all solids of one Poisson's ratio; beyond 7 times the friction it slides all
  // the time.
  double last = -10;
  for (double const tangent : {0.2, 0.5, 1.0, 2.0, 2.8, 4.0, 8.0}) {
    impact of{{7e10, 0.3, 2650}, {1, 0.4}, 0.01, 0, 1, tangent};
    outcome const found = simulated(of, 2000);
    of.solid = {7e8, 0.3, 1300};
    of.radius = 0.003;
    outcome const other = simulated(of, 2000);
    double const slip = found.tangential - found.turn * 0.01, other_slip = other.tangential - other.turn * 0.003;
    CHECK(std::abs(slip - other_slip) < 0.02 * tangent);
    if (tangent >= 4) {
      CHECK(slip == doctest::Approx(tangent - 7 * 0.4).epsilon(1e-2));
      tests::compared<double>("slip of a rebound that slides, `mindlin`", "s = s0 - 7/2 mu (1 + e) v", slip,
                              tangent - 7 * 0.4);
    }
    if (tangent < 1) CHECK(slip > 0);  // the surface springs back, and once more
    if (tangent == 1 || tangent == 2) CHECK(slip < 0);
    if (tangent > 2) CHECK(slip > last);
    last = slip;
    check({{7e10, 0.3, 2650}, {1, 0.4}, 0.01, 0, 1, tangent});
  }
}

namespace {

using collide::vec3;

/// A sphere as laws see it; of what they give it, the velocities.
struct grain {
  double r;
  vec3<double> x, v, w{0, 0, 0};
  int place = 0;

  template <class Column>
  static constexpr bool has = false;  // of a clump

  double radius() const { return r; }
  int number() const { return place; }
  vec3<double> const& operator[](collide::position) const { return x; }
  vec3<double> const& operator[](collide::velocity) const { return v; }
  vec3<double> const& operator[](collide::angular_velocity) const { return w; }
  vec3<double>& operator[](collide::velocity) { return v; }
  vec3<double>& operator[](collide::angular_velocity) { return w; }
};

/// Velocity Verlet of two spheres, or of one at the wall z = 0, with a law alone: no simulation, which takes longer to
/// compile.
template <class Law>
void play(Law const& law, std::vector<grain>& grains, int steps, double dt, vec3<double> const& gravity = {0, 0, 0}) {
  using list = typename Law::remembers::list;
  using values = collide::detail::contact_values<double, list>;
  using memory = collide::detail::contact_access<list, values, double>;
  std::vector<values> kept(grains.size());
  std::vector<grain> gained(grains);
  bool touch = false;
  for (int step = 0; step <= steps; ++step) {
    for (std::size_t i = 0; i < grains.size(); ++i) {
      if (step > 0) {
        grains[i].v += gained[i].v * 0.5, grains[i].w += gained[i].w * 0.5;
        grains[i].x += grains[i].v * dt;
      }
      gained[i].v = gravity * dt, gained[i].w = vec3<double>(0, 0, 0);
    }
    double const elapsed = step > 0 ? dt : 0;
    bool still = false;
    if (grains.size() == 1) {
      grain const& g = grains[0];
      collide::mesh_overlap<double> const wall{{0, 0, 1}, g.r - g.x.z(), {0, 0, 0}, 0, collide::no_id};
      if (wall.overlap > 0 || touch) still = law.on_mesh_overlap(gained[0], g, wall, memory(kept[0], elapsed), dt);
    } else if ((grains[0].x - grains[1].x).norm() < grains[0].r + grains[1].r || touch) {
      for (std::size_t i = 0; i < 2; ++i)
        still = law.on_pair_contact(gained[i], grains[i], grains[1 - i], memory(kept[i], elapsed), dt);
    }
    if (!still) kept.assign(kept.size(), values{});
    touch = still;
    if (step == 0) continue;
    for (std::size_t i = 0; i < grains.size(); ++i) grains[i].v += gained[i].v * 0.5, grains[i].w += gained[i].w * 0.5;
  }
}

/// The oblique pair of granular.hpp with a law: velocity of the upper, turns of both about y, to the digits of a code.
template <class Law>
void check_digits(char const* code, Law const& law, std::vector<grain> grains, int steps,
                  std::array<double, 4> const& expected) {
  CAPTURE(code);
  grains[1].place = 1;
  auto const angular_momentum = [&] {  // about y, of mass 1 / r^3
    double sum = 0;
    for (auto const& g : grains)
      sum += g.r * g.r * g.r * (g.x.z() * g.v.x() - g.x.x() * g.v.z() + 0.4 * g.r * g.r * g.w.y());
    return sum;
  };
  double const before = angular_momentum();
  play(law, grains, steps, 5e-9);
  std::array<double, 4> const found{grains[0].v.x(), grains[0].v.z(), grains[0].w.y(), grains[1].w.y()};
  for (std::size_t i = 0; i < 4; ++i) CHECK(found[i] == doctest::Approx(expected[i]).epsilon(2e-11).scale(0));
  if (law.arm_shortening == 0.5) CHECK(angular_momentum() == doctest::Approx(before).epsilon(1e-11).scale(0));
  tests::compared<double>("two spheres meet aslant, each law without a simulation", code, found[0], expected[0]);
}

}  // namespace

TEST_CASE("granular laws: two bodies to the digits of LAMMPS, each tangential law") {
  // as of check_oblique_pair, friction 1, `tangential mindlin`, `mindlin_rescale`, `mindlin/force` and
  // `mindlin_rescale/force`, LAMMPS 22 Jul 2025
  std::vector<grain> const spheres{{0.001, {0, 0, 0.00101}, {0.5, 0, -1}}, {0.001, {0, 0, -0.001}, {0, 0, 0}}};
  char const* const code = "LAMMPS, all its digits";
  auto const check = [&](auto tangential, bool dashpot, std::array<double, 3> const& of) {
    static_cast<collide::mindlin&>(tangential) = tests::mindlin_of_lammps(dashpot);
    using law = collide::granular_contact<collide::hertz, decltype(tangential)>;
    law by{one_material(tests::glass, {0.5, 1}), {}, tangential};
    by.slip_shortening = 0;
    check_digits(code, by, spheres, 16000, {of[0], of[1], of[2], of[2]});
  };
  collide::mindlin_force keeps_force;
  keeps_force.rescales = false;
  check(collide::mindlin{}, false, {0.4453372191402596, -0.2518089550530938, 145.2138487147404});
  check(collide::mindlin{}, true, {0.4362556942540058, -0.2517558966676798, 168.0804474604557});
  check(collide::mindlin_rescale{}, false, {0.4443432382627577, -0.2518044448803939, 147.6754273433523});
  check(collide::mindlin_rescale{}, true, {0.4348964816666884, -0.2517460523870348, 171.4686722262372});
  check(keeps_force, false, {0.4350751046086158, -0.2518293044340877, 170.9992881366818});
  check(keeps_force, true, {0.4350173847458219, -0.2517946463823902, 171.2797014031442});
  check(collide::mindlin_force{}, false, {0.4342853741014477, -0.251825458775671, 172.9578046141266});
  check(collide::mindlin_force{}, true, {0.4338667135083716, -0.2517856722625965, 174.1504610234516});

  // `jkr 1e9 0 0.2 10 tangential ... NULL 0 1 damping velocity`, 8,000 steps: while they touch
  auto const check_sticky = [&](auto tangential, std::array<double, 3> const& of) {
    static_cast<collide::mindlin&>(tangential) = tests::mindlin_of_lammps(false);
    using law = collide::granular_contact<collide::hertz, decltype(tangential), collide::none, collide::jkr>;
    law by{one_material(tests::glass, {1, 1, 0, 10}), {}, tangential};
    by.slip_shortening = 0;
    check_digits(code, by, spheres, 8000, {of[0], of[1], of[2], of[2]});
  };
  check_sticky(collide::mindlin{}, {0.508316529970156, -0.006724424418233035, -6.482166401088941});
  check_sticky(collide::mindlin_rescale{}, {0.4990594488498106, -0.006659975454143204, 16.55642217608478});
  check_sticky(collide::mindlin_force{}, {0.4902354111965536, -0.006696635879702719, 38.709107817155});
}

TEST_CASE("granular laws: two bodies to the digits of LIGGGHTS, each law of rolling and cohesion") {
  // `pair_style gran model hertz tangential history`, `cohesion sjkr2` and `rolling_friction` epsd2, epsd or cdt,
  // LIGGGHTS 3.8; no sphere turns out of the plane or about the normal, where laws here are others
  std::vector<grain> const spheres{{0.001, {0, 0, 0.00101}, {0.5, 0, -1}, {0, -30, 0}},
                                   {0.002, {0, 0, -0.002}, {0, 0, 0}, {0, 20, 0}}};
  auto const check = [&](auto rolling, auto cohesion, std::array<double, 4> const& of) {
    using law = collide::granular_contact<collide::hertz, collide::mindlin, decltype(rolling), decltype(cohesion)>;
    check_digits("LIGGGHTS, all its digits", law{one_material(tests::glass, {0.5, 0.3, 0.1, 1e7})}, spheres, 16000, of);
  };
  using collide::sjkr;
  check(collide::epsd2{}, collide::none{},
        {0.3388440949255996, 0.331293328348387, 199.9750391243963, 51.59941157010797});
  check(collide::epsd2{}, sjkr{}, {0.2312887559928209, 0.09344591081750514, 57.9828833089167, 81.20343382997439});
  check(collide::epsd{}, collide::none{},
        {0.3560724546439026, 0.3312022444378809, 219.3581184776372, 46.97299958606687});
  check(collide::epsd{}, sjkr{}, {0.3127853794200949, 0.09222691635138046, 168.2337023103215, 58.91779982982609});
  check(collide::constant_torque{}, collide::none{},
        {0.3310762305831007, 0.331340990285463, 182.5987550824206, 53.958055373919});
  check(collide::constant_torque{}, sjkr{},
        {0.2648343073082548, 0.09302927776736523, 72.94735701534835, 72.98301192463708});
}

TEST_CASE("granular laws: two bodies to the digits of LAMMPS, linear springs with memory") {
  // as of check_oblique_pair: `granular hooke 1e5 0.5 tangential linear_history <2/7 of 1e5> 0 0.3` and 1 0.3, `damping
  // coeff_restitution`; `gran/hooke/history 1e5 NULL <gamma> NULL 0.3 1`, gamma that of a restitution of 0.5
  std::vector<grain> const spheres{{0.001, {0, 0, 0.00101}, {0.5, 0, -1}}, {0.001, {0, 0, -0.001}, {0, 0, 0}}};
  using law = collide::granular_contact<collide::linear, collide::cundall_strack>;
  law by{one_material(tests::glass, {0.5, 0.3}), {1e5}};
  by.slip_shortening = 0;
  auto const check = [&](double arm, std::array<double, 3> const& of) {
    by.arm_shortening = arm;
    check_digits("LAMMPS, all its digits", by, spheres, 16000, {of[0], of[1], of[2], of[2]});
  };
  by.tangential.keeps_length = true;
  by.tangential.damping_ratio = 0;
  check(0.5, {0.3807121875365634, -0.2512074225440892, 305.5358968826653});
  by.tangential.damping_ratio = 1;
  check(0.5, {0.427371202825937, -0.2514681273935503, 189.0910453624652});
  by.tangential = {};
  check(0, {0.4065779611621012, -0.2512984547218519, 241.3286537312479});
}

TEST_CASE("granular laws: two bodies to the digits of LAMMPS, torsion") {
  // `twisting marshall`, `twisting sds 1e-2 1e-8` with 1e-5 and 1e-6 (which slides), of spheres that turn about all
  // axes
  std::vector<grain> const spheres{{0.001, {0, 0, 0.00101}, {0.5, 0.2, -1}, {100, -30, 500}},
                                   {0.002, {0, 0, -0.002}, {0, 0, 0}, {-50, 20, -200}}};
  auto const check = [&](auto by, std::array<double, 6> const& of) {
    by.slip_shortening = 0;
    auto grains = spheres;
    check_digits("LAMMPS, all its digits", by, grains, 16000, {of[0], of[1], of[2], of[3]});
    play(by, grains, 16000, 5e-9);
    CHECK(grains[0].w.z() == doctest::Approx(of[4]).epsilon(2e-11).scale(0));
    CHECK(grains[1].w.z() == doctest::Approx(of[5]).epsilon(2e-11).scale(0));
  };
  using by_constants = collide::granular_contact<collide::hertz, collide::mindlin, collide::torsion<>>;
  by_constants constants{
      one_material(tests::glass, {0.5, 0.3}), {}, tests::mindlin_of_lammps(true), {{}, {}, 1e-2, 1e-8, 1e-5}};
  check(constants, {0.3602240567631736, 0.3303173120702729, 330.5623597107539, 42.60896833282547, 464.548685990757,
                    -198.8911283708108});
  constants.rolling.friction = 1e-6;
  check(constants, {0.3602168761282407, 0.3303173119736965, 330.6339724888292, 42.60840839510795, 496.4634978276052,
                    -199.8884926370573});
  using by_line = collide::granular_contact<collide::linear, collide::cundall_strack, collide::marshall<>>;
  by_line line{one_material(tests::glass, {0.5, 0.3}), {1e5}};
  line.tangential.keeps_length = true;
  line.tangential.damping_ratio = 1;
  line.rolling.stiffness_ratio = 2.0 / 7;
  check(line, {0.3734208221028075, 0.3308682663895946, 296.2600529751349, 40.41567176256041, 494.025934543332,
               -199.812684756564});
  line.made_of = one_material(tests::glass, {0.5, 0.003});  // it slides
  check(line, {0.500572224846605, 0.3298027224446111, -20.16655206451743, 20.61546033810719, 499.5912154008223,
               -199.987203505125});

  // of `mindlin`: a^2 / 2 of 8 G* a, which LAMMPS takes without the factor a
  collide::detail::contact_material const m({1e7, 0.3, 2500}, {1e7, 0.3, 2500}, {1, 1e9});
  collide::granular_pair<double> p{};
  p.normal = {0, 0, 1}, p.radius = 0.005, p.mass = 1, p.overlap = 1e-5, p.twist = 3;
  using remembered = collide::columns<collide::twist_angle>;
  collide::detail::contact_values<double, remembered> kept{};
  collide::detail::contact_access<remembered, decltype(kept), double> const memory(kept, 1e-3);
  auto const n = collide::hertz{}.force(p, m);
  double const a = std::sqrt(0.005 * 1e-5), shear = 1e7 / 2.6 / (2 * 1.7);
  CHECK(collide::marshall<>{}.torque(p, m, n, memory).z() == doctest::Approx(-4 * shear * a * a * a * 3e-3).scale(0));
}

TEST_CASE("granular laws: a linear spring of a time of contact gives it") {
  // the closed form of a spring and dashpot: half a period, and e
  double const mass = 2e-5, time = 3e-4, e = 0.7;
  auto const law = collide::linear::of_contact_time(time, e, mass);
  double const beta = collide::detail::contact_material({1e7, 0.3, 1}, {1e7, 0.3, 1}, {e}).damping;
  double const damping = 2 * beta * std::sqrt(law.stiffness * mass), dt = time / 100000;
  double x = 0, v = 1, at = 0;
  do {
    double const half = v - dt / 2 * (law.stiffness * x + damping * v) / mass;
    x += dt * half;
    v = (half - dt / 2 * law.stiffness * x / mass) / (1 + dt / 2 * damping / mass);
    at += dt;
  } while (x > 0);
  CHECK(at == doctest::Approx(time).epsilon(1e-4));
  CHECK(v == doctest::Approx(-e).epsilon(1e-4));
}

namespace {

/// By how much a ball creeps on a turntable in a turn, in radians, and how it turns about the vertical then.
template <class Law>
std::array<double, 2> crept(Law const& law, double spin) {
  using scene = simulation<gravity, Law, collide::moving_bodies<>, collide::velocity_verlet>;
  world<double> w;
  w.radius = 0.01;
  tests::add_divided_floor(w, 0.2, 2);
  double const rate = 2, at = 0.05, weight = 2500 * 4.0 / 3 * pi * 1e-6 * 9.81,
               deep = std::pow(weight / (4.0 / 3 * (1e6 / (2 * (1 - 0.04))) * 0.1), 2.0 / 3);
  w.particle(at, 0, 0.01 - deep, 0, rate * at);
  collide::body_motion turning;
  turning.rate = rate;
  tests::running_bodies<scene> made(host(1), w, tests::one_body(w, turning), gravity{}, law, collide::moving_bodies<>{},
                                    collide::velocity_verlet{});
  made.simulation.template assign<collide::angular_velocity>(std::vector<double>{0, 0, spin});
  int const steps = 100000;
  made.simulation.steps(steps, 2 * pi / rate / steps);
  auto const x = made.positions();
  return {std::atan2(x[1], x[0]), made.simulation.template to_host<collide::angular_velocity>()[2]};
}

}  // namespace

TEST_CASE("granular laws: springs that turn about the normal do not creep on a turntable, and torsion takes along") {
  using law = collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>;
  law by{one_material({1e6, 0.2, 2500}, {0.3, 0.5, 0.2})};
  CHECK(crept(by, 2)[0] > 3e-3);
  by.tangential.turns_about_normal = by.rolling.turns_about_normal = true;
  CHECK(std::abs(crept(by, 2)[0]) < 1e-6);
  CHECK(crept(by, 0)[0] > 1e-3);  // it does not turn along, so that the contact turns half as fast as the table
  collide::granular_contact<collide::hertz, collide::mindlin, collide::marshall<collide::epsd>> twisted{
      by.made_of, {}, by.tangential};
  twisted.rolling.rolling = by.rolling;
  auto const found = crept(twisted, 0);
  CHECK(std::abs(found[0]) < 1e-4);
  CHECK(found[1] == doctest::Approx(2).epsilon(0.01));
}

TEST_CASE("granular laws: a grain that sticks to a vertical wall rolls down it") {
  // LIGGGHTS 3.8, `cohesion sjkr2`, a wall at z = 0, gravity 9.81 along -y, 0.1 s in steps of 1e-6 s
  using law = collide::granular_contact<collide::hertz, collide::mindlin, collide::none, collide::sjkr>;
  law by{one_material({1e7, 0.3, 2500}, {0.3, 0.5, 0, 1e5})};
  std::vector<grain> grains{{0.001, {0, 0, 0.00098}, {0, 0, 0}}};
  play(by, grains, 100000, 1e-6, {0, -9.81, 0});
  double const expected = -0.6992356854335028;
  CHECK(grains[0].x.y() == doctest::Approx(-0.03496174951863656).epsilon(1e-10).scale(0));
  CHECK(grains[0].x.z() == doctest::Approx(0.0009926442825359198).epsilon(1e-13).scale(0));
  CHECK(grains[0].v.y() == doctest::Approx(expected).epsilon(1e-10).scale(0));
  CHECK(grains[0].w.x() == doctest::Approx(701.8168687324635).epsilon(1e-10).scale(0));
  CHECK(grains[0].v.y() == doctest::Approx(-5.0 / 7 * 9.81 * 0.1).epsilon(3e-3));
  tests::compared<double>("rolls down a vertical wall, `sjkr` without a simulation", "LIGGGHTS, all its digits",
                          grains[0].v.y(), expected);
  by.cohesion.wall_factor = 1;  // as of two spheres: twice the pull, four times the overlap
  double const overlap = 0.001 - grains[0].x.z();
  play(by, grains, 20000, 1e-6);
  CHECK(0.001 - grains[0].x.z() == doctest::Approx(4 * overlap).epsilon(1e-9).scale(0));
}

namespace {

/// The energy that a tangential law gives at most over random paths of load and slip that end where they began, over
/// what it has stored at most; moves change the one or the other, by small steps.
template <class Law>
double energy_of_cycles(Law const& law, double friction) {
  using list = typename Law::remembers::list;
  using values = collide::detail::contact_values<double, list>;
  collide::detail::contact_material const m({1e7, 0.3, 2500}, {1e7, 0.3, 2500}, {1, friction});
  double most = -1e300;
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    values kept{};
    collide::granular_pair<double> p{};
    p.normal = {0, 0, 1}, p.radius = p.own_radius = 0.005, p.mass = 1, p.overlap = 1e-5;
    vec3<double> at(0, 0, 0), force(0, 0, 0);
    double given = 0, stored = 0, sum = 0;
    auto const move = [&](double overlap, vec3<double> const& to, int steps) {
      vec3<double> const step = (to - at) * (1.0 / steps);
      double const deeper = (overlap - p.overlap) / steps, dt = 1e-3;
      for (int i = 0; i < steps; ++i) {
        p.overlap += deeper, at += step, p.slip = step * (1 / dt);
        auto const n = collide::hertz{}.force(p, m);
        collide::detail::contact_access<list, values, double> const memory(kept, dt);
        vec3<double> const next = law.force(p, m, n, memory);
        given += (force + next).dot(step) / 2;
        force = next;
        stored = std::max(stored, sum = law.energy(p, m, n, memory));
      }
    };
    for (int k = 0; k < 20; ++k) {
      if (uniform(engine) < 0.5)
        move(1e-6 + 1e-4 * uniform(engine), at, 20);
      else
        move(p.overlap, {2e-6 * (uniform(engine) - 0.5), 2e-6 * (uniform(engine) - 0.5), 0}, 20);
    }
    move(p.overlap, {0, 0, 0}, 20);
    move(1e-5, {0, 0, 0}, 20);
    most = std::max(most, (given + sum) / stored);
  }
  return most;
}

}  // namespace

TEST_CASE("granular laws: no cycle of load and slip makes energy with mindlin_force, and some do with others") {
  auto const of = [](auto law, double friction) {
    law.damping = collide::tangential_damping::none;
    return energy_of_cycles(law, friction);
  };
  collide::mindlin_force keeps_force;
  keeps_force.rescales = false;
  for (double const friction : {1e9, 0.3, 0.01}) {
    CHECK(of(collide::mindlin_force{}, friction) < 1e-13);
    CHECK(energy_of_cycles(collide::mindlin_force{}, friction) < 1e-13);
  }
  CHECK(of(collide::mindlin{}, 1e9) > 0.5);
  CHECK(of(collide::mindlin_rescale{}, 1e9) > 0.5);
  CHECK(of(keeps_force, 1e9) > 0.5);
}

TEST_CASE("granular laws: grazing impacts make no energy") {
  // https://github.com/lammps/lammps/issues/5007
  for (double const restitution : {0.5, 1.0})
    for (double const friction : {0.1, 0.5, 2.0})
      for (double const degrees : {0.2, 1.0, 5.0, 20.0}) {
        impact const of{{1e8, 0.3, 2500},
                        {restitution, friction},
                        0.001,
                        0,
                        std::sin(degrees * pi / 180),
                        std::cos(degrees * pi / 180)};
        for (auto const& variant : {collide::mindlin{}, tests::mindlin_of_lammps(true)}) {
          outcome const found = simulated(of, 1000, variant);
          double const after = found.normal * found.normal + found.tangential * found.tangential +
                               0.4 * std::pow(found.turn * of.radius, 2);
          CHECK(after < 1 + 1e-6);
        }
      }
}

TEST_CASE("granular laws: epsd is a spring that slides, with its dashpot below the limit") {
  using values = collide::detail::contact_values<double, collide::columns<collide::rolling_torque>>;
  collide::epsd const law;
  collide::detail::contact_material const m({1e7, 0.2, 2500}, {1e7, 0.2, 2500}, {1, 0.5, 0.1});
  collide::granular_pair<double> p{};
  p.normal = {0, 0, 1};
  p.radius = p.own_radius = 0.01;
  p.overlap = 1e-5, p.mass = 0.01;
  p.rolling_inertia = 1.4 * 0.01 * 1e-4;
  auto n = collide::hertz{}.force(p, m);
  n.secant = n.elastic / p.overlap;
  double const a = std::sqrt(0.01 * 1e-5), k_n = 4.0 / 3 * (1e7 / (2 * (1 - 0.04))) * a;
  double const k = 2.25 * k_n * 0.1 * 0.1 * 1e-4, limit = 0.1 * 0.01 * k_n * 1e-5;
  double const dash = 2 * 0.3 * std::sqrt(p.rolling_inertia * k), rate = 0.5, dt = 1e-5;
  values kept;
  collide::detail::contact_access<collide::columns<collide::rolling_torque>, values, double> const memory(kept, dt);
  double spring = 0;
  int slid = 0;
  for (int step = 0; step < 3000; ++step) {
    double const w = step < 2000 ? rate : -rate;  // it turns back
    p.turning = p.own_turning = {0, w, 0};
    double const y = law.torque(p, m, n, memory).y();
    spring += k * w * dt;
    bool const slides = std::abs(spring) > limit;
    if (slides) spring = std::copysign(limit, spring), ++slid;
    CHECK(y == doctest::Approx(-(spring + (slides ? 0 : dash * w))).epsilon(1e-9));
  }
  CHECK(slid > 100);
}

namespace {

/// A ball of 1 cm that rolls on a floor, as a spring resists it: by how far its weight presses it in.
constexpr double ball_mass = 2500 * 4.0 / 3 * pi * 1e-6, ball_weight = ball_mass * 9.81;
double pressed_in() { return std::pow(ball_weight / (4.0 / 3 * (1e7 / (2 * (1 - 0.04))) * std::sqrt(0.01)), 2.0 / 3); }

/// How far a ball rolls that begins with a speed, and how it turns in the end.
template <class Rolling>
std::array<double, 2> rolled(double speed) {
  using law = collide::granular_contact<collide::hertz, collide::mindlin, Rolling>;
  world<double> w;
  w.radius = 0.01;
  tests::add_divided_floor(w, 1, 4);
  w.particle(0, 0, 0.01 - pressed_in(), speed);
  running<simulation<gravity, law, collide::velocity_verlet>> made(
      host(1), w, gravity{}, law{one_material({1e7, 0.2, 2500}, {0.3, 0.5, 0.05})}, collide::velocity_verlet{});
  made.simulation.template assign<collide::angular_velocity>(std::vector<double>{0, speed / 0.01, 0});
  made.simulation.steps(60000, 2e-5);
  return {made.positions()[0], made.simulation.template to_host<collide::angular_velocity>()[1]};
}

}  // namespace

namespace {

/// The same with `epsd`, of a ball that rolls without slip, by small steps of the angle: I w dw/da = -(k a + c w) until
/// the spring k a is at its limit; then the limit alone slows it; in the end the spring takes it back.
double rolled_against_spring(double speed) {
  double const r = 0.01, mu = 0.05, inertia = 1.4 * ball_mass * r * r, limit = mu * r * ball_weight;
  double const k = 2.25 * ball_weight / pressed_in() * mu * mu * r * r, c = 2 * 0.3 * std::sqrt(inertia * k);
  double const slides_at = limit / k;
  double w = speed / r;
  constexpr int steps = 10000;
  for (int n = 0; n < steps; ++n) {
    double const angle = (n + 0.5) * slides_at / steps;
    w -= (k * angle / w + c) / inertia * slides_at / steps;
  }
  // to where it stops, and back by what the spring is long
  return r * (slides_at + w * w * inertia / (2 * limit) - slides_at);
}

}  // namespace

TEST_CASE("granular laws: a ball that rolls stops where rolling friction says") {
  // torque mu_r R N against inertia 1.4 m R^2 about the point of contact
  double const far = 0.1 * 0.1 * 1.4 / (2 * 0.05 * 9.81);
  double const constant = rolled<collide::constant_torque>(0.1)[0];
  CHECK(constant == doctest::Approx(far).epsilon(0.01).scale(0));
  auto const [at, turn] = rolled<collide::epsd>(0.1);
  CHECK(at == doctest::Approx(rolled_against_spring(0.1)).epsilon(0.01).scale(0));
  tests::compared<double>("rolling to a stop, `constant_torque`", "s = 7 v² / (10 mu_r g)", constant, far);
  CHECK(std::abs(turn) < 1e-3);
  CHECK(rolled<collide::none>(0.1)[0] == doctest::Approx(0.1 * 60000 * 2e-5).epsilon(1e-3));
}

TEST_CASE("granular laws: jkr is the force of Johnson, Kendall and Roberts, in contact and apart") {
  using values = collide::detail::contact_values<double, collide::columns<collide::contact_radius>>;
  collide::detail::contact_material const m({1e7, 0.2, 2500}, {1e7, 0.2, 2500}, {1, 0, 0, 0.05});
  double const young = 1e7 / (2 * (1 - 0.04)), gamma = 0.05, r = 0.002;
  double const least = std::cbrt(pi * gamma * r * r / (4 * young));  // radius of contact where they part
  values kept;
  collide::detail::contact_access<collide::columns<collide::contact_radius>, values, double> const memory(kept, 1e-6);
  double pull = 0;
  for (double a = least * 1.001; a < 40 * least; a *= 1.05) {
    collide::granular_pair<double> p{};
    p.radius = r;
    p.overlap = a * a / r - 2 * std::sqrt(pi * gamma * a / young);
    auto n = collide::hertz{}.force(p, m);
    collide::jkr{}.pull(n, p, m, memory);
    double const expected = 4 * young * a * a * a / (3 * r) - 2 * pi * a * a * std::sqrt(4 * gamma * young / (pi * a));
    CHECK(n.contact_radius == doctest::Approx(a).epsilon(1e-6).scale(0));
    CHECK(n.elastic == doctest::Approx(expected).epsilon(1e-5).scale(0));
    tests::compared<double>("force of `jkr`", "F = 4 E a³ / (3 R) - 2 pi a² sqrt(4 gamma E / (pi a))", n.elastic,
                            expected);
    CHECK(n.pull_off == doctest::Approx(3 * pi * gamma * r).scale(0));
    pull = std::max(pull, -n.elastic);
  }
  CHECK(pull == doctest::Approx(3 * pi * gamma * r).epsilon(3e-3).scale(0));
}

namespace {

/// The pull at which a ball leaves a wall, or a ball that is held, over 3 pi gamma R*.
template <class Cohesion>
double pull_that_parts(double gamma) {
  using law = collide::granular_contact<collide::hertz, collide::none, collide::none, Cohesion>;
  world<double> w;
  w.radius = 0.001;
  tests::add_divided_floor(w, 0.01, 3);
  w.particle(0.0001, 0.0002, 0.001 - 1e-9);
  running<simulation<gravity, law, collide::velocity_verlet>> made(
      host(1), w, gravity{0, 0, 0}, law{one_material({1e6, 0.2, 2500}, {0.1, 0, 0, gamma})},
      collide::velocity_verlet{});
  double const mass = 2500 * 4 / 3 * pi * 1e-9, largest = 3 * pi * gamma * 0.001, dt = 2e-6;
  made.simulation.steps(4000, dt);
  for (int k = 100; k < 300; ++k) {
    made.simulation.template effect<gravity>().z = k * 0.005 * largest / mass;
    made.simulation.steps(1600, dt);
    if (made.positions()[2] > 0.00102) return k * 0.005;
  }
  return 10;
}

}  // namespace

TEST_CASE("granular laws: jkr holds a ball at a wall until 3 pi gamma R pull, dmt until 4 pi gamma R") {
  double const of_jkr = pull_that_parts<collide::jkr>(0.05), of_dmt = pull_that_parts<collide::dmt>(0.05);
  CHECK(of_jkr == doctest::Approx(1).epsilon(0.02));
  CHECK(of_dmt == doctest::Approx(4.0 / 3).epsilon(0.02));
  double const unit = pi * 0.05 * 0.001;  // pi gamma R
  tests::compared<double>("pull that parts from a wall, `jkr`", "F = 3 pi gamma R", 3 * unit * of_jkr, 3 * unit);
  tests::compared<double>("pull that parts from a wall, `dmt`", "F = 4 pi gamma R", 3 * unit * of_dmt, 4 * unit);
}

TEST_CASE("granular laws: momentum closes") {
  using law = collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>;
  world<double> w = tests::falling_grains<double>(3, false);
  w.corners.clear();
  for (std::size_t i = 0; i < w.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) w.velocities[3 * i + c] -= 20 * (w.centres[3 * i + c] - (c == 2 ? 0.03 : 0));
  running<simulation<law, collide::velocity_verlet>> made(
      host(1), w, law{one_material({1e7, 0.2, 2500}, {0.5, 0.3, 0.1})}, collide::velocity_verlet{});
  double before[3] = {}, after[3] = {};
  for (std::size_t i = 0; i < w.velocities.size(); ++i) before[i % 3] += w.velocities[i];
  made.simulation.steps(2000, 1e-5);
  auto const v = made.velocities();
  double changed = 0;
  for (std::size_t i = 0; i < v.size(); ++i) after[i % 3] += v[i], changed += std::abs(v[i] - w.velocities[i]);
  CHECK(changed > 1);
  for (int c = 0; c < 3; ++c) CHECK(std::abs(after[c] - before[c]) < 1e-12);
}

namespace {

/// Four grains and one on top of them.
world<double> small_pile() {
  world<double> w;
  w.radius = 0.01;
  tests::add_divided_floor(w, 1, 4);
  for (int k = 0; k < 4; ++k) w.particle(0.0199 * (k % 2), 0.0199 * (k / 2), 0.01);
  w.particle(0.00995, 0.00995, 0.0242);
  return w;
}

}  // namespace

TEST_CASE("granular laws: energy and contacts of a scene, by hand") {
  using law =
      collide::granular_contact<collide::hertz, collide::mindlin, collide::none, collide::none, collide::materials<3>>;
  world<double> w;
  w.radii = {0.01, 0.02, 0.01};
  w.particle(0, 0, 0.1, 2);
  w.particle(0.0299, 0, 0.1);
  w.particle(0.0299, 0, 0.1275);  // a quarter of its radius in the other
  law by;
  by.made_of = tests::benchmark_materials();
  running<simulation<collide::polydisperse, gravity, law, collide::velocity_verlet>> made(
      host(1), w, collide::polydisperse{}, gravity{0, 0, -10}, by, collide::velocity_verlet{});
  made.simulation.assign<collide::material>(std::vector<std::uint8_t>{0, 2, 1});
  made.simulation.assign<collide::angular_velocity>(std::vector<double>{0, 3, 0, 0, 0, 0, 0, 0, 0});
  double const ball = 4.0 / 3 * pi * 1e-6;
  auto const found = collide::energy(made.simulation);
  CHECK(found.kinetic == doctest::Approx(0.5 * 2500 * ball * 4).scale(0));
  CHECK(found.rotational == doctest::Approx(0.2 * 2500 * ball * 1e-4 * 9).scale(0));
  CHECK(found.potential == doctest::Approx(10 * ball * (2500 * 0.1 + 8 * 7200 * 0.1 + 2000 * 0.1275)));
  double const root = std::sqrt(0.02 / 3);
  CHECK(found.elastic == doctest::Approx(8.0 / 15 * root *
                                         (1036729857.820 * std::pow(1e-4, 2.5) + 519596199.525 * std::pow(0.0025, 2.5)))
                             .epsilon(1e-8));
  auto const report = collide::contact_report(made.simulation);
  CHECK(report.contacts == 2);
  CHECK(report.coordination == doctest::Approx(4.0 / 3));
  CHECK(report.deep == 1);
  CHECK(report.largest_overlap == doctest::Approx(0.25));
  CHECK_THROWS_WITH_AS(report.require_shallow(), doctest::Contains("1 contacts overlap by more than a fifth"),
                       collide::error);
  collide::contact_counts{}.require_shallow();
}

TEST_CASE("granular laws: only solids that particles are of limit the step") {
  using law =
      collide::granular_contact<collide::hertz, collide::none, collide::none, collide::none, collide::materials<3>>;
  using scene = simulation<collide::polydisperse, law, collide::velocity_verlet>;
  auto const rayleigh = [](collide::solid const& s, double r) {
    double const shear = s.young / (2 * (1 + s.poisson));
    return pi * r * std::sqrt(s.density / shear) / (0.1631 * s.poisson + 0.8766);
  };
  law by;
  by.made_of = tests::benchmark_materials();
  by.made_of.wall_material = 2;
  world<double> w;
  w.radii = {0.001, 0.004, 0.02};
  tests::add_floor(w, 1, 3);
  for (int k = 0; k < 3; ++k) w.particle(0.1 * k, 0, 0.03);
  running<scene> made(host(1), w, collide::polydisperse{}, by, collide::velocity_verlet{});
  auto& s = made.simulation;
  auto const longest = [&] { return 4 * collide::largest_time_step(s); };
  CHECK(longest() == doctest::Approx(rayleigh(tests::glass, 0.001)).scale(0));
  s.step(0.99 * longest());
  CHECK_THROWS_AS(s.step(1.01 * longest()), collide::error);
  s.assign<collide::material>(std::vector<std::uint8_t>{1, 0, 2});
  CHECK(longest() == doctest::Approx(rayleigh(tests::soft, 0.001)).scale(0));
  s.assign<collide::material>(std::vector<std::uint8_t>{1, 0, 200});  // as of the last
  CHECK(longest() == doctest::Approx(rayleigh(tests::soft, 0.001)).scale(0));
  s.assign<collide::radius>(std::vector<double>{0.01, 0.008, 0.01});
  CHECK(longest() == doctest::Approx(rayleigh(tests::steel, 0.01)).scale(0));
  std::stringstream file;
  collide::save(s, file);
  running<scene> other(host(1), w, collide::polydisperse{}, by, collide::velocity_verlet{});
  collide::load(other.simulation, file);
  CHECK(collide::largest_time_step(other.simulation) == longest() / 4);
}

TEST_CASE("granular laws: energy never grows") {
  using law = collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>;
  for (double const restitution : {0.3, 1.0}) {
    world<double> w = tests::falling_grains<double>(4, false);
    running<simulation<gravity, law, collide::velocity_verlet>> made(
        host(1), w, gravity{}, law{one_material({1e7, 0.2, 2500}, {restitution, 0.4, 0.1})},
        collide::velocity_verlet{});
    double const start = collide::energy(made.simulation).total();
    double last = start;
    for (int k = 0; k < 40; ++k) {
      made.simulation.steps(200, 1e-5);
      double const now = collide::energy(made.simulation).total();
      CHECK(now < start * (1 + 1e-4));
      last = now;
    }
    CHECK(last < 0.97 * start);
  }
}

TEST_CASE("granular laws: a pile at rest stays") {
  using law = collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>;
  law const by{one_material({1e7, 0.2, 2500}, {0.2, 0.5, 0.1})};
  world<double> const w = small_pile();
  running<simulation<gravity, law, collide::velocity_verlet>> awake(host(1), w, gravity{}, by,
                                                                    collide::velocity_verlet{});
  awake.simulation.steps(60000, 2e-5);
  auto const before = awake.positions();
  awake.simulation.steps(20000, 2e-5);
  auto const after = awake.positions();
  for (std::size_t i = 0; i < before.size(); ++i) CHECK(std::abs(after[i] - before[i]) / 0.4 < 1e-9 * 0.01);

  running<simulation<collide::sleep, gravity, law, collide::velocity_verlet>> asleep(
      host(1), w, collide::sleep{1e-3, 100}, gravity{}, by, collide::velocity_verlet{});
  asleep.simulation.steps(20000, 2e-5);
  auto const slept = asleep.positions();
  asleep.simulation.steps(100000, 2e-5);
  CHECK(std::memcmp(slept.data(), asleep.positions().data(), slept.size() * sizeof(double)) == 0);
}

namespace {

/// The slope of a heap that a column of grains makes: twice its mean height over its mean distance from the axis, less
/// that of a layer, of a cone 4/3 (height - radius) over the base's radius.
template <class Rolling>
double slope_of_heap() {
  using law = collide::granular_contact<collide::hertz, collide::mindlin, Rolling>;
  world<double> w;
  w.radius = 0.005;
  tests::add_divided_floor(w, 1, 2);
  for (int k = 0; k < 300; ++k) {
    double const shift = 1e-4 * (k % 7);
    w.particle((k % 5 - 2) * 0.0101 + shift, (k / 5 % 5 - 2) * 0.0101 - shift, 0.006 + k / 25 * 0.0101);
  }
  running<simulation<gravity, law, collide::velocity_verlet>> made(
      host(1), w, gravity{}, law{one_material({1e6, 0.2, 2500}, {0.3, 0.5, 0.3})}, collide::velocity_verlet{});
  double const dt = largest_time_step(made.simulation);
  made.simulation.steps(static_cast<std::size_t>(1.0 / dt), dt);
  auto const x = made.positions();
  double height = 0, away = 0;
  for (std::size_t i = 0; i < x.size(); i += 3) height += x[i + 2] - 0.005, away += std::hypot(x[i], x[i + 1]);
  return 2 * height / away;
}

}  // namespace

TEST_CASE("granular laws: a heap is steeper with rolling resistance") {
  double const with = slope_of_heap<collide::epsd>(), without = slope_of_heap<collide::none>();
  MESSAGE("slopes with and without: ", with, ", ", without);
  CHECK(with > 0.1);
  CHECK(with > 1.5 * without);
}

namespace {

/// By how much a grain of glass, of numbers `S`, overlaps a floor of steel 9 cm from the origin at rest, over what
/// Hertz says; and how many have lost a step's motion on their way there.
template <class S>
std::array<double, 2> weighed_far_away() {
  using law =
      collide::granular_contact<collide::hertz, collide::mindlin, collide::none, collide::none, collide::materials<3>>;
  using scene = collide::simulation<tests::meets_mesh<host, collide::karabassi<>, S>, gravity, law,
                                    collide::lost_motion, collide::velocity_verlet>;
  law by;
  by.made_of = tests::benchmark_materials();
  by.made_of.set_pair(0, 2, {0.01, 0.2});  // so that it rests soon
  by.made_of.wall_material = 2;
  double const floor_at = -0.0902431, r = 0.001, mass = 2500 * 4.0 / 3 * pi * 1e-9;
  double const expected = std::pow(mass * 9.81 / (4.0 / 3 * 1036729857.820 * std::sqrt(r)), 2.0 / 3);
  world<S> w;
  w.radius = S(r);
  tests::add_floor(w, 0.01, 3);
  for (std::size_t k = 2; k < w.corners.size(); k += 3) w.corners[k] = S(floor_at);
  w.particle(0.001, 0.0005, floor_at + r - 2 * expected);
  running<scene> made(host(1), w, gravity{}, by, collide::lost_motion{}, collide::velocity_verlet{});
  made.simulation.steps(100, S(5e-7));
  auto const lost = double(collide::lost_particles(made.simulation));
  made.simulation.steps(20000, S(5e-7));
  double const overlap = double(w.radius) - (double(made.positions()[2]) - double(S(floor_at)));
  return {overlap / expected, lost};
}

}  // namespace

TEST_CASE("granular laws: the overlap of a grain of glass 9 cm away is resolved in double, and not in float") {
  auto const [found, lost] = weighed_far_away<double>();
  CHECK(std::abs(found - 1) < 1e-4);
  CHECK(lost == 0);
  auto const [coarse, lost_of_float] = weighed_far_away<float>();
  CHECK(std::abs(coarse - 1) > 1e-2);
  CHECK(lost_of_float == 1);
}
