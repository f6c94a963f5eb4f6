/// \file
/// A particle that may touch the mesh in a step, and the contacts that it has had in it.
#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>

#include <collide/contact.hpp>
#include <collide/detail/bodies/bodies_ref.hpp>
#include <collide/detail/numeric/float_bits.hpp>
#include <collide/effect.hpp>

namespace collide::detail {

/// Keys of contacts: the smaller comes first. That is the earlier contact, and of those at the beginning of the motion
/// the deeper one. Ties go to the face, then to the edge, so that on a plane which is divided into triangles the normal
/// is that of the face below the centre; then to the lower triangle number.
inline constexpr std::uint64_t no_contact = ~std::uint64_t{0};
/// Bits for the time or the depth in a key; one more tells which of them it is.
inline constexpr int key_bits = 29;

/// The next time at or below a time from 0 to 1 that keys tell from others: a multiple of 2^-29 below 1.
template <class S>
COLLIDE_HD_INLINE S key_time(S time) {
  constexpr auto ticks = std::uint32_t{1} << key_bits, last = ticks - (sizeof(S) == sizeof(float) ? 32 : 1);
  return S(min(static_cast<std::uint32_t>(time * S(ticks)), last)) * (S(1) / S(ticks));
}

/// `time` is a `key_time`.
template <class S>
COLLIDE_HD_INLINE std::uint64_t contact_key(S time, contact<S> const& c) {
  constexpr auto ticks = std::uint32_t{1} << key_bits;
  std::uint32_t const first = time > 0 ? static_cast<std::uint32_t>(time * S(ticks)) | ticks
                                       : ~to_ordered_bits(static_cast<float>(c.depth)) >> (32 - key_bits);
  return std::uint64_t{first} << 34 | std::uint64_t{static_cast<std::uint32_t>(c.feature)} << 32 | c.triangle;
}

/// The time of a contact, from its key.
template <class S>
COLLIDE_HD_INLINE S time_of_key(std::uint64_t key) {
  constexpr auto ticks = std::uint32_t{1} << key_bits;
  auto const first = static_cast<std::uint32_t>(key >> 34);
  return (first & ticks) != 0 ? S(first & (ticks - 1)) * (S(1) / S(ticks)) : S(0);
}

/// How many of the contacts that a particle has had are recorded: the last ones.
inline constexpr int max_recorded_contacts = 3;

/// What is known of a swept particle alone.
template <class S, bool IsSwept>
struct remaining_motion {};
template <class S>
struct remaining_motion<S, true> {
  S displacement[3];
  S remaining_time;                     ///< of the step, after the contacts so far
  id triangles[max_recorded_contacts];  ///< of the recorded contacts

  COLLIDE_HD_INLINE vec3<S> motion() const { return {displacement[0], displacement[1], displacement[2]}; }
};

/// What is known of a particle alone that may touch bodies that move.
template <class S, bool HasBodies>
struct body_contacts {};
template <class S>
struct body_contacts<S, true> {
  // of the recorded contacts
  S surface_velocities[max_recorded_contacts][3];
  S own_normals[max_recorded_contacts][3], own_points[max_recorded_contacts][3];  ///< in the frame of their body
  int frames[max_recorded_contacts];
  bool is_held;  ///< it had no velocity relative to the surface after the last one
};

/// How a particle moves, as a surface sees it that it may touch: one that rests sees what there is.
struct seen_at_rest {};
/// A surface of a body sees a displacement of its own in the rest of the step, and a velocity.
template <class S>
struct seen_from_body {
  vec3<S> own_displacement;  ///< in the frame of the body
  vec3<S> displacement;      ///< turned to the world
  vec3<S> own_point;         ///< where the two may touch, in the frame of the body
  vec3<S> drift;             ///< in the world, of what moves with the body, since the particle's last contact
  vec3<S> velocity;          ///< in the world
  int frame;
};

/// A particle that may touch the mesh in this step, in scratch memory. Plain numbers: scratch memory is not
/// constructed.
template <class S, bool IsSwept, bool HasBodies = false>
struct active_particle : remaining_motion<S, IsSwept>, body_contacts<S, HasBodies> {
  static constexpr bool is_swept = IsSwept;
  static constexpr int max_recorded = max_recorded_contacts;

