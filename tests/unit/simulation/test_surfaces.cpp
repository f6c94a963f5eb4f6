/// Walls of granular contact are surfaces, on the host and as blocks of threads go.
#include "compositions.hpp"
#include "simulation/surfaces.hpp"

using collide::host;
using blocks = tests::lockstep<64, true>;

TEST_CASE("surfaces: short facets have the force of the plane, cylinder, cone and sphere") {
  tests::check_smooth_surfaces(host(1));
}

TEST_CASE("surfaces: a fold that gets flat has the force, restitution and pull-off of the plane") {
  tests::check_flat_folds(host(1));
}

TEST_CASE("surfaces: hanging corners, cracks, plates and bodies that lie flush are one flat wall") {
  tests::check_force_at_seams(host(1));
  tests::check_motion_over_seams(host(1));
}

TEST_CASE("surfaces: a fan of many triangles is a flat wall, and hides no other") { tests::check_fan(host(1), 2000); }

TEST_CASE("surfaces: impacts in folds make no energy") { tests::check_energy_in_folds(host(1), 16); }

TEST_CASE("surfaces: a trough makes no energy") { tests::check_energy_in_troughs(host(1), 0.4); }

TEST_CASE("surfaces: grains of two sizes in a box that repeats come to rest and sleep on bodies in pieces") {
  tests::check_features_on_pieces(host(1));
}

TEST_CASE("surfaces: the same bits as blocks of threads go") {
  tests::check_same_surfaces<double>(blocks(), 16, 200, 300);
  tests::check_same_surfaces<float>(blocks(), 16, 200, 300);
  tests::check_same_surfaces<double>(host(2), 16, 200, 300);
}
