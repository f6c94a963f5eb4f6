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
  };

  COLLIDE_HD_INLINE cell of(vec3<S> const& p) const {
    return {coordinate(p.x()), coordinate(p.y()), coordinate(p.z())};
  }

  /// Place of a cell in the table.
  COLLIDE_HD_INLINE std::uint32_t number(cell c) const {
    auto const u = [](std::int32_t v) { return static_cast<std::uint32_t>(v); };
    std::uint32_t const block = u(c.x >> 4) * 73856093u ^ u(c.y >> 1) * 19349663u ^ u(c.z >> 1) * 83492791u;
    std::uint32_t const mixed = (block ^ block >> 15) * 0x2c1b3c6du;
    return ((mixed ^ mixed >> 13) << 6 | (u(c.z) & 1) << 5 | (u(c.y) & 1) << 4 | (u(c.x) & 15)) & mask;
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

/// What decides whether two particles overlap, to be read at once.
template <class S>
struct alignas(4 * sizeof(S)) near_sphere {
  S x, y, z, radius;
};

/// The particles in the order of the grid, with all that they must know of each other.
template <class S, class Scene>
struct ordered_particles {
  particle_order order;
  std::uint32_t const* total;
  near_sphere<S>* spheres;
  particle_state<S, typename Scene::meeting_copies> copies;

  using meeting = particle<S, typename Scene::meeting>;

  COLLIDE_HD_INLINE meeting operator[](std::size_t i) const {
    meeting p;
    p.number = order.numbers[i];
    near_sphere<S> const s = spheres[i];
    p[position{}] = vec3<S>(s.x, s.y, s.z);
    p.the_radius = s.radius;
    if constexpr (contains<typename Scene::meeting, radius>) p[radius{}] = s.radius;
    copies.load(p, i, typename Scene::meeting_copies{});
    return p;
  }
};

/// Kernel body of `for_each` over places in the order.
template <class S, class Scene>
struct copy_in_order {
  particle_state<S, typename Scene::all> state;
  ordered_particles<S, Scene> to;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (i >= *to.total) return;
    typename ordered_particles<S, Scene>::meeting p;
    state.load(p, to.order.numbers[i]);
    vec3<S> const& c = p[position{}];
    to.spheres[i] = {c.x(), c.y(), c.z(), p.the_radius};
    to.copies.store(p, i, typename Scene::meeting_copies{});
  }
};

/// Kernel body of `for_each` over places in the order: the overlaps of one particle. Those that overlap it are listed
/// first, and then met: threads that run together meet one each at the same time, which takes longer than to look for
/// them.
template <class S, class Scene>
struct meet_neighbours {
  particle_state<S, typename Scene::all> state;
  ordered_particles<S, Scene> particles;
  particle_cells<S> cells;
  Scene scene;
  S dt;

