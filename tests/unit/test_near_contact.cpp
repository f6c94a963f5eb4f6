/// Verdicts and contacts of the narrow phase where they are hardest, on the host. 1e7 pairs in four parts, which run
/// side by side.
#include <collide/host.hpp>

#include "checks.hpp"
#include "narrow_phase.hpp"

TEST_CASE("near contact: 2.5e6 pairs of floats within 4 ulp of tangency") {
  tests::check_near_contact<float>(collide::host(1), 1000, 14);
}

TEST_CASE("near contact: another 2.5e6 pairs of floats within 4 ulp of tangency") {
  tests::check_near_contact<float>(collide::host(1), 2000, 14);
}

TEST_CASE("near contact: 2.5e6 pairs of doubles within 4 ulp of tangency") {
  tests::check_near_contact<double>(collide::host(1), 3000, 14);
}

TEST_CASE("near contact: another 2.5e6 pairs of doubles within 4 ulp of tangency") {
  tests::check_near_contact<double>(collide::host(1), 4000, 14);
}

TEST_CASE_TEMPLATE("near contact: exact ties of faces, edges and vertices, and coordinates of all exponents", S, float,
                   double) {
  tests::check_ties_and_exponents<S>(collide::host(1));
}

TEST_CASE_TEMPLATE("near contact: the contact, or the closest point where nothing touches", S, float, double) {
  for (auto const& cases :
       {tests::near_contact<S>(51, 1500), tests::ties<S>(52, 2000), tests::mixed_exponents<S>(53, 2000)})
    for (auto const& c : cases) {
      if (c.ball.radius < 0) continue;
      CAPTURE(tests::describe(c));
      tests::narrow_case<S> const made(c);
      auto const contact = collide::karabassi<collide::exact>::contact_of(made.shape, made.ball);
      tests::check_contact(contact, c.shape, c.ball, false);
    }
}
