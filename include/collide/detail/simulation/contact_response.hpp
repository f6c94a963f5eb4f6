/// \file
/// The second part of a simulation's step: finds the contacts of the particles that may touch the mesh, and lets the
/// effects respond.
///
/// The candidates of some particles are spread evenly over the lanes of the block; those that the quick test lets
/// through are listed, and judged as many at a time as there are lanes. Each that the narrow phase accepts offers
/// itself as the next contact of its particle: the deepest, or of particles that move the earliest, wins, by a minimum
/// over 64-bit keys, which does not depend on the order. One lane then lets the effects respond. This is repeated until
/// no contact counts, each time from where the particle then is. A contact counts only if its foot lies above the
/// tangent planes of those before: in a corner both walls count; on a plane that is divided into triangles one does,
/// and no inner edge is felt. A swept particle spends what is left of the step after each impact.
#pragma once

#include <cstring>

#include <collide/detail/narrow_phase/intersects.hpp>
#include <collide/detail/simulation/integrate.hpp>
#include <collide/detail/simulation/mesh_contact.hpp>

namespace collide::detail {

/// Of how many contacts that came before a particle has a note.
inline constexpr int noted_contacts = 3;

/// What else is known of a particle that moves.
template <class S, bool Moves>
struct survivor_way {};
template <class S>
struct survivor_way<S, true> {
  S way[3];
  id triangles[noted_contacts];  ///< of the contacts that came before
  S rest;                        ///< of the step, after the impacts so far

  COLLIDE_HD_INLINE vec3<S> along() const { return {way[0], way[1], way[2]}; }
};

/// A particle of radius `r` that is swept is taken to be at least so large that rounding its centre leaves it in front
/// of what it touches: 4 units in the last place of its coordinates, but no more than `largest`, for which the index is
/// prepared.
template <class S>
COLLIDE_HD_INLINE S swept_radius(S r, vec3<S> const& centre, vec3<S> const& displacement, S largest) {
  S const reach = collide::detail::largest<S>(centre.cwiseAbs()) + collide::detail::largest<S>(displacement.cwiseAbs());
  S const least = 4 * std::numeric_limits<S>::epsilon() * reach;
  return r >= 0 && r < largest ? larger(r, smaller(least, largest)) : r;
}

/// A particle that may touch the mesh in this step, in scratch memory. Plain numbers: scratch memory is not
/// constructed.
template <class S, bool Moves>
struct survivor : survivor_way<S, Moves> {
  static constexpr int planes = noted_contacts;

  S centre[3], radius;
  S normals[planes][3], feet[planes][3];  ///< of the contacts that came before
  S last_impulse;                         ///< with which the last of them repelled the particle
  S arrival[3], start[3];                 ///< velocity before the contacts at this place, and where it led from
  std::uint8_t before;                    ///< how many contacts came before
  std::uint8_t here;                      ///< how many of those at this place
  bool is_active;
  std::uint64_t best;       ///< key of the next contact
  std::uint32_t best_kept;  ///< where it is kept
  std::uint32_t offered;    ///< how many candidates offered themselves
  id number;
  candidate_cursor cursor;

  COLLIDE_HD_INLINE auto ball() const {
    if constexpr (Moves) {
      return moving_sphere<S>{{{centre[0], centre[1], centre[2]}, radius}, this->along()};
    } else {
      return sphere<S>{{centre[0], centre[1], centre[2]}, radius};
    }
  }

  COLLIDE_HD_INLINE void place(vec3<S> const& at, vec3<S> const& along) {
    for (int k = 0; k < 3; ++k) {
      centre[k] = at[k];
      if constexpr (Moves) this->way[k] = along[k];
    }
  }

  COLLIDE_HD_INLINE void remember(touching<S> const& c) {
    int const slot = before % planes;
    for (int k = 0; k < 3; ++k) {
      normals[slot][k] = c.normal[k];
      feet[slot][k] = c.point[k];
    }
    last_impulse = c.impulse;
    if constexpr (Moves) this->triangles[slot] = c.triangle;
    ++before;
    ++here;
  }

