/// Candidates that are decided several at a time, against one at a time.
#include <algorithm>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <collide/karabassi.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/query/detail/candidate_batch.hpp>
#include <collide/spaces/detail/block.hpp>

#include "query/pair_output.hpp"

using namespace collide::detail;

namespace {

using tests::pair_output;

using block_type = serial_block<4, 8>;

/// Random triangles and spheres of about one size, and displacements.
struct scene {
  std::vector<float> triangles, centres, displacements;
  std::size_t n;

  explicit scene(std::size_t count) : n{count} {
    std::mt19937 engine(1);
    std::uniform_real_distribution<float> uniform(-1, 1);
    for (std::size_t i = 0; i < 9 * n; ++i) triangles.push_back(2 * uniform(engine));
    for (std::size_t i = 0; i < 3 * n; ++i)
      centres.push_back(uniform(engine)), displacements.push_back(uniform(engine));
    // the last ones touch a face at exactly the radius
    for (std::size_t i = n - 20; i < n; ++i) {
      float const flat[] = {-8, -8, 0, 8, -8, 0, 0, 8, 0}, above[] = {0, 0, 0.5f}, along[] = {1, 0, 0};
      std::copy(flat, flat + 9, &triangles[9 * i]);
      std::copy(above, above + 3, &centres[3 * i]);
      std::copy(along, along + 3, &displacements[3 * i]);
    }
  }
};

/// Pairs (i, i) that are hits, in batches of any size.
template <class NarrowPhase, class Spheres>
std::vector<collide::pair> in_batches_of(int size, scene const& made, Spheres const& spheres) {
  std::vector<collide::pair> found;
  auto const mesh = collide::triangle_soup(made.triangles.data(), made.n);
  candidate_pipeline<float, NarrowPhase, pair_output> const pipeline{mesh, spheres, {&found}, nullptr};
  block_type block(0);
  pipeline_storage<block_type> hits;
  pipeline.reset(hits, 0);
  candidate_batch<float> batch;
  batch.size = 0;
  std::vector<std::decay_t<decltype(spheres[0])>> kept;  // those that move must stay where they are
  kept.reserve(made.n);
  for (std::size_t i = 0; i < made.n; ++i) {
    kept.push_back(spheres[i]);
    batch.add({static_cast<collide::id>(i), static_cast<collide::id>(i)}, mesh[i], kept.back());
    if (batch.size == size) batch.decide(pipeline, block, hits);
  }
  batch.decide(pipeline, block, hits);
  CHECK(batch.size == 0);
  pipeline.drain(block, hits);
  std::sort(found.begin(), found.end());
  return found;
}

template <class NarrowPhase, class Spheres>
void check(scene const& made, Spheres const& spheres) {
  std::vector<collide::id> expected;
  auto const mesh = collide::triangle_soup(made.triangles.data(), made.n);
  for (std::size_t i = 0; i < made.n; ++i) {
    if (NarrowPhase::intersects(mesh[i], spheres[i])) expected.push_back(static_cast<collide::id>(i));
  }
  CHECK(expected.size() > made.n / 10);
  CHECK(expected.size() < made.n);
  CHECK(expected.back() == made.n - 1);
  for (int size : {1, 5, candidate_batch<float>::capacity}) {
    std::vector<collide::id> found;
    for (auto const& p : in_batches_of<NarrowPhase>(size, made, spheres)) {
      CHECK(p.sphere == p.triangle);
      found.push_back(p.sphere);
    }
    CHECK(found == expected);
  }
}

}  // namespace

TEST_CASE("candidate batch: decides what the narrow phase decides, of static and moving spheres") {
  scene const made(1000);
  auto const spheres = collide::spheres_xyz(made.centres.data(), made.n, 0.5f);
  check<collide::karabassi<>>(made, spheres);
  check<collide::karabassi_swept<>>(made, collide::with_displacements(spheres, made.displacements.data()));
}
