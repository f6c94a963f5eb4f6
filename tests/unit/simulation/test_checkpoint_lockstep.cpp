/// Checkpoints on the GPU's kernels in lockstep.
#include "compositions.hpp"
#include "simulation/checkpoint.hpp"

TEST_CASE("checkpoint: in lockstep, a simulation that is loaded goes on in the same bits") {
  tests::check_scenes_go_on(tests::lockstep<64, true>());
}
