/// \file
/// Kernels that sort spheres into the cells of grids, on the CPU: spheres near triangles are listed, counted by cells,
/// numbered and copied in the order of the cells.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include <collide/broad/detail/bucket/triangle_order.hpp>
#include <collide/broad/detail/grid/grid.hpp>
#include <collide/exact/detail/geometry/sphere_pack.hpp>
#include <collide/spaces/detail/atomic.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace collide::detail {

/// Bit k is flags[k], for k < n <= 64; flags are 0 or 1.
template <std::size_t n>
inline std::uint64_t bits_of_flags(unsigned char const* flags) {
  std::uint64_t mask = 0;
  for (std::size_t k = 0; k < n; k += 8) {
    std::uint64_t bytes;
    std::memcpy(&bytes, flags + k, sizeof bytes);
    mask |= (bytes * 0x0102040810204080u >> 56) << k;
  }
  return mask;
}

/// Spheres that move as spheres at rest, all of one radius, that contain their paths: as far as placing them goes.
template <class S>
struct swept_bounding_spheres {
  moving_sphere_view<S> spheres;
  S reach;

  std::size_t size() const { return spheres.size(); }
  bool one_radius() const { return true; }
  S common_radius() const { return reach; }
};

/// The centres and radii of consecutive spheres.
template <class S, unsigned Items>
void load(sphere_pack<S, Items>& batch, sphere_view<S> const& spheres, std::size_t first) {
  batch.load(spheres, first);
}

/// The bounding spheres of consecutive moving spheres. A centre that is not finite is in no cell.
template <class S, unsigned Items>
void load(sphere_pack<S, Items>& batch, swept_bounding_spheres<S> const& bounds, std::size_t first) {
  moving_pack<S, Items> ways;
  ways.load(bounds.spheres, first);
  for (unsigned k = 0; k < Items; ++k) {
    batch.x[k] = ways.x[k] + S(0.5) * ways.dx[k];
    batch.y[k] = ways.y[k] + S(0.5) * ways.dy[k];
    batch.z[k] = ways.z[k] + S(0.5) * ways.dz[k];
    batch.radius[k] = bounds.reach;
  }
}

/// A sphere in a cell with triangles.
template <class S>
struct binned_sphere {
  sphere<S> copy;  ///< in the order of the cells the caller's memory would be read all over the place
  id number;
  std::uint32_t cell;
};

/// Kernel functor of a block of one thread: lists the spheres that are in cells with triangles. A sphere that no grid
/// serves counts as in the cell behind the last, into which all triangles look.
template <class S, class Spheres>
struct place_spheres {
  static constexpr int items = 4;
  static constexpr std::size_t batches = 16;  ///< of `Block::items` spheres

  Spheres spheres;
  grid<S> const* grids;
  int grid_count;
  std::uint32_t const* occupied;
  std::uint32_t everywhere;  ///< number of the cell behind the last
  binned_sphere<S>* to;
  std::uint64_t* total;  ///< counts also those that find no room
  std::uint64_t capacity;
  std::size_t stride = 1;  ///< 1: all spheres; n: those of every n-th block

  template <class Block>
  struct scratch {
    static constexpr std::size_t capacity = 16 * Block::items;
    binned_sphere<S> found[capacity];
    std::size_t count;
  };

  template <class Block>
  void operator()(Block& block, scratch<Block>& s) const {
    static_assert(Block::num_threads == 1 && Block::items == 64,
                  "collide: spheres are sorted by blocks of one thread with 64 items");
    multiversioned([&] { place(block, s); });
  }

