/// \file
/// Finds for each active particle the next contact with the mesh.
///
/// The candidates of a batch of particles are spread evenly over the lanes of the block. Those that the quick test of
/// their cell lets through are queued, and go through the narrow phase's filter as many at a time as there are lanes;
/// what passes is queued again, and its contact computed as many at a time. Each queue is drained when it is full. A
/// lane alone does all of this at once with each candidate. The deepest contact, or of particles that move the
/// earliest, wins by a minimum over 64-bit keys, which does not depend on the order.
#pragma once

#include <cstdint>
#include <type_traits>

#include <collide/detail/execution/atomic.hpp>
#include <collide/detail/narrow_phase/two_stages.hpp>
#include <collide/detail/simulation/active_particle.hpp>
#include <collide/detail/simulation/mesh_contact.hpp>

namespace collide::detail {

/// Candidates and contacts of a batch that wait for the lanes of their block.
template <class Block>
struct contact_queues {
  static constexpr bool used = Block::lanes > 1;
  static constexpr std::uint32_t ahead = 3;  ///< cell items that a lane looks at together
  static constexpr std::uint32_t candidate_capacity = used ? (ahead + 1) * Block::lanes : 1;
  static constexpr std::uint32_t record_capacity = used ? Block::lanes * 2 : 1;

  /// A particle of the batch, and a triangle.
  struct candidate {
    id triangle;
    std::uint16_t particle;
    std::int8_t touches;  ///< its verdict, once it has been filtered; `miss` once its contact is known
    COLLIDE_HD_INLINE bool has(verdict v) const { return touches == static_cast<std::int8_t>(v); }
  };

  candidate candidates[candidate_capacity];
  candidate records[record_capacity];  ///< those that touch, or may do so
  std::uint32_t candidate_count, record_count, unsure_count;
};

/// How many spans of candidates have been listed, and how often a particle may have had more. They only rise, so that
/// nothing waits until they are 0 again.
struct span_counts {
  std::uint32_t spans, unfinished;
};

/// Scratch memory of a block for a batch of particles.
template <class S, bool IsSwept, class Block>
struct contact_scratch {
  using particle_type = active_particle<S, IsSwept>;
  static constexpr std::size_t bytes_per_particle = sizeof(particle_type) + sizeof(cell_entry const*) +
                                                    3 * sizeof(std::uint32_t) + sizeof(std::uint16_t) + sizeof(id);

  /// How many particles a batch has: as many as fit in the 48 KB that CUDA has for a block. The rest is for what else
  /// a step keeps there.
  static constexpr std::uint32_t batch_size =
      Block::lanes > 1 ? static_cast<std::uint32_t>((47 * 1024 - sizeof(contact_queues<Block>)) / bytes_per_particle)
                       : Block::items;

  particle_type particles[batch_size];
  std::uint16_t particle_of_span[batch_size];
  std::uint32_t span_sizes[batch_size], span_coverage[batch_size];
  cell_entry const* span_items[batch_size];
  id span_first[batch_size];
  contact_queues<Block> queues;
  span_counts spans;
  std::uint32_t active_count;  ///< how often a particle was to be looked at again; only rises
  typename Block::balance_scratch balance;
};

/// The search, which knows neither effects nor the integrator. `Triangles` is a lookup that is opened.
template <class S, class NarrowPhase, class Triangles>
struct contact_search {
  static constexpr bool is_swept = !at_rest<NarrowPhase, S>;
  using active = active_particle<S, is_swept>;
  using shape = std::conditional_t<is_swept, moving_sphere<S>, sphere<S>>;
  template <class Block>
  using scratch = contact_scratch<S, is_swept, Block>;
  template <class Block>
  using record_of = typename contact_queues<Block>::candidate;

  Triangles triangles;

