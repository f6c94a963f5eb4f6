/// Policies of a user, in the spaces of the host.
#include "execution/lockstep.hpp"
#include "custom_policies.hpp"

TEST_CASE_TEMPLATE("extending: a broad phase that enumerates candidates, on the host", S, float, double) {
  tests::check_custom_broad_phase<S>(collide::host(2));
}

TEST_CASE_TEMPLATE("extending: a broad phase that enumerates candidates, in lockstep", S, float, double) {
  tests::check_custom_broad_phase<S>(tests::lockstep<64, false>(1));
  tests::check_custom_broad_phase<S>(tests::lockstep<64, true>(1));
}
