/// \file
/// Particles in the order of the cells of a grid, and who is near whom; verlet_list.hpp explains it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <collide/core/geometry.hpp>
#include <collide/effects/detail/contact_memory.hpp>
#include <collide/effects/detail/particle.hpp>
#include <collide/exact/detail/numeric/repeating_box.hpp>
#include <collide/exact/detail/numeric/rounding.hpp>
#include <collide/simulation/detail/neighbours/spatial_hash.hpp>
#include <collide/spaces/detail/atomic.hpp>

namespace collide::detail {

/// On a CPU: a value that is read, or `Written`, soon comes into the cache.
template <bool Written = false>
COLLIDE_HD_INLINE void prefetch([[maybe_unused]] void const* value) {
#if !defined(__CUDA_ARCH__)
  __builtin_prefetch(value, Written);
#endif
}

/// The first of neighbours in the order of their numbers.
template <std::uint32_t Room>
struct first_neighbours {
  id numbers[Room];
  std::uint32_t places[Room];
  std::uint32_t size = 0;
  bool complete = true;

  /// Once each, also if it is added again.
  COLLIDE_HD_INLINE void add(id number, std::uint32_t place) {
    if (size == Room && number > numbers[Room - 1]) {
      complete = false;
      return;
    }
    std::uint32_t at = size;
    COLLIDE_NO_UNROLL
    while (at > 0 && numbers[at - 1] > number) --at;
    if (at > 0 && numbers[at - 1] == number) return;
    if (size == Room) {
      complete = false;
      --size;
    }
    COLLIDE_NO_UNROLL
    for (std::uint32_t k = size++; k > at; --k) {
      numbers[k] = numbers[k - 1];
      places[k] = places[k - 1];
    }
    numbers[at] = number;
    places[at] = place;
  }
};

/// Centre and radius of a particle, which decide whether two overlap, to be read at once.
template <class S>
struct alignas(4 * sizeof(S)) packed_sphere {
  S x, y, z, radius;
};

/// The position of a particle when the lists were made, and its radius, if that may change.
template <class S, bool HasRadius>
struct reference {
  S x, y, z;
  COLLIDE_HD_INLINE void set(packed_sphere<S> const& s) { x = s.x, y = s.y, z = s.z; }
  COLLIDE_HD_INLINE S growth(packed_sphere<S> const&) const { return S(0); }
};
template <class S>
struct reference<S, true> : packed_sphere<S> {
  COLLIDE_HD_INLINE void set(packed_sphere<S> const& s) { static_cast<packed_sphere<S>&>(*this) = s; }
  /// By how much it has grown; 0 if it has shrunk.
  COLLIDE_HD_INLINE S growth(packed_sphere<S> const& s) const { return max(s.radius - this->radius, S(0)); }
};

/// The cells of small particles beside much larger ones.
template <class S>
struct small_cells {
  spatial_hash<S> cells;
  S largest = -1;  ///< radius of those in them; below 0: there are none, all are in the other cells
  S reach = 0;     ///< from the surface of a larger one to the centre of a small one that it lists

