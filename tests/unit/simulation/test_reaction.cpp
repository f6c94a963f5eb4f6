/// Impulses of particles on bodies, on the host and as blocks of threads go: all, and where sums cannot hold them.
#include "compositions.hpp"
#include "simulation/reaction.hpp"

using collide::host;
using tests::lockstep;

TEST_CASE("reaction: what sums cannot hold is counted, or an error, and never in them") {
  tests::check_sums_that_do_not_fit(host(1));
  tests::check_sums_that_do_not_fit(host(2));
  tests::check_sums_that_do_not_fit(lockstep<256, true>());
}

TEST_CASE("reaction: has all that the mesh gives, wherever it stands in the list") {
  tests::check_reaction_anywhere(host(1));
}
