/// Granular contact that is evaluated once a pair and on lanes, beside each particle asking for itself: the same bits.
#include <cmath>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <collide/bucket.cuh>
#include <collide/effects/bodies.hpp>
#include <collide/effects/contact_work.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/integrators.hpp>
#include <collide/effects/polydisperse.hpp>
#include <collide/simulation.cuh>
#include <collide/simulation/checkpoint.hpp>

#include "execution/lockstep.hpp"

namespace {

using namespace collide;

/// A heap of grains that fall on each other, some large among small ones, more than sixteen about each of those.
struct heap {
  std::vector<double> centres, velocities, radii;
  std::vector<std::uint8_t> made_of;

  explicit heap(std::size_t side) {
    std::mt19937 engine(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (std::size_t i = 0; i < side * side * side; ++i) {
      for (std::size_t at : {i % side, i / side % side, i / side / side}) {
        centres.push_back(0.0018 * static_cast<double>(at) + 1e-4 * uniform(engine));
        velocities.push_back(0.3 * uniform(engine));
      }
      radii.push_back(i % 97 == 50 ? 0.0022 : 0.001 * (0.75 + 0.25 * std::abs(uniform(engine))));
      made_of.push_back(i % 3 == 0);
    }
  }
};

materials<2> two_solids() {
  materials<2> m;
  m.set(0, {1e7, 0.2, 2500});
  m.set(1, {5e6, 0.3, 2000});
  m.set_pair(0, 0, {0.5, 0.3, 0.1, 0.1});
  m.set_pair(0, 1, {0.6, 0.2, 0.2, 0.3});
  m.set_pair(1, 1, {0.4, 0.4, 0.1, 0.2});
  return m;
}

/// Pushes each particle by its number, wherever it lies.
struct push_by_number {
  using reads = columns<>;
  using writes = columns<velocity>;
  template <class Particle, class S>
  COLLIDE_HD void accelerate(Particle& p, S dt) const {
    p[velocity{}].x() += static_cast<S>(p.number() % 7) * dt;
  }
};

/// All that a simulation is after some steps, with a restart in between.
template <class S, class Law, class Space, class... Effect>
std::string played(Space const& space, Law const& law, heap const& of, Effect const&... effects) {
  using made_type = simulation<detector<bucket, karabassi<>, Space, S>, polydisperse, gravity, push_by_number, Law,
                               velocity_verlet, moving_bodies<>, Effect...>;
  made_type made(space, polydisperse{}, gravity{0, 0, -9.81}, push_by_number{}, law, velocity_verlet{},
                 moving_bodies<>{}, effects...);
  std::vector<S> const floor{-1, -1, -S(0.001), 2, -1, -S(0.001), -1, 2, -S(0.001)};
  std::vector<S> const x(of.centres.begin(), of.centres.end()), v(of.velocities.begin(), of.velocities.end()),
      r(of.radii.begin(), of.radii.end());
  body_motion lift;
  lift.velocity[2] = 1;  // farther than the skin of lists in 40 steps
  made.set_mesh(triangle_soup(floor.data(), 1), {body{0, 1, lift}});
  made.set(spheres_xyz(x.data(), r.size(), r.data()), v.data());
  if constexpr (detail::contains<typename made_type::columns, material>) made.template assign<material>(of.made_of);
  std::string all;
  for (int part = 0; part < 3; ++part) {
    made.steps(40, S(1e-5));
    std::stringstream file(std::ios::in | std::ios::out | std::ios::binary);
    save(made, file);
    all += file.str();
    load(made, file);
    std::stringstream again(std::ios::out | std::ios::binary);
    save(made, again);
    CHECK(again.str() == file.str());
  }
  return all;
}

template <class S, class Law, class... Effect>
void check_once_a_pair(Law const& law, Effect const&... effects) {
  heap const of(7);
  std::string const expected = played<S>(tests::lockstep<64, true>(), law, of, effects...);
  CHECK(expected.size() > of.radii.size());
  for (int threads : {1, 3}) CHECK(played<S>(host(threads), law, of, effects...) == expected);
}

}  // namespace

TEST_CASE("once a pair: laws have the bits that they have where each particle asks for itself") {
  one_material const soft({1e7, 0.3, 2500}, {0.5, 0.3, 0.1, 0.1});
  mindlin other;
  other.damping = tangential_damping::of_normal;
  other.test = slip_test::spring_and_dashpot;
  other.keeps_length = other.turns_about_normal = true;
  check_once_a_pair<double>(granular_contact<hertz, mindlin, epsd, none, materials<2>>{two_solids(), {}, other});
  torsion<constant_torque> twisting;
  twisting.stiffness = 1e-4, twisting.damping = 1e-9, twisting.friction = 1e-5;
  check_once_a_pair<float>(
      granular_contact<hertz, mindlin_rescale, torsion<constant_torque>, dmt>{soft, {}, {}, twisting});
  check_once_a_pair<double>(granular_contact<hertz, mindlin_force, marshall<epsd2>, jkr>{soft});
  check_once_a_pair<float>(granular_contact<linear, cundall_strack, none, sjkr, materials<2>>{two_solids()});
  check_once_a_pair<double>(granular_contact<linear, dashpot>{soft, {}, {0.01}});
  check_once_a_pair<double>(granular_contact<hertz>{soft});
}

TEST_CASE("once a pair: contact_work has the bits that it has where each particle asks for itself") {
  one_material const soft({1e7, 0.3, 2500}, {0.5, 0.3, 0.1, 0.1});
  contact_work<> const work{{2500}};
  check_once_a_pair<double>(granular_contact<hertz, mindlin, epsd, none, materials<2>>{two_solids()},
                            contact_work<materials<2>>{two_solids()});
  check_once_a_pair<float>(granular_contact<hertz, mindlin_rescale>{soft}, work);
  check_once_a_pair<double>(granular_contact<linear>{soft}, work);
}
