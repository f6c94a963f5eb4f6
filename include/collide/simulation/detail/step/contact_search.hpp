/// \file
/// Finds for each active particle the next contact with the mesh.
///
/// The candidates of a batch of particles are spread evenly over the threads of the block. Those that the quick test of
/// their cell lets through are queued, and go through the narrow phase's filter as many at a time as there are threads;
/// what passes is queued again, and its contact computed as many at a time. Queues are drained when they are full, and
/// at the end. A thread alone does all of this at once with each candidate. The deepest contact, or of particles that
/// move the earliest, wins by a minimum over 64-bit keys, which does not depend on the order.
#pragma once

#include <cstdint>
#include <type_traits>

#include <collide/narrow/detail/intersects.hpp>
#include <collide/narrow/detail/traits.hpp>
#include <collide/simulation/detail/step/contact_scratch.hpp>
#include <collide/simulation/detail/step/mesh_contact.hpp>
#include <collide/simulation/detail/step/moving_surface.hpp>

namespace collide::detail {

/// The search, which knows neither effects nor the integrator. `Triangles` is a lookup that is opened.
template <class S, class NarrowPhase, class Triangles>
struct contact_search {
  static constexpr bool is_swept = !is_discrete<NarrowPhase, S>;
  using mesh_type = decltype(Triangles::mesh);
  static constexpr bool has_bodies = is_moving_mesh<mesh_type>;
  using active = active_particle<S, is_swept, has_bodies>;
  using shape = std::conditional_t<is_swept, moving_sphere<S>, sphere<S>>;
  template <class Block>
  using scratch = contact_scratch<S, is_swept, has_bodies, Block>;

  Triangles triangles;

  /// Called by one thread when the block begins with a batch.
  template <class Block>
  COLLIDE_HD_INLINE void reset(scratch<Block>& s) const {
    s.queues.candidates.size = s.queues.contacts.size = s.queues.unsure_count = 0;
    s.spans = {0, 0};
  }

  /// To be called for a particle before its next contact is searched for.
  COLLIDE_HD_INLINE void start(active& a) const {
    a.best_key = no_contact;
    a.candidate_count = 0;
    a.cursor = triangles.begin(a.shape());
  }

  /// Finds the next contact of each active particle of the first `n`. `seen` is what `s.spans` was before, and is then.
  template <class Block>
  COLLIDE_HD_INLINE void find(Block& block, scratch<Block>& s, std::uint32_t n, span_counts& seen) const {
    using queues = contact_queues<Block>;
    for (bool more = true; more;) {
      span_counts const before = seen;
      list_spans(block, s, n, before);
      seen = block.broadcast(s.spans);
      more = seen.unfinished != before.unfinished;
      std::uint32_t const spans = seen.spans - before.spans;
      if (spans == 0) break;
      block.template for_each_balanced<queues::items_per_thread>(
          s.balance, s.span_sizes, spans, [&](std::uint32_t i) { return span_of<Block>(s, i); },
          [](span const& c, std::uint32_t k) { return c.range.at(k); },
          [](span const& c, cell_item const& e) { return c.range.passes_coverage(e); },
          [&](span const& c, cell_item const& e) {
            if constexpr (has_bodies) {
              if (triangles.mesh.frame_of(e.triangle) != c.frame) return;  // of another body
            }
            if constexpr (queues::used) {
              s.queues.candidates.push(block, c.particle, e.triangle);
            } else {
              consider_at_once(c, e.triangle);
            }
          },
          [&](bool is_last) {
            if constexpr (queues::used) {
              std::uint32_t const candidates = block.broadcast(s.queues.candidates.size);
              bool const is_full =
                  candidates + queues::items_per_thread * Block::num_threads > s.queues.candidates.capacity;
              if (is_full || (is_last && !is_swept)) drain(block, s, candidates);
            }
          });
    }
    // candidates of a swept particle come a cell at a time
    if constexpr (queues::used && is_swept) drain(block, s, block.broadcast(s.queues.candidates.size));
  }

 private:
  /// A particle and candidates that follow each other.
  struct span {
    std::uint8_t particle;
    active& one;
    shape whole;
    sphere<S> around;  ///< the part of its motion on which something may come before the best contact so far
    candidate_range range;
    std::conditional_t<has_bodies, int, only_frame> frame;
  };

  /// Lists the next span of candidates of each active particle. `before` is what `s.spans` was before.
  template <class Block>
  COLLIDE_HD_INLINE void list_spans(Block& block, scratch<Block>& s, std::uint32_t n, span_counts const& before) const {
    constexpr std::uint32_t max_count = (1u << 31) / scratch<Block>::batch_size;
    block.for_each_thread([&](int thread_rank) {
      for (auto j = static_cast<std::uint32_t>(thread_rank); j < n; j += Block::num_threads) {
        active& a = s.particles[j];
        candidate_range range{};
        if (!a.is_active || !next(a, max_count, range)) continue;
        if (!a.cursor.at_end()) block.add(s.spans.unfinished, 1);
        std::uint32_t const i = block.add(s.spans.spans, 1) - before.spans;
        s.particle_of_span[i] = static_cast<std::uint8_t>(j);
        s.span_sizes[i] = range.count;
        s.span_items[i] = range.listed;
        s.span_first[i] = range.first;
        s.span_coverage[i] = range.coverage;
        s.set_frame(i, a.cursor);
      }
    });
  }

