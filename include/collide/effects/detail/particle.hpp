/// \file
/// Particles in registers, and their columns in memory.
#pragma once

#include <algorithm>
#include <cmath>

#include <collide/core/detail/detected.hpp>
#include <collide/core/memory.hpp>
#include <collide/effects/detail/column_list.hpp>
#include <collide/exact/detail/numeric/pack.hpp>

namespace collide::detail {

/// A value of a column is `width` numbers of type `element`, one after the other.
template <class V>
struct layout_of {
  static_assert(is_number<V>, "collide: a column holds vec3<S>, S or an integer");
  using element = V;
  static constexpr int width = 1;
  static COLLIDE_HD_INLINE V& at(V& v, int) { return v; }
  static COLLIDE_HD_INLINE V const& at(V const& v, int) { return v; }
};
template <class S>
struct layout_of<vec3<S>> {
  using element = S;
  static constexpr int width = 3;
  static COLLIDE_HD_INLINE S& at(vec3<S>& v, int k) { return v[k]; }
  static COLLIDE_HD_INLINE S const& at(vec3<S> const& v, int k) { return v[k]; }
};

template <class T, std::size_t N>
struct layout_of<several<T, N>> {
  using element = T;
  static constexpr int width = int(N);
  static COLLIDE_HD_INLINE T& at(several<T, N>& v, int k) { return v.of[k]; }
  static COLLIDE_HD_INLINE T const& at(several<T, N> const& v, int k) { return v.of[k]; }
};

template <class C, class S>
using column_value = typename C::template value<S>;
template <class C, class S>
using column_layout = layout_of<column_value<C, S>>;
template <class C, class S>
using column_element = typename column_layout<C, S>::element;

/// Bytes of a particle in a column.
template <class C, class S>
inline constexpr std::size_t column_bytes = sizeof(column_element<C, S>) * std::size_t(column_layout<C, S>::width);

template <class C, class S>
using initial_member = decltype(C::template initial<S>);
template <class C, class S>
COLLIDE_HD column_value<C, S> initial_of() {
  if constexpr (is_valid<initial_member, C, S>) {
    constexpr column_value<C, S> v = C::template initial<S>;
    return v;
  } else if constexpr (column_layout<C, S>::width == 3) {
    return column_value<C, S>(S(0), S(0), S(0));
  } else {
    return column_value<C, S>(0);
  }
}

/// The value of one column, in a base class that is found by its type.
template <class C, class S>
struct column_slot {
  column_value<C, S> value;
};

template <class S, class List>
struct particle;
template <class S, class... C>
struct particle<S, columns<C...>> : column_slot<C, S>... {
  using scalar = S;
  using list = columns<C...>;

  id number;  ///< where the particle is in memory, from 0
  id name;    ///< by which effects know it, unless it has a `global_number`
  S the_radius;

