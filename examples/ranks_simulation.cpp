/// \file
/// A simulation on ranks that are threads: each puts some grains into it. The same code runs on the processes of MPI.

#include <cstdio>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/effects/bounce.hpp>
#include <collide/effects/friction.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/ranks/distributed_simulation.cuh>
#include <collide/ranks/thread_ranks.hpp>

using grains = collide::simulation<collide::detector<collide::bucket>, collide::sphere_contact, collide::gravity,
                                   collide::bounce, collide::friction>;

/// The program of a rank. Returns the heights of its grains in the end.
template <class Ranks>
std::vector<float> work(Ranks const& ranks, int count) {
  float const floor[] = {-9, -9, 0, 9, -9, 0, 0, 9, 0};
  std::vector<float> centres;
  for (int i = count * ranks.rank() / ranks.size(); i < count * (ranks.rank() + 1) / ranks.size(); ++i) {
    auto const x = static_cast<float>(i % 10), z = static_cast<float>(i / 10);
    centres.insert(centres.end(), {0.19f * x, 0.02f * z, 0.2f + 0.21f * z});
  }
  collide::distributed<grains, Ranks> simulation(ranks, collide::host(1),
                                                 collide::sphere_contact::from_restitution(0.3, 0.02, 0.1, 2500, 0.4),
                                                 collide::gravity{}, collide::bounce{0.3}, collide::friction{});
  simulation.set_mesh(collide::triangle_soup(floor, 1));  // all of it, on every rank
  simulation.set(collide::spheres_xyz(centres.data(), centres.size() / 3, 0.1f));
  simulation.steps(500, 0.001f);
  std::vector<float> heights;
  auto const x = simulation.template to_host<collide::position>();  // of the grains that this rank has set
  for (std::size_t i = 2; i < x.size(); i += 3) heights.push_back(x[i]);
  return heights;
}

int main() {
  std::vector<float> one, all(200);
  collide::thread_ranks::run(1, [&](auto const& ranks) { one = work(ranks, 200); });
  collide::thread_ranks::run(3, [&](auto const& ranks) {
    std::vector<float> const heights = work(ranks, 200);
    std::copy(heights.begin(), heights.end(),
              all.begin() + static_cast<std::ptrdiff_t>(count_before(ranks, heights.size())));
  });
  std::printf("%s\n", one == all ? "three ranks give the bits of one" : "something is different");
}
