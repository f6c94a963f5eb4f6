/// \file
/// A simulation's step: each block moves its share of the particles, and then resolves the contacts of those that may
/// touch the mesh.
///
/// Particles are divided into tiles. Where threads share a block and something touches the mesh, there are as many
/// blocks as can be at work at the same time. Each has tiles from everywhere among the particles, as those that are
/// close to each other there may be close to the mesh together; so all have about as many contacts to resolve, and none
/// waits for another. Else a block has one tile.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/effects/detail/effect_list.hpp>
#include <collide/narrow/detail/traits.hpp>
#include <collide/simulation/detail/bodies/bodies_ref.hpp>
#include <collide/simulation/detail/step/contact_response.hpp>
#include <collide/simulation/detail/step/integrate.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace collide::detail {

/// The particles, the effects, the mesh, and the time. `NarrowPhase` judges spheres at rest, or spheres that move: then
/// particles that may touch the mesh stay where they are until their contacts are resolved. `Triangles` is what an
/// index's `mesh_lookup()` returns (mesh_lookup.hpp).
template <class S, class NarrowPhase, class Triangles, class Effects>
struct step_context {
  using scalar = S;
  using narrow_phase = NarrowPhase;
  using triangles_type = Triangles;
  using effects_type = Effects;
  using state_type = particle_state<S, typename Effects::all>;

  static constexpr bool is_swept = !is_discrete<NarrowPhase, S>;
  static constexpr bool any_mesh_contact = Effects::any_mesh_contact;
  static constexpr bool has_bodies = has_moving_mesh<Triangles>;
  /// The parts of a step's acceleration that come before positions change, and at the end of the step.
  static constexpr S kick_before = S(Effects::integrator::kick_before), kick_after = S(Effects::integrator::kick_after);

  state_type state;
  Effects effects;
  Triangles triangles;
  id* overflow;  ///< room for the numbers of all particles and their padding; only where threads share a block
  S dt;
  bool reverse_order;  ///< the last particles first: what the step before has written last is still in the caches
  S min_radius;        ///< swept particles are searched for as if they were at least so large
};

/// Kernel functor: a step, in `blocks` blocks.
template <class Context>
struct step_kernel {
  using S = typename Context::scalar;
  using effects_type = typename Context::effects_type;
  using integration_type = integration<Context>;
  using response_type = contact_response<Context>;

  static constexpr int items = particles_per_pack;
  /// Waits for memory, mostly; a thread alone resolves contacts in many registers.
  template <class Block>
  static constexpr int min_blocks_per_sm = !Context::any_mesh_contact ? 1 : (Block::num_threads > 1 ? 3 : 2);

  Context context;
  std::size_t blocks;

  /// True if a block has many tiles. It may have more particles near the mesh than its queue has room for, which need
  /// `context.overflow`.
  template <class Block>
  static constexpr bool has_many_tiles = Context::any_mesh_contact&& Block::num_threads > 1;

  /// A tile: the particles of threads that read and write together. One that is a block's only one is all of the
  /// block's.
  template <class Block>
  static constexpr std::uint32_t tile_threads = has_many_tiles<Block> ? Block::warp_size : Block::num_threads;
  template <class Block>
  static constexpr std::uint32_t tile = tile_threads<Block>* Block::items;
  template <class Block>
  static constexpr std::uint32_t tiles_together = Block::num_threads / tile_threads<Block>;  ///< of a block

  template <class Block>
  static COLLIDE_HD_INLINE std::uint32_t tile_count(std::size_t particles) {
    return static_cast<std::uint32_t>((particles + tile<Block> - 1) / tile<Block>);
  }

  /// How many blocks there are to be: one a tile, but where a block has many, no more than can be at work at a time.
  template <class Space>
  static std::size_t grid_size([[maybe_unused]] Space const& space, std::size_t particles) {
    using block = typename Space::template block<step_kernel>;
    std::size_t const tiles = tile_count<block>(particles);
    if constexpr (has_many_tiles<block>)
      return min(tiles, min(space.saturating_blocks(), space.template max_resident_blocks<step_kernel>()));
    return tiles;
  }

  template <class Block, bool Touches>
  struct scratch_of {
    typename integration_type::template scratch<Block> packs;
  };
  template <class Block>
  struct scratch_of<Block, true> {
    static constexpr std::uint32_t capacity = response_type::template scratch<Block>::batch_size;