  /// Begins with the contacts at a place: all in a step, but those of a particle that moves on to the next one.
  COLLIDE_HD_INLINE void arrive(S time, vec3<S> const& velocity, vec3<S> const& from) {
    bool again = before > 0;
    if constexpr (Moves) {
      vec3<S> const moved = scaled(this->along(), time);
      again = again && dot(moved, moved) <= S(1e-6) * radius * radius;
    }
    if (again) return;
    here = 0;
    for (int k = 0; k < 3; ++k) {
      arrival[k] = velocity[k];
      start[k] = from[k];
    }
  }

  COLLIDE_HD_INLINE vec3<S> normal_of(int slot) const { return {normals[slot][0], normals[slot][1], normals[slot][2]}; }

  /// Finds how to leave a contact such that this leaves the particle on the surfaces of those before it at this place:
  /// the projection of the normal onto what they leave free. They count where the normal leads into them, and a single
  /// one also where it leads off it but pushed harder than that relieves it, as in the two sides of an open groove.
  COLLIDE_HD_INLINE void find_lift(touching<S>& c, vec3<S> const& velocity) const {
    vec3<S> const& n = c.normal;
    c.lift = n;
    c.free_change = std::numeric_limits<S>::max();
    int const count = smaller(int{here}, planes);
    int opposed = -1;
    S along = 0;
    auto const slot = [&](int i) { return (before - 1 - i) % planes; };
    for (int i = 0; i < count; ++i) {
      S const with = dot(n, normal_of(slot(i)));
      if (with >= along) continue;
      along = with;
      opposed = i;
    }
    vec3<S> out = n;
    S free = 0;
    if (opposed >= 0) {
      vec3<S> const wall = normal_of(slot(opposed));
      free = larger(dot(velocity, wall), S(0)) / -along;
      out -= wall * along;
      for (int i = 0; i < count; ++i) {
        if (i == opposed || dot(out, normal_of(slot(i))) >= -contact_tolerance<S>) continue;
        vec3<S> const edge = cross(wall, normal_of(slot(i)));
        out = edge * (dot(n, edge) / dot(edge, edge));
        free = 0;
      }
    } else if (count == 1) {
      vec3<S> const wall = normal_of(slot(0));
      S const with = dot(n, wall), apart = 1 - with * with;  // the square of the sine of the angle between the two
      S const relief = 2 * with * larger(-dot(velocity, n), S(0));
      if (!(apart > S(1e-2) && relief <= last_impulse * apart)) return;
      out -= wall * with;
    } else {
      return;
    }
    S const height = dot(out, n);
    if (!(height > S(1e-4))) return;  // between two walls that are nearly parallel
    c.lift = out * (1 / height);
    c.free_change = free;
  }

  /// True of a triangle that it has touched before and leaves: no part of that is above the tangent plane. To judge it
  /// once more would take exact arithmetic, as the distance is the radius.
  COLLIDE_HD_INLINE bool leaves(id triangle) const {
    bool left = false;
    if constexpr (Moves) {
      for (int i = 0; i < planes && i < before; ++i) {
        left = left || (this->triangles[i] == triangle && !approaches({normals[i][0], normals[i][1], normals[i][2]}));
      }
    }
    return left;
  }

  /// True if the sphere overlaps the mesh by more than rounding.
  COLLIDE_HD_INLINE bool overlaps(S depth) const {
    return depth > contact_tolerance<S> * radius + rounding_at(vec3<S>(centre[0], centre[1], centre[2]));
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
      known = known || (leaves && above <= contact_tolerance<S> * radius);
    }
    return known;
  }

  /// True if the way leads towards a surface with this normal, and not only along it.
  COLLIDE_HD_INLINE bool approaches(vec3<S> const& normal) const {
    vec3<S> const d = this->along();
    S const into = -dot(d, normal);
    constexpr S tolerance = contact_tolerance<S>;
    return into > 0 && (into * into > tolerance * tolerance * dot(d, d) || into > radius / 4);
  }
};

