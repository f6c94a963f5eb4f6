/// \file
/// What a CPU makes of the spheres before it looks at triangles: a list of those that have candidates, in the order of
/// their cells.
///
/// Most spheres are in empty cells and are sorted out at the pace of the memory. The others would read lists and
/// triangles all over the place, each time from a far cache; in the order of the cells they read them from the nearest.
#pragma once

#include <collide/detail/candidate_batch.hpp>
#include <collide/detail/grid.hpp>
#include <collide/detail/hits.hpp>
#include <collide/detail/partition.hpp>
#include <collide/detail/sphere_batch.hpp>
#include <collide/memory.hpp>

namespace collide::detail {

/// A sphere, and a cell with triangles that it may touch.
template <class S>
struct placed {
  static constexpr std::uint32_t everywhere = 0xffffffffu;  ///< the cell of a sphere that no grid serves

  std::uint32_t cell;
  id number;
  sphere<S> ball;  ///< a copy: in the order of the cells the caller's memory would be read all over the place
};

/// Kernel body of a block of one lane: lists the spheres that have candidates.
template <class S>
struct place_spheres {
  static constexpr int items = 4;
  static constexpr std::size_t batches = 16;  ///< of `Block::items` spheres

  sphere_view<S> spheres;
  grid<S> const* grids;
  int grid_count;
  std::uint32_t const* occupied;
  placed<S>* to;
  std::uint64_t* total;
  std::uint64_t capacity;

  template <class Block>
  struct scratch {
    static constexpr std::size_t room = 16 * Block::items;
    placed<S> found[room];
    std::size_t count;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    constexpr int n = Block::items;
    static_assert(Block::lanes == 1 && n == 64, "collide: spheres are placed 64 at a time");
    std::size_t const begin = block.index() * batches * n;
    s.count = 0;
    for (std::size_t first = begin; first < begin + batches * n && first < spheres.size(); first += n) {
      sphere_batch<S, n> batch;
      batch.load(spheres, first);
      std::uint64_t open = mask_of<n>([&](int k) { return valid_radius(batch.radius[k]); });
      // by rising reach, so that a sphere ends up in the tightest
      for (int g = grid_count - 1; g >= 0 && open != 0; --g) {
        grid<S> const& box = grids[g];
        std::uint64_t const served = open & mask_of<n>([&](int k) { return batch.radius[k] <= box.reach; });
        std::uint64_t const inside = served & mask_of<n>([&](int k) {
          return (batch.x[k] >= box.lower[0]) & (batch.x[k] <= box.upper[0]) & (batch.y[k] >= box.lower[1]) &
                 (batch.y[k] <= box.upper[1]) & (batch.z[k] >= box.lower[2]) & (batch.z[k] <= box.upper[2]);
        });
        open &= ~served;
        if (inside == 0) continue;
        for (int l = 0; l < box.levels; ++l) {
          grid_level<S> const& level = box.level[l];
          make_room(s);
          for (std::uint64_t rest = inside; rest != 0; rest &= rest - 1) {
            int const k = __builtin_ctzll(rest);
            std::uint32_t const cell = box.cell_of(level, {batch.x[k], batch.y[k], batch.z[k]});
            s.found[s.count] = listed(batch, cell, first, k);
            s.count += occupied[cell / 32] >> cell % 32 & 1;
          }
        }
      }
      if (open != 0) {
        make_room(s);
        for (std::uint64_t rest = open; rest != 0; rest &= rest - 1) {
          s.found[s.count++] = listed(batch, placed<S>::everywhere, first, __builtin_ctzll(rest));
        }
      }
    }
    flush(s);
  }

 private:
  template <class Batch>
  static COLLIDE_HD_INLINE placed<S> listed(Batch const& batch, std::uint32_t cell, std::size_t first, int k) {
    return {cell, static_cast<id>(first) + static_cast<id>(k), {{batch.x[k], batch.y[k], batch.z[k]}, batch.radius[k]}};
  }

  /// Bit k is holds(k), for k < n <= 64. Without branches, for the processor's vector unit.
  template <int n, class Holds>
  static COLLIDE_HD_INLINE std::uint64_t mask_of(Holds const& holds) {
    unsigned char flags[n];
    for (int k = 0; k < n; ++k) flags[k] = holds(k);
    std::uint64_t mask = 0;
    for (int k = 0; k < n; k += 8) {
      std::uint64_t bytes;
      std::memcpy(&bytes, flags + k, sizeof bytes);
      mask |= (bytes * 0x0102040810204080u >> 56) << k;
    }
    return mask;
  }

  template <class Scratch>
  COLLIDE_HD_INLINE void make_room(Scratch& s) const {
    if (s.count + 64 > Scratch::room) flush(s);
  }

