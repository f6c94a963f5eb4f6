/// \file
/// The second kernel of a simulation's step: finds the contacts of the particles that may touch the mesh, and lets the
/// effects respond.
///
/// The candidates of some particles are spread evenly over the lanes of the block. Each candidate that the narrow phase
/// accepts offers itself as the next contact of its particle: the deepest, or of particles that move the earliest,
/// wins, by a minimum over 64-bit keys, which does not depend on the order. One lane then lets the effects respond.
/// This is repeated until no contact counts:
///   - a contact counts only if its foot lies above the tangent planes of those before. In a corner both walls count;
///   on
///     a plane that is divided into triangles one does, and no inner edge is felt;
///   - particles that move spend what is left of the step after each impact, from where they then are.
#pragma once

#include <collide/detail/fly.hpp>
#include <collide/detail/touching_mesh.hpp>

namespace collide::detail {

/// A particle that may touch the mesh in this step, in scratch memory. Plain numbers: scratch memory is not
/// constructed.
template <class S, bool Moves>
struct survivor {
  static constexpr int planes = 3;

  S centre[3], radius, way[Moves ? 3 : 1];
  S normals[planes][3], feet[planes][3];  ///< of the contacts that came before
  S rest;                                 ///< of the step, after the impacts so far
  std::uint64_t best;                     ///< key of the next contact
  std::uint32_t offered;                  ///< how many candidates offered themselves
  int before;                             ///< how many contacts came before
  id number;
  bool is_active;
  candidate_cursor cursor;

  COLLIDE_HD_INLINE auto ball() const {
    if constexpr (Moves) {
      return moving_sphere<S>{{{centre[0], centre[1], centre[2]}, radius}, {way[0], way[1], way[2]}};
    } else {
      return sphere<S>{{centre[0], centre[1], centre[2]}, radius};
    }
  }

  COLLIDE_HD_INLINE void place(vec3<S> const& at, vec3<S> const& along) {
    for (int k = 0; k < 3; ++k) {
      centre[k] = at[k];
      if constexpr (Moves) way[k] = along[k];
    }
  }

  COLLIDE_HD_INLINE void remember(contact<S> const& c) {
    int const slot = before % planes;
    for (int k = 0; k < 3; ++k) {
      normals[slot][k] = c.normal[k];
      feet[slot][k] = c.point[k];
    }
    ++before;
  }

  /// True if a foot is part of the same surface as a contact before: not above its tangent plane.
  COLLIDE_HD_INLINE bool knows(vec3<S> const& foot) const {
    bool known = false;
    for (int i = 0; i < planes; ++i) {
      if (i >= before) break;
      S above = 0;
      for (int k = 0; k < 3; ++k) above += normals[i][k] * (foot[k] - feet[i][k]);
      bool leaves = true;
      if constexpr (Moves) leaves = !approaches({normals[i][0], normals[i][1], normals[i][2]});
      known = known || (leaves && above <= tolerance * radius);
    }
    return known;
  }

  /// True if the way leads towards a surface with this normal, and not only along it.
  COLLIDE_HD_INLINE bool approaches(vec3<S> const& normal) const {
    vec3<S> const d(way[0], way[1], way[2]);
    S const into = -dot(d, normal);
    return into > 0 && into * into > tolerance * tolerance * dot(d, d);
  }

  /// What feet may differ in height, in radii, and normals in slope, due to rounding.
  static constexpr S tolerance = sizeof(S) == sizeof(float) ? S(1e-5) : S(1e-9);
};

/// Keys of contacts: the smaller comes first. Ties go to the lower triangle number.
inline constexpr std::uint64_t no_contact = ~std::uint64_t{0};

template <class S>
COLLIDE_HD_INLINE std::uint64_t contact_key(S time, S depth, id triangle) {
  std::uint32_t const first =
      time > 0 ? (bits(static_cast<float>(time)) | 0x80000000u) : ~ordered(static_cast<float>(depth)) >> 1;
  return (std::uint64_t{first} << 32) | triangle;
}

/// Kernel body: the contacts of all listed particles, in `blocks` blocks that share the list.
template <class S, class NarrowPhase, class Lookup, class Scene>
struct respond_body {
  static constexpr int items = 1;
  template <class Block>
  static constexpr int residency = Block::lanes > 1 ? 4 : 2;  ///< waits for memory, mostly
  static constexpr bool moves = !at_rest<NarrowPhase, S>;
  static constexpr int most_contacts = moves ? 8 : 4;  ///< of a particle in a step
  static constexpr S part_after = S(Scene::integrator::after);

  particle_state<S, typename Scene::all> state;
  Scene scene;
  Lookup lookup;
  listed_particles list;
  S dt;
  std::size_t blocks;

