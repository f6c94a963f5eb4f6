/// \file
/// How wide the cells of a grid are, whether it has two levels, and how large its table is: as cheap as cells of some
/// width are by the entries of triangles and the candidates that spheres find.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include <collide/broad/detail/grid/grid.hpp>
#include <collide/broad/detail/grid/mesh_statistics.hpp>
#include <collide/broad/detail/grid/pair_distances.hpp>
#include <collide/spaces/detail/tuning.hpp>

namespace collide::detail {

/// Sums over triangles.
struct triangle_sums {
  float count, area, perimeter;
  float widest;  ///< the extent of the largest of their boxes, about

  COLLIDE_HD_INLINE triangle_sums& operator+=(triangle_sums const& o) {
    count += o.count, area += o.area, perimeter += o.perimeter, widest = max(widest, o.widest);
    return *this;
  }

  /// About how many cells of this width the triangles meet when they are dilated by `reach`: the volume within a
  /// distance of a triangle (Steiner's formula), by that of a cell.
  COLLIDE_HD_INLINE float entries(float width, float reach) const {
    float const d = (reach + 0.7f * width) / width;
    return 2 * d * (area / (width * width)) + 1.5708f * d * d * (perimeter / width) + 4.1888f * d * d * d * count;
  }

  COLLIDE_HD_INLINE float mean_extent() const { return count > 0 ? perimeter / (perimeter_of_extent * count) : 0.f; }

  /// The largest of them alone.
  COLLIDE_HD_INLINE triangle_sums largest() const {
    return {1, area_of_extent * widest * widest, perimeter_of_extent * widest, widest};
  }

  /// The area of a triangle whose box has an extent of 1: up to 0.87.
  static constexpr float area_of_extent = 0.3f;
  /// The perimeter of a triangle whose box has an extent of 1: from 2 to 3.5.
  static constexpr float perimeter_of_extent = 2.4f;
};

/// The cost of a level of cells, in nanoseconds. All blocks enter triangles, but one alone the largest: others may have
/// to wait for it.
struct level_cost {
  bucket_costs costs;
  float spheres;
  float reach;
  float path;  ///< how far a sphere moves
  share_of_pairs const& share;
  float sides[3];    ///< of the grid
  float max_cells;   ///< of two levels; where there are more they wrap
  bool for_queries;  ///< of which there are many: cells that wrap cost each of them

  COLLIDE_HD_INLINE float operator()(triangle_sums const& t, float width) const {
    float const cells = path / width, thin = 1 - share.full();
    float pairs = spheres * t.count * share(reach + 0.5f * width, t.mean_extent());
    if (for_queries && number_of_cells(width) > 2 * max_cells) pairs += spheres * t.entries(width, reach) / max_cells;
    return (costs.entry_ns + costs.thin_entry_ns * thin) * t.entries(width, reach) +
           costs.serial_ns * t.largest().entries(width, reach) +
           (costs.candidate_ns + costs.thin_ns * thin) * pairs * (1 + cells) + costs.step_ns * spheres * cells;
  }

  /// The cost if its spheres look into the cells of a grid that reaches farther, which are about twice as wide as that.
  COLLIDE_HD_INLINE float without(triangle_sums const& t, float wider_reach) const {
    return costs.candidate_ns * spheres * t.count * share(2 * wider_reach, t.mean_extent());
  }

  /// False if long thin triangles go around what wraps more than once: they are not cut then (triangle_cells.hpp), and
  /// in nearly all cells.
  COLLIDE_HD_INLINE bool cuts(triangle_sums const& t, float width) const {
    float const box = (t.widest + 2 * reach) / width;
    return share.full() > 0.5f || number_of_cells(width) <= max_cells || box * box * box < max_cells;
  }

 private:
  COLLIDE_HD_INLINE float number_of_cells(float width) const {
    float cells = 1;
    for (float const side : sides) cells *= side / width + 1;
    return cells;
  }
};

template <class S>
struct grid_request {
  S reach;                        ///< of the only grid,
  grid_reaches<S> const* chosen;  ///< or how far each reaches; null if there is one
  int count;                      ///< the most grids
  S cell_width;                   ///< asked for; 0 = choose
  bool whole_boxes;               ///< as `grid` has it
  float entry_limit;              ///< how many entries the grids may have, about
  std::uint32_t table_bits;       ///< log2 of the number of cells per grid
  float spheres;                  ///< of all queries to come
  bucket_costs costs;

