/// \file
/// Scratch memory of the search for contacts: particles, spans of candidates, and pairs that wait for threads.
#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>

#include <collide/narrow/detail/intersects.hpp>
#include <collide/simulation/detail/bodies/bodies_ref.hpp>
#include <collide/simulation/detail/step/contact_history.hpp>
#include <collide/simulation/detail/step/surface_at_rest.hpp>
#include <collide/spaces/detail/block.hpp>

namespace collide::detail {

/// A particle that may touch the mesh in this step, in scratch memory.
template <class S, bool IsSwept, bool HasBodies = false>
struct active_particle : contact_history<S, IsSwept, HasBodies> {
  bool is_active;
  id number;
  std::uint32_t candidate_count;  ///< how many contacts have been considered as the next one
  std::uint64_t best_key;         ///< of the next contact
  std::conditional_t<HasBodies, body_cursor, candidate_cursor> cursor;  ///< which triangles have been looked at
  alignas(S) unsigned char best[sizeof(contact<S>)];                    ///< the next contact

  COLLIDE_HD_INLINE void set_best(contact<S> const& c) { std::memcpy(best, static_cast<void const*>(&c), sizeof c); }
  COLLIDE_HD_INLINE contact<S> best_contact() const {
    contact<S> c;
    std::memcpy(static_cast<void*>(&c), best, sizeof c);
    return c;
  }
};

/// Pairs of a particle of the batch and a triangle, that wait for the threads of their block.
template <std::uint32_t Capacity>
struct pair_queue {
  static constexpr std::uint32_t capacity = Capacity;

  id triangles[Capacity];
  std::uint8_t particles[Capacity];
  std::uint32_t size;

  /// To be called by any thread, where there is room.
  template <class Block>
  COLLIDE_HD_INLINE std::uint32_t push(Block& block, std::uint8_t particle, id triangle) {
    std::uint32_t const i = block.add(size, 1);
    particles[i] = particle;
    triangles[i] = triangle;
    return i;
  }
};

/// A verdict in scratch memory.
enum class verdict_byte : std::uint8_t {};
COLLIDE_HD_INLINE verdict_byte packed(verdict v) { return static_cast<verdict_byte>(v); }

/// The queues of a block; a thread alone has none.
template <class Block>
struct contact_queues {
  static constexpr bool used = Block::num_threads > 1;
  static_assert(Block::num_threads <= 256, "a byte counts the particles of a batch");
  static constexpr std::uint32_t items_per_thread = 5;  ///< cell items that a thread looks at together

  pair_queue<used ? (items_per_thread + 1) * Block::num_threads : 1> candidates;
  pair_queue<used ? 2 * Block::num_threads : 1> contacts;    ///< pairs that touch, or may do so
  verdict_byte verdicts[used ? 2 * Block::num_threads : 1];  ///< on the latter; `miss` once the contact is known
  std::uint32_t unsure_count;
};

/// How many spans of candidates have been listed, and how often a particle may have had more. They only rise, so that
/// nothing waits until they are 0 again.
struct span_counts {
  std::uint32_t spans, unfinished;
};

/// In which frames the candidates of spans are.
template <bool HasBodies>
struct span_frames {
  COLLIDE_HD_INLINE void set_frame(std::uint32_t, candidate_cursor const&) {}
  COLLIDE_HD_INLINE only_frame frame(std::uint32_t) const { return {}; }
};
template <>
struct span_frames<true> {
  std::uint8_t of[256];  // as many as bytes can count
  COLLIDE_HD_INLINE void set_frame(std::uint32_t i, body_cursor const& c) {
    of[i] = static_cast<std::uint8_t>(c.frame_of_last);
  }
  COLLIDE_HD_INLINE int frame(std::uint32_t i) const { return of[i]; }
};

template <class S, bool IsSwept, bool HasBodies, class Block>
struct contact_scratch : span_frames<HasBodies> {
  using particle_type = active_particle<S, IsSwept, HasBodies>;
  static constexpr std::size_t bytes_per_particle = sizeof(particle_type) + sizeof(cell_item const*) +
                                                    2 * sizeof(std::uint32_t) + sizeof(std::uint8_t) + 2 * sizeof(id);
  static constexpr std::size_t bytes_of_frames = HasBodies ? sizeof(span_frames<HasBodies>) : 0;

  /// How many particles a batch has: as many as fit in the 48 KB that CUDA has for a block, but fewer than threads, and
  /// than bytes can count. The rest is for what else a step keeps there.
  static constexpr std::uint32_t capacity =
      static_cast<std::uint32_t>((47 * 1024 - sizeof(contact_queues<Block>) - bytes_of_frames) / bytes_per_particle);
  static constexpr std::uint32_t batch_size = Block::num_threads == 1         ? Block::items
                                              : capacity < Block::num_threads ? capacity
                                                                              : Block::num_threads - 1;

  particle_type particles[batch_size];
  std::uint8_t particle_of_span[batch_size];
  std::uint32_t span_sizes[batch_size], span_coverage[batch_size];
  cell_item const* span_items[batch_size];
  id span_first[batch_size];
  contact_queues<Block> queues;
  span_counts spans;
  std::uint32_t active_count;  ///< how often a particle was to be looked at again; only rises
  typename Block::balance_storage balance;
};

}  // namespace collide::detail
