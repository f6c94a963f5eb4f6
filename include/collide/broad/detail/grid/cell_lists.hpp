/// \file
/// The triangles of each cell of grids, in memory of a space: they are counted, given memory, and entered.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <collide/broad/detail/grid/grid.hpp>
#include <collide/broad/detail/grid/memory_plan.hpp>
#include <collide/broad/detail/grid/triangle_cells.hpp>
#include <collide/core/memory.hpp>
#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/mesh.hpp>
#include <collide/spaces/detail/atomic.hpp>
#include <collide/spaces/detail/block.hpp>

namespace collide::detail {

/// Counts the entries of cells.
struct count_entries {
  item_range* cells;

  /// Counts the cells whose bit is set.
  template <unsigned N>
  COLLIDE_HD_INLINE void operator()(cell_ref const (&some)[N], std::uint32_t mask, id) const {
    aggregated_count<N> counters;
    counters.match([&](std::uint32_t k) { return some[k].number; }, mask);
    counters.add([&](std::uint32_t cell) { return &cells[cell].count; });
  }
};

/// Writes the entries of cells.
struct fill_entries {
  item_range* cells;
  cell_item* entries;
  std::size_t capacity;

  /// First all counters are asked, then all entries written: so their answers come together.
  template <unsigned N>
  COLLIDE_HD_INLINE void operator()(cell_ref const (&some)[N], std::uint32_t mask, id triangle) const {
    aggregated_count<N> counters;
    counters.match([&](std::uint32_t k) { return some[k].number; }, mask);
    counters.add([&](std::uint32_t cell) { return &cells[cell].end; });
    for (std::uint32_t k = 0; k < N; ++k) {
      std::uint32_t const slot = counters.before(k);
      if ((mask >> k & 1) != 0 && slot < capacity) entries[slot] = {triangle, some[k].coverage};
    }
  }
};

/// Grids in memory of a space.
template <class S>
struct planned_grids {
  grid<S> const* data;
  int count;
  std::uint32_t table_bits;  ///< log2 of the number of cells per grid
  std::size_t cells;         ///< of all grids
  bool const* are_new;       ///< points to false if the triangles are in them; null: they are not

  COLLIDE_HD_INLINE bool are_entered() const { return are_new != nullptr && !*are_new; }
};

/// Kernel functor: counts or fills, with `Pass`, the cells of triangles. A thread enters a triangle that meets few
/// cells at once; the slabs of the others are spread evenly over the threads.
template <class S, class Pass>
struct enter_triangles {
  static constexpr int items = 1;
  /// A block takes fewer triangles where there would be fewer blocks than this: the slabs of large ones keep it busy.
  static constexpr std::size_t many_blocks = 240;
  static constexpr int together = 4;  ///< cells that a thread asks at a time

  mesh_view<S> mesh;
  triangle_aabb<S> const* boxes;  ///< null if there was no room for them
  planned_grids<S> grids;
  Pass pass;
  std::size_t per_block;  ///< triangles: at most `Block::num_threads`

  template <class Block>
  struct scratch {
    id large[Block::num_threads];
    std::uint32_t slabs[Block::num_threads];
    std::uint32_t count;
    typename Block::balance_storage balance;
  };

  /// How many triangles a block takes, of which no more than `threads`.
  static std::size_t triangles_of_block(std::size_t triangles, std::size_t threads) {
    std::size_t n = threads;
    while (n > 32 && triangles < n * many_blocks) n /= 2;
    return n;
  }

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    if (grids.are_entered()) return;
    for (int g = 0; g < grids.count; ++g) {
      if (grids.data[g].levels == 0) continue;
      block.for_each_thread([&](int thread_rank) {
        if (thread_rank == 0) s.count = 0;
      });
      block.for_each_thread([&](int thread_rank) {
        auto const k = static_cast<std::size_t>(thread_rank);
        std::size_t const i = block.index() * per_block + k;
        if (k < per_block && i < mesh.size()) enter_if_small(block, s, grids.data[g], static_cast<id>(i));
      });
      std::uint32_t const large = block.broadcast(s.count);
      if (large != 0) enter_slabs(block, s, grids.data[g], large);
    }
  }

 private:
  template <class Block>
  COLLIDE_HD_INLINE void enter_if_small(Block& block, scratch<Block>& s, grid<S> const& g, id triangle) const {
    aabb<S> const b = box_at(triangle);
    if (b.is_empty()) return;
    triangle_cells<S> const cells(g, g.level_of(b), b);
    if (cells.is_small()) return enter_box(cells, triangle);
    std::uint32_t const slot = block.add(s.count, 1);
    s.large[slot] = triangle;
    s.slabs[slot] = cells.slabs();
  }