  /// False if the grids that are there serve.
  COLLIDE_HD bool is_new() const { return chosen == nullptr || chosen->are_new; }

  /// How many grids there are.
  COLLIDE_HD int used() const { return chosen == nullptr ? 1 : min(chosen->count, count); }

  /// How far grid `i` reaches; -1 if there is none.
  COLLIDE_HD S reach_of(std::size_t i) const {
    if (i >= static_cast<std::size_t>(count)) return -1;
    return chosen != nullptr ? chosen->reaches[i] : (i == 0 ? reach : S(-1));
  }
};

/// Cells, in units of the grid's extent.
struct cell_choice {
  float cost;
  float width;
  float coarse_width;  ///< of a second level; 0 if there is none
  float small_end;     ///< the largest extent of triangles of the first level then

  struct cheaper {
    COLLIDE_HD cell_choice operator()(cell_choice const& a, cell_choice const& b) const {
      return b.cost < a.cost || (b.cost == a.cost && b.width > a.width) ? b : a;
    }
  };
};

/// Kernel functor of a block per grid: chooses widths, levels and table sizes such that entering the triangles and
/// testing the candidates cost least together, from the summary of the mesh and from the distances of some triangles
/// and some spheres. It takes some microseconds, so a build on the device does not wait for the host. The blocks behind
/// these empty the cells meanwhile.
template <class S, class Spheres>
struct plan_grid {
  static constexpr int items = 1;
  static constexpr bool is_cooperative = true;

  mesh_view<S> mesh;
  triangle_aabb<S> const* boxes;  ///< may be null
  Spheres spheres;
  mesh_statistics<S> const* summary;
  grid<S>* grids;
  grid_request<S> request;
  item_range* cells;   ///< to empty; may be null
  std::size_t listed;  ///< how many of them there are

  static constexpr std::size_t emptied = 8;  ///< by a thread

  /// How many blocks there must be.
  template <class Block>
  std::size_t blocks() const {
    constexpr std::size_t share = emptied * Block::num_threads;
    return static_cast<std::size_t>(request.count) + (listed + share - 1) / share;
  }

  /// On a device it would take longer than narrower cells gain.
  template <class Block>
  static constexpr bool knows_thin = Block::num_threads == 1;

  static constexpr int size_classes = 32, widths = 64;
  static constexpr float width_step = 0.45f;  ///< of the logarithm of the width, to the base of 2

  template <class Block>
  struct scratch {
    pair_distances distances;
    triangle_aabb<S> boxes[pair_distances::triangles];
    thin_part<S> parts[knows_thin<Block> ? pair_distances::triangles : 1];
    triangle_sums classes[size_classes];  ///< of triangles of rising sizes
    float class_end[size_classes];
    typename Block::template reduce_storage<cell_choice> reduction;
    cell_choice chosen;
    grid_header<S> planned;
    S extent;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    if (!request.is_new()) return;
    if (block.index() >= static_cast<std::size_t>(request.count)) return empty_cells(block);
    auto& g = grids[block.index()];
    block.for_each_thread([&](int thread_rank) {
      if (thread_rank == 0) s.planned = header_of(block.index(), s.extent);
      for (auto b = static_cast<std::uint32_t>(thread_rank); b < pair_distances::bins; b += Block::num_threads) {
        s.distances.counts[b] = 0;
      }
      for (auto i = static_cast<std::uint32_t>(thread_rank); i < pair_distances::triangles; i += Block::num_threads) {
        sample<Block>(s, i);
      }
      if (thread_rank == 0) s.distances.sampled = s.distances.path = s.distances.thin = 0;
    });
    if (block.broadcast(s.planned.levels) == 0) {
      return block.for_each_thread([&](int thread_rank) {
        if (thread_rank == 0) set_empty(g, s.planned);
      });
    }
    measure_distances(block, s);
    weigh(block, s);
    block.for_each_thread([&](int thread_rank) {
      if (thread_rank != 0) return;
      if (s.chosen.width != no_cells) return set_levels(g, s.planned, s.chosen, s.extent, block.index());
      s.planned.reach = -1;
      s.planned.levels = 0;
      set_empty(g, s.planned);
    });
  }

