/// \file
/// Which particles overlap each other: a grid of the particles, made anew in each step.
///
/// Cells are as wide as the largest particle. They lie in a table of fixed size: blocks of 4 x 4 x 4 cells are spread
/// over it by a hash function, so that any scene fits, and near cells are near in memory. Particles are counted into
/// the cells, the counts are scanned, and the particles' columns are copied in the order of the cells, and within a
/// cell of their numbers: so sums over neighbours have an order, and do not depend on which thread was first. Each
/// particle looks into the 27 cells around it.
#pragma once

#include <collide/detail/arithmetic.hpp>
#include <collide/detail/atomic.hpp>
#include <collide/detail/column_buffers.hpp>
#include <collide/detail/scene.hpp>

namespace collide::detail {

/// The cells of a table.
template <class S>
struct particle_cells {
  S inverse_width;
  std::uint32_t mask;  ///< number of cells - 1

  struct cell {
    std::int32_t x, y, z;
    friend COLLIDE_HD_INLINE bool operator==(cell a, cell b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
  };

  COLLIDE_HD_INLINE cell of(vec3<S> const& p) const {
    return {coordinate(p.x()), coordinate(p.y()), coordinate(p.z())};
  }

  /// Place of a cell in the table.
  COLLIDE_HD_INLINE std::uint32_t number(cell c) const {
    auto const u = [](std::int32_t v) { return static_cast<std::uint32_t>(v); };
    std::uint32_t const block = u(c.x >> 2) * 73856093u ^ u(c.y >> 2) * 19349663u ^ u(c.z >> 2) * 83492791u;
    std::uint32_t const mixed = (block ^ block >> 15) * 0x2c1b3c6du;
    return ((mixed ^ mixed >> 13) << 6 | (u(c.z) & 3) << 4 | (u(c.y) & 3) << 2 | (u(c.x) & 3)) & mask;
  }

 private:
  /// Rounded down; NaN and what is too far away are somewhere.
  COLLIDE_HD_INLINE std::int32_t coordinate(S x) const {
    constexpr S end = S(1 << 30);
    S const c = smaller(end, larger(-end, mul(x, inverse_width)));
    auto const i = static_cast<std::int32_t>(c);
    return static_cast<S>(i) > c ? i - 1 : i;
  }
};

/// The order of the particles in the grid.
struct particle_order {
  std::uint32_t* ends;  ///< of cell c: ends[c] .. ends[c + 1]
  id* numbers;
};

/// Kernel body of `for_each` over particles: counts them into cells, or, once the counts have been scanned, fills in
/// their numbers.
template <class S, class Scene, bool Fill>
struct sort_into_cells {
  particle_state<S, typename Scene::all> state;
  particle_cells<S> cells;
  particle_order order;

  COLLIDE_HD void operator()(std::size_t i) const {
    particle<S, placing> p;
    state.load(p, i);
    if constexpr (contains<placing, present>) {
      if (p[present{}] == 0) return;
    }
    std::uint32_t const slot = fetch_add(order.ends + 1 + cells.number(cells.of(p[position{}])), 1u);
    if constexpr (Fill) order.numbers[slot] = static_cast<id>(i);
  }

 private:
  using placing = joined_t<columns<position>, common_t<columns<present>, typename Scene::all>>;
};

/// Kernel body of `for_each` over cells: sorts each by numbers. Few particles fit into a cell.
struct sort_cells {
  particle_order order;

  COLLIDE_HD void operator()(std::size_t c) const {
    id* const first = order.numbers + order.ends[c];
    std::uint32_t const n = order.ends[c + 1] - order.ends[c];
    for (std::uint32_t i = 1; i < n; ++i) {
      id const moved = first[i];
      std::uint32_t k = i;
      for (; k > 0 && first[k - 1] > moved; --k) first[k] = first[k - 1];
      first[k] = moved;
    }
  }
};

/// Kernel body of `for_each` over places in the order: copies what particles must know of each other.
template <class S, class Scene>
struct copy_in_order {
  particle_state<S, typename Scene::all> state;
  particle_state<S, typename Scene::meeting> copies;
  particle_order order;
  std::uint32_t const* total;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (i >= *total) return;
    particle<S, typename Scene::meeting> p;
    state.load(p, order.numbers[i]);
    copies.store(p, i, typename Scene::meeting{});
  }
};

/// Kernel body of `for_each` over places in the order: the overlaps of one particle.
template <class S, class Scene>
struct meet_neighbours {
  particle_state<S, typename Scene::all> state;
  particle_state<S, typename Scene::meeting> copies;
  particle_cells<S> cells;
  particle_order order;
  std::uint32_t const* total;
  Scene scene;
  S dt;

