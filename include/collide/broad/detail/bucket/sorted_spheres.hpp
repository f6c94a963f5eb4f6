/// \file
/// Buckets the other way round, for a CPU and many spheres: the spheres are sorted into the cells, and the triangles
/// look for them there; docs/development/design.md, "On the host, triangles look for spheres".
///
/// A triangle looks into the cells that it would be entered into, so the same pairs meet, each once. Spheres that move
/// go the same way as the bounding spheres of their paths, which are spheres at rest; the narrow phase then judges the
/// spheres themselves. That is for short paths: the bounding sphere of a long one touches much that the sphere does
/// not.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <collide/broad/detail/bucket/bin_spheres.hpp>
#include <collide/broad/detail/bucket/measure_groups.hpp>
#include <collide/broad/detail/bucket/triangle_group.hpp>
#include <collide/broad/detail/bucket/triangle_major.hpp>
#include <collide/broad/detail/bucket/triangle_order.hpp>
#include <collide/broad/detail/grid/grid.hpp>
#include <collide/broad/detail/grid/triangle_cells.hpp>
#include <collide/core/memory.hpp>
#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/exact/detail/geometry/bounding_sphere.hpp>
#include <collide/exact/detail/geometry/sphere_pack.hpp>
#include <collide/narrow/detail/traits.hpp>
#include <collide/spaces/detail/algorithms.hpp>
#include <collide/spaces/detail/atomic.hpp>
#include <collide/spaces/detail/block.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace collide::detail {

/// Kernel functor of a block of one thread: decides every `stride`-th of the pairs of a triangle and a sphere in its
/// cells.
template <class S, class NarrowPhase>
struct sample_hits {
  static constexpr int items = 4;
  static constexpr std::uint32_t stride = 256;

  spheres_in_cells<S> in;
  std::uint64_t* hits;  ///< of those that were decided

  struct nothing {};
  template <class>
  using scratch = nothing;

  template <class Block>
  void operator()(Block& block, nothing&) const {
    constexpr std::uint32_t n = triangle_group<S>::size;
    std::size_t const begin = block.index() * Block::items, end = min(begin + Block::items, in.mesh.mesh.size());
    // where the first one is differs from block to block, whatever these have in common
    std::uint32_t skip = static_cast<std::uint32_t>(block.index()) * 2654435769u >> 24;
    std::uint64_t found = 0;
    for (std::size_t first = begin; first < end; first += n) {
      if (in.groups[first / n].is_empty()) continue;
      triangle_group<S> group;
      multiversioned([&] { in.mesh.load(group, first / n); });
      for (std::uint32_t k = 0; k < n; ++k) found += sample(group, k, skip);
    }
    if (found != 0) fetch_add(hits, found);
  }

  /// How many there are in all, with so many in the sample: more than that is unlikely, and by half more all but
  /// impossible.
  static std::uint64_t all_of(std::uint64_t sampled) {
    double const n = static_cast<double>(sampled) + 1;
    return static_cast<std::uint64_t>(stride * (n + n / 16 + 3 * std::sqrt(n)));
  }

 private:
  /// How many of the sampled pairs of triangle `k` of a group are hits; `skip` is how many pairs come before the next.
  std::uint64_t sample(triangle_group<S> const& group, std::uint32_t k, std::uint32_t& skip) const {
    if (!group.has(k)) return 0;
    triangle_aabb<S> const around = group.box(k);
    std::uint64_t found = 0;
    auto const look_into = [&](std::uint32_t cell, std::uint32_t n) {
      std::uint32_t const first = in.ends[cell], size = in.ends[cell + n] - first;
      for (; skip < size; skip += stride) found += touches(first + skip, around, group[k]);
      skip -= size;
    };
    for (int g = 0; g < in.grid_count; ++g) {
      each_range(
          in.grids[g], around, [&] { return group[k]; }, look_into);
    }
    look_into(in.everywhere, 1);
    return found;
  }

  COLLIDE_COLD bool touches(std::uint32_t place, triangle_aabb<S> const& around, triangle<S> const& t) const {
    sphere<S> const here = in.spheres[place];
    if (!around.overlaps(here.centre, here.radius)) return false;
    if constexpr (is_discrete<NarrowPhase, S>) {
      return NarrowPhase::intersects(t, here);
    } else {
      return NarrowPhase::intersects(t, in.spheres.moving[place]);
    }
  }
};

/// Kernel functor of a block of one thread: the longest displacement, squared, and the farthest coordinate, as bits, of
/// which the larger are those of the larger number. What is NaN does not count, also where the compiler takes it that
/// there is none.
template <class S>
struct measure_displacements {
  static constexpr int items = 4;
  static constexpr std::size_t batches = 64;  ///< of `Block::items` spheres

  moving_sphere_view<S> spheres;
  uint_for<S>* squared_length;  ///< 0 at first
  uint_for<S>* farthest;        ///< of a coordinate; 0 at first

  struct nothing {};
  template <class>
  using scratch = nothing;