 private:
  static constexpr float unlimited = std::numeric_limits<float>::max();
  static constexpr float no_cells = 0;  ///< in place of a width: the grid costs more than it saves

  template <class Block>
  COLLIDE_HD_INLINE void empty_cells(Block& block) const {
    constexpr std::size_t share = emptied * Block::num_threads;
    std::size_t const first = (block.index() - static_cast<std::size_t>(request.count)) * share;
    block.for_each_thread([&](int thread_rank) {
      for (std::size_t k = 0; k < emptied; ++k) {
        std::size_t const c = first + k * Block::num_threads + static_cast<std::size_t>(thread_rank);
        if (c < listed) cells[c] = {0, 0};
      }
    });
  }

  /// A grid without levels; the first is read before it is known that there is none.
  static COLLIDE_HD void set_empty(grid<S>& g, grid_header<S> const& planned) {
    static_cast<grid_header<S>&>(g) = planned;
    g.level[0] = {};
  }

  /// The grid except for its levels: of these there are none if it can hold no triangle, or serve no sphere.
  COLLIDE_HD grid_header<S> header_of(std::size_t i, S& extent) const {
    grid_header<S> g{};
    extent = 0;
    g.reach = request.reach_of(i);
    if (summary->extents.empty() || g.reach < 0) {  // no finite triangle, or no grid: a box that contains nothing
      for (int k = 0; k < 3; ++k) {
        g.lower[k] = 1;
        g.upper[k] = -1;
      }
      return g;
    }
    S const far = set_box(g, extent);
    constexpr S end = std::numeric_limits<S>::max() / 16;
    if (!(extent < end && far < end)) {  // the range of S does not suffice: it serves no sphere
      g.reach = -1;
      return g;
    }
    g.padded_reach =
        g.dilation + 256 * ieee_traits<S>::unit_roundoff * (far + g.dilation) + 64 * std::numeric_limits<S>::min();
    // where squares overflow or vanish, triangles are not cut
    bool const has_squares = g.padded_reach < sqrt_rn(std::numeric_limits<S>::max()) / 256 &&
                             g.dilation > sqrt_rn(std::numeric_limits<S>::min()) / ieee_traits<S>::unit_roundoff;
    g.whole_boxes = request.whole_boxes || !has_squares;
    g.levels = 1;
    return g;
  }

  /// How many spheres are sampled: by one thread not so many that this takes longer than a query of few spheres.
  template <class Block>
  COLLIDE_HD std::uint32_t spheres_asked() const {
    if (Block::num_threads > 1) return pair_distances::spheres;
    float const work = (request.spheres + 2 * static_cast<float>(mesh.size())) / 256;
    return static_cast<std::uint32_t>(min(max(work, 4.f), static_cast<float>(pair_distances::spheres)));
  }

  template <class Block, class Scratch>
  COLLIDE_HD_INLINE void sample(Scratch& s, std::uint32_t i) const {
    std::size_t const t = mesh.size() * i / pair_distances::triangles;
    s.boxes[i] = boxes != nullptr ? boxes[t] : triangle_aabb_of(mesh[t]);
    if constexpr (knows_thin<Block>) s.parts[i] = thin_part<S>::of(mesh[t]);
  }