  template <class D>
  COLLIDE_HD_INLINE column_value<D, S>& operator[](D) {
    return static_cast<column_slot<D, S>&>(*this).value;
  }
  template <class D>
  COLLIDE_HD_INLINE column_value<D, S> const& operator[](D) const {
    return static_cast<column_slot<D, S> const&>(*this).value;
  }
};

/// The number that effects know a particle by: where it is in memory, or among those of all ranks.
template <class S, class List>
COLLIDE_HD_INLINE id number_of(particle<S, List> const& p) {
  if constexpr (contains<List, global_number>) return p[global_number{}];
  return p.name;
}

/// Says that a particle has touched something, where it may fall asleep.
template <class S, class List>
COLLIDE_HD_INLINE void mark_contact([[maybe_unused]] particle<S, List>& p) {
  if constexpr (contains<List, in_contact>) p[in_contact{}] = 1;
}

template <class S, class... C>
COLLIDE_HD_INLINE void set_initial_values(particle<S, columns<C...>>& p) {
  ((p[C{}] = initial_of<C, S>()), ...);
}

/// The address of a column in memory.
template <class C, class S>
struct pointer_of {
  column_element<C, S>* value;
};

/// How many particles are read or written together: four coordinates are 16 bytes.
inline constexpr int particles_per_pack = 4;

/// Four values that are read or written at once.
template <class T>
struct alignas(4 * sizeof(T)) pack4 {
  T v[4];
};

/// All columns of a simulation in memory. Each has room for a multiple of this many particles: as many as a CUDA block
/// reads and writes at a time, so that no thread asks whether its own are there.
inline constexpr std::size_t particle_padding = 1024;

/// Places of columns for so many particles.
inline std::size_t padded_size(std::size_t particles) {
  return (particles + particle_padding - 1) / particle_padding * particle_padding;
}

/// The particles of a rank among those of all ranks. Those at places from `own` on are copies of other ranks'
/// particles.
struct rank_share {
  std::size_t own;
  std::size_t all_size, all_placed;  ///< `size` and `placed` of the simulation of all
};
struct single_rank {};

/// Numbers at `particle_state::time`: the time, then those of a source: how many particles have come due, what part of
/// the next one is, how many came in this step; how many overlapped others, and how many were not born.
inline constexpr std::size_t clock_made = 1, clock_fraction = 2, clock_made_now = 3, clock_overlapping = 4,
                             clock_not_born = 5, clock_size = 6;

/// In `alive` from where a source makes a particle until particles meet: it is there, and new; and it overlaps others.
/// And of what another effect makes: it is new, too, but not counted.
inline constexpr std::uint8_t newborn = 2, crowded_newborn = 3, made_by_effect = 4;
COLLIDE_HD_INLINE bool is_newborn(std::uint8_t mark) { return mark == newborn || mark == crowded_newborn; }

/// How many particles a source makes in a step in which `due` are due. A part of 1e-9 of one is put down to rounding.
COLLIDE_HD_INLINE std::uint64_t begin_in_step(double const* time, double due) {
  double const whole = std::floor(time[clock_fraction] + due + 1e-9);
  return static_cast<std::uint64_t>(whole < 0x1p53 ? whole : 0x1p53);
}

template <class S, class List>
struct particle_state;
template <class S, class... C>
struct particle_state<S, columns<C...>>
    : pointer_of<C, S>..., std::conditional_t<contains<columns<C...>, global_number>, rank_share, single_rank> {
  using list = columns<C...>;

  std::size_t size;    ///< number of particles, or of places for them
  std::size_t placed;  ///< how many of them `set` has placed; effects that make particles use the others
  S common_radius;     ///< if there is no column for it
  double* time;        ///< since `set`, when the step begins; null unless an effect has a member begin_step. Behind it
                       ///< what is known of a source: see `clock_size`
  id const* names;     ///< the numbers of the particles, where they lie in another order (cell_order.hpp); or null

  COLLIDE_HD_INLINE id name_at(std::size_t i) const { return names != nullptr ? names[i] : static_cast<id>(i); }

  template <class D>
  COLLIDE_HD_INLINE column_element<D, S>* at(D) const {
    return static_cast<pointer_of<D, S> const&>(*this).value;
  }

  COLLIDE_HD_INLINE S radius_at(std::size_t i) const {
    if constexpr (contains<list, radius>) return at(radius{})[i];
    return common_radius;
  }

  template <class... D>
  COLLIDE_HD_INLINE void load(particle<S, columns<D...>>& p, std::size_t i) const {
    p.number = static_cast<id>(i);
    p.name = name_at(i);
    (load_value(D{}, p[D{}], i), ...);
    p.the_radius = radius_of(p);
  }

  template <class P, class... E>
  COLLIDE_HD_INLINE void load(P& p, [[maybe_unused]] std::size_t i, columns<E...>) const {
    (load_value(E{}, p[E{}], i), ...);
  }

  template <class P, class... E>
  COLLIDE_HD_INLINE void store(P const& p, [[maybe_unused]] std::size_t i, columns<E...>) const {
    (store_value(E{}, p[E{}], i), ...);
  }

  /// Scratch memory of a block that reads and writes groups. Of all columns, vectors take the most.
  template <class Block>
  using pack_scratch = typename Block::template warp_exchange_storage<pack4<S>, 3>;

  /// A group's values of a column, and of all columns of a list, as they are read.
  template <class D>
  struct column_pack {
    static_assert(column_layout<D, S>::width <= 3, "scratch memory is for vectors");
    pack4<column_element<D, S>> of[column_layout<D, S>::width];
  };
  template <class List>
  struct pack_of;
  template <class... D>
  struct pack_of<columns<D...>> : column_pack<D>... {};

  /// A group of particles from `first` on, which is a multiple of their number; see `load_striped` in block.hpp.
  template <class Block, class... D>
  COLLIDE_HD_INLINE void load_pack(Block& block, pack_scratch<Block>& s, particle<S, columns<D...>>* p,
                                   std::size_t first) const {
    pack_of<columns<D...>> read;
    begin_load(block, read, first);
    end_load(block, s, read, p, first);
  }

  /// `load_pack` in two parts: all is on its way before something is waited for.
  template <class Block, class... D>
  COLLIDE_HD_INLINE void begin_load(Block& block, pack_of<columns<D...>>& read, std::size_t first) const {
    (load_values(block, D{}, static_cast<column_pack<D>&>(read).of, first), ...);
  }
  template <class Block, class... D>
  COLLIDE_HD_INLINE void end_load(Block& block, pack_scratch<Block>& s, pack_of<columns<D...>>& read,
                                  particle<S, columns<D...>>* p, std::size_t first) const {
    (take_values(block, s, D{}, static_cast<column_pack<D>&>(read).of, p), ...);
    COLLIDE_UNROLL
    for (int k = 0; k < particles_per_pack; ++k) {
      p[k].number = static_cast<id>(first) + static_cast<id>(k);
      p[k].name = name_at(p[k].number);
      p[k].the_radius = radius_of(p[k]);
    }
  }

  template <class Block, class P, class... E>
  COLLIDE_HD_INLINE void store_pack(Block& block, pack_scratch<Block>& s, P const* p, std::size_t first,
                                    columns<E...>) const {
    (store_values(block, s, E{}, p, first), ...);
  }

 private:
  template <class P>
  COLLIDE_HD_INLINE S radius_of(P const& p) const {
    if constexpr (contains<typename P::list, radius>) return p[radius{}];
    return common_radius;
  }

  template <class D>
  COLLIDE_HD_INLINE void load_value(D, column_value<D, S>& v, std::size_t i) const {
    using layout = column_layout<D, S>;
    COLLIDE_UNROLL
    for (int k = 0; k < layout::width; ++k) {
      layout::at(v, k) = at(D{})[i * std::size_t(layout::width) + static_cast<std::size_t>(k)];
    }
  }

  template <class D>
  COLLIDE_HD_INLINE void store_value(D, column_value<D, S> const& v, std::size_t i) const {
    using layout = column_layout<D, S>;
    COLLIDE_UNROLL
    for (int k = 0; k < layout::width; ++k) {
      at(D{})[i * std::size_t(layout::width) + static_cast<std::size_t>(k)] = layout::at(v, k);
    }
  }

  template <class Block, class D, class Q, std::size_t N>
  COLLIDE_HD_INLINE void load_values(Block& block, D, Q (&read)[N], std::size_t first) const {
    block.load_striped(reinterpret_cast<Q const*>(at(D{})), static_cast<std::uint32_t>(first / particles_per_pack),
                       read);
  }

  template <class Block, class D, class Q, std::size_t N, class P>
  COLLIDE_HD_INLINE void take_values(Block& block, pack_scratch<Block>& s, D, Q (&read)[N], P* p) const {
    block.striped_to_blocked(s, read);
    constexpr int width = int(N);
    COLLIDE_UNROLL
    for (int k = 0; k < particles_per_pack; ++k) {
      COLLIDE_UNROLL
      for (int c = 0; c < width; ++c)
        column_layout<D, S>::at(p[k][D{}], c) = read[(k * width + c) / 4].v[(k * width + c) % 4];
    }
  }

  template <class Block, class D, class P>
  COLLIDE_HD_INLINE void store_values(Block& block, pack_scratch<Block>& s, D, P const* p, std::size_t first) const {
    using layout = column_layout<D, S>;
    using pack_type = pack4<column_element<D, S>>;
    constexpr int width = layout::width;
    pack_type write[std::size_t(width)];
    COLLIDE_UNROLL
    for (int k = 0; k < particles_per_pack; ++k) {
      COLLIDE_UNROLL
      for (int c = 0; c < width; ++c) write[(k * width + c) / 4].v[(k * width + c) % 4] = layout::at(p[k][D{}], c);
    }
    block.store_transposed(s, reinterpret_cast<pack_type*>(at(D{})),
                           static_cast<std::uint32_t>(first / particles_per_pack), write);
  }
};

/// The number that effects know the particle at a place by.
template <class S, class List>
COLLIDE_HD_INLINE id number_of(particle_state<S, List> const& state, std::size_t i) {
  if constexpr (contains<List, global_number>) return state.at(global_number{})[i];
  return state.name_at(i);
}

template <class C, class S>
struct buffer_of {
  buffer<column_element<C, S>> memory;
};

template <class S, class List>
struct column_buffers;
template <class S, class... C>
struct column_buffers<S, columns<C...>> : buffer_of<C, S>... {
  static constexpr std::size_t bytes_per_particle = (column_bytes<C, S> + ... + std::size_t{0});
  static constexpr std::size_t widest = std::max({std::size_t{0}, column_bytes<C, S>...});

  void reserve([[maybe_unused]] std::pmr::memory_resource* resource, [[maybe_unused]] std::size_t n) {
    (static_cast<buffer_of<C, S>&>(*this).memory.reserve(resource, n * std::size_t(column_layout<C, S>::width)), ...);
  }

  std::size_t bytes() const {
    return (static_cast<buffer_of<C, S> const&>(*this).memory.bytes() + ... + std::size_t{0});
  }

  particle_state<S, columns<C...>> state(std::size_t size, std::size_t placed, S radius) const {
    return {pointer_of<C, S>{static_cast<buffer_of<C, S> const&>(*this).memory.data()}...,
            {},
            size,
            placed,
            radius,
            nullptr,
            nullptr};
  }
};

}  // namespace collide::detail
