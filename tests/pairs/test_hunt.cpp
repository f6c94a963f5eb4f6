/// Draws a list, its surface, parameters and particles at random, again and again, and checks what is checked of lists.
/// Two environment variables: COLLIDE_HUNT_SECONDS, 3600 if not set; COLLIDE_HUNT_SEED, the first seed, 1 if not set.
/// A failure prints its seed; that seed and 0 seconds do the same again.
#include <chrono>
#include <cstdlib>

#include "check_list.hpp"
#include "hunt.hpp"

namespace {

std::uint64_t from_environment(char const* name, std::uint64_t otherwise) {
  char const* const text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

}  // namespace

TEST_CASE("hunt: pairs: lists, surfaces, parameters and particles at random") {
  using clock = std::chrono::steady_clock;
  std::uint64_t const first = from_environment("COLLIDE_HUNT_SEED", 1);
  auto const end = clock::now() + std::chrono::seconds(from_environment("COLLIDE_HUNT_SECONDS", 3600));
  auto const& lists = tests::pairs::hunted();
  REQUIRE(!lists.empty());
  std::uint64_t seed = first;
  do {
    tests::pairs::trial t{{}, seed};
    auto const& list = lists[static_cast<std::size_t>(t.uniform(100) * static_cast<double>(lists.size()))];
    t.how = list.surfaces[static_cast<std::size_t>(t.uniform(101) * static_cast<double>(list.surfaces.size()))];
    INFO("COLLIDE_HUNT_SEED=" << seed << " COLLIDE_HUNT_SECONDS=0: list " << list.name << " (" << list.effects
                              << "), surface " << int(t.how));
    list.check(t);
    ++seed;
  } while (clock::now() < end);
  MESSAGE("seeds " << first << " to " << seed - 1);
}

TEST_CASE("pairs: scenes in which a hunt found something") {
  using tests::pairs::surface;
  bool is_there = false;
  for (auto const& list : tests::pairs::hunted()) {
    if (list.effects !=
        "sphere_contact sleep granular_contact mesh_forces lost absorbing_box lost_motion emit reaction")
      continue;  // what had vanished got the rotation that it had before, but not after a checkpoint
    is_there = true;
    list.check({surface::at_rest, 43100850});
    list.check({surface::driven_body, 43102004});
  }
  CHECK(is_there);
}