  template <class Block, class Scratch>
  COLLIDE_HD_INLINE void measure_distances(Block& block, Scratch& s) const {
    std::size_t const i = block.index();
    S const reach = request.reach_of(i), above = request.reach_of(i + 1);
    S const scale = S(1) / s.extent;
    constexpr std::uint32_t pairs_of_sphere =
        Block::num_threads > 1 ? pair_distances::triangles / 4 : pair_distances::triangles;
    constexpr std::uint32_t parts = pair_distances::triangles / pairs_of_sphere;
    block.for_each_thread([&](int thread_rank) {
      for (auto j = static_cast<std::uint32_t>(thread_rank); j < parts * spheres_asked<Block>();
           j += Block::num_threads) {
        if (spheres.size() == 0) break;
        auto const moved = spheres[spheres.size() * (j / parts) / spheres_asked<Block>()];
        sphere<S> const here = sphere_on_path(moved, static_cast<S>(j / parts * 37 % 64) / S(63));  // all along
        if (!(here.radius <= reach && here.radius > above) || !is_finite(here.centre)) continue;
        if (j % parts == 0) {
          block.add(s.distances.sampled, 1);
          float const path = static_cast<float>(path_of(moved) * scale) / pair_distances::path_unit;
          block.add(s.distances.path, path < 0x1p16f ? static_cast<std::uint32_t>(path) : 1u << 16);
        }
        COLLIDE_NO_UNROLL
        for (std::uint32_t k = 0; k < pairs_of_sphere; ++k) {
          triangle_aabb<S> const& b = s.boxes[j % parts * pairs_of_sphere + k];
          if (b.is_empty()) continue;
          S distance = max(b.axis_distance(0, here.centre.x()),
                           max(b.axis_distance(1, here.centre.y()), b.axis_distance(2, here.centre.z())));
          if constexpr (knows_thin<Block>) distance = max(distance, s.parts[k].distance(here.centre));
          block.add(s.distances.counts[pair_distances::bin_of(static_cast<float>(distance * scale))], 1);
        }
      }
      for (int c = thread_rank; c < size_classes; c += Block::num_threads) sum_class(s, c);
      if constexpr (knows_thin<Block>) {
        for (auto const& part : s.parts) s.distances.thin += part.is_thin;
      }
    });
  }

  /// The triangles of a class, in units of the grid's extent.
  template <class Scratch>
  COLLIDE_HD_INLINE void sum_class(Scratch& s, int c) const {
    int const first = summary->extents.first(), per_class = (summary->extents.last() - first) / size_classes + 1;
    triangle_sums sum{};
    float end = 0;
    COLLIDE_NO_UNROLL
    for (int b = first + c * per_class; b < first + (c + 1) * per_class && b < size_bins; ++b) {
      float const count = static_cast<float>(summary->extents.counts[b]);
      end = bin_end(static_cast<std::uint32_t>(b));
      float const extent = static_cast<float>(S(end) / s.extent);
      if (count == 0) continue;
      sum += {count, static_cast<float>(summary->extents.sums[b]) * 0x1p-8f * (extent * extent),
              triangle_sums::perimeter_of_extent * extent * count, extent};
    }
    s.classes[c] = sum;
    s.class_end[c] = end;
  }

  /// The width number `i`, in units of the grid's extent.
  static COLLIDE_HD_INLINE float width_at(int i) { return 1.01f * exp2f(-width_step * static_cast<float>(i)); }

  /// The cells may be no narrower, in units of the grid's extent: cell coordinates are exact enough then.
  static constexpr float narrowest = 96 * static_cast<float>(ieee_traits<S>::unit_roundoff);

