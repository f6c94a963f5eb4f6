/// Walls that move, on the host and as blocks of threads go.
#include "compositions.hpp"
#include "simulation/moving_walls.hpp"

using collide::host;
using collide::karabassi;
using collide::karabassi_swept;
using tests::lockstep;

TEST_CASE_TEMPLATE("moving walls: a mesh that is set again pushes what friction holds", S, float, double) {
  for (double const speed : {0.002, 0.2, 2.0}) {
    tests::check_wall_set_again<karabassi<>, S>(host(1), speed);
    tests::check_wall_set_again<karabassi_swept<>, S>(host(1), speed);
  }
}

TEST_CASE("moving walls: a body pushes what friction holds, however slowly") {
  for (double const speed : {0.001, 0.1}) {
    tests::check_slow_wall<karabassi<>, double>(host(1), speed);
    tests::check_slow_wall<karabassi_swept<>, double>(host(1), speed);
  }
}

TEST_CASE("moving walls: a function of one's own moves bodies") {
  tests::check_own_motion<karabassi<>>(host(1));
  tests::check_own_motion<karabassi_swept<>>(host(1));
  tests::check_own_motion<karabassi<>>(lockstep<256, true>());
}

TEST_CASE("moving walls: a screw moves what lies in its trough by its pitch times turns, less slip") {
  tests::check_screw<karabassi<>>(host(1));
  tests::check_screw<karabassi_swept<>>(host(1));
}

TEST_CASE("moving walls: the work of the bodies is the work on the particles") {
  tests::check_work<karabassi<>>(host(1));
  tests::check_work<karabassi_swept<>>(host(1));
}

TEST_CASE_TEMPLATE("moving walls: a mesh that deforms hits and carries as its vertices move", S, float, double) {
  tests::check_deforming<karabassi<>, S>(host(1));
  tests::check_deforming<karabassi_swept<>, S>(host(1));
}

TEST_CASE("moving walls: a box that turns far in a step gets what swept particles lose, and each triangle its part") {
  tests::check_momentum_of_turning_box(host(1));
}
