/// Calls in the wrong order, and numbers that make no sense: what the errors say.
#include <cmath>
#include <limits>
#include <string>

#include <doctest/doctest.h>

#include <collide/bucket.cuh>
#include <collide/checks/validate.hpp>
#include <collide/core/moving_spheres.hpp>
#include <collide/effects/absorb.hpp>
#include <collide/effects/adhesion.hpp>
#include <collide/effects/bounce.hpp>
#include <collide/effects/bounds.hpp>
#include <collide/effects/contact_forces.hpp>
#include <collide/effects/drag.hpp>
#include <collide/effects/emit.hpp>
#include <collide/effects/friction.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/effects/sleep.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/effects/spin.hpp>
#include <collide/effects/wind.hpp>
#include <collide/simulation.cuh>

using namespace collide;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN(),
                 infinity = std::numeric_limits<double>::infinity();
float const corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, centres[] = {0.25f, 0.25f, 0.25f};

mesh_view<float> mesh() { return triangle_soup(corners, 1); }
sphere_view<float> spheres() { return spheres_xyz(centres, 1, 0.5f); }

/// The text of the error; empty if there is none.
template <class F>
std::string said_by(F const& f) {
  try {
    f();
  } catch (error const& e) {
    return e.what();
  }
  return {};
}

/// The error of a step with an effect of these parameters.
template <class... Before, class Effect>
std::string said_with(Effect effect) {
  simulation<detector<bucket>, Before..., Effect> scene(host(1), Before()..., effect);
  scene.set(spheres());
  scene.set_mesh(mesh());
  return said_by([&] { scene.step(0.125f); });
}

/// Refuses memory.
class empty_resource final : public std::pmr::memory_resource {
  void* do_allocate(std::size_t, std::size_t) override { throw std::bad_alloc(); }
  void do_deallocate(void*, std::size_t, std::size_t) override {}
  bool do_is_equal(std::pmr::memory_resource const& other) const noexcept override { return this == &other; }
};

}  // namespace

TEST_CASE("misuse: a query before build, and after one that failed") {
  detector<bucket> one;
  auto const query = [&] { one.query(spheres(), count()); };
  CHECK(said_by(query) == "collide: detector: query needs a mesh: call build before it");
  one.build({});
  CHECK(said_by(query) == "");
  one.build(mesh());
  CHECK(one.query(spheres(), count()).total() == 1);

  empty_resource nothing;
  detector<bucket> poor(host(1, &nothing));
  CHECK_THROWS_AS(poor.build(mesh()), std::bad_alloc);
  CHECK(said_by([&] { poor.query(spheres(), count()); }) != "");
}

TEST_CASE("misuse: the radius that build gets") {
  detector<bucket> one;
  one.build(mesh(), 0.5);  // a double for a detector of floats
  CHECK(one.query(spheres(), count()).total() == 1);
  for (double const radius : {not_a_number, -1.0}) {
    CHECK(said_by([&] { one.build(mesh(), float(radius)); }) ==
          "collide: detector: the radius passed to build is negative or NaN");
  }
  CHECK(one.query(spheres(), count()).total() == 1);
  one.build(mesh(), std::numeric_limits<float>::infinity());
  CHECK(one.query(spheres(), count()).total() == 1);
}

TEST_CASE("misuse: a step without particles, without a mesh, and of a time that is none") {
  simulation<detector<bucket>, gravity, bounce> scene;
  auto const step = [&](double dt) { return said_by([&] { scene.step(float(dt)); }); };
  CHECK(step(0.125) == "collide: simulation: step needs particles: call set before it");
  scene.set(spheres());
  CHECK(step(0.125) == "collide: simulation: an effect of the scene touches the mesh: call set_mesh before step");
  scene.set_mesh({});
  CHECK(step(0.125) == "");
  for (double const dt : {not_a_number, infinity, 0.0, -0.125})
    CHECK(step(dt) == "collide: simulation: the time dt of a step is finite and above 0");
  simulation<detector<bucket>, gravity> free;
  free.set(spheres());
  CHECK(said_by([&] { free.step(0.125f); }) == "");
  int const back = -5;
  CHECK(said_by([&] { free.steps(static_cast<std::size_t>(back), 0.125f); }) ==
        "collide: simulation: the number of steps is negative");
}