/// Keys of contacts: the smaller comes first. That is the earlier contact, and of those at the beginning of the way the
/// deeper one. Ties go to the face, then to the edge, so that on a plane which is divided into triangles the normal is
/// that of the face below the centre; then to the lower triangle number.
inline constexpr std::uint64_t no_contact = ~std::uint64_t{0};
/// Bits for the time or the depth in a key; one more tells which of them it is.
inline constexpr int key_bits = 29;

/// The next multiple of 2^-29 at or below a time from 0 to 1: keys tell such times apart.
template <class S>
COLLIDE_HD_INLINE S key_time(S time) {
  constexpr auto ticks = std::uint32_t{1} << key_bits;
  return S(smaller(static_cast<std::uint32_t>(time * S(ticks)), ticks - 1)) * (S(1) / S(ticks));
}

/// `time` is a `key_time`.
template <class S>
COLLIDE_HD_INLINE std::uint64_t contact_key(S time, contact<S> const& c) {
  constexpr auto ticks = std::uint32_t{1} << key_bits;
  std::uint32_t const first = time > 0 ? static_cast<std::uint32_t>(time * S(ticks)) | ticks
                                       : ~ordered(static_cast<float>(c.depth)) >> (32 - key_bits);
  return std::uint64_t{first} << 34 | std::uint64_t{static_cast<std::uint32_t>(c.kind)} << 32 | c.triangle;
}

/// The time of a contact, from its key.
template <class S>
COLLIDE_HD_INLINE S time_of_key(std::uint64_t key) {
  constexpr auto ticks = std::uint32_t{1} << key_bits;
  auto const first = static_cast<std::uint32_t>(key >> 34);
  return (first & ticks) != 0 ? S(first & (ticks - 1)) * (S(1) / S(ticks)) : S(0);
}

/// Kernel body: the contacts of all listed particles, in `blocks` blocks that share the list, of lanes that work alone.
template <class S, class NarrowPhase, class Lookup, class Scene>
struct respond_body : fly_body<S, NarrowPhase, Lookup, Scene> {
  using fly_type = fly_body<S, NarrowPhase, Lookup, Scene>;
  using fly_type::dt;
  using fly_type::least_radius;
  using fly_type::list;
  using fly_type::lookup;
  using fly_type::moves;
  using fly_type::scene;
  using fly_type::state;

  static constexpr int items = 1;
  template <class Block>
  static constexpr int residency = 2;                  ///< waits for memory, mostly
  static constexpr int most_contacts = moves ? 8 : 4;  ///< of a particle in a step
  static constexpr S part_after = S(Scene::integrator::after);

  std::size_t blocks;

  static constexpr int ahead = 3;  ///< entries that a lane looks at together

  /// How many particles a block resolves at a time. With the contacts that it keeps, this makes up most of its scratch
  /// memory, of which CUDA has 48 KB: fewer of doubles.
  template <class Block>
  static constexpr std::uint32_t together = Block::lanes > 1 ? Block::lanes*(moves ? 14 : 24) / 10 / sizeof(S)
                                                             : Block::items;

  /// A particle of those that are resolved together, and a triangle.
  struct candidate {
    std::uint32_t particle;
    id triangle;
  };

  /// A contact that a particle may have, in scratch memory.
  struct kept_contact {
    static constexpr std::uint32_t none = ~std::uint32_t{0};
    static constexpr S open = -1, touching = -2;  ///< in place of a time: it is open whether they touch; they do

    std::uint32_t particle;
    id triangle;  ///< `no_id` if they do not touch after all
    S time;       ///< below 0 while the contact is not known
    alignas(S) unsigned char bytes[sizeof(contact<S>)];

    COLLIDE_HD_INLINE void set(contact<S> const& c) { std::memcpy(bytes, static_cast<void const*>(&c), sizeof c); }
    COLLIDE_HD_INLINE contact<S> get() const {
      contact<S> c;
      std::memcpy(static_cast<void*>(&c), bytes, sizeof c);
      return c;
    }
  };

