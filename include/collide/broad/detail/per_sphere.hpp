/// \file
/// The kernel of a broad phase that enumerates the candidates of one sphere after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include <collide/broad/detail/mesh_lookup.hpp>
#include <collide/exact/detail/geometry/bounding_sphere.hpp>
#include <collide/query/detail/candidate_batch.hpp>
#include <collide/query/detail/candidate_pipeline.hpp>

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

/// True if a reference can go on with an enumeration where it was left: its members `begin` and `next`.
template <class Ref, class S, class = void>
struct resumes : std::false_type {};
template <class Ref, class S>
struct resumes<Ref, S,
               std::void_t<decltype(std::declval<Ref const&>().next(
                   std::declval<sphere<S> const&>(),
                   std::declval<decltype(std::declval<Ref const&>().begin(std::declval<sphere<S> const&>()))&>(),
                   std::declval<id&>()))>> : std::true_type {};

/// How far the candidates of a sphere have been gone through, of a reference that cannot go on by itself: how many
/// there were.
struct enumeration_count {
  std::uint32_t seen;
};

template <class Ref, class S>
COLLIDE_HD_INLINE auto begin_candidates([[maybe_unused]] Ref const& ref, [[maybe_unused]] sphere<S> const& s) {
  if constexpr (resumes<Ref, S>::value) {
    return ref.begin(s);
  } else {
    return enumeration_count{0};
  }
}

/// Calls f(triangle) for at most `max_count` more candidates; false if it has come to the end. What cannot go on
/// enumerates all that it has had once more.
template <class Ref, class Sphere, class Cursor, class F>
COLLIDE_HD_INLINE bool next_candidates(Ref const& ref, Sphere const& s, Cursor& c, std::uint32_t max_count,
                                       F const& f) {
  if constexpr (std::is_same<Cursor, enumeration_count>::value) {
    std::uint32_t number = 0;
    for_each_candidate(ref, s, [&](id t) {
      if (number >= c.seen && number - c.seen < max_count) f(t);
      ++number;
    });
    c.seen += max_count;
    return number > c.seen;
  } else {
    auto const& around = swept_bounding_sphere(s);
    id t;
    for (std::uint32_t n = 0; n < max_count; ++n) {
      if (!ref.next(around, c, t)) return false;
      f(t);
    }
    return true;
  }
}

/// Kernel functor: a thread has a sphere after the other, and looks at some of its candidates at a time, as there is
/// room for only so many.
template <class S, class NarrowPhase, class Output, class Ref>
struct per_sphere_query {
  static constexpr int items = 4;
  static constexpr int items_per_thread = 8;

  candidate_pipeline<S, NarrowPhase, Output> pipeline;
  Ref ref;

  template <class Block>
  struct scratch {
    pipeline_storage<Block, items_per_thread> pipeline;
    std::uint32_t unfinished;  ///< how often a thread had more to do; only rises
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    typename Block::template thread_private<progress> own;
    std::size_t const base = block.index() * Block::num_threads * Block::items;
    block.for_each_thread([&](int thread_rank) {
      pipeline.reset(s.pipeline, thread_rank);
      if (thread_rank == 0) s.unfinished = 0;
      own[thread_rank].k = 0;
      start(own[thread_rank], base + static_cast<std::size_t>(thread_rank), Block::num_threads, Block::items);
    });
    for (std::uint32_t seen = 0;;) {
      block.for_each_thread([&](int thread_rank) {
        progress& p = own[thread_rank];
        std::size_t const first = base + static_cast<std::size_t>(thread_rank);
        for (std::uint32_t capacity = items_per_thread; capacity != 0 && p.k < Block::items;) {
          std::size_t const i = first + static_cast<std::size_t>(p.k) * Block::num_threads;
          auto const sphere = pipeline.spheres[i];
          bool const more = next_candidates(ref, sphere, p.at, capacity, [&](id t) {
            pipeline.push(block, s.pipeline, {static_cast<id>(i), t}, sphere);
            --capacity;
          });
          if (more) break;
          ++p.k;
          start(p, first, Block::num_threads, Block::items);
        }
        if (p.k < Block::items) block.add(s.unfinished, 1);
      });
      pipeline.drain_if_full(block, s.pipeline);
      std::uint32_t const unfinished = block.broadcast(s.unfinished);
      if (unfinished == seen) break;
      seen = unfinished;
    }
    pipeline.drain(block, s.pipeline);
  }

 private:
  /// How far a thread is: with its sphere number `k`.
  struct progress {
    int k;
    decltype(begin_candidates(std::declval<Ref const&>(), std::declval<sphere<S> const&>())) at;
  };

  /// Begins with sphere k of a thread, unless there is none.
  COLLIDE_HD_INLINE void start(progress& p, std::size_t first, std::size_t stride, int all) const {
    if (p.k >= all) return;
    std::size_t const i = first + static_cast<std::size_t>(p.k) * stride;
    if (i >= pipeline.spheres.size()) {
      p.k = all;
      return;
    }
    p.at = begin_candidates(ref, swept_bounding_sphere(pipeline.spheres[i]));
  }
};

/// Kernel functor of a host, for blocks of one thread: candidates are decided many at a time, in the lanes of the
/// processor's vector unit.
template <class S, class NarrowPhase, class Output, class Ref>
struct batched_per_sphere_query {
  static constexpr int items = 4;

  candidate_pipeline<S, NarrowPhase, Output> pipeline;
  Ref ref;