  /// How many particles a block resolves at a time.
  template <class Block>
  static constexpr std::uint32_t together = Block::lanes > 1 ? Block::lanes / 4 : Block::items;

  template <class Block>
  struct scratch {
    static constexpr std::uint32_t size = together<Block>;

    std::uint32_t ranges, active;
    survivor<S, moves> those[size];
    std::uint32_t owner[size], counts[size];
    id const* from[size];
    id first[size];
    typename Block::balance_scratch balance;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    std::uint32_t const n = *list.count;
    Lookup const near = lookup.opened();
    constexpr std::uint32_t size = together<Block>;
    for (std::size_t base = block.index() * size; base < n; base += blocks * size) {
      collide(block, s, near, list.numbers + base, smaller(n - static_cast<std::uint32_t>(base), size));
    }
    // the last block that had something to do empties the list for the next step; those that come later find it so
    std::size_t const busy = smaller(blocks, (n + std::size_t{size} - 1) / size);
    if (block.index() >= busy) return;
    block.each([&](int lane) {
      if (lane != 0 || fetch_add(list.done, 1u) + 1 != busy) return;
      *list.count = 0;
      *list.done = 0;
    });
  }

 private:
  using colliding = particle<S, typename Scene::contact>;

  /// Resolves the contacts of some listed particles.
  template <class Block>
  COLLIDE_HD void collide(Block& block, scratch<Block>& s, Lookup const& near, id const* numbers,
                          std::uint32_t n) const {
    auto const each_of_lane = [&](auto const& f) {
      block.each([&](int lane) {
        for (auto j = static_cast<std::uint32_t>(lane); j < n; j += Block::lanes) f(s.those[j], j);
      });
    };
    each_of_lane([&](survivor<S, moves>& one, std::uint32_t j) {
      one.number = numbers[j];
      colliding p;
      state.load(p, one.number);
      one.radius = p.the_radius;
      one.place(p[position{}], p[velocity{}] * dt);
      one.rest = dt;
      one.before = 0;
      one.is_active = true;
    });
    for (bool more = true; more;) {
      each_of_lane([&](survivor<S, moves>& one, std::uint32_t j) {
        one.best = no_contact;
        one.offered = 0;
        if (one.is_active) one.cursor = near.begin(one.ball());
        if (j == 0) s.active = 0;
      });
      offer_all(block, s, near, each_of_lane);
      each_of_lane([&](survivor<S, moves>& one, std::uint32_t) {
        if (!one.is_active) return;
        respond(one, near);
        if (one.is_active) block.add(s.active, 1);
      });
      more = block.shared(s.active) != 0;
    }
  }

  /// Offers all candidates of the active ones.
  template <class Block, class Each>
  COLLIDE_HD void offer_all(Block& block, scratch<Block>& s, Lookup const& near, Each const& each_of_lane) const {
    constexpr std::uint32_t most = (1u << 31) / together<Block>;
    for (;;) {
      block.each([&](int lane) {
        if (lane == 0) s.ranges = 0;
      });
      each_of_lane([&](survivor<S, moves>& one, std::uint32_t j) {
        candidate_range range;
        if (!one.is_active || !near.next(one.ball(), one.cursor, most, range)) return;
        std::uint32_t const place = block.add(s.ranges, 1);
        s.owner[place] = j;
        s.counts[place] = range.count;
        s.from[place] = range.listed;
        s.first[place] = range.first;
      });
      std::uint32_t const ranges = block.shared(s.ranges);
      if (ranges == 0) return;
      block.template balanced<1>(
          s.balance, s.counts, ranges,
          [&](std::uint32_t i) {
            auto& one = s.those[s.owner[i]];
            auto const ball = one.ball();
            sphere<S> const around = enclosing(until_next<Block>(one, ball));
            return candidates{one, ball, around, {s.from[i], s.first[i], 0}};
          },
          [&](candidates const& c, std::uint32_t k) {
            id const number = c.range.at(k);
            return near.near(c.around, number) ? number : no_id;
          },
          [&](candidates const& c, id number) {
            if (number != no_id) offer<Block>(c, near, number);
          },
          [] {});
    }
  }

  /// A particle and some of its candidates.
  struct candidates {
    survivor<S, moves>& one;
    std::conditional_t<moves, moving_sphere<S>, sphere<S>> ball;
    sphere<S> around;
    candidate_range range;
  };