  /// The way of candidates to the next contact. A single lane judges each at once, and keeps the best of each particle.
  template <class Block>
  struct candidate_lists {
    static constexpr bool used = Block::lanes > 1;
    static constexpr std::uint32_t near_room = used ? (ahead + 1) * Block::lanes : 1;
    static constexpr std::uint32_t kept_room = used ? Block::lanes * 5 / 2 / sizeof(S) : together<Block>;

    candidate near[near_room];     ///< let through by the quick test
    kept_contact kept[kept_room];  ///< of those that the narrow phase may accept, as far as there is room
    std::uint32_t near_count, kept_count;
    std::uint32_t open_count;  ///< how many of those that are kept take long
  };

  /// How many ranges of candidates there are, and how often a particle may have had more. These only rise, so that
  /// nothing waits until they are 0 again.
  struct listing {
    std::uint32_t ranges, unfinished;
  };

  template <class Block>
  struct scratch {
    static constexpr std::uint32_t size = together<Block>;

    listing listed;
    std::uint32_t active;  ///< how often a particle has been to be looked at again
    survivor<S, moves> those[size];
    std::uint32_t owner[size], counts[size];
    cell_entry const* from[size];
    id first[size];
    std::uint32_t at[size];
    candidate_lists<Block> lists;
    typename Block::balance_scratch balance;
  };

  template <class Block>
  COLLIDE_HD void operator()(Block& block, scratch<Block>& s) const {
    static_assert(Block::lanes == 1, "lanes that work together have one kernel for both parts");
    std::uint32_t const n = *list.count;
    if (n == 0) return;
    Lookup const near = lookup.opened();
    // as many as come to each block, or the same each time if it has no room for so many
    auto const shares = static_cast<std::uint32_t>(blocks), most = shares * together<Block>;
    std::uint32_t const share = (n - 1) / (shares * ((n - 1) / most + 1)) + 1;
    for (std::size_t base = block.index() * share; base < n; base += blocks * share) {
      collide(block, s, near, smaller(n - static_cast<std::uint32_t>(base), share),
              [&](survivor<S, moves>& one, std::uint32_t j) { begin(one, list.numbers[base + j]); });
    }
    // the last block that had something to do empties the list for the next step; those that come later find it so
    std::size_t const busy = smaller(blocks, (n + std::size_t{share} - 1) / share);
    if (block.index() >= busy || fetch_add(list.done, 1u) + 1 != busy) return;
    *list.count = 0;
    *list.done = 0;
  }

 protected:
  using colliding = particle<S, typename Scene::contact>;

  /// What is known of a particle when its contacts are to be found.
  COLLIDE_HD_INLINE void begin(survivor<S, moves>& one, id number) const {
    colliding p;
    state.load(p, number);
    one.number = number;
    one.radius = p.the_radius;
    one.place(p[position{}], p[velocity{}] * dt);
    if constexpr (moves) one.radius = swept_radius(p.the_radius, p[position{}], one.along(), least_radius);
  }

  /// Resolves the contacts of `n` particles, at most `together`: begin(one, j) for all j < n says which they are.
  template <class Block, class Begin>
  COLLIDE_HD void collide(Block& block, scratch<Block>& s, Lookup const& near, std::uint32_t n,
                          Begin const& begin) const {
    auto const each_of_lane = [&](auto const& f) {
      block.each([&](int lane) {
        for (auto j = static_cast<std::uint32_t>(lane); j < n; j += Block::lanes) f(s.those[j], j);
      });
    };
    auto const look_around = [&](survivor<S, moves>& one) {
      one.best = no_contact;
      one.best_kept = kept_contact::none;
      one.offered = 0;
      one.cursor = near.begin(one.ball());
    };
    each_of_lane([&](survivor<S, moves>& one, std::uint32_t j) {
      begin(one, j);
      if constexpr (moves) one.rest = dt;
      one.before = one.here = 0;
      one.is_active = true;
      look_around(one);
      if (j != 0) return;
      s.listed = {0, 0};
      s.active = 0;
    });
    listing listed{0, 0};
    std::uint32_t active = 0;
    for (;;) {
      offer_all(block, s, near, each_of_lane, listed);
      find_best(block, s);
      each_of_lane([&](survivor<S, moves>& one, std::uint32_t) {
        if (!one.is_active) return;
        respond(one, near, s.lists.kept);
        if (!one.is_active) return;
        look_around(one);
        block.add(s.active, 1);
      });
      std::uint32_t const before = active;
      active = block.shared(s.active);
      if (active == before) break;
    }
  }

