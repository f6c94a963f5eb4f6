/// The state of a particle while its contacts are resolved.
#include <cmath>

#include <doctest/doctest.h>

#include <collide/simulation/detail/step/contact_scratch.hpp>
#include <collide/simulation/detail/step/mesh_contact.hpp>
#include <collide/simulation/detail/step/surface_at_rest.hpp>

namespace {

using collide::contact;
using collide::vec3;
using namespace collide::detail;

template <class S>
contact<S> at_depth(S depth, collide::feature kind = collide::feature::face, collide::id triangle = 0) {
  contact<S> c{};
  c.depth = depth;
  c.feature = kind;
  c.triangle = triangle;
  return c;
}

}  // namespace

TEST_CASE_TEMPLATE("contact scratch: a key tells its time, never a later one, and times from 0 to 1 in order", S, float,
                   double) {
  std::uint64_t before = 0;
  for (int i = 1; i <= 1000; ++i) {
    S const time = S(i) / 1000, kept = key_time(time);
    CHECK((kept <= time && time - kept <= S(0x1p-23)));
    std::uint64_t const key = contact_key(kept, at_depth(S(0)));
    CHECK(time_of_key<S>(key) == kept);
    CHECK(key > before);
    before = key;
  }
  CHECK(time_of_key<S>(contact_key(S(0), at_depth(S(1)))) == 0);
}

TEST_CASE_TEMPLATE("contact scratch: the earlier contact comes first, then the deeper, a face, the lower number", S,
                   float, double) {
  using collide::feature;
  auto const deep = contact_key(S(0), at_depth(S(2))), flat = contact_key(S(0), at_depth(S(1)));
  CHECK(deep < flat);
  CHECK(flat < contact_key(S(0), at_depth(S(-1))));
  CHECK(flat < contact_key(key_time(S(0.001)), at_depth(S(2))));
  CHECK(flat < contact_key(S(0), at_depth(S(1), feature::edge)));
  CHECK(flat < contact_key(S(0), at_depth(S(1), feature::face, 1)));
  CHECK(contact_key(key_time(S(1)), at_depth(S(1))) < no_contact);
}

TEST_CASE_TEMPLATE("contact scratch: what lies on a recorded contact's surface is no contact of its own", S, float,
                   double) {
  active_particle<S, false> a;
  motion_in_world<S> motion{};
  a.place({0, 0, S(0.5)}, {});
  a.radius = 1;
  a.contact_count = a.contacts_here = 0;
  CHECK(!a.is_internal_contact({0, 0, 0}, motion));
  collide::mesh_contact<S> floor{};
  floor.normal = vec3<S>(0, 0, 1);
  floor.point = vec3<S>(0, 0, 0);
  a.record_contact(floor);
  CHECK(a.is_internal_contact({S(0.3), 0, 0}, motion));
  CHECK(!a.is_internal_contact({S(0.3), 0, S(0.1)}, motion));

  collide::mesh_contact<S> wall{};
  wall.normal = vec3<S>(1, 0, S(-0.5)) / std::sqrt(S(1.25));  // leads into the floor
  motion.velocity = {0, 0, -1};
  project_onto_contacts(a, wall, motion.velocity, motion);
  CHECK(std::abs(wall.wedge_direction.z()) <= S(1e-6));
  CHECK(dot(wall.wedge_direction, wall.normal) == doctest::Approx(1));
}
