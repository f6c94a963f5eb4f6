/// Births where something is already, on the host and as blocks of threads go.
#include "compositions.hpp"
#include "simulation/births.hpp"

using collide::host;
using collide::polydisperse;
using collide::semi_implicit_euler;
using collide::velocity_verlet;
using blocks = tests::lockstep<64, true>;

TEST_CASE("births: those that overlap others are counted, and not born where that is asked for") {
  tests::check_births<semi_implicit_euler, float>(host(1));
  tests::check_births<semi_implicit_euler, double>(host(2), polydisperse{});
  tests::check_births<semi_implicit_euler, float>(blocks());
  tests::check_births<velocity_verlet, float>(host(1), polydisperse{});
  tests::check_births<velocity_verlet, double>(blocks());
}

TEST_CASE("births: a hundred in one point") {
  tests::check_births_in_one_point(host(1));
  tests::check_births_in_one_point(blocks());
}

TEST_CASE("births: nothing is counted where particles do not meet") {
  tests::check_births_of_what_does_not_meet(host(1));
}

TEST_CASE("births: contacts of what is new remember nothing") {
  for (bool const dies : {false, true}) {
    for (int const n : {1, 24}) tests::check_births_touch_nothing<float>(host(1), n, dies);
    tests::check_births_touch_nothing<double>(blocks(), 3, dies);
  }
}

TEST_CASE("births: contacts of what an effect of one's own makes remember nothing, and nothing holds it") {
  for (int const n : {1, 24}) tests::check_revived_touch_nothing<float>(host(1), n);
  tests::check_revived_touch_nothing<double>(blocks(), 3);
  tests::check_revived_falls<semi_implicit_euler>(host(1));
  tests::check_revived_falls<velocity_verlet>(blocks());
}

TEST_CASE("births: what one of two effects makes begins anew in what the other writes") {
  tests::check_two_makers(host(1));
  tests::check_two_makers(blocks());
}
