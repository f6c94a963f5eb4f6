/// \file
/// The kernel of a broad phase that enumerates the candidates of one sphere after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include <collide/detail/geometry/swept_bounds.hpp>
#include <collide/detail/grid/triangle_ref.hpp>
#include <collide/detail/query/candidate_pipeline.hpp>

namespace collide::detail {

/// Converts to exactly one type, and not to its bases.
template <class T>
struct exactly {
  template <class U, class = std::enable_if_t<std::is_same<U, T>::value>>
  operator U const&() const;
};

struct ignore_candidate {
  COLLIDE_HD void operator()(id) const {}
};

/// True if a reference has a member `for_each_candidate` that takes `Sphere`, and not only its base.
template <class Ref, class Sphere, class = void>
struct enumerates_candidates_of : std::false_type {};
template <class Ref, class Sphere>
struct enumerates_candidates_of<Ref, Sphere,
                                std::void_t<decltype(std::declval<Ref const&>().for_each_candidate(
                                    std::declval<exactly<Sphere> const&>(), ignore_candidate{}))>> : std::true_type {};

/// Calls f(triangle) for each candidate of a sphere. One that moves is replaced by a sphere around its motion, unless
/// the reference takes it as it is.
template <class Ref, class Sphere, class F>
COLLIDE_HD_INLINE void for_each_candidate(Ref const& ref, Sphere const& s, F const& f) {
  if constexpr (enumerates_candidates_of<Ref, Sphere>::value) {
    ref.for_each_candidate(s, f);
  } else {
    ref.for_each_candidate(swept_bounding_sphere(s), f);
  }
}

/// Kernel functor: a thread has a sphere. Where threads work together a sphere's candidates are enumerated again for
/// each `items_per_thread` of them, as there is room for only so many.
template <class S, class NarrowPhase, class Output, class Ref>
struct per_sphere_query {
  static constexpr int items = 1;
  static constexpr int items_per_thread = 8;

  candidate_pipeline<S, NarrowPhase, Output> pipeline;
  Ref ref;

  template <class Block>
  struct scratch {
    pipeline_storage<Block, items_per_thread> pipeline;
    std::uint32_t unfinished;  ///< how often a sphere had more candidates; only rises
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    block.for_each_thread([&](int thread_rank) {
      pipeline.reset(s.pipeline, thread_rank);
      if (thread_rank == 0) s.unfinished = 0;
    });
    std::size_t const base = block.index() * Block::num_threads * Block::items;
    std::uint32_t seen = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(Block::items); ++k) {
      std::size_t const first = base + k * Block::num_threads;
      if constexpr (Block::num_threads == 1) {
        if (first < pipeline.spheres.size()) test_all(block, s, first);
        pipeline.drain_if_full(block, s.pipeline);
      } else {
        for (std::uint32_t skip = 0;; skip += items_per_thread) {
          block.for_each_thread([&](int thread_rank) {
            std::size_t const i = first + static_cast<std::size_t>(thread_rank);
            if (i < pipeline.spheres.size()) test_some(block, s, i, skip);
          });
          pipeline.drain_if_full(block, s.pipeline);
          std::uint32_t const unfinished = block.broadcast(s.unfinished);
          if (unfinished == seen) break;
          seen = unfinished;
        }
      }
    }
    pipeline.drain(block, s.pipeline);
  }

 private:
  template <class Block>
  COLLIDE_HD_INLINE void test_all(Block& block, scratch<Block>& s, std::size_t i) const {
    auto const own = pipeline.spheres[i];
    for_each_candidate(ref, own, [&](id t) { pipeline.push(block, s.pipeline, {static_cast<id>(i), t}, own); });
  }

  /// Candidates number `skip` and the next ones.
  template <class Block>
  COLLIDE_HD_INLINE void test_some(Block& block, scratch<Block>& s, std::size_t i, std::uint32_t skip) const {
    std::uint32_t number = 0;
    for_each_candidate(ref, pipeline.spheres[i], [&](id t) {
      if (number >= skip && number - skip < items_per_thread) pipeline.push(block, s.pipeline, {static_cast<id>(i), t});
      ++number;
    });
    if (number > skip + items_per_thread) block.add(s.unfinished, 1);
  }
};

/// A reference to the triangles near a single sphere; the members are those of triangle_ref.hpp. A cursor is
/// the number of a triangle: the next candidate is that of the least number from there on, for which all are
/// enumerated.
template <class S, class Ref>
struct per_sphere_ref : triangle_ref<S> {
  Ref ref;

  COLLIDE_HD per_sphere_ref const& without_overflown_grids() const { return *this; }
  template <class Sphere>
  COLLIDE_HD bool next(Sphere const& s, candidate_cursor& c, std::uint32_t, candidate_range& range) const {
    if (c.at_end() || this->mesh.size() == 0) return false;
    id least = no_id;
    for_each_candidate(ref, s, [&](id t) {
      if (t >= c.skip && t < least) least = t;
    });
    if (least == no_id) {
      c.grid = candidate_cursor::ended;
      return false;
    }
    range = {nullptr, least, 1, cell_coverage::full_query};
    c.skip = least + 1;
    return true;
  }
};

}  // namespace collide::detail
