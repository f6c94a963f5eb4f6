/// \file
/// Triangles are entered into the cells: count, allocate, fill.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/detail/execution/atomic.hpp>
#include <collide/detail/geometry/aabb.hpp>
#include <collide/detail/grid/grid.hpp>
#include <collide/mesh.hpp>

// the numbers of elements of small arrays are int
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-conversion"

namespace collide::detail {

/// Visits the cells of triangles in all grids: the common part of counting and filling. `Parts` threads, next to each
/// other, share the cells of a triangle, because each cell's counter takes its time to answer, and counters next to
/// each other answer together.
template <class S, int Parts>
struct triangle_insertion {
  mesh_view<S> mesh;
  triangle_aabb<S> const* boxes;  ///< null if there was no room for them
  grid<S> const* grids;
  int grid_count;

  /// How many threads there are.
  std::size_t size() const { return mesh.size() * Parts; }

  static constexpr int together = Parts > 1 ? 4 : 1;  ///< cells that a thread asks at a time

  /// Calls f(cells, n, triangle) for all cells that are this thread's, n of at most `together` at a time.
  template <class F>
  COLLIDE_HD_INLINE void each_cells(std::size_t thread, F const& f) const {
    auto const number = static_cast<id>(thread / Parts);
    aabb<S> const around = box_at(number);
    for (int g = 0; g < grid_count; ++g) {
      grids[g].template each_cells<together>(
          around, static_cast<std::uint32_t>(thread % Parts), Parts,
          [&](cell_ref const(&cells)[together], std::uint32_t n) { f(cells, n, number); });
    }
  }

 private:
  COLLIDE_HD_INLINE aabb<S> box_at(std::size_t i) const {
    triangle_aabb<S> const b = boxes != nullptr ? boxes[i] : triangle_aabb_of(mesh[i]);
    return b;
  }
};

/// Kernel body of `for_each` over an insertion's threads: counts the entries of each cell.
template <class S, int Parts>
struct count_entries {
  triangle_insertion<S, Parts> insertion;
  item_range* cells;
  COLLIDE_HD void operator()(std::size_t thread) const {
    constexpr std::uint32_t together = triangle_insertion<S, Parts>::together;
    insertion.each_cells(thread, [&](auto const& some, std::uint32_t n, id) {
      for (std::uint32_t k = 0; k < together; ++k) {
        if (k < n) fetch_add(&cells[some[k].number].count, 1u);
      }
    });
  }
};

/// Kernel body: finds a place for the entries of each cell, and sets a bit for every cell that has some. Which cell's
/// come first is open; those of cells next to each other are next to each other, but for the ends of blocks.
template <class S>
struct allocate_entries {
  static constexpr int items = 8;  ///< cells of a lane: their bits are a byte

  grid<S> const* grids;
  std::uint32_t table_bits;
  std::size_t cell_count;  ///< of all grids
  item_range* cells;       ///< aligned to 16 bytes
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
    constexpr auto n = static_cast<std::size_t>(Block::items);
    std::size_t const first = block.index() * Block::num_threads * n;
    std::size_t const table = std::size_t{1} << table_bits;
    // a part of the table that the grid does not need; its lists are read all the same, to wait for both at once
    bool const needless = table >= Block::num_threads * n && (first & (table - 1)) >= grids[first >> table_bits].cells;
    typename Block::template thread_private<counts_of<Block>> own;
    auto const first_of = [&](int thread_rank) { return first + static_cast<std::size_t>(thread_rank) * n; };
    block.for_each_thread([&](int thread_rank) {
      std::uint32_t sum = 0;
      for (std::size_t k = 0; k < n; k += 2) {
        std::size_t const c = first_of(thread_rank) + k;
        auto const [a, b] = c < cell_count ? two_at(c) : two_lists{};
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
        if (c >= cell_count) break;
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
  /// What a lane reads and writes at once.
  struct alignas(16) two_lists {
    item_range a, b;
  };
  COLLIDE_HD_INLINE two_lists& two_at(std::size_t cell) const { return reinterpret_cast<two_lists*>(cells)[cell / 2]; }

  template <class Block>
  struct counts_of {
    std::uint32_t counts[Block::items];
  };
};

/// Kernel body of `for_each` over an insertion's threads: writes the entries.
template <class S, int Parts>
struct fill_entries {
  triangle_insertion<S, Parts> insertion;
  item_range* cells;
  cell_item* entries;
  std::size_t capacity;
  COLLIDE_HD void operator()(std::size_t thread) const {
    constexpr std::uint32_t together = triangle_insertion<S, Parts>::together;
    insertion.each_cells(thread, [&](auto const& some, std::uint32_t n, id triangle) {
      std::uint32_t slots[together] = {};
      for (std::uint32_t k = 0; k < together; ++k) {
        if (k < n) slots[k] = fetch_add(&cells[some[k].number].end, 1u);
      }
      for (std::uint32_t k = 0; k < together; ++k) {
        if (k < n && slots[k] < capacity) entries[slots[k]] = {triangle, some[k].coverage};
      }
    });
  }
};

}  // namespace collide::detail

#pragma GCC diagnostic pop