  /// Offers all candidates of the active ones, and keeps their contacts. `listed` is what `s.listed` was before, and is
  /// then.
  template <class Block, class Each>
  COLLIDE_HD void offer_all(Block& block, scratch<Block>& s, Lookup const& near, Each const& each_of_lane,
                            listing& listed) const {
    constexpr std::uint32_t most = (1u << 31) / together<Block>;
    for (bool is_first = true, more = true; more; is_first = false) {
      each_of_lane([&](survivor<S, moves>& one, std::uint32_t j) {
        if (j == 0 && is_first) s.lists.near_count = s.lists.kept_count = s.lists.open_count = 0;
        candidate_range range{};
        if (!one.is_active || !near.next(one.ball(), one.cursor, most, range)) return;
        if (!one.cursor.at_end()) block.add(s.listed.unfinished, 1);
        std::uint32_t const place = block.add(s.listed.ranges, 1) - listed.ranges;
        s.owner[place] = j;
        s.counts[place] = range.count;
        s.from[place] = range.listed;
        s.first[place] = range.first;
        s.at[place] = range.place;
      });
      listing const before = listed;
      listed = block.shared(s.listed);
      more = listed.unfinished != before.unfinished;
      std::uint32_t const ranges = listed.ranges - before.ranges;
      if (ranges == 0) break;
      block.template balanced<ahead>(
          s.balance, s.counts, ranges,
          [&](std::uint32_t i) {
            auto& one = s.those[s.owner[i]];
            auto const ball = one.ball();
            sphere<S> const around = enclosing(until_next<Block>(one, ball));
            return candidates{s.owner[i], one, ball, around, {s.from[i], s.first[i], 0, s.at[i]}};
          },
          [](candidates const& c, std::uint32_t k) { return c.range.at(k); },
          [&](candidates const& c, cell_entry const& e) { return c.range.may_touch(e); },
          [&](candidates const& c, cell_entry const& e) {
            if constexpr (candidate_lists<Block>::used) {
              s.lists.near[block.add(s.lists.near_count, 1)] = {c.particle, e.triangle};
            } else {
              if (near.near(c.around, e.triangle) && !c.one.leaves(e.triangle)) offer_next(s, c, near, e.triangle);
            }
          },
          [&] {
            if constexpr (candidate_lists<Block>::used) {
              std::uint32_t const n = block.shared(s.lists.near_count);
              if (n + ahead * Block::lanes > candidate_lists<Block>::near_room) judge_listed(block, s, near, n);
            }
          });
    }
    if constexpr (candidate_lists<Block>::used) {
      judge_listed(block, s, near, block.shared(s.lists.near_count));
      offer_found(block, s, near);
    }
  }

  /// Judges the `n` candidates that are listed, and lists those that may touch. What there is no room for is offered.
  template <class Block>
  COLLIDE_HD_INLINE void judge_listed(Block& block, scratch<Block>& s, Lookup const& near, std::uint32_t n) const {
    for (std::uint32_t base = 0; base < n; base += Block::lanes) {
      block.each([&](int lane) {
        std::uint32_t const i = base + static_cast<std::uint32_t>(lane);
        if (lane == 0) s.lists.near_count = 0;
        if (i >= n) return;
        candidate const c = s.lists.near[i];
        id const number = c.triangle;
        auto& one = s.those[c.particle];
        auto const ball = one.ball();
        if (!near.template may_touch<NarrowPhase>(ball, number) || one.leaves(number)) return;
        triangle<S> const t = near.mesh[number];
        verdict const quick = attempt(t, ball);
        if (quick == verdict::miss) return;
        std::uint32_t const place = block.add(s.lists.kept_count, 1);
        if (place < candidate_lists<Block>::kept_room) {
          s.lists.kept[place].particle = c.particle;
          s.lists.kept[place].triangle = number;
          s.lists.kept[place].time = quick == verdict::hit ? kept_contact::touching : kept_contact::open;
          return;
        }
        offer_late<Block>(one, near.mesh, number, quick == verdict::hit);
      });
    }
  }