  template <class Block>
  void operator()(Block& block, nothing&) const {
    constexpr std::size_t share = batches * Block::items;
    std::size_t const begin = block.index() * share, end = min(begin + share, spheres.size());
    uint_for<S> lengths[Block::items] = {}, fars[Block::items] = {};  // one would be compared one after the other
    multiversioned([&] { measure(begin, end, lengths, fars); });
    for (int k = 1; k < Block::items; ++k) {
      lengths[0] = max(lengths[0], lengths[k]);
      fars[0] = max(fars[0], fars[k]);
    }
    fetch_max(squared_length, lengths[0]);
    fetch_max(farthest, fars[0]);
  }

 private:
  template <std::size_t n>
  void measure(std::size_t begin, std::size_t end, uint_for<S> (&lengths)[n], uint_for<S> (&fars)[n]) const {
    for (std::size_t first = begin; first < end; first += n) {
      moving_pack<S, n> batch;
      batch.load(spheres, first);
      for (std::size_t k = 0; k < n; ++k) {
        S const dx = batch.dx[k], dy = batch.dy[k], dz = batch.dz[k];
        lengths[k] = max(lengths[k], magnitude_bits(dx * dx + (dy * dy + dz * dz)));
        uint_for<S> const xy = max(magnitude_bits(batch.x[k]), magnitude_bits(batch.y[k]));
        fars[k] = max(fars[k], max(xy, magnitude_bits(batch.z[k])));
      }
    }
  }

  /// Bits of |x|; 0 if that is NaN.
  static uint_for<S> magnitude_bits(S x) {
    uint_for<S> const b = to_bits(x) & ~to_bits(-S(0));
    return b > to_bits(std::numeric_limits<S>::infinity()) ? 0 : b;
  }
};

/// The spheres of a query in the order of the cells, and what triangles look for them with.
template <class S>
class sorted_spheres {
 public:
  /// The most spheres that can be sorted: places have 32 bits, and a sphere may be in a cell of each level.
  static constexpr std::size_t max_size = std::size_t{0xffffffffu} / max_levels - sphere_soa<S>::simd_width;

  /// Measures a mesh, whose summary is empty yet, and the boxes around groups of its triangles.
  template <class Space>
  void measure(Space& space, mesh_view<S> const& mesh, mesh_statistics<S>* summary) {
    mesh_ = group_triangles_(space, mesh);
    measure_groups<S> const kernel{mesh_, summary, groups_.reserve(space.resource(), mesh_.size())};
    space.launch(kernel.blocks(), kernel);
  }

  grouped_mesh<S> const& mesh() const { return mesh_; }

  /// Marks the cells that triangles of the mesh measured last touch. To be called for new grids, the cells of each of
  /// which begin at a multiple of 2^table_bits.
  template <class Space>
  void mark(Space& space, grid<S> const* grids, int grid_count, std::uint32_t table_bits) {
    grid_count_ = grid_count;
    grids_ = number_cells(space, grids, table_bits);
    std::size_t const words = cells_ / 32 + 1;
    std::uint32_t* const occupied = occupied_.reserve(space.resource(), words);
    space.fill(occupied, 0, words * sizeof *occupied);
    space.for_each(mesh_.size(), mark_occupied_cells<S>{mesh_, groups_.data(), grids_, grid_count, occupied});
  }

  /// How far the grid must reach for spheres of one radius that move: the radius of the bounding sphere of each path.
  template <class Space>
  S reach_of(Space& space, moving_sphere_view<S> const& spheres) {
    auto* const found = measures_.reserve(space.resource(), 2);
    space.fill(found, 0, 2 * sizeof *found);
    measure_displacements<S> const kernel{spheres, found, found + 1};
    constexpr std::size_t share = measure_displacements<S>::batches * 64;
    space.launch((spheres.size() + share - 1) / share, kernel);
    S const length = sqrt_rn(from_bits<S>(space.read(found))), far = from_bits<S>(space.read(found + 1));
    // of none is it larger, except for some rounding
    return swept_bounding_sphere(moving_sphere<S>{{{far, far, far}, spheres.common_radius()}, {length, S(0), S(0)}})
               .radius *
           (1 + 32 * S(ieee_traits<float>::unit_roundoff));
  }