  S centre[3], radius;
  id number;
  bool is_active;
  std::uint8_t contact_count;     ///< contacts so far in this step
  std::uint8_t contacts_here;     ///< those of them at this place
  std::uint32_t candidate_count;  ///< how many contacts have been considered as the next one
  std::uint64_t best_key;         ///< of the next contact
  std::conditional_t<HasBodies, body_cursor, candidate_cursor> cursor;  ///< which triangles have been looked at
  alignas(S) unsigned char best[sizeof(contact<S>)];                    ///< the next contact

  // of the recorded contacts; not set before there is one
  S normals[max_recorded][3], points[max_recorded][3];
  S last_impulse;                   ///< with which the last one repelled the particle
  S arrival_velocity[3], start[3];  ///< before the contacts at this place, and where it led from

  COLLIDE_HD_INLINE auto shape() const {
    if constexpr (IsSwept) {
      return moving_sphere<S>{{{centre[0], centre[1], centre[2]}, radius}, this->motion()};
    } else {
      return sphere<S>{{centre[0], centre[1], centre[2]}, radius};
    }
  }

  COLLIDE_HD_INLINE void place(vec3<S> const& at, [[maybe_unused]] vec3<S> const& motion) {
    for (int k = 0; k < 3; ++k) {
      centre[k] = at[k];
      if constexpr (IsSwept) this->displacement[k] = motion[k];
    }
  }

  COLLIDE_HD_INLINE void set_best(contact<S> const& c) { std::memcpy(best, static_cast<void const*>(&c), sizeof c); }
  COLLIDE_HD_INLINE contact<S> best_contact() const {
    contact<S> c;
    std::memcpy(static_cast<void*>(&c), best, sizeof c);
    return c;
  }

  /// `own` is the contact in the frame of its body, if there are bodies.
  COLLIDE_HD_INLINE void record_contact(mesh_contact<S> const& c, [[maybe_unused]] contact<S> const& own = {},
                                        [[maybe_unused]] int frame = 0) {
    int const slot = contact_count % max_recorded;
    for (int k = 0; k < 3; ++k) {
      normals[slot][k] = c.normal[k];
      points[slot][k] = c.point[k];
    }
    last_impulse = c.normal_impulse;
    if constexpr (IsSwept) this->triangles[slot] = c.triangle;
    if constexpr (HasBodies) {
      for (int k = 0; k < 3; ++k) {
        this->surface_velocities[slot][k] = c.surface_velocity[k];
        this->own_normals[slot][k] = own.normal[k];
        this->own_points[slot][k] = own.point[k];
      }
      this->frames[slot] = frame;
    }
    ++contact_count;
    ++contacts_here;
  }

  /// Begins with the contacts at a place: all in a step, but those of a particle that moves on to the next one.
  template <class Seen = seen_at_rest>
  COLLIDE_HD_INLINE void begin_contact_place(S time, vec3<S> const& velocity, vec3<S> const& from,
                                             Seen const& seen = {}) {
    bool is_same_place = contact_count > 0;
    if constexpr (IsSwept) {
      vec3<S> const moved = scaled(path_seen(seen), time);
      is_same_place = is_same_place && dot(moved, moved) <= S(1e-6) * radius * radius;
    }
    if (is_same_place) {
      if constexpr (IsSwept) advect_start(seen);
      return;
    }
    contacts_here = 0;
    for (int k = 0; k < 3; ++k) {
      arrival_velocity[k] = velocity[k];
      start[k] = from[k];
    }
  }

  /// What a surface that has been moved has pushed by `height` does not go back to where it was: where it is held at
  /// the contacts that follow, it is there.
  COLLIDE_HD_INLINE void offset_start(mesh_contact<S> const& c, S height) {
    if (!overlaps(height)) return;
    for (int k = 0; k < 3; ++k) start[k] += c.wedge_direction[k] * height;
  }