  /// Offers a contact that there is no room for. Hardly ever happens: out of line, and without a reference to what is
  /// in registers or parameters, which each thread would then have to keep in memory.
  template <class Block>
  static COLLIDE_HD_NOINLINE void offer_late(survivor<S, moves>& one, mesh_view<S> mesh, id number, bool sure) {
    S time;
    contact<S> found;
    if (find_contact(mesh[number], one.ball(), sure, number, time, found)) offer<Block>(one, time, found);
  }

  /// Whether a ball touches a triangle, where that is quick to tell. What is left open, many balls that rest on the
  /// mesh, is finished with the contacts: there as few warps as possible go through long code in double.
  template <class Ball>
  static COLLIDE_HD_INLINE verdict attempt(triangle<S> const& t, Ball const& ball) {
    if constexpr (in_stages<NarrowPhase>::value) {
      return in_stages<NarrowPhase>::attempt(t, ball);
    } else {
      return NarrowPhase::intersects(t, ball) ? verdict::hit : verdict::miss;
    }
  }
  template <class Ball>
  static COLLIDE_HD_INLINE bool finish(triangle<S> const& t, Ball const& ball) {
    if constexpr (in_stages<NarrowPhase>::value) {
      return in_stages<NarrowPhase>::finish(t, ball);
    } else {
      return false;  // nothing is left open
    }
  }

  /// Finds when and how a ball and a triangle touch; `sure` says that they do, else it is open whether.
  template <class Ball>
  static COLLIDE_HD_INLINE bool find_contact(triangle<S> const& t, Ball const& ball, bool sure, id number, S& time,
                                             contact<S>& found) {
    if (!sure && !finish(t, ball)) return false;
    time = time_of(t, ball);
    found = contact_of(t, ball, time, number);
    return true;
  }

  /// Finds the contacts that are to be kept, many at a time, and offers them: first those that take no call. What a
  /// thread has at hand when it calls something it keeps in memory, and begins to do so long before.
  template <class Block>
  COLLIDE_HD_INLINE void offer_found(Block& block, scratch<Block>& s, Lookup const& near) const {
    if constexpr (!moves) {
      each_kept(block, s, [&](survivor<S, moves>& one, kept_contact& k, std::uint32_t) {
        contact<S> found;
        bool const sure = k.time == kept_contact::touching;
        verdict const quick = quick_contact_here(near.mesh[k.triangle], one.ball(), sure, found);
        if (quick == verdict::unsure) block.add(s.lists.open_count, 1);
        if (quick == verdict::miss) k.triangle = no_id;
        if (quick != verdict::hit) return;
        found.triangle = k.triangle;
        k.time = 0;
        k.set(found);
        offer<Block>(one, k.time, found);
      });
      if (block.shared(s.lists.open_count) == 0) return;
    }
    each_kept(block, s, [&](survivor<S, moves>& one, kept_contact& k, std::uint32_t) {
      if constexpr (moves) {
        offer_one<Block>(one, near.mesh, k);
      } else {
        if (k.time < 0) offer_open<Block>(one, near.mesh, k);
      }
    });
  }

  /// What is open, out of line.
  template <class Block>
  static COLLIDE_HD_NOINLINE void offer_open(survivor<S, moves>& one, mesh_view<S> mesh, kept_contact& k) {
    offer_one<Block>(one, mesh, k);
  }