  template <class Block>
  struct scratch {
    static constexpr std::uint32_t capacity = 64, few = 4;
    pipeline_storage<Block> pipeline;
    candidate_batch<S> batch;
    id found[capacity];
    std::uint32_t size;
  };

  template <class Block>
  void operator()(Block& block, scratch<Block>& s) const {
    pipeline.reset(s.pipeline, 0);
    s.batch.size = 0;
    bool const wants_one = wants_one_of_each(pipeline.output, 0);
    std::uint32_t const max_count = wants_one ? s.few : s.capacity;
    std::size_t const begin = block.index() * Block::items, size = pipeline.spheres.size();
    for (std::size_t i = begin; i < begin + Block::items && i < size; ++i) {
      auto const own = pipeline.spheres[i];
      if constexpr (resumes<Ref, S>::value) {
        auto const around = swept_bounding_sphere(own);
        decltype(ref.begin(around)) at;
        bool more = true, begins = true;
        while (more) {
          multiversioned([&] {
            if (begins) at = ref.begin(around);
            s.size = 0;
            more = next_candidates(ref, around, at, max_count, [&](id t) { s.found[s.size++] = t; });
          });
          begins = false;
          for (std::uint32_t k = 0; k < s.size; ++k) take(block, s, {static_cast<id>(i), s.found[k]}, own);
          if (wants_one && more) more = !touches_already(block, s, static_cast<id>(i));
        }
      } else {
        for_each_candidate(ref, own, [&](id t) { take(block, s, {static_cast<id>(i), t}, own); });
      }
      // of spheres that move the batch has the address
      if constexpr (!is_discrete<NarrowPhase, S>) flush(block, s);
    }
    flush(block, s);
    pipeline.drain(block, s.pipeline);
  }

 private:
  template <class Block, class Sphere>
  void take(Block& block, scratch<Block>& s, pair p, Sphere const& own) const {
    if constexpr (in_batches<NarrowPhase, S>) {
      s.batch.add(p, pipeline.mesh[p.triangle], own);
      if (s.batch.size == s.batch.capacity) flush(block, s);
    } else {
      pipeline.push(block, s.pipeline, p, own);
      pipeline.drain_if_full(block, s.pipeline);
    }
  }

  /// True if the candidates so far have a hit of a sphere, all of which are decided and written.
  template <class Block>
  bool touches_already(Block& block, scratch<Block>& s, id sphere) const {
    flush(block, s);
    pipeline.drain(block, s.pipeline);
    return has_enough_of(pipeline.output, sphere, 0);
  }

  template <class Block>
  void flush(Block& block, scratch<Block>& s) const {
    if constexpr (in_batches<NarrowPhase, S>) {
      if (s.batch.size != 0) s.batch.decide(pipeline, block, s.pipeline);
    }
  }
};

/// A reference to the triangles near a single sphere; the members are those of mesh_lookup.hpp. Where the
/// reference cannot go on by itself a cursor is the number of a triangle: the next candidate is that of the least
/// number from there on, for which all are enumerated.
template <class S, class Ref>
struct per_sphere_ref : mesh_lookup<S> {
  Ref ref;

  COLLIDE_HD per_sphere_ref const& opened() const { return *this; }
  template <class Sphere>
  COLLIDE_HD bool empty([[maybe_unused]] Sphere const& s) const {
    if (this->mesh.size() == 0) return true;
    if constexpr (resumes<Ref, S>::value) {
      auto const& around = swept_bounding_sphere(s);
      auto at = ref.begin(around);
      id t;
      return !ref.next(around, at, t);
    } else {
      return false;
    }
  }
  template <class Sphere>
  COLLIDE_HD candidate_cursor begin([[maybe_unused]] Sphere const& s) const {
    candidate_cursor c{0, 0, 0, 0};
    if constexpr (resumes<Ref, S>::value) {
      if (this->mesh.size() != 0) keep(ref.begin(swept_bounding_sphere(s)), c);
    }
    return c;
  }
  template <class Sphere>
  COLLIDE_HD bool next(Sphere const& s, candidate_cursor& c, std::uint32_t, candidate_range& range) const {
    if (c.at_end() || this->mesh.size() == 0) return false;
    id found = no_id;
    if constexpr (resumes<Ref, S>::value) {
      auto const& around = swept_bounding_sphere(s);
      auto at = ref.begin(around);
      std::memcpy(static_cast<void*>(&at), &c.level, sizeof at);
      if (!ref.next(around, at, found)) found = no_id;
      keep(at, c);
    } else {
      for_each_candidate(ref, s, [&](id t) {
        if (t >= c.skip && t < found) found = t;
      });
      c.skip = found + 1;
    }
    if (found == no_id) {
      c.grid = candidate_cursor::ended;
      return false;
    }
    range = {nullptr, found, 1, cell_coverage::full_query};
    return true;
  }

 private:
  /// Keeps a cursor of the reference in what there is besides the number of a grid.
  template <class Cursor>
  static COLLIDE_HD_INLINE void keep(Cursor const& at, candidate_cursor& c) {
    static_assert(std::is_trivially_copyable<Cursor>::value && sizeof(Cursor) <= sizeof c - sizeof c.grid,
                  "collide: what begin() of a per_sphere reference returns is a trivially copyable value of at most 12 "
                  "bytes");
    std::memcpy(&c.level, &at, sizeof at);
  }
};

}  // namespace collide::detail