TEST_CASE("misuse: materials and laws of granular contact") {
  using collide::solid;
  auto const of = [](solid const& s, collide::surface_pair const& p) {
    return said_by([&] { collide::one_material(s, p); });
  };
  CHECK(of({1e7, 0.3, 1000}, {0.5, 0.3}) == "");
  std::string const modulus = "collide: materials: Young's modulus and density of a solid are above 0, and finite",
                    ratio = "collide: materials: Poisson's ratio is above -1, and at most 0.5",
                    restitution = "collide: materials: the coefficient of restitution is above 0, and at most 1",
                    amounts =
                        "collide: materials: friction, rolling friction and cohesion of a pair are not negative, "
                        "and finite";
  for (double const wrong : {0.0, -1.0, infinity, not_a_number}) {
    CHECK(of({wrong, 0.3, 1000}, {}) == modulus);
    CHECK(of({1e7, 0.3, wrong}, {}) == modulus);
  }
  for (double const wrong : {-1.0, 0.6, not_a_number}) CHECK(of({1e7, wrong, 1000}, {}) == ratio);
  for (double const wrong : {0.0, 1.1, not_a_number}) CHECK(of({1e7, 0.3, 1000}, {wrong}) == restitution);
  for (double const wrong : {-0.1, infinity, not_a_number}) {
    CHECK(of({1e7, 0.3, 1000}, {0.5, wrong}) == amounts);
    CHECK(of({1e7, 0.3, 1000}, {0.5, 0, wrong}) == amounts);
    CHECK(of({1e7, 0.3, 1000}, {0.5, 0, 0, wrong}) == amounts);
  }
  collide::materials<2> two;
  two.set(0, {1e7, 0.3, 1000});
  CHECK(said_by([&] {
          two.set(2, {1e7, 0.3, 1000});
        }) == "collide: materials: the number of a solid is from 0 to N - 1");
  CHECK(said_by([&] { two.set_pair(0, 1, {}); }) == "collide: materials: set both solids before their pair");
  two.set(1, {1e7, 0.3, 1000});
  two.set_pair(0, 0, {});
  two.set_pair(1, 1, {});
  using law =
      collide::granular_contact<collide::hertz, collide::none, collide::none, collide::none, collide::materials<2>>;
  simulation<detector<bucket>, law> grains(collide::host(1), law{two});
  grains.set_mesh({});
  grains.set(spheres());
  CHECK(said_by([&] { grains.step(1e-6f); }) == "collide: materials: the pair of 0 and 1 is missing: call set_pair");

  two.set_pair(0, 1, {0.5, 0.3});
  two.set(0, {1e8, 0.2, 2000});  // pairs know it, too
  struct {
    int operator[](collide::material) const { return 0; }
  } const grain;
  two.wall_material = 1;
  auto const& pair_of_both = two.with_wall(grain, collide::no_id, collide::no_id);
  CHECK(pair_of_both.young == doctest::Approx(1 / (0.96e-8 + 0.91e-7)).epsilon(1e-12));
  CHECK(pair_of_both.shear == doctest::Approx(1 / (2 * 1.2 * 1.8e-8 + 2 * 1.3 * 1.7e-7)).epsilon(1e-12));
  CHECK(pair_of_both.friction == 0.3);
  grains.effect<law>().made_of = two;
  CHECK(said_by([&] { grains.step(1e-6f); }) == "");
  grains.assign<collide::material>(std::vector<std::uint8_t>{7});
  CHECK(said_by([&] { grains.step(1e-6f); }) == "collide: materials: a particle is of solid 7, and there are 2");
  grains.assign<collide::material>(std::vector<std::uint8_t>{1});
  CHECK(said_by([&] { grains.step(1e-6f); }) == "");
  std::uint8_t const of_triangle = 200, of_body = 2;
  grains.effect<law>().made_of.triangle_materials = &of_triangle;
  CHECK(said_by([&] { grains.set_mesh(mesh()); }) == "collide: materials: triangle 0 is of solid 200, and there are 2");
  two.body_materials = &of_body;
  simulation<detector<bucket>, law, collide::moving_bodies<>> with_body(collide::host(1), law{two},
                                                                        collide::moving_bodies<>{});
  CHECK(said_by([&] {
          with_body.set_mesh(mesh(), {collide::body{0, 1, {}}});
        }) == "collide: materials: body 0 is of solid 2, and there are 2");
  simulation<detector<bucket>, collide::granular_contact<collide::hertz>> pair;
  pair.set_mesh({});
  pair.set(spheres());
  CHECK(said_by([&] { pair.step(1.0f); }).find("is longer than an effect allows") != std::string::npos);
  for (double const wrong : {-0.1, 1.1, not_a_number}) {
    pair.effect<collide::granular_contact<collide::hertz>>().arm_shortening = wrong;
    CHECK(said_by([&] { pair.step(1e-6f); }) == "collide: granular_contact: arm_shortening is from 0 to 1");
  }
}

