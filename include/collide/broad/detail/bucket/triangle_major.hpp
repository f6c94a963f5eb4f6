/// \file
/// The triangles look for spheres that are sorted into cells; sorted_spheres.hpp explains why.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/broad/detail/bucket/bin_spheres.hpp>
#include <collide/broad/detail/bucket/triangle_group.hpp>
#include <collide/broad/detail/grid/triangle_cells.hpp>
#include <collide/query/detail/candidate_batch.hpp>
#include <collide/query/detail/candidate_pipeline.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace collide::detail {

/// Pairs that are near each other: bit k is of sphere `sphere` + k, or, in a group, of triangle `triangle` + k.
struct reached {
  std::uint32_t sphere;
  id triangle;
  std::uint32_t mask;
};

/// Triangles look for spheres in the cells that they touch. Narrow phases share these loops, which are compiled for two
/// vector units: `test` is called for the pairs that were found, of single triangles or of a group.
template <class S>
struct near_search {
  static constexpr std::uint32_t capacity = 256;
  reached found[capacity];
  std::uint32_t count;
  triangle_group<S> group;
  bool is_loaded;  ///< the group: most groups have no sphere near them, and are not read
  void* tester;
  void (*test)(void* tester, bool of_group);

  void run(spheres_in_cells<S> const& in, std::size_t begin, std::size_t end) {
    constexpr std::uint32_t n = triangle_group<S>::size;
    count = 0;
    bool const some_everywhere = in.ends[in.everywhere] != in.ends[in.everywhere + 1];
    for (std::size_t first = begin; first < end; first += n) {
      triangle_aabb<S> const& around = in.groups[first / n];
      if (around.is_empty()) continue;
      std::uint32_t const near = in.grids_near(around);
      if (near == 0 && !some_everywhere) continue;
      is_loaded = false;
      std::uint32_t together = 0;  // bits of grids where the group is compared as a whole
      for (int g = 0; g < in.grid_count; ++g) {
        if ((near >> g & 1) != 0 && is_small(around, in.grids[g])) together |= 1u << g;
      }
      if (near != together || some_everywhere) {
        load(in, first);
        for (int g = 0; g < in.grid_count; ++g) {
          if ((near & ~together) >> g & 1) together |= group.pays(in.grids[g]) ? 1u << g : 0;
        }
      }
      if (together != 0) {
        multiversioned([&] { look_together(in, first, together); });
        test(tester, true);
      }
      if (near == together && !some_everywhere) continue;
      multiversioned([&] { look(in, first, near & ~together); });
      test(tester, false);
    }
  }

 private:
  void load(spheres_in_cells<S> const& in, std::size_t first) {
    if (!is_loaded) multiversioned([&] { in.mesh.load(group, first / triangle_group<S>::size); });
    is_loaded = true;
  }

  /// Finds the spheres near single triangles of the group, in the grids whose bits are set.
  void look(spheres_in_cells<S> const& in, std::size_t first, std::uint32_t some) {
    for (std::uint32_t k = 0; k < triangle_group<S>::size; ++k) {
      if (!group.has(k)) continue;
      triangle_aabb<S> const around = group.box(k);
      auto const look_into = [&](std::uint32_t cell, std::uint32_t n) {
        std::uint32_t const last = in.ends[cell + n];
        for (std::uint32_t i = in.ends[cell]; i < last; i += in.spheres.simd_width) {
          std::uint32_t const here = in.spheres.reaching(around, i) & (0xffu >> (8 - min(last - i, 8u)));
          found[count] = {i, static_cast<id>(first) + k, here};
          count += here != 0;  // no branch: it would often be mispredicted
          if (count == capacity) test(tester, false);
        }
      };
      for (int g = 0; g < in.grid_count; ++g) {
        if ((some >> g & 1) == 0) continue;
        each_range(
            in.grids[g], around, [&] { return group[k]; }, look_into);
      }
      look_into(in.everywhere, 1);
    }
  }

  /// Finds the spheres near a group, in the grids whose bits are set, and which of its triangles they are near to.
  void look_together(spheres_in_cells<S> const& in, std::size_t first, std::uint32_t some) {
    triangle_aabb<S> const around = in.groups[first / triangle_group<S>::size];
    auto const look_into = [&](std::uint32_t cell, std::uint32_t n) {
      std::uint32_t const last = in.ends[cell + n];
      for (std::uint32_t i = in.ends[cell]; i < last; i += in.spheres.simd_width) {
        std::uint32_t near = in.spheres.reaching(around, i) & (0xffu >> (8 - min(last - i, 8u)));
        if (near != 0) load(in, first);
        for (; near != 0; near &= near - 1) {
          std::uint32_t const k = i + static_cast<std::uint32_t>(__builtin_ctz(near));
          std::uint32_t const mask =
              group.reached_by(in.spheres.x[k], in.spheres.y[k], in.spheres.z[k], in.spheres.reach[k]);
          found[count] = {k, static_cast<id>(first), mask};
          count += mask != 0;
          if (count == capacity) test(tester, true);
        }
      }
    };
    for (int g = 0; g < in.grid_count; ++g) {
      if ((some >> g & 1) != 0) each_range_of_group(in.grids[g], around, look_into);
    }
  }
};