  COLLIDE_HD_INLINE bool next(active& a, std::uint32_t max_count, candidate_range& range) const {
    if constexpr (has_bodies) {
      return triangles.next(a.shape(), fraction_done(triangles.mesh, a), a.cursor, max_count, range);
    } else {
      return triangles.next(a.shape(), a.cursor, max_count, range);
    }
  }

  /// The sphere of a particle in the frame of a triangle's body.
  static COLLIDE_HD_INLINE shape shape_at(mesh_type const& mesh, active const& a, id number) {
    return shape_seen(mesh, a, frame_of(mesh, number));
  }

  template <class Block>
  COLLIDE_HD_INLINE span span_of(scratch<Block>& s, std::uint32_t i) const {
    active& a = s.particles[s.particle_of_span[i]];
    shape const whole = shape_seen(triangles.mesh, a, s.frame(i));
    shape clipped = whole;
    if constexpr (is_swept && Block::num_threads == 1) clip_to_best(a, clipped);
    return {s.particle_of_span[i],
            a,
            whole,
            swept_bounding_sphere(clipped),
            {s.span_items[i], s.span_first[i], 0, s.span_coverage[i]},
            s.frame(i)};
  }

  /// A thread alone finds the first contacts first, as it goes along the motion, and hardly looks at what comes later.
  static COLLIDE_HD_INLINE void clip_to_best(active const& a, shape& clipped) {
    // times are early by less, or by what the slack of bounding spheres covers; in keys they are rounded
    constexpr S late = S(0x1p-21);
    if (a.best_key == no_contact) return;
    clipped.displacement = scaled(clipped.displacement, min(S(1), time_of_key<S>(a.best_key) + late));
  }

  /// False if the triangle's box is out of reach. A filtered predicate begins with a test of boxes itself.
  COLLIDE_HD_INLINE bool may_touch([[maybe_unused]] shape const& s, [[maybe_unused]] id triangle) const {
    if constexpr (filtered_predicate<NarrowPhase>::value) {
      return true;
    } else {
      return triangles.near(swept_bounding_sphere(s), triangle);
    }
  }

  /// Filters the `n` candidates that are queued, and computes the contacts of those that may touch.
  template <class Block>
  COLLIDE_HD_INLINE void drain(Block& block, scratch<Block>& s, std::uint32_t n) const {
    auto& q = s.queues;
    for (std::uint32_t base = 0; base < n; base += Block::num_threads) {
      block.for_each_thread([&](int thread_rank) {
        std::uint32_t const i = base + static_cast<std::uint32_t>(thread_rank);
        if (thread_rank == 0) q.candidates.size = q.unsure_count = 0;
        if (i >= n) return;
        id const number = q.candidates.triangles[i];
        active const& a = s.particles[q.candidates.particles[i]];
        shape const whole = shape_at(triangles.mesh, a, number);
        if (!may_touch(whole, number) || is_leaving(a, number, whole)) return;
        verdict const quick = filter<NarrowPhase>(triangles.mesh[number], whole);
        if (quick == verdict::miss) return;
        q.verdicts[q.contacts.push(block, q.candidates.particles[i], number)] = packed(quick);
      });
      std::uint32_t const found = block.broadcast(q.contacts.size);
      if (found + Block::num_threads > q.contacts.capacity || base + Block::num_threads >= n)
        compute_contacts(block, s, found);
    }
  }

  /// Computes the contacts of the `n` pairs that are queued: first those that take no call. What a thread has at hand
  /// when it calls something it keeps in memory, and begins to do so long before.
  template <class Block>
  COLLIDE_HD_INLINE void compute_contacts(Block& block, scratch<Block>& s, std::uint32_t n) const {
    auto& q = s.queues;
    if (n == 0) return;
    if constexpr (!is_swept) {
      consider_all(block, s, n, [&](active& a, id number, std::uint32_t i, contact<S>& found) {
        bool const is_sure = q.verdicts[i] == packed(verdict::hit);
        verdict const quick =
            try_contact_double(triangles.mesh[number], shape_at(triangles.mesh, a, number), is_sure, found);
        if (quick == verdict::uncertain) {
          block.add(q.unsure_count, 1);
          return no_contact;
        }
        q.verdicts[i] = packed(verdict::miss);
        if (quick == verdict::miss) return no_contact;
        found.triangle = number;
        return consider<Block>(a, triangles.mesh, a.shape(), S(0), found);
      });
      if (block.broadcast(q.unsure_count) == 0) return;
    }
    consider_all(block, s, n, [&](active& a, id number, std::uint32_t i, contact<S>& found) {
      if (q.verdicts[i] == packed(verdict::miss)) return no_contact;
      return compute_contact<Block>(a, triangles.mesh, number, q.verdicts[i] == packed(verdict::hit), found);
    });
  }