  /// The part of a way on which something may come before the next contact that is known so far. A lane alone finds
  /// the first contacts first, as it goes along the way, and hardly looks at what comes later.
  template <class Block, class Ball>
  static COLLIDE_HD_INLINE Ball until_next(survivor<S, moves> const& one, Ball ball) {
    if constexpr (moves && Block::lanes == 1) {
      constexpr S late = S(0x1p-21);  // times of impact are early by less, and rounded in keys
      if (one.best != no_contact)
        ball.displacement = scaled(ball.displacement, smaller(S(1), time_of(one.best) + late));
    }
    return ball;
  }

  /// Offers a triangle as the next contact of a particle, if they touch and it counts.
  template <class Block>
  COLLIDE_HD_INLINE void offer(candidates const& c, Lookup const& near, id number) const {
    if constexpr (moves && Block::lanes == 1) {
      if (c.one.best != no_contact && static_cast<id>(c.one.best) == number) return;  // it was in another cell, too
    }
    offer_near<Block>(c.one, c.ball, near.mesh[number], number);
  }

  template <class Block, class Ball>
  COLLIDE_HD_INLINE void offer_near(survivor<S, moves>& one, Ball const& ball, triangle<S> const& t, id number) const {
    if (!NarrowPhase::intersects(t, ball)) return;
    S const time = time_of(t, ball);
    contact<S> const c = contact_here(t, place_at(ball, time));
    if (one.knows(c.point)) return;
    if constexpr (moves) {
      if (!one.approaches(c.normal)) return;
    }
    std::uint64_t const key = contact_key(time, c.depth, number);
    if constexpr (Block::lanes > 1) {
      fetch_add(&one.offered, 1u);
      fetch_min(&one.best, key);
    } else {
      ++one.offered;
      one.best = smaller(one.best, key);
    }
  }

  static COLLIDE_HD_INLINE S time_of(std::uint64_t key) {
    auto const first = static_cast<std::uint32_t>(key >> 32);
    return (first & 0x80000000u) != 0 ? S(from_bits<float>(first & 0x7fffffffu)) : S(0);
  }
  static COLLIDE_HD_INLINE S time_of(triangle<S> const& t, moving_sphere<S> const& ball) {
    return NarrowPhase::time_of_impact(t, ball);
  }
  static COLLIDE_HD_INLINE S time_of(triangle<S> const&, sphere<S> const&) { return 0; }
  static COLLIDE_HD_INLINE sphere<S> place_at(moving_sphere<S> const& ball, S time) { return ball_at(ball, time); }
  static COLLIDE_HD_INLINE sphere<S> const& place_at(sphere<S> const& ball, S) { return ball; }

  /// Lets the effects respond to the contact that was found, and says whether to look for another. If there was none,
  /// the particle's step ends.
  COLLIDE_HD void respond(survivor<S, moves>& one, Lookup const& near) const {
    colliding p;
    state.load(p, one.number);
    if (one.best == no_contact) {
      if constexpr (moves) p[position{}] += p[velocity{}] * one.rest;
      one.is_active = false;
    } else {
      auto const number = static_cast<id>(one.best);
      auto const ball = one.ball();
      triangle<S> const t = near.mesh[number];
      S const time = time_of(t, ball);
      sphere<S> const here = place_at(ball, time);
      touching<S> c{contact_here(t, here), vec3<S>(S(0), S(0), S(0)), moves ? S(0) : dt, S(0), false};
      c.sphere = one.number;
      c.triangle = number;
      if constexpr (moves) {
        p[position{}] = here.centre;
        one.rest -= one.rest * time;
      } else {
        c.depth -= dot(c.normal, vec3<S>(p[position{}] - here.centre));  // earlier contacts have moved it
      }
      one.remember(c);
      colliding next = p;
      scene.accelerate(next, dt);
      c.gain = next[velocity{}] - p[velocity{}];
      scene.touch(p, c, dt);
      one.is_active = one.before < most_contacts;
      if constexpr (moves) {
        one.place(p[position{}], p[velocity{}] * one.rest);
        if (one.approaches(c.normal)) {  // nothing repels: it goes through
          p[position{}] += p[velocity{}] * one.rest;
          one.is_active = false;
        }
      } else {
        one.is_active = one.is_active && one.offered > 1;
      }
      if (is_skipped(p)) one.is_active = false;
    }
    if (!one.is_active) {
      if constexpr (part_after != 0) scene.accelerate(p, part_after * dt);
      scene.finish(p, dt);
    }
    state.store(p, one.number, typename Scene::contact_writes{});
  }

  /// True if an effect has taken the particle out of the scene.
  COLLIDE_HD_INLINE bool is_skipped(colliding& p) const {
    if constexpr (Scene::skips) {
      return scene.is_skipped(p);
    } else {
      return false;
    }
  }
};

}  // namespace collide::detail