  /// Finds a contact that is to be kept, and offers it.
  template <class Block>
  static COLLIDE_HD_INLINE void offer_one(survivor<S, moves>& one, mesh_view<S> const& mesh, kept_contact& k) {
    S time;
    contact<S> found;
    bool const sure = k.time == kept_contact::touching;
    if (!find_contact(mesh[k.triangle], one.ball(), sure, k.triangle, time, found)) {
      k.triangle = no_id;
      return;
    }
    k.time = time;
    k.set(found);
    offer<Block>(one, time, found);
  }

  /// Finds where the best contacts are kept. A lane alone knows.
  template <class Block>
  COLLIDE_HD_INLINE void find_best(Block& block, scratch<Block>& s) const {
    if constexpr (candidate_lists<Block>::used) {
      each_kept(block, s, [&](survivor<S, moves>& one, kept_contact& k, std::uint32_t place) {
        contact<S> const c = k.get();
        if (one.best == contact_key(k.time, c)) fetch_min(&one.best_kept, place);
      });
    }
  }

  template <class Block, class F>
  COLLIDE_HD_INLINE void each_kept(Block& block, scratch<Block>& s, F const& f) const {
    std::uint32_t const n = smaller(block.shared(s.lists.kept_count), candidate_lists<Block>::kept_room);
    block.each([&](int lane) {
      for (auto i = static_cast<std::uint32_t>(lane); i < n; i += Block::lanes) {
        kept_contact& k = s.lists.kept[i];
        if (k.triangle != no_id) f(s.those[k.particle], k, i);
      }
    });
  }