  /// Place in the table: the small have other blocks.
  COLLIDE_HD_INLINE std::uint32_t number(typename spatial_hash<S>::cell c) const {
    return cells.number({c.x, c.y, c.z + 0x2d6b2e8});
  }
};

struct list_state {
  std::uint32_t rebuild;    ///< not 0: the lists are to be made anew
  std::uint32_t count;      ///< how many particles are in the order
  std::uint32_t in_runs;    ///< how many neighbours are in runs, or would be if there were room
  std::uint32_t kept;       ///< how many contacts are kept while lists are made anew
  std::uint32_t forgotten;  ///< not 0: there was no room for what some contact remembers
};

struct list_state_on_ranks : list_state {
  std::uint32_t at_border;  ///< how many particles have copies of other ranks' on their list
};

/// Forgets what others do to a particle, where that is kept.
template <class Effects, class S, class List>
COLLIDE_HD_INLINE void forget_kicks([[maybe_unused]] particle_state<S, List> const& state,
                                    [[maybe_unused]] std::size_t i) {
  if constexpr (Effects::keeps_pair_forces) {
    particle<S, typename Effects::interaction_kicks> none;
    set_initial_values(none);
    state.store(none, i, typename Effects::interaction_kicks{});
  }
}

/// The particles in the order of the grid, with all that they must know of each other.
template <class S, class Effects>
struct sorted_particles {
  using all = typename Effects::all;
  using copied = typename Effects::interaction_copies;
  using interaction = particle<S, typename Effects::interaction>;
  using cell = typename spatial_hash<S>::cell;
  static constexpr bool has_absent = contains<all, alive>;
  static constexpr bool repeats = Effects::repeats;
  static constexpr bool sizes_differ = contains<all, radius>;
  static constexpr bool on_ranks = contains<all, global_number>;
  static constexpr bool has_clumps = contains<all, in_clump>;
  using state_of_lists = std::conditional_t<on_ranks, list_state_on_ranks, list_state>;

  typename Effects::space_type space;
  spatial_hash<S> cells;
  small_cells<S> small;
  std::uint32_t* curve;  ///< where each block is along a curve through all of space; null where it does not matter
  std::uint32_t* ends;   ///< of the cell at place c: ends[c] .. ends[c + 1]; the first of a block begins where it does
  state_of_lists* header;
  id* numbers;                             ///< where each particle is in memory
  id const* names;                         ///< the number of each, if that is not where it is; or null
  packed_sphere<S>* spheres;               ///< as they are in this step
  reference<S, sizes_differ>* references;  ///< as they were when the lists were made
  column_element<alive, S>* known;         ///< `alive` when the lists were made, by numbers
  particle_state<S, copied> copies;

  static constexpr std::uint32_t listed = 16;  ///< the most neighbours that a list has
  static constexpr std::uint32_t overflow_mark = 0xffffffffu;
  /// Places, in the order of numbers; the particle's own behind the last. Or `overflow_mark`, and then where its run
  /// begins and how long that is; `overflow_mark` again where there was no room for it.
  std::uint32_t* lists;
  std::size_t capacity;  ///< of each of `listed` arrays
  std::uint32_t* runs;   ///< places of those that have more neighbours than that, as in lists
  std::size_t run_capacity;

  using remembered = typename Effects::remembered;
  static constexpr bool has_memory = remembered::size != 0;
  contact_memory_ref<S, remembered> memory;

  std::size_t own;                  ///< on ranks: copies of other ranks' particles have the numbers from here on
  std::uint32_t* places_of_copies;  ///< by those numbers
  std::uint8_t* is_at_border;       ///< by places: not 0 if one on the list is such a copy, or there is no list
  std::uint32_t* border;            ///< those places, as many as there is room for
  std::size_t border_capacity;
  id const* clumps;  ///< by numbers: `in_clump`; null if the scene has none

  COLLIDE_HD_INLINE std::uint32_t& list(std::uint32_t k, std::size_t i) const { return lists[k * capacity + i]; }

  /// True of the numbers of copies of other ranks' particles, which meet their neighbours there.
  COLLIDE_HD_INLINE bool is_of_another(std::size_t number) const { return on_ranks && number >= own; }

  /// Keeps the place of a particle, if that is a copy of another rank's.
  COLLIDE_HD_INLINE void keep_place(std::size_t number, std::uint32_t place) const {
    if (is_of_another(number)) places_of_copies[number - own] = place;
  }

  COLLIDE_HD_INLINE packed_sphere<S> store(std::size_t i, interaction const& p) const {
    vec3<S> const c = inside(p[position{}]);
    copies.store(p, i, copied{});
    return spheres[i] = {c.x(), c.y(), c.z(), p.the_radius};
  }

  /// A point, moved into the box if space repeats.
  COLLIDE_HD_INLINE vec3<S> inside(vec3<S> const& x) const {
    if constexpr (repeats) return space.inside(x);
    return x;
  }