    union {  // one after the other
      typename integration_type::template scratch<Block> packs;
      typename response_type::template scratch<Block> contacts;
    };
    occupancy_view<S> occupancy;
    bool single_cell;  ///< `occupancy` tell of all particles whether they may touch the mesh
    std::uint32_t queue_size;
    id queue[capacity];  ///< the first of those that may; the others are in `context.overflow`
  };
  template <class Block>
  using scratch = scratch_of<Block, Context::any_mesh_contact>;

  template <class Block>
  COLLIDE_AS_O3 COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    static_assert(Block::warp_size == 1 || particle_padding % tile<Block> == 0, "there is room for whole tiles");
    if constexpr (Context::any_mesh_contact) {
      advance_and_enqueue(block, s);
      resolve_queue(block, s);
    } else {
      advance_tiles<unfiltered_at_a_time<Block>>(block, s, no_filter{});
    }
  }

 private:
  static constexpr int pack = particles_per_pack;

  /// How many particles a thread moves at a time: a pack, which compilers put into vector registers, or as many as are
  /// asked together whether they are near the mesh.
  template <class Block>
  static constexpr int at_a_time = Block::items % 16 == 0 && (Context::any_mesh_contact || effects_type::any_resistance)
                                       ? 16
                                       : pack;
  template <class Block>
  static constexpr int unfiltered_at_a_time = effects_type::any_resistance ? at_a_time<Block> : pack;
  static_assert(particle_padding % 16 == 0, "the last ones are read and written with those that are not there");

  /// On a CPU, where nothing happens to particles after they have moved, they are asked afterwards whether they may
  /// touch the mesh, as many as fill its vector registers at a time.
  template <class Block>
  static constexpr bool filters_after_integration =
      Block::items % 16 == 0 && !Context::is_swept && integration_type::has_one_radius && !effects_type::any_inactive &&
      !effects_type::any_end_step && Context::kick_after == 0;

  /// The next particles are on their way while a thread moves some. To ask for the cells of motions, or for bodies,
  /// takes too many registers for that.
  template <class Block>
  static constexpr bool prefetches = has_many_tiles<Block> && !Context::is_swept && !effects_type::any_inactive &&
                                     !has_moving_mesh<typename Context::triangles_type>;

  /// The number of a block's `k`-th tile.
  template <class Block>
  COLLIDE_HD_INLINE std::uint32_t tile_index(Block const& block, std::uint32_t k) const {
    return k * static_cast<std::uint32_t>(blocks) + static_cast<std::uint32_t>(block.index());
  }

  /// The first particle of a thread in a tile that exists.
  template <class Block>
  COLLIDE_HD_INLINE std::uint32_t first_of(int thread_rank, std::uint32_t tile_number, std::uint32_t tiles) const {
    return (context.reverse_order ? tiles - 1 - tile_number : tile_number) * tile<Block> +
           static_cast<std::uint32_t>(thread_rank) % tile_threads<Block> * Block::items;
  }

  /// The address at which a block keeps the number of its `i`-th particle for which its queue has no room: where its
  /// own tiles would be.
  template <class Block>
  COLLIDE_HD_INLINE std::size_t overflow_slot(Block const& block, std::uint32_t i) const {
    return std::size_t{tile_index(block, i / tile<Block>)} * tile<Block> + i % tile<Block>;
  }

  template <class Block>
  COLLIDE_HD_INLINE void enqueue(Block& block, scratch<Block>& s, id number) const {
    std::uint32_t const i = block.add(s.queue_size, 1);
    if (!has_many_tiles<Block> || i < scratch<Block>::capacity) {
      s.queue[i] = number;
    } else {
      context.overflow[overflow_slot(block, i - scratch<Block>::capacity)] = number;
    }
  }

  /// Moves the particles of a block, and queues those that may touch the mesh.
  template <class Block>
  COLLIDE_HD_INLINE void advance_and_enqueue(Block& block, scratch<Block>& s) const {
    integration_type const integrate{context};
    block.for_each_thread([&](int thread_rank) {
      if (thread_rank != 0) return;
      s.queue_size = 0;
      s.single_cell = integrate.is_single_cell();
      s.occupancy = context.triangles.occupancy();
    });
    auto const enqueue_one = [&](id number) { enqueue(block, s, number); };
    if constexpr (filters_after_integration<Block>) {
      if (s.single_cell) {
        advance_tiles<unfiltered_at_a_time<Block>>(block, s, no_filter{});
        auto const first = first_of<Block>(0, tile_index(block, 0), tile_count<Block>(context.state.size));
        multiversioned([&] { integrate.template enqueue_occupied<Block::items>(first, s.occupancy, enqueue_one); });
        return;
      }
    }
    advance_tiles<at_a_time<Block>>(block, s,
                                    [&, size = context.state.size](auto const& p, auto const& inactive, auto& near) {
                                      constexpr int n = sizeof(near) / sizeof(near[0]);
                                      integrate.test_occupancy(s.single_cell, s.occupancy, p, near);
                                      for (int k = 0; k < n; ++k) {
                                        near[k] = near[k] && !inactive[k] && p[k].number < size;
                                        if (near[k]) enqueue_one(p[k].number);
                                      }
                                    });
  }

  /// Moves the particles of a block's tiles, a thread `N` at a time.
  template <int N, class Block, class Filter>
  COLLIDE_HD_INLINE void advance_tiles(Block& block, scratch<Block>& s, Filter const& filter) const {
    integration_type const integrate{context};
    std::uint32_t const tiles = tile_count<Block>(context.state.size);
    block.for_each_thread([&](int thread_rank) {
      std::uint32_t k = static_cast<std::uint32_t>(thread_rank) / tile_threads<Block>;
      if constexpr (prefetches<Block>) {
        advance_with_prefetch(block, s, thread_rank, tile_index(block, k), tiles, filter);
      } else if constexpr (has_many_tiles<Block>) {
        COLLIDE_NO_UNROLL
        for (std::uint32_t i; (i = tile_index(block, k)) < tiles; k += tiles_together<Block>) {
          integrate.template advance<N>(block, s.packs, first_of<Block>(thread_rank, i, tiles), filter);
        }
      } else {
        std::uint32_t const first = first_of<Block>(thread_rank, tile_index(block, 0), tiles);
        for (int n = 0; n < Block::items; n += N) {
          integrate.template advance<N>(block, s.packs, first + static_cast<std::uint32_t>(n), filter);
        }
      }
    });
  }

  /// Moves a thread's particles of tiles from the `i`-th on; while it moves some, the next ones are on their way.
  template <class Block, class Filter>
  COLLIDE_HD_INLINE void advance_with_prefetch(Block& block, scratch<Block>& s, int thread_rank, std::uint32_t i,
                                               std::uint32_t tiles, Filter const& filter) const {
    integration_type const integrate{context};
    // in place of a tile that does not exist, the last one is read
    auto const first = [&](std::uint32_t t) { return first_of<Block>(thread_rank, min(t, tiles - 1), tiles); };
    typename integration_type::loaded_pack loaded;
    context.state.begin_load(block, loaded, first(i));
    COLLIDE_NO_UNROLL
    for (std::uint32_t next; i < tiles; i = next) {
      next = i + tiles_together<Block> * static_cast<std::uint32_t>(blocks);
      typename integration_type::integrated p[pack];
      bool const inactive[pack] = {};
      context.state.end_load(block, s.packs, loaded, p, first(i));
      context.state.begin_load(block, loaded, first(next));
      integrate.integrate(block, s.packs, first(i), p, inactive, filter);
    }
  }

  /// Resolves the contacts of the particles that are queued, as many at a time as there is room for.
  template <class Block>
  COLLIDE_HD_INLINE void resolve_queue(Block& block, scratch<Block>& s) const {
    constexpr std::uint32_t capacity = scratch<Block>::capacity;
    std::uint32_t const n = block.broadcast(s.queue_size);
    if (n == 0) return;
    response_type const response(context);
    std::uint32_t const share = (n - 1) / ((n - 1) / capacity + 1) + 1;
    for (std::uint32_t base = 0; base < n; base += share) {
      response.resolve(block, s.contacts, min(n - base, share), [&](std::uint32_t j) {
        std::uint32_t const i = base + j;
        return !has_many_tiles<Block> || i < capacity ? s.queue[i]
                                                      : context.overflow[overflow_slot(block, i - capacity)];
      });
    }
  }
};

}  // namespace collide::detail
