/// Hard contacts on the GPU, in float.
#include "simulation/hard_contacts.hpp"

using collide::cuda_shared;
using collide::karabassi;
using collide::karabassi_swept;

TEST_CASE("hard contacts: on the GPU, in float") {
  tests::check_small_particles<float>(cuda_shared(), 5000);
  tests::check_walls<karabassi<>, float>(cuda_shared(), 100000);
  tests::check_walls<karabassi_swept<>, float>(cuda_shared(), 100000);
  tests::check_held<karabassi<>, float>(cuda_shared(), 100000, collide::gravity{}, collide::bounce{0.3},
                                        collide::friction{0.6, 0.6}, collide::spin{0.5});
  tests::check_lost_motion<float>(cuda_shared());
}
