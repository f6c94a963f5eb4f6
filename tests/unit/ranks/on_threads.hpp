/// Simulations on ranks that are threads, on the host.
#pragma once

#include <cstring>
#include <functional>
#include <memory>
#include <numeric>
#include <sstream>
#include <utility>

#include <collide/ranks/distributed_checkpoint.hpp>
#include <collide/ranks/thread_ranks.hpp>

#include "ranks/simulations.hpp"

namespace tests {

/// Ranks whose messages are under way until `end_exchange`: what is to be overwritten has other bytes till then.
class late_ranks {
 public:
  explicit late_ranks(collide::thread_ranks ranks) : ranks_(ranks) {}

  int rank() const { return ranks_.rank(); }
  int size() const { return ranks_.size(); }
  void all_gather(void const* mine, std::size_t bytes, void* all) const { ranks_.all_gather(mine, bytes, all); }
  void reduce(std::uint64_t const* mine, std::uint64_t* all, std::size_t n, collide::reduction how) const {
    ranks_.reduce(mine, all, n, how);
  }
  void exchange_counts(std::uint64_t const* to_each, std::uint64_t* of_each) const {
    ranks_.exchange_counts(to_each, of_each);
  }
  void exchange(void const* from, std::uint64_t const* to_each, void* to, std::uint64_t const* of_each,
                std::size_t bytes) const {
    ranks_.exchange(from, to_each, to, of_each, bytes);
  }
  void begin_exchange(void const* from, std::uint64_t const* to_each, void* to, std::uint64_t const* of_each,
                      std::size_t bytes) const {
    std::size_t const n = std::accumulate(of_each, of_each + size(), std::size_t{0}) * bytes;
    if (n != 0) std::memset(to, 0xff, n);
    *under_way_ = [=, ranks = ranks_] { ranks.exchange(from, to_each, to, of_each, bytes); };
  }
  void end_exchange() const { std::exchange(*under_way_, nullptr)(); }

 private:
  collide::thread_ranks ranks_;
  std::shared_ptr<std::function<void()>> under_way_ = std::make_shared<std::function<void()>>();
};

/// So many ranks make of the scene what one simulation does, however its particles are divided.
template <class Ranks = collide::thread_ranks, class Scene>
void check_on_threads(Scene const& scene, std::vector<int> const& sizes = {1, 2, 3, 4, 7},
                      std::vector<split> const& splits = {split::evenly, split::last, split::odd}) {
  expected_values<Scene> const expected(scene);
  for (int const n : sizes) {
    for (split const how : splits) {
      if (n == 1 && how != splits.front()) continue;
      std::vector<complaints> wrong(static_cast<std::size_t>(n));
      collide::thread_ranks::run(n, [&](collide::thread_ranks const& ranks) {
        check_scene(Ranks(ranks), scene, expected, how, wrong[static_cast<std::size_t>(ranks.rank())]);
      });
      for (auto const& w : wrong) CHECK(w.text() == "");
    }
  }
}

/// Ranks save the bytes that one saves; one, and any number of ranks, go on from them.
template <class Scene>
void check_checkpoints(Scene const& scene) {
  using simulation = typename Scene::simulation;
  std::apply(
      [&](auto const&... effects) {
        world_in<collide::host, typename Scene::S> const there(collide::host(1), scene.w);
        auto const half = static_cast<std::size_t>(scene.steps / 2);
        std::ostringstream saved, end;
        simulation one(collide::host(1), effects...);
        there.set_mesh(one, scene.bodies);
        there.set(one, {0, scene.w.size()}, scene.capacity);
        one.steps(half, scene.dt);
        collide::save(one, saved);
        one.steps(half, scene.dt);
        collide::save(one, end);
        for (int const n : {1, 2, 5}) {
          CAPTURE(n);
          std::ostringstream from_start, at_end;
          collide::thread_ranks::run(n, [&](collide::thread_ranks const& ranks) {
            auto const own = part_of(scene.w.size(), split::odd, ranks.rank(), n);
            collide::distributed<simulation, collide::thread_ranks> parts(ranks, collide::host(1), effects...);
            there.set_mesh(parts, scene.bodies);
            there.set(parts, own, scene.capacity);
            parts.steps(half, scene.dt);
            collide::save(parts, from_start);
            collide::distributed<simulation, collide::thread_ranks> later(ranks, collide::host(1));
            there.set_mesh(later, scene.bodies);
            std::istringstream before(saved.str());
            collide::load(later, before);
            later.steps(half, scene.dt);
            collide::save(later, at_end);
          });
          CHECK((from_start.str() == saved.str()));
          CHECK((at_end.str() == end.str()));
          simulation alone(collide::host(1));
          there.set_mesh(alone, scene.bodies);
          std::istringstream before(from_start.str());
          collide::load(alone, before);
          alone.steps(half, scene.dt);
          values_of<simulation> expected, found, on_ranks;
          expected.read(one);
          found.read(alone);
          CHECK(equal(found, expected));
          std::istringstream last(at_end.str());
          collide::load(alone, last);
          on_ranks.read(alone);
          CHECK(equal(on_ranks, expected));
        }
      },
      scene.effects);
}

}  // namespace tests
