/// \file
/// Which spheres of a rank go to which others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include <collide/core/moving_spheres.hpp>
#include <collide/exact/detail/geometry/sphere_pack.hpp>
#include <collide/exact/detail/numeric/exact_number.hpp>
#include <collide/ranks/detail/rank_map.hpp>
#include <collide/ranks/detail/send_plan.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace collide::detail {

/// Passes every sphere that a `rank_lookup` says goes to another rank, and few more: a plain value that a kernel takes.
///
/// A box no wider than a cell meets, on each axis, the cell that it begins in and perhaps the next: the lookup has a
/// bit for these eight. Where it begins is computed in S, with room for the rounding of that and for what `reach_of`
/// adds. Proof: docs/development/numerics.md. Wider spheres pass, and where numbers may overflow all do.
template <class S>
class halo_filter {
 public:
  /// `extent`: as for `reach_of`; `radius`: of all spheres, or 0. Larger ones have larger cells.
  halo_filter(rank_lookup const& map, double extent, S radius) : rows_{map.others} {
    for (int level = coarse_grid::finest; level >= 0; --level) {
      if (!set(map, extent, level)) return;
      if (to_bits(2 * radius) < limit_) return;
    }
  }

  /// Says which pass: bit k is of sphere k. Without branches, for the CPU's vector unit.
  template <unsigned N>
  COLLIDE_HD_INLINE std::uint32_t mark(sphere_pack<S, N> const& b) const {
    static_assert(N <= 32, "collide: a word has a bit for each");
    std::uint32_t rows[N], columns[N], inside[N], wide[N];
    for (unsigned k = 0; k < N; ++k) {
      S const r = b.radius[k], x = place(0, b.x[k], r), y = place(1, b.y[k], r), z = place(2, b.z[k], r);
      wide[k] = to_bits(2 * r) < limit_ ? 0u : 1u;
      inside[k] = is_inside(x) & is_inside(y) & is_inside(z);
      bool const so = inside[k] != 0;
      columns[k] = cell(select(so, x, S(0)));
      rows[k] = cell(select(so, y, S(0))) + across_ * cell(select(so, z, S(0)));
    }
    std::uint32_t near = 0;
    for (unsigned k = 0; k < N; ++k) near |= (wide[k] | (inside[k] & rows_[rows[k]] >> columns[k])) << k;
    return near;
  }

 private:
  /// For the cells of a level. False if numbers may overflow; all spheres pass then.
  bool set(rank_lookup const& map, double extent, int level) {
    using limits = std::numeric_limits<S>;
    auto const& bounds = map.grid.bounds();
    double const u = static_cast<double>(ieee_traits<S>::unit_roundoff), across = 1 << level;
    double const tiny = static_cast<double>(limits::min()), huge = static_cast<double>(limits::max());
    double limit = extent;
    for (int k = 0; k < 3; ++k) {
      double const size = max(max(-bounds.lower[k], bounds.lower[k]), max(-bounds.upper[k], bounds.upper[k]));
      double const cells = map.grid.cells_on(k, level), width = cells > 0 ? 1 / cells : extent / across;
      if (!(size < huge / 8 && 1 / width < huge)) return false;
      double const margin = 0x1p-12 * width + 0x1p-19 * extent + (8 * u + 0x1p-46) * size + 4 * sqrt_rn(tiny);
      lower_[k] = static_cast<S>(bounds.lower[k] + margin - width);
      scale_[k] = static_cast<S>(1 / width);
      limit = min(limit, width - 2 * margin);
    }
    limit_ = limit > 0 ? to_bits(static_cast<S>(limit)) : 0;
    end_ = to_bits(static_cast<S>(across + 1));
    across_ = 1u << level;
    rows_ = map.others + rank_lookup::first_row_of(level);
    return true;
  }

  /// The first cell of a box, in cells, one more than from the bounds on.
  COLLIDE_HD_INLINE S place(int axis, S x, S radius) const { return mul_rn(x - lower_[axis] - radius, scale_[axis]); }

  /// 1 if a box that begins there may reach into the bounds; on bits, which negative numbers and NaN have more of.
  COLLIDE_HD_INLINE std::uint32_t is_inside(S place) const { return to_bits(place) < end_ ? 1u : 0u; }

  /// The cell of a place; the first for one before it.
  static COLLIDE_HD_INLINE std::uint32_t cell(S place) {
    return static_cast<std::uint32_t>(max(static_cast<std::int32_t>(place) - 1, 0));
  }

  S lower_[3] = {}, scale_[3] = {};
  uint_for<S> limit_ = 0;  ///< how wide a box is at most, as bits, which are in the order of the numbers from 0 on
  uint_for<S> end_ = 0;    ///< where the last cell ends, as bits
  std::uint32_t across_ = 0;
  std::uint32_t const* rows_;  ///< there are some, also where all pass
};

/// `reach_of` sphere i of a view of spheres, at rest or moving.
template <class S>
COLLIDE_HD aabb<double> reach_of(sphere_view<S> const& spheres, std::size_t i, double extent) {
  return reach_of(spheres[i], vec3<S>(0, 0, 0), extent);
}
template <class S>
COLLIDE_HD aabb<double> reach_of(moving_sphere_view<S> const& spheres, std::size_t i, double extent) {
  auto const s = spheres[i];
  return reach_of(sphere<S>{s.centre, s.radius}, s.displacement, extent);
}

/// Kernel functor of `for_each` over so many spheres at a time: puts out a pair of each other rank that a sphere goes
/// to, and the sphere.
template <class Spheres, unsigned Items>
struct find_sends {
  using S = typename Spheres::scalar;
  Spheres spheres;
  rank_lookup map;
  halo_filter<S> quick;
  double extent;
  int self;
  output to;
  COLLIDE_HD void operator()(std::size_t pack) const {
    std::size_t const first = pack * Items;
    std::uint32_t near = 0;
    multiversioned([&] {
      sphere_pack<S, Items> batch;
      batch.load(spheres, first);
      near = quick.mark(batch);
    });
    for (; near != 0; near &= near - 1) {
      std::size_t const i = first + static_cast<std::size_t>(trailing_zeros(near));
      if (i < spheres.size()) find(i);
    }
  }

 private:
  COLLIDE_HD void find(std::size_t i) const {
    map.for_each_rank(reach_of(spheres, i, extent), [&](int rank) {
      if (rank != self) add_send(to, rank, i);
    });
  }
};

class sphere_send_plan : public send_plan {
 public:
  /// Finds the routes of spheres to ranks other than `self`.
  template <class Space, class Spheres>
  void find(Space& space, rank_lookup const& map, Spheres const& spheres, int self, int ranks) {
    constexpr unsigned items = Space::host_accessible ? 32 : 4;
    double const extent = map.grid.meets(map.grid.bounds()) ? map.grid.bounds().max_extent() : 0;
    halo_filter<typename Spheres::scalar> const quick(map, extent, spheres.common_radius());
    send_plan::find(space, find_sends<Spheres, items>{spheres, map, quick, extent, self, {}},
                    (spheres.size() + items - 1) / items, spheres.size(), ranks);
  }

  /// How many rounds it takes on all ranks to send about `chunk` spheres of each at a time. All ranks call it.
  template <class Ranks>
  std::uint64_t rounds(Ranks const& ranks, std::size_t chunk) const {
    std::uint64_t const mine = (size() + chunk - 1) / chunk;
    std::uint64_t limit = 0;
    ranks.reduce(&mine, &limit, 1, reduction::max);
    return limit;
  }
};

}  // namespace collide::detail