  /// From one point to another: the shortest way, if space repeats.
  template <class A, class B>
  COLLIDE_HD_INLINE vec3<S> between(A const& from, B const& to) const {
    vec3<S> a(from.x, from.y, from.z), b(to.x, to.y, to.z);
    if constexpr (repeats) space.bring_together(a, b);
    return b - a;
  }

  COLLIDE_HD_INLINE interaction load(std::size_t i) const {
    interaction p;
    p.number = numbers[i];
    p.name = number_of_place(i);
    packed_sphere<S> const s = spheres[i];
    p[position{}] = vec3<S>(s.x, s.y, s.z);
    p.the_radius = sizes_differ ? s.radius : copies.common_radius;  // what follows from it is computed once
    if constexpr (contains<typename Effects::interaction, radius>) p[radius{}] = s.radius;
    copies.load(p, i, copied{});
    return p;
  }

  /// The number of the particle at a place, in the order of which its neighbours meet it.
  COLLIDE_HD_INLINE id number_at(std::uint32_t place) const {
    if constexpr (contains<copied, global_number>) return copies.at(global_number{})[place];
    return number_of_place(place);
  }
  COLLIDE_HD_INLINE id number_of_place(std::size_t place) const {
    if constexpr (Effects::may_be_reordered) {
      if (names != nullptr) return names[numbers[place]];
    }
    return numbers[place];
  }

  /// True of a particle that a source had just made when the lists were made.
  COLLIDE_HD_INLINE bool is_new([[maybe_unused]] std::uint32_t place) const {
    if constexpr (has_absent) return known[numbers[place]] >= newborn;
    return false;
  }

  /// True if the surfaces of two particles are less than `skin` apart.
  COLLIDE_HD_INLINE bool within_skin(packed_sphere<S> const& a, packed_sphere<S> const& b, S skin) const {
    vec3<S> const apart = between(b, a);
    S const reach = a.radius + b.radius + skin;
    return dot(apart, apart) < mul_rn(reach, reach);
  }

  /// Puts a particle that is not there, or nowhere, so far away, and makes it so small, that it is near nothing, not
  /// even its like. When it is back it has moved far.
  COLLIDE_HD_INLINE void deactivate(std::size_t i) const {
    constexpr S far = std::numeric_limits<S>::max();  // squares of distances overflow
    references[i].set(spheres[i] = {far, far, far, S(0)});
  }

  COLLIDE_HD_INLINE void ask_to_rebuild() const { store_relaxed(&header->rebuild, 1u); }

  /// True of two spheres of one clump, which do not meet. All of it are on one rank.
  COLLIDE_HD_INLINE bool are_rigid([[maybe_unused]] std::uint32_t i, [[maybe_unused]] std::uint32_t k) const {
    if constexpr (has_clumps) {
      if (is_of_another(numbers[k])) return false;
      return clumps[numbers[i]] != no_id && clumps[numbers[i]] == clumps[numbers[k]];
    }
    return false;
  }

  /// f(place, row) for those less than `skin` away from particle i, of which `is_in_row` must still be asked. That
  /// takes a while, in which threads that run together would wait for the one that has found something. If space
  /// repeats, some may be found several times.
  template <class F>
  COLLIDE_HD_INLINE void for_each_overlapping(std::uint32_t i, S skin, F const& found) const {
    auto const f = [&](std::uint32_t k, int row) {
      if (!are_rigid(i, k)) found(k, row);
    };
    if constexpr (repeats) {
      auto const& at = references[i];
      vec3<S> const x(at.x, at.y, at.z);
      for_each_in_rows(i, 0, skin, f);
      COLLIDE_NO_UNROLL
      for (int image = 1; image < repeating_box<S>::images; ++image) {
        if (!space.is_near_in(x, image, 1 / cells.inverse_width)) continue;
        for_each_in_rows(i, 9 * image, skin, [&](std::uint32_t k, int row) {
          if (is_in_row(k, i, row)) f(k, row);  // else many would be found in vain
        });
      }
    } else {
      for_each_in_rows(i, 0, skin, f);
    }
  }