  /// Calls key = compute(particle, triangle, i, contact) for all pairs i < n that are queued, and keeps the contacts
  /// that are the best ones.
  template <class Block, class Compute>
  COLLIDE_HD_INLINE void consider_all(Block& block, scratch<Block>& s, std::uint32_t n, Compute const& compute) const {
    auto& queue = s.queues.contacts;
    for (std::uint32_t base = 0; base < n; base += Block::num_threads) {
      typename Block::template thread_private<contact<S>> found;
      typename Block::template thread_private<std::uint64_t> key;
      block.for_each_thread([&](int thread_rank) {
        std::uint32_t const i = base + static_cast<std::uint32_t>(thread_rank);
        if (thread_rank == 0) queue.size = 0;
        key[thread_rank] = no_contact;
        if (i < n)
          key[thread_rank] = compute(s.particles[queue.particles[i]], queue.triangles[i], i, found[thread_rank]);
      });
      block.for_each_thread([&](int thread_rank) {
        if (key[thread_rank] == no_contact) return;
        active& a = s.particles[queue.particles[base + static_cast<std::uint32_t>(thread_rank)]];
        if (key[thread_rank] == a.best_key) a.set_best(found[thread_rank]);
      });
    }
  }

  /// A thread alone: a candidate's whole way to the best contact.
  COLLIDE_HD_INLINE void consider_at_once(span const& c, id number) const {
    using block = serial_block<1, 0>;
    if (!triangles.near(c.around, number) || is_leaving(c.one, number, c.whole)) return;
    if constexpr (is_swept) {
      if (c.one.best_key != no_contact && static_cast<id>(c.one.best_key) == number) return;  // it was in another cell
    }
    verdict const quick = filter<NarrowPhase>(triangles.mesh[number], c.whole);
    if (quick == verdict::miss) return;
    contact<S> found;
    std::uint64_t const key = contact_key_of<block>(c.one, triangles.mesh, triangles.mesh[number], c.whole,
                                                    quick == verdict::hit, number, found);
    if (key != no_contact && key == c.one.best_key) c.one.set_best(found);
  }

  /// Computes the contact of a particle and a triangle, and considers it as the next one. `is_sure` says that the two
  /// touch; else that is found out, too. Returns its key, or `no_contact`. Out of line, and without a reference to what
  /// is in registers or parameters, which each thread would then have to keep in memory.
  template <class Block>
  static COLLIDE_HD_NOINLINE std::uint64_t compute_contact(active& a, mesh_type mesh, id number, bool is_sure,
                                                           contact<S>& found) {
    return contact_key_of<Block>(a, mesh, mesh[number], shape_at(mesh, a, number), is_sure, number, found);
  }
  template <class Block>
  static COLLIDE_HD_INLINE std::uint64_t contact_key_of(active& a, mesh_type const& mesh, triangle<S> const& t,
                                                        shape const& s, bool is_sure, id number, contact<S>& found) {
    if (!is_sure && !resolve<NarrowPhase>(t, s)) return no_contact;
    S time = 0;
    if constexpr (is_swept) time = key_time(stopping_time<NarrowPhase>::of(t, s));
    found = contact_double(t, sphere_at(s, time));
    found.triangle = number;
    if constexpr (is_swept) face_against(found, s.displacement);
    return consider<Block>(a, mesh, s, time, found);
  }

  /// True if a particle, which is `whole` in the frame of a triangle, leaves that after it has touched it.
  COLLIDE_HD_INLINE bool is_leaving(active const& a, id number, shape const& whole) const {
    auto const& mesh = triangles.mesh;
    return is_swept && a.is_leaving(number, motion_seen(mesh, a, frame_of(mesh, number), whole));
  }

  /// Considers a contact, in the frame of its triangle, as the next one of a particle. Returns its key, or `no_contact`
  /// if it does not count: it is part of a surface that the particle has touched, or the particle does not move towards
  /// it. Then the contact is in the world.
  template <class Block>
  static COLLIDE_HD_INLINE std::uint64_t consider(active& a, mesh_type const& mesh, shape const& whole, S time,
                                                  contact<S>& c) {
    auto const seen = contact_in_world(mesh, a, whole, time, c);
    if (a.is_internal_contact(c.point, seen)) return no_contact;
    if constexpr (is_swept) {
      if (!a.is_approaching(c.normal, seen) && !(time == 0 && a.overlaps(c.depth))) return no_contact;
    }
    std::uint64_t const key = contact_key(time, c);
    if constexpr (Block::num_threads > 1) {
      fetch_add(&a.candidate_count, 1u);
      fetch_min(&a.best_key, key);
    } else {
      ++a.candidate_count;
      a.best_key = min(a.best_key, key);
    }
    return key;
  }
};

/// Finds the next contact of each active particle; see `contact_search::find`. Not inline: what does not depend on the
/// effects of a scene is in collide::compiled; see compiled.hpp.
template <class Search, class Block, class Scratch>
COLLIDE_AS_O3 COLLIDE_HD_LINKED void find_contacts(Search const& search, Block& block, Scratch& s, std::uint32_t n,
                                                   span_counts& seen) {
  search.find(block, s, n, seen);
}

}  // namespace collide::detail