TEST_CASE("misuse: steps that are too long for springs, radii of 0, and values that do not fit a column") {
  simulation<detector<bucket>, sphere_contact> springs(collide::host(1), sphere_contact{1000, 0, 0, 0, 1});
  springs.set(spheres());  // pi sqrt(m / (2 k)) / 5, of a sphere of mass m
  double const r = double(spheres().radius(0)),
               fifth = 0.2 * std::sqrt(r * r * r * 2 / 3 * std::pow(3.14159265358979, 3) / 1000);
  CHECK(collide::largest_time_step(springs) == doctest::Approx(fifth / 4));
  CHECK(said_by([&] { springs.step(float(0.99 * fifth)); }) == "");
  CHECK(said_by([&] { springs.step(float(1.01 * fifth)); }).find("is longer than an effect allows") !=
        std::string::npos);
  simulation<detector<bucket>, gravity> free;
  CHECK(collide::largest_time_step(free) == infinity);

  float const centre[] = {0, 0, 0};
  simulation<detector<bucket>, bounce> touches;
  CHECK(said_by([&] { touches.set(collide::spheres_xyz(centre, 1, 0.0f)); }) ==
        "collide: simulation: set: radii of particles that touch a mesh are above 0");

  simulation<detector<bucket>, collide::polydisperse, gravity> sizes;
  for (float const wrong : {float(infinity), float(-infinity), float(not_a_number)}) {
    float const two_centres[] = {0, 0, 0, 3, 0, 0}, radii[] = {wrong, 1}, right[] = {1, 1};
    CHECK(said_by([&] { sizes.set(collide::spheres_xyz(two_centres, 2, radii)); }) ==
          "collide: simulation: set: radii are finite");
    sizes.set(collide::spheres_xyz(two_centres, 2, right));
    CHECK(said_by([&] {
            sizes.assign<collide::radius>(std::vector<float>{1, wrong});
          }) == "collide: simulation: assign: radii are finite");
  }

  free.set(collide::spheres_xyz(centre, 1, 1.0f));
  free.assign<collide::velocity>(std::vector<float>{1, 2, 3});
  CHECK(free.to_host<collide::velocity>() == std::vector<float>{1, 2, 3});
  CHECK(said_by([&] {
          free.assign<collide::velocity>(std::vector<float>{1, 2});
        }) == "collide: simulation: assign: there are 2 values for 3 numbers of the column");
}

