/// \file
/// Particles in the order of the cells of a grid, and who is near whom; verlet_list.hpp explains it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include <collide/detail/execution/atomic.hpp>
#include <collide/detail/numeric/rounding.hpp>
#include <collide/detail/simulation/particle.hpp>
#include <collide/detail/simulation/spatial_hash.hpp>

namespace collide::detail {

/// What decides whether two particles overlap, to be read at once.
template <class S>
struct alignas(4 * sizeof(S)) near_sphere {
  S x, y, z, radius;
};

/// Where a particle was when the lists were made, and how large, if that may change.
template <class S, bool HasRadius>
struct reference {
  S x, y, z;
  COLLIDE_HD_INLINE void set(near_sphere<S> const& s) { x = s.x, y = s.y, z = s.z; }
  COLLIDE_HD_INLINE S resized(near_sphere<S> const&) const { return S(0); }
};
template <class S>
struct reference<S, true> : near_sphere<S> {
  COLLIDE_HD_INLINE void set(near_sphere<S> const& s) { static_cast<near_sphere<S>&>(*this) = s; }
  /// By how much it has grown, or shrunk: what strayed meanwhile is near it only as far as it reached then.
  COLLIDE_HD_INLINE S resized(near_sphere<S> const& s) const {
    return larger(s.radius - this->radius, this->radius - s.radius);
  }
};

/// What all particles in the order have in common.
struct order_header {
  static constexpr std::uint32_t most_strays = 128;

  std::uint32_t renew;                ///< not 0: the lists are to be made anew
  std::uint32_t crowded;              ///< not 0: some particles have more neighbours than lists have room for
  std::uint32_t before, now;          ///< how many particles were in the order after the last step, and are now
  std::uint32_t arrivals;             ///< not 0: there are strays of this step
  std::uint32_t seen, count;          ///< strays of earlier steps, and with those of this one
  std::uint32_t strays[most_strays];  ///< places of what came or moved far since the grid was made, once for each time
};

/// The particles in the order of the grid, with all that they must know of each other.
template <class S, class Scene>
struct particle_order {
  using all = typename Scene::all;
  using copied = typename Scene::meeting_copies;
  using meeting = particle<S, typename Scene::meeting>;
  using cell = typename particle_cells<S>::cell;
  static constexpr bool comes_and_goes = contains<all, present>;

  particle_cells<S> cells;
  std::uint32_t* ends;  ///< of the cell at place c: ends[c] .. ends[c + 1]; the first of a block begins where it does
  order_header* header;
  id* numbers;
  near_sphere<S>* spheres;                          ///< as they are in this step
  reference<S, contains<all, radius>>* references;  ///< as they were when they came to the order, or strayed
  column_element<present, S>* known;                ///< whether particles are in the order, by numbers
  particle_state<S, copied> copies;

  static constexpr std::uint32_t listed = 16;  ///< the most neighbours that a list has
  static constexpr std::uint32_t too_many = 0xffffffffu;
  std::uint32_t* lists;  ///< places, in the order of numbers; the particle's own behind the last; or too_many
  std::size_t capacity;  ///< of each of `listed` arrays

  /// How many strays are listed alone. Of few particles fewer: it takes longer to look at many than to make few lists.
  COLLIDE_HD_INLINE std::uint32_t stray_room() const {
    return static_cast<std::uint32_t>(smaller(capacity / 16 + 8, std::size_t{order_header::most_strays}));
  }

  COLLIDE_HD_INLINE std::uint32_t& list(std::uint32_t k, std::size_t i) const { return lists[k * capacity + i]; }

  COLLIDE_HD_INLINE near_sphere<S> store(std::size_t i, meeting const& p) const {
    vec3<S> const& c = p[position{}];
    copies.store(p, i, copied{});
    return spheres[i] = {c.x(), c.y(), c.z(), p.the_radius};
  }

  COLLIDE_HD_INLINE meeting load(std::size_t i) const {
    meeting p;
    p.number = numbers[i];
    near_sphere<S> const s = spheres[i];
    p[position{}] = vec3<S>(s.x, s.y, s.z);
    p.the_radius = s.radius;
    if constexpr (contains<typename Scene::meeting, radius>) p[radius{}] = s.radius;
    copies.load(p, i, copied{});
    return p;
  }

  /// True if the surfaces of two particles are less than `skin` apart.
  static COLLIDE_HD_INLINE bool are_near(near_sphere<S> const& a, near_sphere<S> const& b, S skin) {
    vec3<S> const between(a.x - b.x, a.y - b.y, a.z - b.z);
    S const reach = a.radius + b.radius + skin;
    return dot(between, between) < mul(reach, reach);
  }

