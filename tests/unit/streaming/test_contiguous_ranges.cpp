/// The memory that views of spheres read: copies of it alone make the same spheres.
#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include <doctest/doctest.h>

#include <collide/detectors/detail/contiguous_ranges.hpp>
#include <collide/spheres.hpp>

namespace {

/// Copies what a view reads, makes the original useless, and compares.
void check_copies(std::vector<float>& memory, collide::sphere_view<float> const& view, std::size_t ranges) {
  collide::detail::contiguous_ranges<collide::sphere_view<float>> const all(view);
  std::vector<float> expected, found, copies(all.size() + 1, -1);
  auto const read = [](collide::sphere_view<float> const& v, std::vector<float>& into) {
    for (std::size_t i = 0; i < v.size(); ++i) {
      collide::vec3<float> const c = v.centre(i);
      into.insert(into.end(), {c.x(), c.y(), c.z(), v.radius(i)});
    }
  };
  read(view, expected);
  std::size_t calls = 0, numbers = 0;
  auto const copy = all.copy(copies.data(), [&](float* to, float const* from, std::size_t n) {
    CHECK((to - copies.data()) % 64 == 0);
    CHECK(from >= memory.data());
    CHECK(from + n <= memory.data() + memory.size());
    std::copy(from, from + n, to);
    ++calls;
    numbers += n;
  });
  std::fill(memory.begin(), memory.end(), -7.f);
  read(copy, found);
  CHECK((found == expected));
  CHECK(calls == ranges);
  CHECK(numbers <= memory.size());
  CHECK(copies.back() == -1);
  std::iota(memory.begin(), memory.end(), 0.f);
}

}  // namespace

TEST_CASE("contiguous ranges: what is copied makes the same spheres, in as few pieces as there are") {
  std::size_t const n = 100;
  std::vector<float> memory(10 * n);
  std::iota(memory.begin(), memory.end(), 0.f);
  float* const m = memory.data();
  check_copies(memory, collide::spheres_xyz(m, n, 0.5f), 1);
  check_copies(memory, collide::spheres_xyz(m, n, m + 4 * n), 2);
  check_copies(memory, collide::spheres_xyzr(m, n), 1);
  check_copies(memory, collide::spheres_soa(m, m + 2 * n, m + 5 * n, n, 0.5f), 3);
  check_copies(memory, collide::spheres_soa(m, m + 2 * n, m + 5 * n, n, m + 7 * n), 4);
  check_copies(memory, collide::spheres_soa(m, m + n, m + 2 * n, 1, 0.5f), 3);
  check_copies(memory, collide::spheres_xyz(m, 0, 0.5f), 1);
}
