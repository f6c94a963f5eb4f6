/// Granular contact, on the host and as blocks of threads go.
#include "compositions.hpp"
#include "simulation/granular_ledgers.hpp"

using collide::host;
using blocks = tests::lockstep<64, true>;

TEST_CASE("granular contact: two bodies to the digits of other codes") {
  tests::check_hertz_rebound(host(1));
  tests::check_oblique_pair(host(1));
  tests::check_pulled_ball(host(1));
}

TEST_CASE("granular contact: a wall does not depend on its triangles") {
  tests::check_divided_walls<double>(host(1));
  tests::check_divided_walls<float>(host(1));
  tests::check_tilted_walls<double>(host(1));
  tests::check_tilted_walls<float>(host(1));
}

TEST_CASE("granular contact: contacts remember the same everywhere, and after a checkpoint") {
  tests::check_same_grains<double>(host(2));
  tests::check_same_grains<float>(blocks());
}

TEST_CASE("granular contact: springs of walls hold energy") {
  tests::check_energy_at_walls(host(1));
  tests::check_energy_at_walls(blocks());
}

TEST_CASE("granular contact: walls that move take grains along, and feel them") {
  tests::check_moving_walls<double>(host(1));
  tests::check_moving_walls<float>(blocks());
}

TEST_CASE("granular contact: grains sleep and press on") { tests::check_sleeping_grains<double>(host(1)); }

TEST_CASE("granular contact: what falls asleep, and is woken, presses with its weight") {
  tests::check_weight_of_naps<collide::velocity_verlet, double>(host(1));
  tests::check_weight_of_naps<collide::semi_implicit_euler, double>(blocks());
}

TEST_CASE("granular contact: what grains lose bodies get: asleep, where dt changes, and parameters between steps") {
  tests::check_ledgers<collide::velocity_verlet, double>(host(1));
  tests::check_ledgers<collide::semi_implicit_euler, double>(blocks());
}

TEST_CASE("granular contact: meetings between steps change nothing") {
  tests::check_meetings_between_steps<collide::velocity_verlet, double>(host(1));
  tests::check_meetings_between_steps<collide::semi_implicit_euler, double>(blocks());
}

TEST_CASE("granular contact: what touches nothing does not fall asleep") {
  tests::check_sleep_needs_contact<collide::velocity_verlet, double>(host(1));
  tests::check_sleep_needs_contact<collide::semi_implicit_euler, double>(blocks());
}

TEST_CASE("granular contact: a driven wall presses on nothing where it lies in memory") {
  tests::check_first_pose_of_walls<double>(host(1));
  tests::check_first_pose_of_walls<float>(blocks());
}

TEST_CASE("granular contact: what sleeps goes with the body on which it lies") {
  tests::check_sleep_on_bodies<collide::velocity_verlet, double>(host(1));
  tests::check_sleep_on_bodies<collide::semi_implicit_euler, float>(blocks());
}

namespace {

/// Memory as a GPU's: the host must not look into it.
struct afar : host {
  using host::host;
  static constexpr bool host_accessible = false;
  std::size_t saturating_blocks() const { return 4; }
};

}  // namespace

TEST_CASE("granular contact: contacts find room for what they remember, or an error says that there is none") {
  tests::check_many_neighbours<double>(host(1));
  tests::check_many_neighbours<float>(blocks());
  tests::check_many_neighbours<double>(afar(1));
}