  /// True of a swept particle's triangle that it has touched before and leaves: no part of that is above the tangent
  /// plane. To judge it once more would take exact arithmetic, as the distance is the radius.
  template <class Seen = seen_at_rest>
  COLLIDE_HD_INLINE bool is_leaving([[maybe_unused]] id triangle, [[maybe_unused]] Seen const& seen = {}) const {
    bool leaves = false;
    if constexpr (IsSwept) {
      for (int i = 0; i < max_recorded && i < contact_count; ++i) {
        leaves = leaves || (this->triangles[i] == triangle && !is_approaching_again(i, seen));
      }
    }
    return leaves;
  }

  /// True if a point of the mesh is part of the same surface as a recorded contact: not above its tangent plane. So
  /// inner edges of a surface that is divided into triangles are not felt.
  template <class Seen = seen_at_rest>
  COLLIDE_HD_INLINE bool is_internal_contact(vec3<S> const& point, [[maybe_unused]] Seen const& seen = {}) const {
    bool is_internal = false;
    for (int i = 0; i < max_recorded; ++i) {
      if (i >= contact_count) break;
      S above = 0;
      for (int k = 0; k < 3; ++k) above += normals[i][k] * (point[k] - points[i][k]);
      bool leaves = true;
      if constexpr (IsSwept) leaves = !is_approaching_again(i, seen);
      if constexpr (HasBodies && IsSwept) {
        if (this->frames[i] == seen.frame) {
          above = own_height(i, seen.own_point);
        } else {  // it is one surface if the other body does not come towards the particle either
          leaves = leaves && !is_approaching(normal_of(i), seen);
        }
      }
      is_internal = is_internal || (leaves && above <= contact_tolerance<S> * radius);
    }
    return is_internal;
  }

  /// True if the motion leads towards a surface with this normal, and not only along it.
  COLLIDE_HD_INLINE bool is_approaching(vec3<S> const& normal) const {
    vec3<S> const d = this->motion();
    S const into = -dot(d, normal);
    constexpr S tolerance = contact_tolerance<S>;
    return into > 0 && (into * into > tolerance * tolerance * dot(d, d) || into > radius / 4);
  }

  /// True if the motion, as a body sees it, leads towards its surface by more than rounding.
  COLLIDE_HD_INLINE bool is_approaching(vec3<S> const& normal, seen_from_body<S> const& seen) const {
    S const into = -dot(seen.displacement, normal);
    constexpr S tolerance = contact_tolerance<S>;
    vec3<S> const here(centre[0], centre[1], centre[2]);
    S const off = std::numeric_limits<S>::epsilon() * dot(vec3<S>(here.cwiseAbs()), vec3<S>(normal.cwiseAbs()));
    return into > 4 * off &&
           (into * into > tolerance * tolerance * dot(seen.displacement, seen.displacement) || into > radius / 4);
  }
  COLLIDE_HD_INLINE bool is_approaching(vec3<S> const& normal, seen_at_rest) const { return is_approaching(normal); }

  /// True if so deep an overlap with the mesh is more than rounding.
  COLLIDE_HD_INLINE bool overlaps(S depth) const {
    return depth > contact_tolerance<S> * radius + rounding_at(vec3<S>(centre[0], centre[1], centre[2]));
  }