/// Kernel functor of a block of one thread: triangles look for spheres in the cells that they touch.
template <class S, class NarrowPhase, class Output>
struct query_triangle_major {
  static constexpr int items = 4;

  candidate_pipeline<S, NarrowPhase, Output> pipeline;
  spheres_in_cells<S> in;
  bool leaves_out;  ///< spheres of which the output has enough: pays where most have many triangles near them

  template <class Block>
  struct scratch {
    near_search<S> near;
    candidate_batch<S> batch;
    pipeline_storage<Block> pipeline;
  };

  template <class Block>
  void operator()(Block& block, scratch<Block>& s) const {
    static_assert(Block::num_threads == 1, "collide: triangles look for spheres in blocks of one thread");
    pipeline.reset(s.pipeline, 0);
    s.batch.size = 0;
    auto test_found = [&](bool of_group) { of_group ? test_group(block, s) : test(block, s); };
    using tester = decltype(test_found);
    s.near.tester = &test_found;
    s.near.test = [](void* by, bool of_group) { (*static_cast<tester*>(by))(of_group); };
    std::size_t const begin = block.index() * Block::items;
    s.near.run(in, begin, min(begin + Block::items, in.mesh.mesh.size()));
    if constexpr (in_batches<NarrowPhase, S>) s.batch.decide(pipeline, block, s.pipeline);
    pipeline.drain(block, s.pipeline);
  }

 private:
  /// Tests what was found near single triangles of the group.
  template <class Block>
  [[gnu::noinline]] void test(Block& block, scratch<Block>& s) const {
    for (std::uint32_t i = 0; i < s.near.count; ++i) {
      reached const r = s.near.found[i];
      triangle<S> const t = s.near.group[r.triangle % triangle_group<S>::size];
      for (std::uint32_t rest = r.mask; rest != 0; rest &= rest - 1) {
        test_pair(block, s, r.sphere + static_cast<std::uint32_t>(__builtin_ctz(rest)), r.triangle, t);
      }
    }
    s.near.count = 0;
  }

  /// Tests what was found near a group.
  template <class Block>
  [[gnu::noinline]] void test_group(Block& block, scratch<Block>& s) const {
    if (s.near.count == 0) return;
    id const first = s.near.found[0].triangle;
    for (std::uint32_t i = 0; i < s.near.count; ++i) {
      reached const r = s.near.found[i];
      if (has_enough_of(r.sphere)) continue;
      if constexpr (is_discrete<NarrowPhase, S> && filtered_predicate<NarrowPhase>::value) {
        if (r.mask == s.near.group.there && s.near.group.is_inside(in.spheres[r.sphere])) {
          for (std::uint32_t rest = r.mask; rest != 0; rest &= rest - 1) {
            auto const k = static_cast<std::uint32_t>(__builtin_ctz(rest));
            pipeline.push_hit(block, s.pipeline, {in.spheres.number[r.sphere], in.mesh.number_of(first + k)});
            pipeline.drain_if_full(block, s.pipeline);
          }
          continue;
        }
      }
      for (std::uint32_t rest = r.mask; rest != 0; rest &= rest - 1) {
        auto const k = static_cast<std::uint32_t>(__builtin_ctz(rest));
        test_pair(block, s, r.sphere, first + k, s.near.group[k]);
      }
    }
    s.near.count = 0;
  }

  template <class Block>
  void test_pair(Block& block, scratch<Block>& s, std::uint32_t place, id number,
                 [[maybe_unused]] triangle<S> const& t) const {
    pair const p{in.spheres.number[place], in.mesh.number_of(number)};
    if constexpr (in_batches<NarrowPhase, S>) {
      if (s.batch.size == s.batch.capacity) s.batch.decide(pipeline, block, s.pipeline);
      s.batch.add(p, t, sphere_of(place));
    } else {
      pipeline.push(block, s.pipeline, p, sphere_of(place));
      pipeline.drain_if_full(block, s.pipeline);
    }
  }

  /// True if more hits of the sphere at a place would change nothing.
  bool has_enough_of(std::uint32_t place) const {
    return leaves_out && detail::has_enough_of(pipeline.output, in.spheres.number[place], 0);
  }

  /// The sphere as the narrow phase takes it.
  decltype(auto) sphere_of(std::uint32_t place) const {
    if constexpr (is_discrete<NarrowPhase, S>) {
      return in.spheres[place];
    } else {
      return static_cast<moving_sphere<S> const&>(in.spheres.moving[place]);
    }
  }
};

}  // namespace collide::detail