  /// Chooses the cells that cost least, with one level or two.
  template <class Block, class Scratch>
  COLLIDE_HD_INLINE void weigh(Block& block, Scratch& s) const {
    typename Block::template thread_private<cell_choice> best;
    block.for_each_thread([&](int thread_rank) {
      triangle_sums all{};
      for (int c = 0; c < size_classes; ++c) all += s.classes[c];
      share_of_pairs const share(s.distances);
      level_cost cost{request.costs,
                      spheres_served<Block>(s),
                      static_cast<float>(s.planned.dilation / s.extent),
                      s.distances.mean_path(),
                      share,
                      {},
                      0.5f * exp2f(static_cast<float>(request.table_bits)),
                      Block::num_threads > 1 && request.spheres > 1.5f * static_cast<float>(spheres.size())};
      for (int k = 0; k < 3; ++k)
        cost.sides[k] = static_cast<float>((s.planned.upper[k] - s.planned.lower[k]) / s.extent);
      float const entry_limit = request.entry_limit / static_cast<float>(request.used());
      best[thread_rank] = {unlimited, width_at(0), 0, 0};
      if (request.cell_width > 0) {
        float const asked = max(narrowest, static_cast<float>(request.cell_width / s.extent));
        best[thread_rank].width = wide_enough(all, asked, cost.reach, entry_limit);
        return;
      }
      for (int i = thread_rank; i < widths + size_classes; i += Block::num_threads) {
        cell_choice const next =
            i < widths ? of_width(all, width_at(i), entry_limit, cost) : of_split(s, i - widths, entry_limit / 2, cost);
        best[thread_rank] = cell_choice::cheaper{}(best[thread_rank], next);
      }
      if (Block::num_threads > 1 && thread_rank == 0 && block.index() > 0) {
        // nobody knows yet which of the others there will be
        cell_choice const none{cost.without(all, static_cast<float>(request.reach_of(0) / s.extent)), no_cells, 0, 0};
        best[thread_rank] = cell_choice::cheaper{}(best[thread_rank], none);
      }
    });
    cell_choice const chosen = block.reduce(s.reduction, best, cell_choice::cheaper{});
    block.for_each_thread([&](int thread_rank) {
      if (thread_rank == 0) s.chosen = chosen;
    });
  }

  static COLLIDE_HD_INLINE cell_choice of_width(triangle_sums const& all, float width, float entry_limit,
                                                level_cost const& cost) {
    bool const allowed = width >= narrowest && all.entries(width, cost.reach) <= entry_limit && cost.cuts(all, width);
    return {allowed ? cost(all, width) : unlimited, width, 0, 0};
  }

  /// With the triangles of the larger classes, from the one after `c` on, in cells of their own. That must save more
  /// than a fifth.
  template <class Scratch>
  COLLIDE_HD_INLINE cell_choice of_split(Scratch const& s, int c, float entry_limit, level_cost const& cost) const {
    bool const splits = c % 4 == 3 && c + 1 < size_classes && summary->extents.last() - summary->extents.first() >= 16;
    triangle_sums const small = sum_of(s, 0, splits ? c + 1 : 0), large = sum_of(s, c + 1, splits ? size_classes : 0);
    cell_choice best{unlimited, 0, 0, 0}, best_large = best;
    if (small.count > 0 && large.count > 0) {
      best = cheapest(small, entry_limit, cost);
      best_large = cheapest(large, entry_limit, cost);
    }
    bool const useful = best.cost < unlimited && best_large.cost < unlimited && best.width < best_large.width;
    float const both = 1.25f * (best.cost + best_large.cost + request.costs.level_ns * cost.spheres);
    return {useful ? both : unlimited, best.width, best_large.width, s.class_end[c]};
  }

  /// The cheapest cells of one of two levels: of every fourth width, then of the widths near the best of these.
  COLLIDE_HD_INLINE cell_choice cheapest(triangle_sums const& some, float entry_limit, level_cost const& cost) const {
    cell_choice best{unlimited, 0, 0, 0};
    int begin = 0, end = widths, around = 0;
    COLLIDE_NO_UNROLL
    for (int step = 4; step > 0; step -= 3) {
      COLLIDE_NO_UNROLL
      for (int i = begin; i < end; i += step) {
        cell_choice const next = of_width(some, width_at(i), entry_limit, cost);
        if (next.cost < best.cost) best = next, around = i;
      }
      begin = max(around - 3, 0), end = min(around + 4, widths);
    }
    return best;
  }

  template <class Scratch>
  COLLIDE_HD_INLINE triangle_sums sum_of(Scratch const& s, int first, int end) const {
    triangle_sums sum{};
    COLLIDE_NO_UNROLL
    for (int c = first; c < end; ++c) sum += s.classes[c];
    return sum;
  }

  /// About how many spheres the grid serves.
  template <class Block, class Scratch>
  COLLIDE_HD_INLINE float spheres_served(Scratch const& s) const {
    float const weighed = request.spheres + request.costs.waiting;
    return weighed * static_cast<float>(max(s.distances.sampled, 1u)) / static_cast<float>(spheres_asked<Block>());
  }