 private:
  template <class Block>
  void place(Block& block, scratch<Block>& s) const {
    constexpr unsigned n = Block::items;
    std::size_t const begin = block.index() * stride * batches * n;
    bool const one_radius = spheres.one_radius();
    s.count = 0;
    for (std::size_t first = begin; first < begin + batches * n && first < spheres.size(); first += n) {
      sphere_pack<S, n> batch;
      load(batch, spheres, first);
      auto const list = [&](int k, std::uint32_t cell, bool wanted) {
        s.found[s.count] = {
            {{batch.x[k], batch.y[k], batch.z[k]}, batch.radius[k]}, static_cast<id>(first) + static_cast<id>(k), cell};
        s.count += wanted;
      };
      // where all radii are equal, one comparison stands for all
      auto const of_radii = [&](auto const& test) {
        if (!one_radius) return mask_of<n>([&](unsigned k) { return test(batch.radius[k]); });
        return test(spheres.common_radius()) ? first_bits(spheres.size() - first) : 0;
      };
      std::uint64_t open = of_radii([](S r) { return is_valid_radius(r); });
      for (int g = grid_count - 1; g >= 0 && open != 0; --g) {  // by rising reach: a sphere ends up in the tightest
        grid<S> const& box = grids[g];
        std::uint64_t const served = open & of_radii([&](S r) { return box.serves(r); });
        std::uint64_t const inside =
            served & mask_of<n>([&](unsigned k) { return box.contains(batch.x[k], batch.y[k], batch.z[k]); });
        open &= ~served;
        for (int l = 0; l < box.levels && inside != 0; ++l) {
          ensure_capacity(s);
          for (std::uint64_t rest = inside; rest != 0; rest &= rest - 1) {
            int const k = __builtin_ctzll(rest);
            std::uint32_t const cell = box.cell_at(box.level[l], {batch.x[k], batch.y[k], batch.z[k]}).number;
            list(k, cell, (occupied[cell / 32] >> cell % 32 & 1) != 0);
          }
        }
      }
      ensure_capacity(s);
      for (; open != 0; open &= open - 1) list(__builtin_ctzll(open), everywhere, true);
    }
    flush(s);
  }

  static std::uint64_t first_bits(std::size_t n) { return n < 64 ? (std::uint64_t{1} << n) - 1 : ~std::uint64_t{0}; }

  template <unsigned n, class Test>
  static std::uint64_t mask_of(Test const& test) {
    unsigned char flags[n];
    for (unsigned k = 0; k < n; ++k) flags[k] = static_cast<unsigned char>(test(k));
    return bits_of_flags<n>(flags);
  }

  template <class Scratch>
  void ensure_capacity(Scratch& s) const {
    if (s.count + 64 >= Scratch::capacity) flush(s);
  }

  template <class Scratch>
  void flush(Scratch& s) const {
    if (s.count == 0) return;
    std::uint64_t const slot = fetch_add(total, std::uint64_t{s.count});
    if (slot + s.count <= capacity) std::copy(s.found, s.found + s.count, to + slot);
    s.count = 0;
  }
};

/// Kernel functor of `for_each` over placed spheres: counts those of each cell.
template <class S>
struct count_bins {
  binned_sphere<S> const* from;
  std::uint32_t* counts;
  void operator()(std::size_t i) const { fetch_add(counts + from[i].cell, 1u); }
};

/// Spheres in the order of the cells, number by number in arrays of their own.
template <class S>
struct sphere_soa {
  static constexpr std::size_t simd_width = 8;  ///< how many are compared with a box at a time, also beyond the end

  S *x, *y, *z, *radius;
  S* reach;  ///< as `triangle_aabb` has it
  id* number;
  moving_sphere<S>* moving = nullptr;  ///< null if they rest; else the others are bounding spheres of their paths

  sphere<S> operator[](std::uint32_t i) const { return {{x[i], y[i], z[i]}, radius[i]}; }

  void set(std::size_t i, sphere<S> const& s, id n) const {
    x[i] = s.centre.x();
    y[i] = s.centre.y();
    z[i] = s.centre.z();
    radius[i] = s.radius;
    reach[i] = triangle_aabb<S>::padded_radius(s.radius);
    number[i] = n;
  }

  /// Bit k is whether sphere first + k can reach what is in the box, for k < lanes. Without branches, for the
  /// processor's vector unit.
  std::uint32_t reaching(triangle_aabb<S> const& b, std::uint32_t first) const {
    uint_for<S> constexpr bit[simd_width] = {1,  2,  4,  8,
                                             16, 32, 64, 128};  // SSE cannot shift lanes by different amounts
    uint_for<S> mask = 0;
    for (std::size_t k = 0; k < simd_width; ++k) {
      S const px = x[first + k], py = y[first + k], pz = z[first + k];
      S const gx = b.axis_distance(0, px), gy = b.axis_distance(1, py), gz = b.axis_distance(2, pz),
              reached = reach[first + k] + b.padding;
      mask |= gx * gx + (gy * gy + gz * gz) <= reached * reached ? bit[k] : uint_for<S>(0);
    }
    return static_cast<std::uint32_t>(mask);
  }
};

/// Spheres that are sorted into the cells of grids, and the boxes around groups of the triangles that look for them.
template <class S>
struct spheres_in_cells {
  grouped_mesh<S> mesh;
  triangle_aabb<S> const* groups;
  grid<S> const* grids;
  int grid_count;
  sphere_soa<S> spheres;
  std::uint32_t const* ends;  ///< the spheres of cell c: ends[c] .. ends[c + 1]
  std::uint32_t everywhere;   ///< number of the cell behind the last

