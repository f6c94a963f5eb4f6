/// \file
/// Queries in a control loop: all memory is taken before it begins, from one arena, and the system is never asked
/// again.
#include <cstdio>
#include <memory_resource>
#include <vector>

#include <collide/bucket.cuh>

int main() {
  std::vector<unsigned char> arena(64 << 20);
  std::pmr::monotonic_buffer_resource chunk(arena.data(), arena.size(), std::pmr::null_memory_resource());
  std::pmr::unsynchronized_pool_resource pool({0, arena.size() / 4}, &chunk);
  collide::detector<collide::bucket> detector(collide::host(1, &pool));

  float const floor[] = {-9, -9, 0, 9, -9, 0, 0, 9, 0};
  std::size_t const n = 10000;
  float const radius = 0.1f;
  std::vector<float> centres(3 * n);
  std::vector<collide::contact<float>> found(2 * n);
  collide::contacts<float> contacts(found.data(), found.size());
  detector.build(collide::triangle_soup(floor, 1), radius);
  detector.reserve(n, found.size(), contacts);

  std::size_t most = 0;
  for (std::size_t cycle = 0; cycle < 100; ++cycle) {  // in each, more of them have come down
    for (std::size_t i = 0; i < n; ++i) centres[3 * i + 2] = i < 100 * cycle ? 0.05f : 1.0f;
    detector.query(collide::spheres_xyz(static_cast<float const*>(centres.data()), n, radius), contacts);
    if (!contacts.complete()) return 1;
    if (contacts.size() > most) most = contacts.size();
  }
  std::printf("at most %zu contacts in a cycle\n", most);
}