  template <class Scratch>
  COLLIDE_HD_INLINE void flush(Scratch& s) const {
    if (s.count == 0) return;
    std::uint64_t const slot = fetch_add(total, std::uint64_t{s.count});
    if (slot + s.count <= capacity) {
      for (std::size_t i = 0; i < s.count; ++i) to[slot + i] = s.found[i];
    }
    s.count = 0;
  }
};

/// Kernel body of a block of one lane: tests spheres with the triangles of their cells.
template <class S, class NarrowPhase, class Sink>
struct placed_query {
  static constexpr int items = 4;

  tester<S, NarrowPhase, Sink> tests;
  bounding_sphere<S> const* bounds;
  std::uint32_t const* ends;
  id const* entries;
  placed<S> const* spheres;
  std::size_t count;

  template <class Block>
  struct scratch {
    static constexpr std::uint32_t most = 256;  ///< candidates at a time
    id reached[most];
    candidate_batch<S> batch;
    hit_buffer<Block> hits;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    static_assert(Block::lanes == 1, "collide: spheres in the order of their cells are for blocks of one lane");
    if (!tests.begin(block, s.hits)) return;
    s.batch.size = 0;
    std::size_t const begin = block.index() * Block::items, end = smaller(begin + Block::items, count);
    for (std::size_t i = begin; i < end; ++i) {
      placed<S> const& p = spheres[i];
      if (p.cell == placed<S>::everywhere) {
        test_all(block, s, p.number, p.ball, static_cast<std::uint32_t>(tests.mesh.size()),
                 [](std::uint32_t k) { return static_cast<id>(k); });
      } else {
        id const* const list = entries + ends[p.cell];
        test_all(block, s, p.number, p.ball, ends[p.cell + 1] - ends[p.cell], [=](std::uint32_t k) { return list[k]; });
      }
    }
    s.batch.decide(tests, block, s.hits);
    tests.flush(block, s.hits);
  }

 private:
  /// Tests a sphere with n triangles.
  template <class Block, class List>
  COLLIDE_HD_INLINE void test_all(Block& block, scratch<Block>& s, id number, sphere<S> const& ball, std::uint32_t n,
                                  List const& list) const {
    for (std::uint32_t first = 0; first < n; first += s.most) {
      std::uint32_t const last = smaller(first + s.most, n);
      std::uint32_t reached = 0;  // no branch per candidate: it would often be mispredicted
      for (std::uint32_t k = first; k < last; ++k) {
        id const t = list(k);
        s.reached[reached] = t;
        reached += bounds[t].reached(ball.centre, ball.radius);
      }
      for (std::uint32_t k = 0; k < reached; ++k) {
        id const t = s.reached[k];
        s.batch.add({number, t}, tests.mesh[t], ball);
        if (s.batch.size == s.batch.room) s.batch.decide(tests, block, s.hits);
      }
    }
  }
};

/// The spheres of a query that have candidates, in the order of their cells.
template <class S>
class placed_spheres {
 public:
  /// Lists them. `cell_bits`: cells have numbers below 2^cell_bits.
  template <class Space>
  void place(Space& space, sphere_view<S> const& spheres, grid<S> const* grids, int grid_count,
             std::uint32_t const* occupied, std::uint32_t cell_bits) {
    std::uint64_t* const total = total_.reserve(space.resource(), 1);
    std::size_t const guess = spheres.size() / 16 + 1024;
    for (std::size_t room = larger(found_.capacity(), guess);; room = *total + *total / 4) {
      placed<S>* const found = found_.reserve(space.resource(), room);
      *total = 0;
      place_spheres<S> const body{spheres, grids, grid_count, occupied, found, total, room};
      constexpr std::size_t share = place_spheres<S>::batches * 64;
      space.launch((spheres.size() + share - 1) / share, body);
      if (*total <= room) break;
    }
    size_ = static_cast<std::size_t>(*total);
    placed<S>* const sorted = sorted_.reserve(space.resource(), found_.capacity());
    std::uint32_t const last = (1u << partition_table::bits) - 1;
    std::uint32_t const shift = cell_bits > partition_table::bits ? cell_bits - partition_table::bits : 0;
    partition(
        found_.data(), sorted, size_, partition_table::bits, [=](placed<S> const& p) { return smaller(p.cell >> shift, last); },
        table_);
  }

  placed<S> const* data() const { return sorted_.data(); }
  std::size_t size() const { return size_; }

 private:
  buffer<std::uint64_t> total_;
  buffer<placed<S>> found_, sorted_;
  std::size_t size_ = 0;
  partition_table table_;
};

}  // namespace collide::detail
