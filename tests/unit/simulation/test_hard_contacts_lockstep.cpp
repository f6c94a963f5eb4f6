/// Hard contacts in blocks whose threads work together, on the host.
#include "compositions.hpp"
#include "simulation/hard_contacts.hpp"

using collide::karabassi;
using collide::karabassi_swept;

using blocks = tests::lockstep<64, true>;

TEST_CASE_TEMPLATE("hard contacts: in lockstep", S, float, double) {
  tests::check_small_particles<S>(blocks(), 50);
  tests::check_walls<karabassi<>, S>(blocks(), 50);
  tests::check_walls<karabassi_swept<>, S>(blocks(), 20);
  tests::check_held<karabassi<>, S>(blocks(), 2000, collide::gravity{}, collide::bounce{0.3},
                                    collide::friction{0.6, 0.6}, collide::spin{0.5});
}