  /// A particle and some of its candidates.
  struct candidates {
    std::uint32_t particle;
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
      // times are early by less, or by what the slack of bounding spheres covers; in keys they are rounded
      constexpr S late = S(0x1p-21);
      if (one.best != no_contact)
        ball.displacement = scaled(ball.displacement, smaller(S(1), time_of_key<S>(one.best) + late));
    }
    return ball;
  }

  /// A lane alone: offers a triangle as the next contact of a particle, if they touch.
  template <class Scratch>
  COLLIDE_HD_INLINE void offer_next(Scratch& s, candidates const& c, Lookup const& near, id number) const {
    if constexpr (moves) {
      if (c.one.best != no_contact && static_cast<id>(c.one.best) == number) return;  // it was in another cell, too
    }
    triangle<S> const t = near.mesh[number];
    verdict const quick = attempt(t, c.ball);
    S time;
    contact<S> found;
    if (quick == verdict::miss || !find_contact(t, c.ball, quick == verdict::hit, number, time, found)) return;
    std::uint64_t const before = c.one.best;
    offer<serial_block<1, 0>>(c.one, time, found);
    if (c.one.best == before) return;
    c.one.best_kept = c.particle;
    s.lists.kept[c.particle].time = time;
    s.lists.kept[c.particle].set(found);
  }

  /// Offers a contact as the next one of a particle. False if it does not count.
  template <class Block>
  static COLLIDE_HD_INLINE bool offer(survivor<S, moves>& one, S time, contact<S> const& c) {
    if (one.knows(c.point)) return false;
    if constexpr (moves) {
      if (!one.approaches(c.normal) && !(time == 0 && one.overlaps(c.depth))) return false;
    }
    std::uint64_t const key = contact_key(time, c);
    if constexpr (Block::lanes > 1) {
      fetch_add(&one.offered, 1u);
      fetch_min(&one.best, key);
    } else {
      ++one.offered;
      one.best = smaller(one.best, key);
    }
    return true;
  }

  /// A surface has two sides. Where the centre lies on it, the normal faces against the path.
  static COLLIDE_HD_INLINE void face_against(contact<S>& c, vec3<S> const& path) {
    if (c.distance == 0 && dot(c.normal, path) > 0) c.normal = -c.normal;
  }

  /// The contact of a ball and a triangle that it touches at a time within the step.
  template <class Ball>
  static COLLIDE_HD_INLINE contact<S> contact_of(triangle<S> const& t, Ball const& ball, S time, id number) {
    contact<S> c = contact_here(t, place_at(ball, time));
    c.triangle = number;
    if constexpr (moves) face_against(c, ball.displacement);
    return c;
  }

  static COLLIDE_HD_INLINE S time_of(triangle<S> const& t, moving_sphere<S> const& ball) {
    return key_time(stop_of<NarrowPhase>::time(t, ball));
  }
  static COLLIDE_HD_INLINE S time_of(triangle<S> const&, sphere<S> const&) { return 0; }
  static COLLIDE_HD_INLINE sphere<S> place_at(moving_sphere<S> const& ball, S time) { return ball_at(ball, time); }
  static COLLIDE_HD_INLINE sphere<S> const& place_at(sphere<S> const& ball, S) { return ball; }

  /// Lets the effects respond to the contact that was found, and says whether to look for another. If there was none,
  /// the particle's step ends.
  COLLIDE_HD_INLINE void respond(survivor<S, moves>& one, Lookup const& near, kept_contact const* kept) const {
    if (one.best == no_contact) {
      if constexpr (!moves && !Scene::finishes && part_after == 0) {
        one.is_active = false;  // nothing is left to do
      } else {
        respond_to(one, nullptr);
      }
    } else if (one.best_kept == kept_contact::none) {
      respond_again(*this, one, near.mesh);
    } else {
      respond_to(one, kept + one.best_kept);
    }
  }

  /// The same to a contact that was not kept. Hardly ever happens; see `offer_late`.
  static COLLIDE_HD_NOINLINE void respond_again(respond_body self, survivor<S, moves>& one, mesh_view<S> mesh) {
    auto const number = static_cast<id>(one.best);
    auto const ball = one.ball();
    kept_contact again;
    again.time = time_of(mesh[number], ball);
    again.set(contact_of(mesh[number], ball, again.time, number));
    self.respond_to(one, &again);
  }

  /// The same to a contact; null: there was none.
  COLLIDE_HD_INLINE void respond_to(survivor<S, moves>& one, kept_contact const* kept) const {
    colliding p;
    state.load(p, one.number);
    if (kept == nullptr) {
      if constexpr (moves) p[position{}] += p[velocity{}] * one.rest;
      one.is_active = false;
    } else {
      auto const ball = one.ball();
      S const time = kept->time;
      sphere<S> const here = place_at(ball, time);
      vec3<S> const came = p[velocity{}];
      one.arrive(time, came, moves ? here.centre : vec3<S>(here.centre - came * dt));
      vec3<S> const arrival(one.arrival[0], one.arrival[1], one.arrival[2]);
      touching<S> c{};
      static_cast<contact<S>&>(c) = kept->get();
      c.sphere = one.number;
      c.start = vec3<S>(one.start[0], one.start[1], one.start[2]);
      if constexpr (moves) {
        p[position{}] = here.centre;
        one.rest -= one.rest * time;
      } else {
        c.moved = dt;
        face_against(c, arrival);
      }
      c.approach = -dot(arrival, c.normal);
      // how deep when the step began: what is pushed out farther than it came in may then touch what it did not before
      [[maybe_unused]] S const deep = c.depth + dot(c.normal, vec3<S>(here.centre - c.start));
      one.find_lift(c, came);
      colliding next = p;
      scene.accelerate(next, dt);
      c.gain = next[velocity{}] - came;
      scene.touch(p, c, dt);
      one.remember(c);
      one.is_active = one.before < most_contacts;
      if constexpr (moves) {
        one.place(p[position{}], p[velocity{}] * one.rest);
        bool const repelled = dot(c.normal, vec3<S>(p[velocity{}] - came)) > 0;
        if (!repelled && one.approaches(c.normal)) {  // it goes through
          p[position{}] += p[velocity{}] * one.rest;
          one.is_active = false;
        }
      } else {
        one.place(p[position{}], p[velocity{}]);
        one.is_active = one.is_active && (one.offered > 1 || one.overlaps(deep));
      }
      if (is_skipped(p)) one.is_active = false;
    }
    if (!one.is_active) {
      if constexpr (part_after != 0) {
        bool const is_held = one.before > 0 && p[velocity{}] == vec3<S>(S(0), S(0), S(0));
        if (!is_held) scene.accelerate(p, part_after * dt);
      }
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
