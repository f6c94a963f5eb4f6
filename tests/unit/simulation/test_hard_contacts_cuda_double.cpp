/// Hard contacts on the GPU, in double.
#include "simulation/hard_contacts.hpp"

using collide::cuda_shared;
using collide::karabassi;
using collide::karabassi_swept;

TEST_CASE("hard contacts: on the GPU, in double") {
  tests::check_small_particles<double>(cuda_shared(), 5000);
  tests::check_walls<karabassi<>, double>(cuda_shared(), 100000);
  tests::check_walls<karabassi_swept<>, double>(cuda_shared(), 100000);
  tests::check_held<karabassi<>, double>(cuda_shared(), 100000, collide::gravity{}, collide::bounce{0.3},
                                         collide::friction{0.6, 0.6}, collide::spin{0.5});
  tests::check_lost_motion<double>(cuda_shared());
}