  /// Puts a particle that is not there, or nowhere, so far away, and makes it so small, that it is near nothing, not
  /// even its like. When it is back it has moved far: lists of what came meanwhile do not have it.
  COLLIDE_HD_INLINE void leave_out(std::size_t i) const {
    constexpr S far = std::numeric_limits<S>::max();  // squares of distances overflow
    references[i].set(spheres[i] = {far, far, far, S(0)});
  }

  /// Lists a particle as one that the grid does not have where it is.
  COLLIDE_HD_INLINE void stray(std::uint32_t i, near_sphere<S> const& now) const {
    references[i].set(now);
    if (load_relaxed(&header->renew) != 0) return;  // where all have moved, they need not all ask for their turn
    std::uint32_t const n = fetch_add(&header->count, 1u);
    if (n < stray_room()) {
      header->strays[n] = i;
      store_relaxed(&header->arrivals, 1u);
    } else {
      store_relaxed(&header->renew, 1u);
    }
  }

  /// f(place, row) for those less than `skin` away from particle i, of which `is_in_row` must still be asked. That
  /// takes a while, in which threads that run together would wait for the one that has found something. Strays may come
  /// more than once.
  template <class F>
  COLLIDE_HD_INLINE void each_near(std::uint32_t i, S skin, F const& f) const {
    near_sphere<S> const self = spheres[i];
    cell const here = cell_of(i);
    COLLIDE_ROLLED
    for (int row = 0; row < 9; ++row) {
      cell const from = first_of(here, row);
      std::int32_t const together = smaller(3, 16 - (from.x & 15));  // those in the same block follow each other
      std::uint32_t const first = cells.number(from);
      std::uint32_t const begin = ends[first], size = ends[first + static_cast<std::uint32_t>(together)] - begin;
      std::uint32_t jump = 0, both = size;
      if (together < 3) {
        std::uint32_t const rest = cells.number({from.x + together, from.y, from.z});
        jump = ends[rest];
        both += ends[rest + static_cast<std::uint32_t>(3 - together)] - jump;
        jump -= size;
      }
      COLLIDE_ROLLED
      for (std::uint32_t n = 0; n < both; ++n) {
        std::uint32_t const k = n + (n < size ? begin : jump);
        if (are_near(self, spheres[k], skin) && k != i) f(k, row);
      }
    }
    each_stray_near(i, 0, skin, [&](std::uint32_t k) { f(k, no_row); });
  }

  /// f(place) for the strays from number `first` on that are less than `skin` away from particle i.
  template <class F>
  COLLIDE_HD_INLINE void each_stray_near(std::uint32_t i, std::uint32_t first, S skin, F const& f) const {
    constexpr std::uint32_t together = 4;  // are on their way at the same time
    near_sphere<S> const self = spheres[i];
    std::uint32_t const end = header->count;
    COLLIDE_ROLLED
    for (std::uint32_t n = first; n < end; n += together) {
      std::uint32_t places[together];
      near_sphere<S> others[together];
      for (std::uint32_t k = 0; k < together; ++k) places[k] = header->strays[smaller(n + k, end - 1)];
      for (std::uint32_t k = 0; k < together; ++k) others[k] = spheres[places[k]];
      for (std::uint32_t k = 0; k < together; ++k) {
        if (n + k < end && are_near(self, others[k], skin) && places[k] != i) f(places[k]);
      }
    }
  }

  /// True if particle i is one of the strays from number `first` on; all are looked at, without a branch.
  COLLIDE_HD_INLINE bool has_strayed(std::uint32_t i, std::uint32_t first) const {
    std::uint32_t const end = header->count;
    std::uint32_t found = 0;
    for (std::uint32_t n = first; n < end; ++n) found |= header->strays[n] == i ? 1u : 0u;
    return found != 0;
  }

  /// True if particle k is in a row of cells around particle i, and not in others at the same place of the table.
  COLLIDE_HD_INLINE bool is_in_row(std::uint32_t k, std::uint32_t i, int row) const {
    if (row == no_row) return true;
    cell const from = first_of(cell_of(i), row), there = cell_of(k);
    return there.y == from.y && there.z == from.z && there.x >= from.x && there.x <= from.x + 2;
  }

 private:
  static constexpr int no_row = 9;

  /// The first of three cells along x next to a cell.
  static COLLIDE_HD_INLINE cell first_of(cell here, int row) {
    return {here.x - 1, here.y + row % 3 - 1, here.z + row / 3 - 1};
  }

  COLLIDE_HD_INLINE cell cell_of(std::uint32_t i) const {
    auto const& from = references[i];
    return cells.of(from.x, from.y, from.z);
  }
};

}  // namespace collide::detail