  COLLIDE_HD_INLINE void enter_box(triangle_cells<S> const& cells, id triangle) const {
    cell_box const& r = cells.range();
    std::uint32_t const nx = r.upper[0] - r.lower[0] + 1, ny = r.upper[1] - r.lower[1] + 1,
                        n = nx * ny * (r.upper[2] - r.lower[2] + 1);
    // a quotient by 1, 2 or 3 of a number below 24
    auto const factor = [](std::uint32_t divisor) { return divisor == 1 ? 256u : (divisor == 2 ? 128u : 86u); };
    std::uint32_t const of_x = factor(nx), of_y = factor(ny);
    for (std::uint32_t i = 0; i < n; i += together) {
      cell_ref some[together];
      for (std::uint32_t k = 0; k < together; ++k) {
        std::uint32_t const row = ((i + k) * of_x) >> 8, z = (row * of_y) >> 8;
        some[k] = cells.at(r.lower[0] + (i + k - row * nx), r.lower[1] + (row - z * ny), r.lower[2] + z);
      }
      pass(some, (1u << min(n - i, std::uint32_t{together})) - 1, triangle);
    }
  }

  COLLIDE_HD_INLINE void enter_run(triangle_cells<S> const& cells, id triangle, std::uint32_t y, std::uint32_t z,
                                   std::uint32_t first, std::uint32_t last) const {
    for (std::uint32_t x = first; x <= last; x += together) {
      cell_ref some[together];
      for (std::uint32_t k = 0; k < together; ++k) some[k] = cells.at(x + k, y, z);
      pass(some, (1u << min(last - x + 1, std::uint32_t{together})) - 1, triangle);
    }
  }

  template <class Block>
  COLLIDE_HD_INLINE void enter_slabs(Block& block, scratch<Block>& s, grid<S> const& g, std::uint32_t n) const {
    block.template for_each_balanced<1>(
        s.balance, s.slabs, n, [&](std::uint32_t i) { return s.large[i]; }, [](id, std::uint32_t k) { return k; },
        [](id, std::uint32_t) { return true; }, [&](id triangle, std::uint32_t slab) { enter_slab(g, triangle, slab); },
        [](bool) {});
  }

  COLLIDE_HD_INLINE void enter_slab(grid<S> const& g, id number, std::uint32_t slab) const {
    triangle<S> const t = mesh[number];
    aabb<S> const b = aabb_of(t);
    triangle_cells<S> const cells(g, g.level_of(b), b);
    cells.each_run(slab, t, [&](std::uint32_t y, std::uint32_t z, std::uint32_t first, std::uint32_t last) {
      enter_run(cells, number, y, z, first, last);
    });
  }

  COLLIDE_HD_INLINE aabb<S> box_at(std::size_t i) const {
    if (boxes != nullptr) return boxes[i];
    return aabb_of(mesh[i]);
  }
};

/// Kernel functor: finds a place for the entries of each cell, and sets a bit for every cell that has some. Which
/// cell's come first is open; those of cells next to each other are next to each other, except for the ends of blocks.
template <class S>
struct allocate_entries {
  static constexpr int items = 8;  ///< cells of a thread: their bits are a byte

  planned_grids<S> grids;
  item_range* cells;  ///< aligned to 16 bytes
  std::uint8_t* occupied;
  std::uint32_t* total;  ///< 0 at first

