/// Hard contacts on the host.
#include "simulation/hard_contacts.hpp"

using collide::host;
using collide::karabassi;
using collide::karabassi_swept;

TEST_CASE_TEMPLATE("hard contacts: particles smaller than rounding stay in front of what they hit", S, float, double) {
  tests::check_small_particles<S>(host(1), 300);
}

TEST_CASE_TEMPLATE("hard contacts: moving walls, divided floors, grooves", S, float, double) {
  tests::check_walls<karabassi<>, S>(host(1), 1000);
  tests::check_walls<karabassi_swept<>, S>(host(1), 500);
}

TEST_CASE_TEMPLATE("hard contacts: what friction holds does not creep", S, float, double) {
  tests::check_held_in_any_order<S>(host(1), 100000);
}

TEST_CASE_TEMPLATE("hard contacts: displacements that rounding swallows are counted", S, float, double) {
  tests::check_lost_motion<S>(host(1));
}