TEST_CASE("misuse: parameters of effects") {
  CHECK(said_with(bounce{3}) == "collide: bounce: restitution is from 0 to 1");
  CHECK(said_with(bounce{not_a_number}) != "");
  CHECK(said_with(bounce{1}) == "");
  CHECK(said_with<bounce>(friction{0.1, 0.2}) ==
        "collide: friction: kinetic_coefficient is not above static_coefficient");
  for (double const x : {-0.1, not_a_number, infinity}) {
    CHECK(said_with<bounce>(friction{x, 0.1}) == "collide: friction: coefficients are not negative, and finite");
    CHECK(said_with<bounce>(friction{0.1, x}) == "collide: friction: coefficients are not negative, and finite");
    CHECK(said_with<bounce>(spin{x}) == "collide: spin: rolling_resistance is not negative, and finite");
    CHECK(said_with<bounce>(adhesion{x}) ==
          "collide: adhesion: max_acceleration and capture_speed are not negative, and the first is finite");
    CHECK(said_with(drag{x, 0}) == "collide: drag: linear and quadratic are not negative, and finite");
    CHECK(said_with(drag{0, x}) == "collide: drag: linear and quadratic are not negative, and finite");
    CHECK(said_with(wind<>{x, 0, {}}) == "collide: wind: linear and quadratic are not negative, and finite");
    CHECK(said_with(wind<>{0, x, {}}) == "collide: wind: linear and quadratic are not negative, and finite");
    CHECK(said_with(emit{x, {}}) == "collide: emit: rate is not negative, and finite");
    CHECK(said_with(collide::sleep{x, 3}) == "collide: sleep: speed is not negative, and finite");
    CHECK(said_with(mesh_forces{x}) == "collide: mesh_forces: density is above 0, and finite");
    CHECK(said_with<sphere_contact>(pair_forces{x}) == "collide: pair_forces: density is above 0, and finite");
    for (int k = 0; k < 4; ++k) {
      double values[4] = {1000, 0, 0, 0};
      values[k] = x;
      CHECK(said_with(sphere_contact{values[0], values[1], values[2], values[3], 1}) ==
            "collide: sphere_contact: stiffness, dampings and friction are not negative, and finite");
      double range[4] = {1, 1, 1, 1};
      range[k] = x;
      CHECK(said_by([&] { sphere_contact::from_restitution(range[0], range[1], range[2], range[3]); }) != "");
    }
    CHECK(said_with(sphere_contact{1000, 0, 0, 0, x}) == "collide: sphere_contact: density is above 0, and finite");
  }
  CHECK(said_with<bounce>(adhesion{1, not_a_number}) != "");
  CHECK(said_with<bounce>(adhesion{1, infinity}) == "");
  CHECK(said_with(mesh_forces{0}) == "collide: mesh_forces: density is above 0, and finite");
  CHECK(said_with<sphere_contact>(pair_forces{0}) == "collide: pair_forces: density is above 0, and finite");
  CHECK(said_with(sphere_contact{1000, 0, 0, 0, 0}) == "collide: sphere_contact: density is above 0, and finite");
  CHECK(said_with(collide::sleep{0.01, 300}) == "collide: sleep: steps are from 1 to 127");
  for (double const x : {not_a_number, infinity, -infinity}) {
    CHECK(said_with(gravity{0, 0, x}) == "collide: gravity: the acceleration is finite");
    CHECK(said_with(wind<>{1, 0, {0, x, 0}}) == "collide: wind: the velocity of uniform_field is finite");
    for (nozzle const& n :
         {nozzle{{0, x, 0}, 0, {}, 0}, nozzle{{}, x, {}, 0}, nozzle{{}, 0, {x, 0, 0}, 0}, nozzle{{}, 0, {}, x}}) {
      CHECK(said_with(emit{1, n}) == "collide: nozzle: position, half_width, velocity and velocity_spread are finite");
    }
    CHECK(said_with(periodic_box{{x, 0, 0}, {1, 1, 1}}) == "collide: periodic_box: the bounds are finite");
    CHECK(said_with(periodic_box{{0, 0, 0}, {1, 1, x}}) == "collide: periodic_box: the bounds are finite");
  }
  CHECK(said_with(box_walls{{infinity, 0, 0}, {infinity, 1, 1}}) ==
        "collide: box_walls: no lower bound is infinite, and no upper bound minus infinite");
  CHECK(said_with(box_walls{{-infinity, 0, 0}, {-infinity, 1, 1}}) ==
        "collide: box_walls: no lower bound is infinite, and no upper bound minus infinite");
  CHECK(said_with(box_walls{{0, not_a_number, 0}, {1, 1, 1}}) != "");
  CHECK(said_with(box_walls{{0, 0, 1}, {1, 1, 0}}) == "collide: box_walls: no lower bound is above its upper bound");
  CHECK(said_with(box_walls{}) == "");
  CHECK(said_with(periodic_box{{0, 0, 0}, {1, 1, 0}}) ==
        "collide: periodic_box: each lower bound is below its upper bound");
  CHECK(said_with(absorbing_box{{1, 0, 0}, {0, 0, 0}}) ==
        "collide: absorbing_box: no lower bound is above its upper bound");
  CHECK(said_by([] { sphere_contact::from_restitution(3, 1, 1, 1); }) != "");
}

