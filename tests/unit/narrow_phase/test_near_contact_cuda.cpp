/// Verdicts of the narrow phase where they are hardest, on the device.
#include <collide/cuda.cuh>

#include "narrow_phase/narrow_phase.hpp"

TEST_CASE_TEMPLATE("near contact: 5e5 pairs within 4 ulp of tangency, on the device", S, float, double) {
  tests::check_near_contact<S>(collide::cuda(), 5000, 3);
}

TEST_CASE_TEMPLATE("near contact: exact ties and coordinates of all exponents, on the device", S, float, double) {
  tests::check_ties_and_exponents<S>(collide::cuda());
}