  /// Called by one lane when the block begins with a batch.
  template <class Block>
  COLLIDE_HD_INLINE void reset(scratch<Block>& s) const {
    s.queues.candidate_count = s.queues.record_count = s.queues.unsure_count = 0;
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
  COLLIDE_HD void find(Block& block, scratch<Block>& s, std::uint32_t n, span_counts& seen) const {
    using queues = contact_queues<Block>;
    for (bool more = true; more;) {
      span_counts const before = seen;
      list_spans(block, s, n, before);
      seen = block.shared(s.spans);
      more = seen.unfinished != before.unfinished;
      std::uint32_t const spans = seen.spans - before.spans;
      if (spans == 0) break;
      block.template balanced<queues::ahead>(
          s.balance, s.span_sizes, spans, [&](std::uint32_t i) { return span_of<Block>(s, i); },
          [](span const& c, std::uint32_t k) { return c.range.at(k); },
          [](span const& c, cell_entry const& e) { return c.range.may_touch(e); },
          [&](span const& c, cell_entry const& e) {
            if constexpr (queues::used) {
              s.queues.candidates[block.add(s.queues.candidate_count, 1)] = {e.triangle, c.particle, 0};
            } else {
              consider_at_once(c, e.triangle);
            }
          },
          [&](bool is_last) {
            if constexpr (queues::used) {
              std::uint32_t const candidates = block.shared(s.queues.candidate_count);
              bool const is_full = candidates + queues::ahead * Block::lanes > queues::candidate_capacity;
              if (is_full || (is_last && !is_swept)) drain(block, s, candidates);
            }
          });
    }
    // candidates of a swept particle come a cell at a time
    if constexpr (queues::used && is_swept) drain(block, s, block.shared(s.queues.candidate_count));
  }

 private:
  /// A particle and candidates that follow each other.
  struct span {
    std::uint16_t particle;
    active& one;
    shape whole;
    sphere<S> around;  ///< the part of its motion on which something may come before the best contact so far
    candidate_range range;
  };

  /// Lists the next span of candidates of each active particle. `before` is what `s.spans` was before.
  template <class Block>
  COLLIDE_HD_INLINE void list_spans(Block& block, scratch<Block>& s, std::uint32_t n, span_counts const& before) const {
    constexpr std::uint32_t most = (1u << 31) / scratch<Block>::batch_size;
    block.each([&](int lane) {
      for (auto j = static_cast<std::uint32_t>(lane); j < n; j += Block::lanes) {
        active& a = s.particles[j];
        candidate_range range{};
        if (!a.is_active || !triangles.next(a.shape(), a.cursor, most, range)) continue;
        if (!a.cursor.at_end()) block.add(s.spans.unfinished, 1);
        std::uint32_t const i = block.add(s.spans.spans, 1) - before.spans;
        s.particle_of_span[i] = static_cast<std::uint16_t>(j);
        s.span_sizes[i] = range.count;
        s.span_items[i] = range.listed;
        s.span_first[i] = range.first;
        s.span_coverage[i] = range.place;
      }
    });
  }

  template <class Block>
  static COLLIDE_HD_INLINE span span_of(scratch<Block>& s, std::uint32_t i) {
    active& a = s.particles[s.particle_of_span[i]];
    shape const whole = a.shape();
    shape part = whole;
    if constexpr (is_swept && Block::lanes == 1) clip_to_best(a, part);
    return {
        s.particle_of_span[i], a, whole, enclosing(part), {s.span_items[i], s.span_first[i], 0, s.span_coverage[i]}};
  }

  /// A lane alone finds the first contacts first, as it goes along the motion, and hardly looks at what comes later.
  static COLLIDE_HD_INLINE void clip_to_best(active const& a, shape& part) {
    // times are early by less, or by what the slack of bounding spheres covers; in keys they are rounded
    constexpr S late = S(0x1p-21);
    if (a.best_key == no_contact) return;
    part.displacement = scaled(part.displacement, smaller(S(1), time_of_key<S>(a.best_key) + late));
  }

  /// Filters the `n` candidates that are queued, and computes the contacts of those that may touch.
  template <class Block>
  COLLIDE_HD_INLINE void drain(Block& block, scratch<Block>& s, std::uint32_t n) const {
    using queues = contact_queues<Block>;
    std::uint32_t records = 0;
    for (std::uint32_t base = 0; base < n; base += Block::lanes) {
      block.each([&](int lane) {
        std::uint32_t const i = base + static_cast<std::uint32_t>(lane);
        if (lane == 0) s.queues.candidate_count = s.queues.unsure_count = 0;
        if (i >= n) return;
        auto const c = s.queues.candidates[i];
        active const& a = s.particles[c.particle];
        shape const whole = a.shape();
        if (!triangles.template may_touch<NarrowPhase>(whole, c.triangle) || a.is_leaving(c.triangle)) return;
        verdict const quick = filter<NarrowPhase>(triangles.mesh[c.triangle], whole);
        if (quick == verdict::miss) return;
        s.queues.records[block.add(s.queues.record_count, 1)] = {c.triangle, c.particle,
                                                                 static_cast<std::int8_t>(quick)};
      });
      records = block.shared(s.queues.record_count);
      if (records + Block::lanes > queues::record_capacity || base + Block::lanes >= n) {
        compute_contacts(block, s, records);
      }
    }
  }

  /// Computes the contacts of the `n` pairs that are queued: first those that take no call. What a thread has at hand
  /// when it calls something it keeps in memory, and begins to do so long before.
  template <class Block>
  COLLIDE_HD_INLINE void compute_contacts(Block& block, scratch<Block>& s, std::uint32_t n) const {
    using record = record_of<Block>;
    if (n == 0) return;
    if constexpr (!is_swept) {
      consider_all(block, s, n, [&](active& a, record& r, contact<S>& found) {
        verdict const quick = quick_contact_here(triangles.mesh[r.triangle], a.shape(), r.has(verdict::hit), found);
        if (quick == verdict::unsure) {
          block.add(s.queues.unsure_count, 1);
          return no_contact;
        }
        r.touches = static_cast<std::int8_t>(verdict::miss);
        if (quick == verdict::miss) return no_contact;
        found.triangle = r.triangle;
        return consider<Block>(a, S(0), found);
      });
      if (block.shared(s.queues.unsure_count) == 0) return;
    }
    consider_all(block, s, n, [&](active& a, record& r, contact<S>& found) {
      if (r.has(verdict::miss)) return no_contact;
      return compute_contact<Block>(a, triangles.mesh, r.triangle, r.has(verdict::hit), found);
    });
  }

  /// Calls key = compute(particle, record, contact) for `n` records, and keeps the contacts that are the best ones.
  template <class Block, class Compute>
  COLLIDE_HD_INLINE void consider_all(Block& block, scratch<Block>& s, std::uint32_t n, Compute const& compute) const {
    for (std::uint32_t base = 0; base < n; base += Block::lanes) {
      typename Block::template per_lane<contact<S>> found;
      typename Block::template per_lane<std::uint64_t> key;
      block.each([&](int lane) {
        std::uint32_t const i = base + static_cast<std::uint32_t>(lane);
        auto& r = s.queues.records[i < n ? i : base];
        if (lane == 0) s.queues.record_count = 0;
        key[lane] = i < n ? compute(s.particles[r.particle], r, found[lane]) : no_contact;
      });
      block.each([&](int lane) {
        if (key[lane] == no_contact) return;
        active& a = s.particles[s.queues.records[base + static_cast<std::uint32_t>(lane)].particle];
        if (key[lane] == a.best_key) a.set_best(found[lane]);
      });
    }
  }

  /// A lane alone: a candidate's whole way to the best contact.
  COLLIDE_HD_INLINE void consider_at_once(span const& c, id number) const {
    using block = serial_block<1, 0>;
    if (!triangles.near(c.around, number) || c.one.is_leaving(number)) return;
    if constexpr (is_swept) {
      if (c.one.best_key != no_contact && static_cast<id>(c.one.best_key) == number) return;  // it was in another cell
    }
    verdict const quick = filter<NarrowPhase>(triangles.mesh[number], c.whole);
    if (quick == verdict::miss) return;
    contact<S> found;
    std::uint64_t const key =
        contact_key_of<block>(c.one, triangles.mesh[number], c.whole, quick == verdict::hit, number, found);
    if (key != no_contact && key == c.one.best_key) c.one.set_best(found);
  }

  /// Computes the contact of a particle and a triangle, and considers it as the next one. `is_sure` says that the two
  /// touch; else that is found out, too. Returns its key, or `no_contact`. Out of line, and without a reference to what
  /// is in registers or parameters, which each thread would then have to keep in memory.
  template <class Block>
  static COLLIDE_HD_NOINLINE std::uint64_t compute_contact(active& a, mesh_view<S> mesh, id number, bool is_sure,
                                                           contact<S>& found) {
    return contact_key_of<Block>(a, mesh[number], a.shape(), is_sure, number, found);
  }
  template <class Block>
  static COLLIDE_HD_INLINE std::uint64_t contact_key_of(active& a, triangle<S> const& t, shape const& s, bool is_sure,
                                                        id number, contact<S>& found) {
    if (!is_sure && !resolve<NarrowPhase>(t, s)) return no_contact;
    S time = 0;
    if constexpr (is_swept) time = key_time(stopping_time<NarrowPhase>::of(t, s));
    found = contact_here(t, sphere_at(s, time));
    found.triangle = number;
    if constexpr (is_swept) face_against(found, s.displacement);
    return consider<Block>(a, time, found);
  }

  /// Considers a contact as the next one of a particle. Returns its key, or `no_contact` if it does not count: it is
  /// part of a surface that the particle has touched, or the particle does not move towards it.
  template <class Block>
  static COLLIDE_HD_INLINE std::uint64_t consider(active& a, S time, contact<S> const& c) {
    if (a.is_internal_contact(c.point)) return no_contact;
    if constexpr (is_swept) {
      if (!a.is_approaching(c.normal) && !(time == 0 && a.overlaps(c.depth))) return no_contact;
    }
    std::uint64_t const key = contact_key(time, c);
    if constexpr (Block::lanes > 1) {
      fetch_add(&a.candidate_count, 1u);
      fetch_min(&a.best_key, key);
    } else {
      ++a.candidate_count;
      a.best_key = smaller(a.best_key, key);
    }
    return key;
  }
};

}  // namespace collide::detail