  /// True if particle k is in a row of cells around particle i, and not in others at the same place of the table.
  COLLIDE_HD_INLINE bool is_in_row(std::uint32_t k, std::uint32_t i, int row) const {
    spatial_hash<S> grid = cells;
    if (is_small(k)) {
      if (!is_small(i)) return true;  // it was asked when it was found
      grid = small.cells;
    }
    return is_in(grid, k, first_of(cell_of(grid, i, row), row), 3);
  }

  /// Says of the block at a place in the table that the cell there, at a point, is in it.
  COLLIDE_HD_INLINE void keep_on_curve(std::uint32_t place, vec3<S> const& x) const {
    if (curve != nullptr) store_relaxed(curve + place / cells.stride, cells.on_curve(cells.of(x.x(), x.y(), x.z())));
  }

  COLLIDE_HD_INLINE std::uint32_t place_in_table(vec3<S> const& x, [[maybe_unused]] S own_radius) const {
    if constexpr (sizes_differ) {
      if (own_radius <= small.largest) return small.number(small.cells.of(x.x(), x.y(), x.z()));
    }
    return cells.number(cells.of(x.x(), x.y(), x.z()));
  }

  COLLIDE_HD_INLINE std::size_t run_item(std::uint32_t n) const { return listed * capacity + n; }

  /// True if the contact of two particles is kept with the first while lists are made anew.
  COLLIDE_HD_INLINE bool keeps(std::uint32_t place, std::uint32_t other) const {
    return !Effects::meets_once || number_at(place) < number_at(other);
  }

  /// f(place, item) for the neighbours with which a particle has a contact that remembers something, in the order of
  /// their numbers.
  template <class F>
  COLLIDE_HD_INLINE void for_each_remembered(std::uint32_t i, F const& f) const {
    if (lists[i] != overflow_mark) {
      std::uint32_t const touching = memory.touching[i];
      COLLIDE_NO_UNROLL
      for (std::uint32_t k = 0; k < listed; ++k) {
        if ((touching >> k & 1) != 0) f(list(k, i), k * capacity + i);
      }
      return;
    }
    std::uint32_t const first = list(1, i), size = list(2, i);
    if (first == overflow_mark) return;
    COLLIDE_NO_UNROLL
    for (std::uint32_t k = 0; k < size; ++k) {
      if (memory.run_touching[first + k] != 0) f(runs[first + k], run_item(first + k));
    }
  }

 private:
  COLLIDE_HD_INLINE bool is_small([[maybe_unused]] std::uint32_t i) const {
    if constexpr (sizes_differ) return references[i].radius <= small.largest;
    return false;
  }

  /// The rows of nine that begin with `first_row`.
  template <class F>
  COLLIDE_HD_INLINE void for_each_in_rows(std::uint32_t i, int first_row, S skin, F const& f) const {
    packed_sphere<S> const self = spheres[i];
    bool finds_small = false;
    if constexpr (sizes_differ) finds_small = small.largest >= 0;
    // once, or once more in the cells of small ones
    COLLIDE_NO_UNROLL
    for (int pass = 0; pass < 2; ++pass) {
      bool const in_small = pass == 1;
      if (in_small && !finds_small) break;
      if (in_small && !is_small(i)) {
        for_each_small(i, first_row, skin, f);
        break;
      }
      cell const here = cell_of(in_small ? small.cells : cells, i, first_row);
      COLLIDE_NO_UNROLL
      for (int row = first_row; row < first_row + 9; ++row) {
        cell const from = first_of(here, row);
        std::int32_t const together = min(3, 16 - (from.x & 15));  // those in the same block follow each other
        std::uint32_t const first = number(from, in_small);
        std::uint32_t const begin = ends[first], size = ends[first + static_cast<std::uint32_t>(together)] - begin;
        std::uint32_t jump = 0, both = size;
        if (together < 3) {
          std::uint32_t const rest = number({from.x + together, from.y, from.z}, in_small);
          jump = ends[rest];
          both += ends[rest + static_cast<std::uint32_t>(3 - together)] - jump;
          jump -= size;
        }
        COLLIDE_NO_UNROLL
        for (std::uint32_t n = 0; n < both; ++n) {
          std::uint32_t const k = n + (n < size ? begin : jump);
          if (within_skin(self, spheres[k], skin) && k != i) f(k, row);
        }
      }
    }
  }