  COLLIDE_HD void set_levels(grid<S>& g, grid_header<S> planned, cell_choice const& chosen, S extent,
                             std::size_t number) const {
    bool const two = chosen.coarse_width > 0;
    auto const first_cell = static_cast<std::uint32_t>(number) << request.table_bits;
    std::uint32_t const bits = request.table_bits - (two ? 1 : 0);
    planned.width = max(static_cast<S>(chosen.width) * extent, request.cell_width);
    constexpr S all = std::numeric_limits<S>::infinity();
    set_level(planned, g.level[0], planned.width, two ? S(chosen.small_end) : all, first_cell, bits);
    if (two) set_level(planned, g.level[1], static_cast<S>(chosen.coarse_width) * extent, all, first_cell, bits);
    planned.levels = two ? 2 : 1;
    static_cast<grid_header<S>&>(g) = planned;
  }

  /// A width, or one that is so much larger that there are not too many entries.
  COLLIDE_HD float wide_enough(triangle_sums const& all, float width, float reach, float entry_limit) const {
    COLLIDE_NO_UNROLL
    while (width < 1.01f && !(all.entries(width, reach) <= entry_limit)) width *= 1.1f;
    return width;
  }

  COLLIDE_HD void set_level(grid_header<S>& g, grid_level<S>& l, S width, S largest, std::uint32_t first_cell,
                            std::uint32_t bits) const {
    l.width = width;
    l.inverse_width = div_rn(S(1), width);
    l.largest = largest;
    l.first = first_cell + g.cells;
    g.cells += dimension(g, l, std::uint64_t{1} << bits);
  }

  /// Sets the dilation and the box of the dilated mesh, and `extent` to the longest edge of that. Returns the largest
  /// coordinate of the mesh, or the reach if that is larger.
  COLLIDE_HD S set_box(grid_header<S>& g, S& extent) const {
    S far = g.reach;
    for (int k = 0; k < 3; ++k) {
      g.lower[k] = summary->lower_of(k);
      g.upper[k] = summary->upper_of(k);
      far = max(far, max(max(g.lower[k], -g.lower[k]), max(g.upper[k], -g.upper[k])));
    }
    g.dilation = g.reach * (1 + 4 * S(ieee_traits<float>::unit_roundoff)) + 64 * ieee_traits<S>::unit_roundoff * far +
                 64 * std::numeric_limits<S>::min();
    for (int k = 0; k < 3; ++k) {
      g.lower[k] -= g.dilation;
      g.upper[k] += g.dilation;
      extent = max(extent, g.upper[k] - g.lower[k]);
    }
    return far;
  }

  /// Gives each axis of the level as many cells as the grid has, and if that is more than `limit` in all, cuts the
  /// longest axes down to powers of two, where coordinates wrap. Returns the number of cells.
  static COLLIDE_HD std::uint32_t dimension(grid_header<S> const& g, grid_level<S>& l, std::uint64_t limit) {
    std::uint64_t cells[3];
    for (int k = 0; k < 3; ++k) {
      cells[k] = std::uint64_t{g.coordinate(l, g.upper[k], k)} + 1;
      l.mask[k] = (1u << 31) - 1;
    }
    // no product overflows: there are at most 2^30 + 1 cells on an axis
    while (cells[0] * cells[1] > limit || cells[0] * cells[1] * cells[2] > limit) {
      int longest = 0;
      for (int k = 1; k < 3; ++k) longest = cells[k] > cells[longest] ? k : longest;
      std::uint64_t power = 1;
      while (2 * power < cells[longest]) power *= 2;
      cells[longest] = power;
      l.mask[longest] = static_cast<std::uint32_t>(power - 1);
    }
    l.stride[0] = static_cast<std::uint32_t>(cells[0]);
    l.stride[1] = static_cast<std::uint32_t>(cells[0] * cells[1]);
    return static_cast<std::uint32_t>(cells[0] * cells[1] * cells[2]);
  }
};

}  // namespace collide::detail
