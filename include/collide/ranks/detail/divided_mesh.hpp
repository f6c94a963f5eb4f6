/// \file
/// A mesh of which each rank has a part: triangles near each other are on one rank, and all ranks have as many.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/core/memory.hpp>
#include <collide/mesh.hpp>
#include <collide/ranks/detail/device_exchange_buffer.hpp>
#include <collide/ranks/detail/rank_map.hpp>
#include <collide/sinks/detail/search_mesh.hpp>
#include <collide/spaces/detail/host_array.hpp>

namespace collide::detail {

template <class S>
class divided_mesh {
 public:
  /// All ranks call it, each with triangles that follow those of the ranks before it in number. O(triangles log
  /// triangles). Throws `error` if there are more than 2^32 - 2 in all.
  template <class Ranks, class Space>
  void build(Ranks const& ranks, Space const& space, mesh_view<S> const& mesh) {
    std::uint64_t const first = count_before(ranks, mesh.size()), size = mesh.size();
    ranks.reduce(&size, &all_, 1, reduction::sum);
    if (all_ >= no_id) throw error("collide: a mesh has at most 2^32 - 2 triangles, also on many ranks");
    exchange_buffer<numbered_triangle<S>> out, in;
    auto bounds = aabb<double>::empty();
    together(ranks, [&] {
      buffer<S> memory;
      std::vector<S> const corners = packed_on_host<S>(space, 9 * mesh.size(), memory, [&](S* to) {
        space.for_each(mesh.size(), pack_triangles<S>{mesh, to});
      });
      out.items.resize(mesh.size());
      for (std::size_t i = 0; i < mesh.size(); ++i) {
        out.items[i].number = static_cast<id>(first + i);
        std::copy_n(corners.data() + 9 * i, 9, out.items[i].corners);
        bounds = aabb<double>::merge()(bounds, out.items[i].box());
      }
    });
    coarse_grid grid;
    grid.build(ranks, bounds);
    sort_among(ranks, grid, out);
    deliver(ranks, out, in);
    together(ranks, [&] { keep(space, in.items); });
    map_.build(ranks, grid, [&](auto const& mark) {
      for (auto const& t : in.items) mark(t.box());
    });
    together(ranks, [&] { lookup_ = map_.lookup(space, lookup_memory_); });
  }

  /// The triangles of this rank, in memory of the space, by rising number.
  mesh_view<S> view() const { return view_; }
  /// Their numbers among those of all ranks, in memory of the space.
  id const* numbers() const { return numbers_in_space_; }
  /// The number of triangles of all ranks.
  std::size_t size() const { return static_cast<std::size_t>(all_); }
  rank_map const& map() const { return map_; }
  /// The map for kernels of the space that the mesh was built in.
  rank_lookup const& lookup() const { return lookup_; }

  numbered_triangle<S> operator[](std::size_t i) const {
    numbered_triangle<S> t{};
    t.number = numbers_[i];
    std::copy_n(corners_.data() + 9 * i, 9, t.corners);
    return t;
  }

 private:
  /// Puts the triangles in the order of the ranks that they go to. Ranks have equal parts of a curve through the cells,
  /// counted in triangles; which of a cell's places a triangle has is as good as random, and depends on its number
  /// alone.
  template <class Ranks>
  static void sort_among(Ranks const& ranks, coarse_grid const& grid, exchange_buffer<numbered_triangle<S>>& out) {
    std::vector<std::uint64_t> mine, ends;
    std::vector<std::size_t> places;
    together(ranks, [&] {
      mine.assign(coarse_grid::places, 0);
      ends.assign(coarse_grid::places, 0);
      places.resize(out.items.size());
      for (std::size_t i = 0; i < places.size(); ++i) ++mine[places[i] = grid.place_at(out.items[i].box())];
    });
    ranks.reduce(mine.data(), ends.data(), ends.size(), reduction::sum);
    for (std::size_t p = 1; p < ends.size(); ++p) ends[p] += ends[p - 1];
    std::uint64_t const all = ends.back(), n = static_cast<std::uint64_t>(ranks.size());
    together(ranks, [&] {
      exchange_buffer<numbered_triangle<S>> sorted;
      fill_exchange_buffer(sorted, ranks.size(), [&](auto const& put) {
        for (std::size_t i = 0; i < places.size(); ++i) {
          std::uint64_t const begin = places[i] == 0 ? 0 : ends[places[i] - 1], capacity = ends[places[i]] - begin;
          std::uint64_t const at = begin + out.items[i].number * std::uint64_t{0x9e3779b1} % capacity;
          put(static_cast<int>(at * n / all), out.items[i]);
        }
      });
      out = std::move(sorted);
    });
  }

  template <class Space>
  void keep(Space const& space, std::vector<numbered_triangle<S>>& triangles) {
    std::sort(triangles.begin(), triangles.end());
    numbers_.resize(triangles.size());
    corners_.resize(9 * triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      numbers_[i] = triangles[i].number;
      std::copy_n(triangles[i].corners, 9, corners_.data() + 9 * i);
    }
    numbers_in_space_ = in_space(space, numbers_, number_memory_);
    view_ = {};
    if (!triangles.empty()) view_ = triangle_soup(in_space(space, corners_, memory_), triangles.size());
  }

  std::uint64_t all_ = 0;
  std::vector<id> numbers_;
  std::vector<S> corners_;  ///< on the host
  buffer<S> memory_;        ///< their copy in memory of the space, where that is another
  buffer<id> number_memory_;
  id const* numbers_in_space_ = nullptr;
  mesh_view<S> view_;
  rank_map map_;
  rank_map::lookup_memory lookup_memory_;
  rank_lookup lookup_{};
};

}  // namespace collide::detail