  COLLIDE_HD_INLINE std::uint32_t number(cell c, bool in_small) const {
    return in_small ? small.number(c) : cells.number(c);
  }

  /// The small ones near a particle that is not: in all of their cells that it reaches, or, if these are very many,
  /// among all particles.
  template <class F>
  COLLIDE_HD void for_each_small(std::uint32_t i, int row, S skin, F const& f) const {
    packed_sphere<S> const self = spheres[i];
    vec3<S> const at = reference_in(i, row);
    S const reach = (radius_at_reference(i) + small.reach) * (1 + S(0.00390625)),
            across = 2 * reach * small.cells.inverse_width + 2;
    if (!(across * across * across < static_cast<S>(header->count))) {
      std::uint32_t const all_of = row == 0 ? header->count : 0;  // images of the box find no others
      COLLIDE_NO_UNROLL
      for (std::uint32_t k = 0; k < all_of; ++k)
        if (within_skin(self, spheres[k], skin) && k != i && is_small(k)) f(k, row);
      return;
    }
    cell const low = small.cells.of(at.x() - reach, at.y() - reach, at.z() - reach),
               high = small.cells.of(at.x() + reach, at.y() + reach, at.z() + reach);
    COLLIDE_NO_UNROLL
    for (std::int32_t z = low.z; z <= high.z; ++z) {
      COLLIDE_NO_UNROLL
      for (std::int32_t y = low.y; y <= high.y; ++y) {
        COLLIDE_NO_UNROLL
        for (std::int32_t x = low.x, next; x <= high.x; x = next) {
          next = min((x & ~15) + 16, high.x + 1);  // those in the same block follow each other
          std::uint32_t const first = small.number({x, y, z}), end = ends[first + static_cast<std::uint32_t>(next - x)];
          COLLIDE_NO_UNROLL
          for (std::uint32_t k = ends[first]; k < end; ++k)
            if (within_skin(self, spheres[k], skin) && is_small(k) && is_in(small.cells, k, {x, y, z}, next - x))
              f(k, row);
        }
      }
    }
  }

  COLLIDE_HD_INLINE S radius_at_reference([[maybe_unused]] std::uint32_t i) const {
    if constexpr (sizes_differ) return references[i].radius;
    return spheres[i].radius;
  }

  /// True if particle k is in one of `n` cells of a grid that follow each other from `first` on.
  COLLIDE_HD_INLINE bool is_in(spatial_hash<S> const& grid, std::uint32_t k, cell first, std::int32_t n) const {
    cell const there = cell_of(grid, k, 0);
    return there.y == first.y && there.z == first.z && there.x >= first.x && there.x < first.x + n;
  }

  /// The first of three cells along x next to a cell.
  static COLLIDE_HD_INLINE cell first_of(cell here, int row) {
    if constexpr (repeats) row %= 9;
    return {here.x - 1, here.y + row % 3 - 1, here.z + row / 3 - 1};
  }

  /// The cell of a particle, where it is in the image of the box that a row belongs to.
  COLLIDE_HD_INLINE cell cell_of(spatial_hash<S> const& grid, std::uint32_t i, int row) const {
    vec3<S> const x = reference_in(i, row);
    return grid.of(x.x(), x.y(), x.z());
  }
  COLLIDE_HD_INLINE vec3<S> reference_in(std::uint32_t i, [[maybe_unused]] int row) const {
    auto const& from = references[i];
    vec3<S> const x(from.x, from.y, from.z);
    if constexpr (repeats) return space.in_image(x, row / 9);
    return x;
  }
};

}  // namespace collide::detail