  using meeting = typename ordered_particles<S, Scene>::meeting;
  using cell = typename particle_cells<S>::cell;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (i >= *particles.total) return;
    meeting self = particles[i];
    meeting changed = self;
    bool const sleeps = is_skipped(self);
    bool met = false;
    cell const here = cells.of(self[position{}]);
    std::uint32_t found = 0, done = 0;
    do {  // once, unless very many overlap it
      std::uint32_t places[room];
      std::uint8_t rows[room];
      found = 0;
      each_near(self, here, static_cast<std::uint32_t>(i), [&](std::uint32_t k, int row) {
        std::uint32_t const n = found++ - done;
        if (n >= room) return;
        places[n] = k;
        rows[n] = static_cast<std::uint8_t>(row);
      });
      std::uint32_t const listed = smaller(found - done, room);
      COLLIDE_ROLLED
      for (std::uint32_t n = 0; n < listed; ++n) {
        meeting other = particles[places[n]];
        cell const from = first_of(here, rows[n]), there = cells.of(other[position{}]);
        // others may be at the same place of the table
        if (there.y != from.y || there.z != from.z || there.x < from.x || there.x > from.x + 2) continue;
        if (!sleeps) {
          scene.meet(changed, self, other, dt);
        } else if (!is_skipped(other)) {
          scene.disturb(changed, other);
        } else {
          continue;
        }
        met = true;
      }
      done += listed;
    } while (done < found);
    if (met) state.store(changed, self.number, typename Scene::meeting_writes{});
  }

 private:
  static constexpr std::uint32_t room = 16;

  /// The first of three cells along x next to a cell.
  static COLLIDE_HD_INLINE cell first_of(cell here, int row) {
    return {here.x - 1, here.y + row % 3 - 1, here.z + row / 3 - 1};
  }

  /// f(place, row) for those that overlap a particle and lie in a cell next to its own, or in one at the same place of
  /// the table.
  template <class F>
  COLLIDE_HD_INLINE void each_near(meeting const& self, cell here, std::uint32_t i, F const& f) const {
    std::uint32_t const* const ends = particles.order.ends;
    COLLIDE_ROLLED
    for (int row = 0; row < 9; ++row) {
      cell const from = first_of(here, row);
      std::int32_t together;
      COLLIDE_ROLLED
      for (std::int32_t x = 0; x < 3; x += together) {
        together = smaller(3 - x, 16 - ((from.x + x) & 15));  // those in the same block follow each other
        std::uint32_t const first = cells.number({from.x + x, from.y, from.z});
        std::uint32_t const end = ends[first + static_cast<std::uint32_t>(together)];
        COLLIDE_ROLLED
        for (std::uint32_t k = ends[first]; k < end; ++k) {
          near_sphere<S> const close = particles.spheres[k];
          vec3<S> const between = self[position{}] - vec3<S>(close.x, close.y, close.z);
          S const reach = self.the_radius + close.radius;
          if (dot(between, between) < mul(reach, reach) && k != i) f(k, row);
        }
      }
    }
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
    while (bits < 28 && (std::size_t{1} << bits) < 2 * n) ++bits;
    count_ = std::size_t{1} << bits;
    // a bit wider than the largest particle, so that rounding separates no pair by more than a cell
    S const width = larger(2 * radius * (1 + 64 * format<S>::unit), std::numeric_limits<S>::min());
    cells_ = {1 / width, static_cast<std::uint32_t>(count_ - 1)};
    auto* const resource = space.resource();
    ends_.reserve(resource, count_ + 2);
    numbers_.reserve(resource, n);
    memory_.reserve(resource, n);
    spheres_.reserve(resource, n);
    scratch_.reserve(resource, larger<std::size_t>(space.scan_bytes(count_ + 1), 1));
  }

  /// One pass of `meet` over all pairs.
  template <class Space>
  void meet(Space& space, particle_state<S, typename Scene::all> const& state, Scene const& scene, S dt) {
    particle_order const order{ends_.data(), numbers_.data()};
    ordered_particles<S, Scene> const ordered{order, order.ends + count_, spheres_.data(),
                                              memory_.state(state.size, state.placed, state.common_radius)};
    space.fill(order.ends, 0, (count_ + 2) * sizeof *order.ends);
    space.for_each(state.size, sort_into_cells<S, Scene, false>{state, cells_, order});
    space.exclusive_scan(order.ends + 1, count_ + 1, scratch_);
    space.for_each(state.size, sort_into_cells<S, Scene, true>{state, cells_, order});
    space.for_each(count_, sort_cells{order});
    space.for_each(state.size, copy_in_order<S, Scene>{state, ordered});
    space.for_each(state.size, meet_neighbours<S, Scene>{state, ordered, cells_, scene, dt});
  }

 private:
  particle_cells<S> cells_{};
  std::size_t count_ = 0;
  buffer<std::uint32_t> ends_;
  buffer<id> numbers_;
  buffer<near_sphere<S>> spheres_;
  column_buffers<S, typename Scene::meeting_copies> memory_;
  buffer<unsigned char> scratch_;
};

}  // namespace collide::detail