  /// Bit k is whether there may be spheres near a group in grid k: in a cell that the dilated box around it meets.
  std::uint32_t grids_near(aabb<S> const& group) const {
    std::uint32_t near = 0;
    for (int g = 0; g < grid_count; ++g) {
      bool found = false;
      for (int l = 0; l < grids[g].levels && !found; ++l) found = has_spheres(grids[g], grids[g].level[l], group);
      near |= found ? 1u << g : 0;
    }
    return near;
  }

 private:
  /// True if there are spheres in the cells that a dilated box meets, or if these are many.
  bool has_spheres(grid<S> const& g, grid_level<S> const& l, aabb<S> const& b) const {
    cell_box const r = g.range_of(l, b);
    if (r.upper[0] - r.lower[0] > l.mask[0]) return true;
    std::uint32_t const rows[2] = {r.upper[1] - r.lower[1], r.upper[2] - r.lower[2]};
    if (rows[0] > 7 || rows[1] > 7) return true;
    std::uint32_t const begin = r.lower[0] & l.mask[0], end = (r.upper[0] & l.mask[0]) + 1;
    for (std::uint32_t k = 0; k <= rows[1]; ++k) {
      for (std::uint32_t j = 0; j <= rows[0]; ++j) {
        std::uint32_t const row = l.row(r.lower[1] + j, r.lower[2] + k);
        if (begin < end) {
          if (ends[row + begin] != ends[row + end]) return true;
        } else {  // beyond the last cell of a row its first ones follow
          if (ends[row + begin] != ends[row + l.mask[0] + 1] || ends[row] != ends[row + end]) return true;
        }
      }
    }
    return false;
  }
};

/// Kernel functor of `for_each` over placed spheres: gives each its place in the order of the cells.
template <class S>
struct rank_spheres {
  binned_sphere<S> const* from;
  std::uint32_t* order;
  std::uint32_t* begins;
  void operator()(std::size_t i) const { order[fetch_add(begins + from[i].cell, 1u)] = static_cast<std::uint32_t>(i); }
};

/// Kernel functor of `for_each` over places: brings the spheres there. Threads write next to themselves only.
template <class S, class Spheres>
struct scatter_spheres {
  binned_sphere<S> const* from;
  std::uint32_t const* order;
  sphere_soa<S> to;
  Spheres spheres;
  void operator()(std::size_t i) const {
    binned_sphere<S> const& p = from[order[i]];
    if constexpr (std::is_same<Spheres, swept_bounding_spheres<S>>::value) {
      moving_sphere<S> const s = spheres.spheres[p.number];
      to.moving[i] = s;
      to.set(i, swept_bounding_sphere(s), p.number);
    } else {
      to.set(i, p.copy, p.number);
    }
  }
};

/// Kernel functor of `for_each` over groups of triangles: sets a bit for every cell that a triangle looks into, and
/// perhaps for some more.
template <class S>
struct mark_occupied_cells {
  grouped_mesh<S> mesh;
  triangle_aabb<S> const* groups;
  grid<S> const* grids;
  int grid_count;
  std::uint32_t* occupied;

  void operator()(std::size_t i) const {
    if (groups[i].is_empty()) return;
    std::uint32_t each = 0;  // bits of grids for which a triangle is not small
    for (int g = 0; g < grid_count; ++g) {
      if (!is_small(groups[i], grids[g])) {
        each |= 1u << g;
        continue;
      }
      each_range_of_group(grids[g], groups[i], [&](std::uint32_t cell, std::uint32_t count) { mark(cell, count); });
    }
    if (each != 0) mark_each(i, each);
  }

 private:
  void mark_each(std::size_t i, std::uint32_t some) const {
    triangle_group<S> group;
    multiversioned([&] { mesh.load(group, i); });
    for (int g = 0; g < grid_count; ++g) {
      if ((some >> g & 1) == 0) continue;
      for (std::uint32_t k = 0; k < triangle_group<S>::size; ++k) {
        if (!group.has(k)) continue;
        each_range(
            grids[g], group.box(k), [&] { return group[k]; },
            [&](std::uint32_t cell, std::uint32_t count) { mark(cell, count); });
      }
    }
  }

  void mark(std::uint32_t first, std::uint32_t n) const {
    for (std::uint32_t const end = first + n; first < end;) {
      std::uint32_t const next = min((first / 32 + 1) * 32, end);
      std::uint32_t const bits = 0xffffffffu >> (32 - (next - first)) << first % 32;
      if ((load_relaxed(occupied + first / 32) & bits) != bits) fetch_or(occupied + first / 32, bits);
      first = next;
    }
  }
};

}  // namespace collide::detail
