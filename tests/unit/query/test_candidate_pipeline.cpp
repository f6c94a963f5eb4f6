/// From candidates to hits in a sink, in blocks of one thread and of several.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <doctest/doctest.h>

#include <collide/karabassi.hpp>
#include <collide/query/detail/candidate_pipeline.hpp>
#include <collide/spaces/detail/block.hpp>

#include "execution/lockstep.hpp"

using namespace collide::detail;

namespace {

using serial = serial_block<4, 8>;
using forward = tests::lockstep_block<8, 4, false>;
using reversed = tests::lockstep_block<8, 4, true>;

struct counted_output {
  std::vector<collide::pair>* to;
  int* allocations;
  std::uint64_t allocate(std::uint64_t n) const { return ++*allocations, to->resize(to->size() + n), to->size() - n; }
  template <class Hit>
  void store(std::uint64_t slot, Hit const& hit) const {
    (*to)[static_cast<std::size_t>(slot)] = {hit.sphere, hit.triangle};
  }
};

/// A triangle, and spheres above it: in turn they overlap it, miss it, and touch it at exactly the radius.
constexpr std::size_t n = 1000;
float const vertices[] = {-8, -8, 0, 8, -8, 0, 0, 8, 0};
auto const mesh = collide::triangle_soup(vertices, 1);

std::vector<float> centres() {
  float const heights[] = {0.25f, 0.75f, 0.5f};
  std::vector<float> all;
  for (std::size_t i = 0; i < n; ++i) all.insert(all.end(), {0.001f * static_cast<float>(i), 0, heights[i % 3]});
  return all;
}

/// Pushes all spheres, two at a time for each thread.
template <class Block, class Pipeline>
void push_all(Pipeline const& pipeline) {
  using storage = pipeline_storage<Block, 2>;
  auto const memory = std::make_unique<storage>();
  Block block(0);
  block.for_each_thread([&](int thread_rank) { pipeline.reset(*memory, thread_rank); });
  for (std::size_t first = 0; first < n; first += 2 * Block::num_threads) {
    block.for_each_thread([&](int thread_rank) {
      for (std::size_t k = 0; k < 2; ++k) {
        std::size_t const i = first + 2 * static_cast<std::size_t>(thread_rank) + k;
        if (i < n) pipeline.push(block, *memory, {static_cast<collide::id>(i), 0});
      }
    });
    pipeline.drain_if_full(block, *memory);
  }
  pipeline.drain(block, *memory);
}

/// The spheres of sorted pairs.
std::vector<collide::id> spheres_of(std::vector<collide::pair> const& pairs) {
  std::vector<collide::id> all;
  for (auto const& p : pairs) all.push_back(p.sphere);
  std::sort(all.begin(), all.end());
  return all;
}

/// The spheres whose number has one of these remainders modulo 3.
std::vector<collide::id> with_remainders(std::vector<std::size_t> const& which) {
  std::vector<collide::id> all;
  for (std::size_t i = 0; i < n; ++i) {
    if (std::count(which.begin(), which.end(), i % 3) != 0) all.push_back(static_cast<collide::id>(i));
  }
  return all;
}

}  // namespace

TEST_CASE_TEMPLATE("candidate pipeline: each hit once, room for many at a time", Block, serial, forward, reversed) {
  auto const where = centres();
  std::vector<collide::pair> found;
  int allocations = 0;
  candidate_pipeline<float, collide::karabassi<>, counted_output> const pipeline{
      mesh, collide::spheres_xyz(where.data(), n, 0.5f), {&found, &allocations}, nullptr};
  push_all<Block>(pipeline);
  CHECK(spheres_of(found) == with_remainders({0, 2}));
  CHECK(allocations <= int(n) / 8 + 1);  // at least half of what a block gathers, each time but the last
}

TEST_CASE_TEMPLATE("candidate pipeline: boxes rule out what is out of reach before the narrow phase", Block, serial,
                   forward, reversed) {
  auto const where = centres();
  triangle_aabb<float> far = triangle_aabb_of(mesh[0]);
  for (int k = 0; k < 3; ++k) far.lower[k] += 100, far.upper[k] += 100;
  std::vector<collide::pair> found;
  int allocations = 0;
  // `baseline` does not begin with a box of its own
  candidate_pipeline<float, collide::karabassi<collide::baseline>, counted_output> const pipeline{
      mesh, collide::spheres_xyz(where.data(), n, 0.5f), {&found, &allocations}, &far};
  push_all<Block>(pipeline);
  CHECK(found.empty());
  CHECK(allocations == 0);
}

TEST_CASE_TEMPLATE("candidate pipeline: what the filter leaves open goes to a list, as far as there is room", Block,
                   serial, forward, reversed) {
  auto const where = centres();
  std::vector<collide::id> const hits = with_remainders({0}), open = with_remainders({2});
  for (std::size_t room : {std::size_t{0}, std::size_t{10}, n}) {
    std::vector<collide::pair> found, later(n, {collide::no_id, collide::no_id});
    int allocations = 0;
    deferred_pairs::counters counters{0, 0};
    using output = output_with_deferral<counted_output>;
    static_assert(defers_pairs<output>);
    candidate_pipeline<float, collide::karabassi<>, output> const pipeline{
        mesh,
        collide::spheres_xyz(where.data(), n, 0.5f),
        {{&found, &allocations}, {&counters, later.data(), room, {}}},
        nullptr};
    push_all<Block>(pipeline);
    CHECK(spheres_of(found) == hits);
    CHECK(counters.total == open.size());
    CHECK(std::all_of(later.begin() + static_cast<std::ptrdiff_t>(std::min(room, open.size())), later.end(),
                      [](auto const& p) { return p.sphere == collide::no_id; }));
    later.resize(std::min(room, open.size()));
    auto const listed = spheres_of(later);
    CHECK(std::includes(open.begin(), open.end(), listed.begin(), listed.end()));
    CHECK(std::unique(later.begin(), later.end(), [](auto const& a, auto const& b) { return a.sphere == b.sphere; }) ==
          later.end());
  }
}
