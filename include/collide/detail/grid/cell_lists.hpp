/// \file
/// The triangles of each cell of grids, in memory of a space.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <collide/detail/execution/launch.hpp>
#include <collide/detail/grid/build.hpp>
#include <collide/detail/grid/grid.hpp>
#include <collide/detail/grid/memory_plan.hpp>
#include <collide/memory.hpp>
#include <collide/mesh.hpp>

namespace collide::detail {

/// Grids in memory of a space.
template <class S>
struct planned_grids {
  grid<S> const* data;
  int count;
  std::uint32_t table_bits;  ///< log2 of the number of cells per grid
  std::size_t cells;         ///< of all grids
};

/// The entries of all cells, and where those of each cell are.
template <class S>
class cell_lists {
 public:
  /// Enters triangles into the cells of grids; `boxes` are those of the triangles, or null. Of more entries than
  /// `limit` some are missing, which `total` tells. If it `asks` for their number, and waits, there is memory for no
  /// more than that.
  template <class Space>
  void enter(Space& space, mesh_view<S> const& mesh, triangle_aabb<S> const* boxes, planned_grids<S> const& grids,
             std::size_t limit, bool asks) {
    cells_ = grids.cells;
    std::size_t const n = mesh.size();
    auto* const lists = lists_.reserve(space.resource(), table_size(cells_));
    space.fill(lists, 0, (cells_ + 1) * sizeof *lists);
    auto const pass_over = [&](auto const& pass) {
      using kernel = enter_triangles<S, std::decay_t<decltype(pass)>>;
      std::size_t const share = kernel::triangles_of_block(n, Space::template block<kernel>::num_threads);
      space.launch((n + share - 1) / share, kernel{mesh, boxes, grids.data, grids.count, pass, share});
    };
    pass_over(count_entries{lists});
    allocate_entries<S> const allocation{grids.data, grids.table_bits, cells_, lists, occupied(), &lists[cells_].count};
    space.launch(grid_size<Space>(cells_, allocation), allocation);
    std::size_t const capacity = asks ? std::min<std::size_t>(space.read(total()), limit) : limit;
    entries_.reserve(space.resource(), capacity);
    pass_over(fill_entries{lists, entries_.data(), entries_.capacity()});
  }

  /// Returns the memory.
  void release() {
    lists_.release();
    entries_.release();
  }

  item_range const* data() const { return lists_.data(); }
  std::uint32_t const* total() const { return &lists_.data()[cells_].count; }
  std::uint8_t* occupied() const { return reinterpret_cast<std::uint8_t*>(lists_.data() + cells_ + 1); }
  cell_item const* entries() const { return entries_.data(); }
  std::size_t capacity() const { return entries_.capacity(); }

 private:
  std::size_t cells_ = 0;
  buffer<item_range> lists_;
  buffer<cell_item> entries_;
};

}  // namespace collide::detail