  using meeting = particle<S, typename Scene::meeting>;
  using cell = typename particle_cells<S>::cell;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (i >= *total) return;
    meeting self;
    load(self, i);
    meeting changed = self;
    bool const sleeps = is_skipped(self);
    bool met = false;
    cell const here = cells.of(self[position{}]);
    for (int offset = 0; offset < 27; ++offset) {
      cell const there{here.x + offset % 3 - 1, here.y + offset / 3 % 3 - 1, here.z + offset / 9 - 1};
      std::uint32_t const c = cells.number(there);
      for (std::uint32_t k = order.ends[c], end = order.ends[c + 1]; k < end; ++k) {
        if (k == i) continue;
        particle<S, near> close;
        copies.load(close, k);
        vec3<S> const between = self[position{}] - close[position{}];
        S const reach = self.the_radius + close.the_radius;
        if (!(dot(between, between) < mul(reach, reach))) continue;
        if (!(cells.of(close[position{}]) == there)) continue;  // another cell at the same place of the table
        meeting other;
        load(other, k);
        if (!sleeps) {
          scene.meet(changed, self, other, dt);
        } else if (!is_skipped(other)) {
          scene.disturb(changed, other);
        } else {
          continue;
        }
        met = true;
      }
    }
    if (met) state.store(changed, self.number, typename Scene::meeting_writes{});
  }

 private:
  using near = joined_t<columns<position>, common_t<columns<radius>, typename Scene::all>>;

  COLLIDE_HD_INLINE void load(meeting& p, std::size_t i) const {
    copies.load(p, i);
    p.number = order.numbers[i];
  }

  COLLIDE_HD_INLINE bool is_skipped(meeting& p) const {
    if constexpr (Scene::skips) {
      return scene.is_skipped(p);
    } else {
      return false;
    }
  }
};

/// The grid and its memory.
template <class S, class Scene>
class neighbours {
 public:
  /// Takes all memory that steps need, for `n` particles of radius up to `radius`.
  template <class Space>
  void reserve(Space& space, std::size_t n, S radius) {
    std::uint32_t bits = 6;
    while (bits < 28 && (std::size_t{1} << bits) < n) ++bits;
    count_ = std::size_t{1} << bits;
    // a bit wider than the largest particle, so that rounding separates no pair by more than a cell
    S const width = larger(2 * radius * (1 + 64 * format<S>::unit), std::numeric_limits<S>::min());
    cells_ = {1 / width, static_cast<std::uint32_t>(count_ - 1)};
    auto* const resource = space.resource();
    ends_.reserve(resource, count_ + 2);
    numbers_.reserve(resource, n);
    memory_.reserve(resource, n);
    scratch_.reserve(resource, larger<std::size_t>(space.scan_bytes(count_ + 1), 1));
  }

  /// One pass of `meet` over all pairs.
  template <class Space>
  void meet(Space& space, particle_state<S, typename Scene::all> const& state, Scene const& scene, S dt) {
    auto const copies = memory_.state(state.size, state.placed, state.common_radius);
    particle_order const order{ends_.data(), numbers_.data()};
    std::uint32_t const* const total = order.ends + count_;
    space.fill(order.ends, 0, (count_ + 2) * sizeof *order.ends);
    space.for_each(state.size, sort_into_cells<S, Scene, false>{state, cells_, order});
    space.exclusive_scan(order.ends + 1, count_ + 1, scratch_);
    space.for_each(state.size, sort_into_cells<S, Scene, true>{state, cells_, order});
    space.for_each(count_, sort_cells{order});
    space.for_each(state.size, copy_in_order<S, Scene>{state, copies, order, total});
    space.for_each(state.size, meet_neighbours<S, Scene>{state, copies, cells_, order, total, scene, dt});
  }

 private:
  particle_cells<S> cells_{};
  std::size_t count_ = 0;
  buffer<std::uint32_t> ends_;
  buffer<id> numbers_;
  column_buffers<S, typename Scene::meeting> memory_;
  buffer<unsigned char> scratch_;
};

}  // namespace collide::detail