  /// Sorts the spheres into the cells: of type sphere_view, or swept_bounding_spheres. O(spheres + cells).
  template <class Space, class Spheres>
  void sort(Space& space, Spheres const& spheres) {
    using place = place_spheres<S, Spheres>;
    auto* const total = total_.reserve(space.resource(), 1);
    constexpr std::size_t share = place::batches * 64;
    std::size_t const blocks = (spheres.size() + share - 1) / share;
    std::size_t capacity = placed_.capacity();
    for (bool placed = false; !placed; capacity = static_cast<std::size_t>(*total + *total / 4)) {
      place kernel{spheres, grids_, grid_count_, occupied_.data(), everywhere(), nullptr, total, 0};
      space.fill(total, 0, sizeof *total);
      if (capacity == 0) {  // of a sample, to begin with
        kernel.stride = blocks / 32 + 1;
        space.launch((blocks - 1) / kernel.stride + 1, kernel);
        *total = *total * kernel.stride + 1024;
        continue;
      }
      kernel.to = placed_.reserve(space.resource(), capacity);
      kernel.capacity = capacity;
      space.launch(blocks, kernel);
      placed = *total <= capacity;
    }
    auto const n = static_cast<std::size_t>(*total);
    columns_ = columns(space, placed_.capacity());
    if constexpr (std::is_same<Spheres, swept_bounding_spheres<S>>::value) {
      columns_.moving = moving_.reserve(space.resource(), placed_.capacity());
    }
    // counts[c + 1] becomes the begin of cell c, and once it is filled its end, which is the begin of the next
    std::size_t const table = cells_ + 2;
    auto* const counts = ends_.reserve(space.resource(), table);
    space.fill(counts, 0, table * sizeof *counts);
    // counters all over a table: few are counted sooner than threads have passed them to each other
    auto const each_placed = [&](auto const& f) {
      if (n > (std::size_t{1} << 17)) return space.for_each(n, f);
      single_threaded_scope const alone(true);
      for (std::size_t i = 0; i < n; ++i) f(i);
    };
    each_placed(count_bins<S>{placed_.data(), counts + 1});
    exclusive_scan(space, counts + 1, table - 1);
    auto* const order = order_.reserve(space.resource(), placed_.capacity());
    each_placed(rank_spheres<S>{placed_.data(), order, counts + 1});
    space.for_each(n, scatter_spheres<S, Spheres>{placed_.data(), order, columns_, spheres});
  }

  /// Makes room for up to so many spheres.
  template <class Space>
  void reserve(Space& space, std::size_t spheres) {
    std::size_t const capacity = max(placed_.capacity(), max_levels * spheres);
    placed_.reserve(space.resource(), capacity);
    order_.reserve(space.resource(), capacity);
    total_.reserve(space.resource(), 1);
    columns_ = columns(space, capacity);
  }

  /// About how many hits a pass over the spheres has, of which there are `all`; 0 if few of them are in cells with
  /// triangles, and so have no more hits than there are spheres, mostly. O(triangles).
  template <class NarrowPhase, class Space>
  std::uint64_t expected_hits(Space& space, std::size_t all) const {
    if (*total_.data() < all / 4) return 0;
    std::uint64_t hits = 0;
    sample_hits<S, NarrowPhase> const kernel{in_cells(), &hits};
    space.launch(grid_size<Space>(mesh_.mesh.size(), kernel), kernel);
    return kernel.all_of(hits);
  }

  /// One pass: the triangles look for the spheres.
  template <class NarrowPhase, class Space, class Output>
  void query(Space& space, candidate_pipeline<S, NarrowPhase, Output> const& pipeline) const {
    bool const are_few = *total_.data() < pipeline.spheres.size() / 4;
    query_triangle_major<S, NarrowPhase, Output> const kernel{pipeline, in_cells(), !are_few};
    space.launch(grid_size<Space>(mesh_.mesh.size(), kernel), kernel);
  }

 private:
  /// Numbers the cells of all grids one after the other, without those that are not in use.
  template <class Space>
  grid<S> const* number_cells(Space& space, grid<S> const* grids, std::uint32_t table_bits) {
    grid<S>* const own = own_grids_.reserve(space.resource(), max_grids);
    cells_ = 0;
    for (int g = 0; g < grid_count_; ++g) {
      own[g] = grids[g];
      std::uint32_t const begin = static_cast<std::uint32_t>(g) << table_bits;
      for (int l = 0; l < own[g].levels; ++l) own[g].level[l].first += static_cast<std::uint32_t>(cells_) - begin;
      cells_ += own[g].cells;
    }
    return own;
  }

  template <class Space>
  sphere_soa<S> columns(Space& space, std::size_t n) {
    std::size_t const capacity = n + sphere_soa<S>::simd_width;
    bool const same = numbers_.capacity() == 5 * capacity;
    S* const to = numbers_.reserve(space.resource(), 5 * capacity);
    id* const ids = ids_.reserve(space.resource(), capacity);
    if (!same) space.fill(to, 0, 5 * capacity * sizeof *to);  // also what is behind the end is read
    return {to, to + capacity, to + 2 * capacity, to + 3 * capacity, to + 4 * capacity, ids};
  }

  spheres_in_cells<S> in_cells() const {
    return {mesh_, groups_.data(), grids_, grid_count_, columns_, ends_.data(), everywhere()};
  }
  std::uint32_t everywhere() const { return static_cast<std::uint32_t>(cells_); }

  grid<S> const* grids_ = nullptr;
  int grid_count_ = 0;
  std::size_t cells_ = 0;
  group_triangles<S> group_triangles_;
  grouped_mesh<S> mesh_{};
  buffer<triangle_aabb<S>> groups_;
  buffer<grid<S>> own_grids_;
  buffer<std::uint32_t> occupied_, ends_, order_;
  buffer<std::uint64_t> total_;
  buffer<uint_for<S>> measures_;
  buffer<moving_sphere<S>> moving_;
  buffer<binned_sphere<S>> placed_;
  buffer<S> numbers_;
  buffer<id> ids_;
  sphere_soa<S> columns_ = {};
};

}  // namespace collide::detail