TEST_CASE("misuse: a parameter that changes between steps") {
  simulation<detector<bucket>, bounce> scene;
  scene.set(spheres());
  scene.set_mesh(mesh());
  scene.step(0.125f);
  scene.effect<bounce>().restitution = not_a_number;
  CHECK(said_by([&] { scene.step(0.125f); }) == "collide: bounce: restitution is from 0 to 1");
}

TEST_CASE_TEMPLATE("misuse: an address that is null, and a size that is not 0", S, float, double) {
  S const* const null = nullptr;
  S const some[12] = {};
  unsigned const* const no_indices = nullptr;
  unsigned const indices[3] = {0, 1, 2};
  struct xyz {
    S x, y, z;
  };
  auto const is_null = [](char const* what, int n) {
    return "collide: the address of the " + std::string(what) + " is null, but there are " + std::to_string(n) +
           ": give the address of the first, or a size of 0";
  };
  CHECK(said_by([&] { indexed_mesh(null, 4, indices, 1); }) == is_null("vertices", 4));
  CHECK(said_by([&] { indexed_mesh(some, 4, no_indices, 1); }) == is_null("indices", 3));
  CHECK(said_by([&] { triangle_soup(null, 2); }) == is_null("vertices", 6));
  CHECK(said_by([&] { validate(triangle_soup(null, 2)); }) == is_null("vertices", 6));
  CHECK(said_by([&] { spheres_xyz(null, 4, 1); }) == is_null("centres", 4));
  CHECK(said_by([&] { spheres_xyz(some, 4, null); }) == is_null("radii", 4));
  CHECK(said_by([&] { spheres_soa(some, null, some, 4, 1); }) == is_null("centres", 4));
  CHECK(said_by([&] { spheres_soa(some, some, null, 4, some); }) == is_null("centres", 4));
  CHECK(said_by([&] { spheres_soa(some, some, some, 4, null); }) == is_null("radii", 4));
  CHECK(said_by([&] { spheres_xyzr(null, 3); }) == is_null("centres", 3));
  CHECK(said_by([&] { spheres_at(points(static_cast<xyz const*>(nullptr), 3), 1); }) == is_null("centres", 3));
  CHECK(said_by([&] { spheres_at(points(some, 4), null); }) == is_null("radii", 4));
  CHECK(said_by([&] { with_displacements(spheres_xyz(some, 4, 1), null); }) == is_null("displacements", 4));
  CHECK(said_by([&] { with_displacements(spheres_xyz(some, 4, 1), some, some, null); }) == is_null("displacements", 4));

  CHECK(indexed_mesh(null, 0, no_indices, 0).size() == 0);
  CHECK(validate(triangle_soup(null, 0)).ok());
  CHECK(validate(spheres_xyz(null, 0, null)).ok());
  CHECK(with_displacements(spheres_xyz(null, 0, 1), null).size() == 0);
}

TEST_CASE("misuse: a stride that is negative, or too large") {
  char const* const said =
      "collide: the stride of an array is negative, or 2^32 or more: copy what it holds to a packed array";
  float const some[12] = {};
  unsigned const indices[12] = {};
  for (long const stride : {-3L, -1L, 1L << 32}) {
    auto const n = static_cast<std::size_t>(stride);
    CHECK(said_by([&] { points(some, 2, n); }) == said);
    CHECK(said_by([&] { points(some, some, some, 2, n); }) == said);
    CHECK(said_by([&] { spheres_at(points(some, 4), some, n); }) == said);
    CHECK(said_by([&] { mesh_view<float>(points(some, 4), indices, 2, n); }) == said);
    CHECK(said_by([&] { mesh_view<float>(points(some, 4), indices, 2, 3, n); }) == said);
  }
}

TEST_CASE("misuse: threads of the host") {
  CHECK(said_by([] { host(-1); }) == "collide: host: the number of threads must not be negative");
#if defined(_OPENMP)
  CHECK(host(2).threads() == 2);
#else
  CHECK(said_by([] { host(2); }).find("-fopenmp") != std::string::npos);
#endif
}