  template <class Block>
  struct scratch {
    std::uint32_t sums[Block::num_threads];
    std::uint32_t begin;
    typename Block::scan_storage scan;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    static_assert(Block::items % items == 0, "collide: bits of cells are written byte by byte");
    if (grids.are_entered()) return;
    constexpr auto n = static_cast<std::size_t>(Block::items);
    std::size_t const first = block.index() * Block::num_threads * n;
    std::size_t const table = std::size_t{1} << grids.table_bits;
    // a part of the table that the grid does not need; its lists are read all the same, to wait for both at once
    bool const needless =
        table >= Block::num_threads * n && (first & (table - 1)) >= grids.data[first >> grids.table_bits].cells;
    typename Block::template thread_private<counts_of<Block>> own;
    auto const first_of = [&](int thread_rank) { return first + static_cast<std::size_t>(thread_rank) * n; };
    block.for_each_thread([&](int thread_rank) {
      std::uint32_t sum = 0;
      for (std::size_t k = 0; k < n; k += 2) {
        std::size_t const c = first_of(thread_rank) + k;
        auto const [a, b] = c < grids.cells ? two_at(c) : two_lists{};
        own[thread_rank].counts[k] = a.count;
        own[thread_rank].counts[k + 1] = b.count;
        sum += a.count + b.count;
      }
      s.sums[thread_rank] = sum;
    });
    if (needless) return;
    std::uint32_t const sum = block.scan(s.scan, s.sums, Block::num_threads);
    block.for_each_thread([&](int thread_rank) {
      if (thread_rank == 0) s.begin = fetch_add(total, sum);
    });
    block.for_each_thread([&](int thread_rank) {
      std::uint32_t begin = s.begin + s.sums[thread_rank];
      for (std::size_t k = 0; k < n; k += items) {
        std::size_t const c = first_of(thread_rank) + k;
        if (c >= grids.cells) break;
        std::uint32_t bits = 0;
        for (std::uint32_t i = 0; i < items; i += 2) {
          std::uint32_t const a = own[thread_rank].counts[k + i], b = own[thread_rank].counts[k + i + 1];
          two_at(c + i) = {{a, begin}, {b, begin + a}};
          begin += a + b;
          bits |= ((a != 0 ? 1u : 0u) | (b != 0 ? 2u : 0u)) << i;
        }
        occupied[c / items] = static_cast<std::uint8_t>(bits);
      }
    });
  }

 private:
  /// Two lists, which a thread reads and writes at once.
  struct alignas(16) two_lists {
    item_range a, b;
  };
  COLLIDE_HD_INLINE two_lists& two_at(std::size_t cell) const { return reinterpret_cast<two_lists*>(cells)[cell / 2]; }

  template <class Block>
  struct counts_of {
    std::uint32_t counts[Block::items];
  };
};

/// The entries of all cells, and where those of each cell are.
template <class S>
class cell_lists {
 public:
  /// Memory of the lists of `cells` cells, of the number of all entries, and of bits: `table_size` words, which the
  /// caller empties before `enter`, except for the bits.
  template <class Space>
  item_range* to_empty(Space& space, std::size_t cells) {
    cells_ = cells;
    are_empty_ = true;
    return lists_.reserve(space.resource(), table_size(cells));
  }

  /// Enters triangles into the cells of grids; `boxes` are those of the triangles, or null. Of more entries than
  /// `limit` some are missing, which `total` tells. If it `asks` for their number, and waits, there is memory for no
  /// more than that.
  template <class Space>
  void enter(Space& space, mesh_view<S> const& mesh, triangle_aabb<S> const* boxes, planned_grids<S> const& grids,
             std::size_t limit, bool asks) {
    cells_ = grids.cells;
    std::size_t const n = mesh.size();
    auto* const lists = lists_.reserve(space.resource(), table_size(cells_));
    if (!are_empty_) space.fill(lists, 0, (cells_ + 1) * sizeof *lists);
    are_empty_ = false;
    auto const pass_over = [&](auto const& pass) {
      using kernel = enter_triangles<S, std::decay_t<decltype(pass)>>;
      std::size_t const share = kernel::triangles_of_block(n, Space::template block<kernel>::num_threads);
      space.launch((n + share - 1) / share, kernel{mesh, boxes, grids, pass, share});
    };
    pass_over(count_entries{lists});
    allocate_entries<S> const allocation{grids, lists, occupied(), &lists[cells_].count};
    space.launch(grid_size<Space>(cells_, allocation), allocation);
    std::size_t const capacity = asks ? std::min<std::size_t>(space.read(total()), limit) : limit;
    entries_.reserve(space.resource(), capacity);
    pass_over(fill_entries{lists, entries_.data(), entries_.capacity()});
  }

  /// Returns the memory.
  void release() {
    lists_.release();
    entries_.release();
    are_empty_ = false;
  }

  item_range const* data() const { return lists_.data(); }
  std::uint32_t const* total() const { return &lists_.data()[cells_].count; }
  std::uint8_t* occupied() const { return reinterpret_cast<std::uint8_t*>(lists_.data() + cells_ + 1); }
  cell_item const* entries() const { return entries_.data(); }
  std::size_t capacity() const { return entries_.capacity(); }

 private:
  std::size_t cells_ = 0;
  bool are_empty_ = false;  ///< as `to_empty` asked
  buffer<item_range> lists_;
  buffer<cell_item> entries_;
};

}  // namespace collide::detail