  /// Finds how to leave a contact such that this leaves the particle on the surfaces of those before it at this place:
  /// the projection of the normal onto what they leave free. They count where the normal leads into them, and a single
  /// one also where it leads off it but pushed harder than that relieves it, as in the two sides of an open groove.
  template <class Seen = seen_at_rest>
  COLLIDE_HD_INLINE void project_onto_contacts(mesh_contact<S>& c, vec3<S> const& velocity,
                                               [[maybe_unused]] Seen const& seen = {}) const {
    vec3<S> const& n = c.normal;
    c.wedge_direction = n;
    c.unconstrained_dv = std::numeric_limits<S>::max();
    int const count = min(int{contacts_here}, max_recorded);
    if (count == 0) return;
    auto const last = [&](int i) { return normal_of((contact_count - 1 - i) % max_recorded); };
    auto const speed_off = [&](int i) {
      return dot(velocity_seen(velocity, (contact_count - 1 - i) % max_recorded, seen), last(i));
    };
    int opposed = -1;
    S along = 0;
    for (int i = 0; i < count; ++i) {
      S const with = dot(n, last(i));
      if (with >= along) continue;
      along = with;
      opposed = i;
    }
    vec3<S> out = n;
    S free = 0;
    if (opposed >= 0) {
      vec3<S> const wall = last(opposed);
      free = max(speed_off(opposed), S(0)) / -along;
      out -= wall * along;
      for (int i = 0; i < count; ++i) {
        if (i == opposed || dot(out, last(i)) >= -contact_tolerance<S>) continue;
        vec3<S> const edge = cross(wall, last(i));
        out = edge * (dot(n, edge) / dot(edge, edge));
        free = 0;
      }
    } else if (count == 1) {
      vec3<S> const wall = last(0);
      S const with = dot(n, wall), apart = 1 - with * with;  // the square of the sine of the angle between the two
      S const relief = 2 * with * max(-speed_towards(velocity, n, seen), S(0));
      if (!(apart > S(1e-2) && relief <= last_impulse * apart)) return;
      out -= wall * with;
    } else {
      return;
    }
    S const height = dot(out, n);
    if (!(height > S(1e-4))) return;  // between two walls that are nearly parallel
    c.wedge_direction = out * (1 / height);
    c.unconstrained_dv = free;
  }

 private:
  COLLIDE_HD_INLINE vec3<S> normal_of(int slot) const { return {normals[slot][0], normals[slot][1], normals[slot][2]}; }

  /// As the surface sees it that it touches now, the particle has stayed at a place: that has moved with the surface.
  COLLIDE_HD_INLINE void advect_start(seen_at_rest) {}
  COLLIDE_HD_INLINE void advect_start(seen_from_body<S> const& seen) {
    for (int k = 0; k < 3; ++k) start[k] += seen.drift[k];
  }

  COLLIDE_HD_INLINE vec3<S> path_seen(seen_at_rest) const { return this->motion(); }
  COLLIDE_HD_INLINE vec3<S> path_seen(seen_from_body<S> const& seen) const { return seen.displacement; }

  /// A velocity as the surface of a recorded contact sees it.
  COLLIDE_HD_INLINE vec3<S> const& velocity_seen(vec3<S> const& velocity, int, seen_at_rest) const { return velocity; }
  COLLIDE_HD_INLINE vec3<S> velocity_seen(vec3<S> const& velocity, int slot, seen_from_body<S> const& seen) const {
    S const(&u)[3] = this->surface_velocities[slot];
    return this->frames[slot] == seen.frame ? seen.velocity : vec3<S>(velocity - vec3<S>(u[0], u[1], u[2]));
  }
  COLLIDE_HD_INLINE S speed_towards(vec3<S> const& velocity, vec3<S> const& n, seen_at_rest) const {
    return dot(velocity, n);
  }
  COLLIDE_HD_INLINE S speed_towards(vec3<S> const&, vec3<S> const& n, seen_from_body<S> const& seen) const {
    return dot(seen.velocity, n);
  }

  /// True if the motion leads towards the surface of a recorded contact.
  COLLIDE_HD_INLINE bool is_approaching_again(int slot, seen_at_rest) const { return is_approaching(normal_of(slot)); }
  COLLIDE_HD_INLINE bool is_approaching_again(int slot, seen_from_body<S> seen) const {
    S const(&n)[3] = this->own_normals[slot];
    if (this->frames[slot] == seen.frame) {  // which may have turned since
      seen.displacement = seen.own_displacement;
      return is_approaching(vec3<S>(n[0], n[1], n[2]), seen);
    }
    S const(&u)[3] = this->surface_velocities[slot];
    seen.displacement = this->motion() - vec3<S>(u[0], u[1], u[2]) * this->remaining_time;
    return is_approaching(normal_of(slot), seen);
  }

  /// How high a point of a body's frame is above the tangent plane of a contact with the body.
  COLLIDE_HD_INLINE S own_height(int slot, vec3<S> const& point) const {
    S above = 0;
    for (int k = 0; k < 3; ++k) above += this->own_normals[slot][k] * (point[k] - this->own_points[slot][k]);
    return above;
  }
};

}  // namespace collide::detail
