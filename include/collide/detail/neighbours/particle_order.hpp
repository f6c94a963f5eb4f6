/// \file
/// Particles in the order of the cells of a grid, and who is near whom; verlet_list.hpp explains it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include <collide/detail/execution/atomic.hpp>
#include <collide/detail/neighbours/spatial_hash.hpp>
#include <collide/detail/numeric/repeating_box.hpp>
#include <collide/detail/numeric/rounding.hpp>
#include <collide/detail/particles/contact_memory.hpp>
#include <collide/detail/particles/particle.hpp>

namespace collide::detail {

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

/// State of the lists of all particles.
struct list_state {
  std::uint32_t rebuild;     ///< not 0: the lists are to be made anew
  std::uint32_t overflowed;  ///< not 0: some particles have more neighbours than lists have room for
  std::uint32_t count;       ///< how many particles are in the order
  std::uint32_t in_runs;     ///< how many neighbours are in runs, or would be if there were room
  std::uint32_t kept;        ///< how many contacts are kept while lists are made anew
  std::uint32_t forgotten;   ///< not 0: there was no room for what some contact remembers
};

/// The particles in the order of the grid, with all that they must know of each other.
template <class S, class Effects>
struct sorted_particles {
  using all = typename Effects::all;
  using copied = typename Effects::interaction_copies;
  using interaction = particle<S, typename Effects::interaction>;
  using cell = typename spatial_hash<S>::cell;
  static constexpr bool has_absent = contains<all, alive>;
  static constexpr bool repeats = Effects::repeats;

  typename Effects::space_type space;
  spatial_hash<S> cells;
  std::uint32_t* ends;  ///< of the cell at place c: ends[c] .. ends[c + 1]; the first of a block begins where it does
  list_state* header;
  id* numbers;
  packed_sphere<S>* spheres;                        ///< as they are in this step
  reference<S, contains<all, radius>>* references;  ///< as they were when the lists were made
  column_element<alive, S>* known;                  ///< `alive` when the lists were made, by numbers
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

  COLLIDE_HD_INLINE std::uint32_t& list(std::uint32_t k, std::size_t i) const { return lists[k * capacity + i]; }

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
    packed_sphere<S> const s = spheres[i];
    p[position{}] = vec3<S>(s.x, s.y, s.z);
    p.the_radius = s.radius;
    if constexpr (contains<typename Effects::interaction, radius>) p[radius{}] = s.radius;
    copies.load(p, i, copied{});
    return p;
  }

  /// The number of the particle at a place, in the order of which its neighbours meet it.
  COLLIDE_HD_INLINE id number_at(std::uint32_t place) const {
    if constexpr (contains<copied, global_number>) {
      return copies.at(global_number{})[place];
    } else {
      return numbers[place];
    }
  }

  /// True of a particle that a source had just made when the lists were made.
  COLLIDE_HD_INLINE bool is_new([[maybe_unused]] std::uint32_t place) const {
    if constexpr (has_absent) {
      return known[numbers[place]] >= newborn;
    } else {
      return false;
    }
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

  /// f(place, row) for those less than `skin` away from particle i, of which `is_in_row` must still be asked. That
  /// takes a while, in which threads that run together would wait for the one that has found something. If space
  /// repeats, some may be found several times.
  template <class F>
  COLLIDE_HD_INLINE void for_each_overlapping(std::uint32_t i, S skin, F const& f) const {
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
    cell const from = first_of(cell_of(i, row), row), there = cell_of(k, 0);
    return there.y == from.y && there.z == from.z && there.x >= from.x && there.x <= from.x + 2;
  }

  /// The item of what is remembered of a neighbour in a run.
  COLLIDE_HD_INLINE std::size_t run_item(std::uint32_t n) const { return listed * capacity + n; }

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
  /// The rows of nine that begin with `first_row`.
  template <class F>
  COLLIDE_HD_INLINE void for_each_in_rows(std::uint32_t i, int first_row, S skin, F const& f) const {
    packed_sphere<S> const self = spheres[i];
    cell const here = cell_of(i, first_row);
    COLLIDE_NO_UNROLL
    for (int row = first_row; row < first_row + 9; ++row) {
      cell const from = first_of(here, row);
      std::int32_t const together = min(3, 16 - (from.x & 15));  // those in the same block follow each other
      std::uint32_t const first = cells.number(from);
      std::uint32_t const begin = ends[first], size = ends[first + static_cast<std::uint32_t>(together)] - begin;
      std::uint32_t jump = 0, both = size;
      if (together < 3) {
        std::uint32_t const rest = cells.number({from.x + together, from.y, from.z});
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

  /// The first of three cells along x next to a cell.
  static COLLIDE_HD_INLINE cell first_of(cell here, int row) {
    if constexpr (repeats) row %= 9;
    return {here.x - 1, here.y + row % 3 - 1, here.z + row / 3 - 1};
  }

  /// The cell of a particle, where it is in the image of the box that a row belongs to.
  COLLIDE_HD_INLINE cell cell_of(std::uint32_t i, [[maybe_unused]] int row) const {
    auto const& from = references[i];
    if constexpr (repeats) {
      vec3<S> const x = space.in_image(vec3<S>(from.x, from.y, from.z), row / 9);
      return cells.of(x.x(), x.y(), x.z());
    } else {
      return cells.of(from.x, from.y, from.z);
    }
  }
};

}  // namespace collide::detail
