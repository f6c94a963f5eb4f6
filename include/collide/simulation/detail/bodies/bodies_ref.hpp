/// \file
/// The lookup of a mesh of which bodies are parts: that of the whole mesh, asked once for each body in its frame. The
/// members are those of mesh_lookup.hpp.
#pragma once

#include <collide/broad/detail/mesh_lookup.hpp>
#include <collide/simulation/detail/bodies/float_frames.hpp>
#include <collide/simulation/detail/bodies/moving_mesh.hpp>

namespace collide::detail {

/// How far the candidates of a sphere have been gone through.
struct body_cursor : candidate_cursor {
  int frame;          ///< where it goes on; the number of frames if there is no more
  int frame_of_last;  ///< of the candidates that it gave last
  bool has_begun;     ///< in the frame
  bool ended;

  COLLIDE_HD_INLINE bool at_end() const { return ended; }
};

COLLIDE_HD_INLINE float path_length(sphere<float> const&) { return 0; }
COLLIDE_HD_INLINE double path_length(sphere<double> const&) { return 0; }
template <class S>
COLLIDE_HD_INLINE S path_length(moving_sphere<S> const& s) {
  return sqrt_rn(dot(s.displacement, s.displacement));
}

template <class S, class Triangles>
struct bodies_ref {
  Triangles whole;  ///< the lookup of all triangles, each in its frame
  moving_mesh<S> mesh;
  float_frames<S> quick;

  COLLIDE_HD_INLINE bodies_ref opened() const { return {whole.opened(), mesh, quick}; }

  /// True if `test_occupied` can tell of spheres of this radius whether they may touch a triangle.
  COLLIDE_HD_INLINE bool has_single_cell_lookup(S radius) const {
    return whole.has_single_cell_lookup(radius + quick.margin) && quick.serve(radius);
  }
  COLLIDE_HD_INLINE auto occupancy() const { return whole.occupancy(); }

  /// Sets near[k] for those of some spheres at rest, of one radius, that may touch a triangle at the end of the step.
  /// False if that is not known. `occupancy` is `occupancy()`.
  template <unsigned N>
  COLLIDE_HD_INLINE bool test_occupied(occupancy_view<S> const& occupancy, S const (&x)[N], S const (&y)[N],
                                       S const (&z)[N], S radius, bool (&near)[N]) const {
    return quick.test_occupied(occupancy, mesh.first_frame, mesh.frame_count, x, y, z, radius, near);
  }

  /// True if the sphere can touch no triangle in the step.
  template <class Sphere>
  COLLIDE_HD bool empty(Sphere const& shape) const {
    COLLIDE_NO_UNROLL
    for (int k = mesh.first_frame; k < mesh.frame_count; ++k) {
      if (!is_empty_in(k, shape)) return false;
    }
    return true;
  }

  /// True if a sphere can touch no body that moves in the step, neither when it begins nor when it ends.
  template <class Sphere>
  COLLIDE_HD bool misses_moving_bodies(Sphere const& shape) const {
    COLLIDE_NO_UNROLL
    for (int k = 1; k < mesh.frame_count; ++k) {
      if (!mesh.frames[k].moves) continue;
      if (!is_empty_in(k, shape) || !whole.empty(mesh.seen_from_start(k, shape))) return false;
    }
    return true;
  }

  template <class Sphere>
  COLLIDE_HD body_cursor begin(Sphere const&) const {
    return {{0, 0, 0, 0}, mesh.first_frame, 0, false, mesh.size() == 0};
  }

  /// `fraction` is how much of the step is over.
  template <class Sphere>
  COLLIDE_HD bool next(Sphere const& shape, double fraction, body_cursor& c, std::uint32_t max_count,
                       candidate_range& range) const {
    COLLIDE_NO_UNROLL
    for (; !c.ended && c.frame < mesh.frame_count; ++c.frame, c.has_begun = false) {
      if (is_far(c.frame, shape)) continue;
      Sphere const seen = mesh.seen_from(c.frame, shape, fraction);
      if (!c.has_begun) static_cast<candidate_cursor&>(c) = whole.begin(seen);
      c.has_begun = true;
      if (!whole.next(seen, c, max_count, range)) continue;
      c.frame_of_last = c.frame;
      if (static_cast<candidate_cursor&>(c).at_end()) skip_far(c, shape);
      return true;
    }
    c.ended = true;
    return false;
  }

  /// `around` is in the triangle's frame.
  COLLIDE_HD_INLINE bool near(sphere<S> const& around, id triangle) const { return whole.near(around, triangle); }

 private:
  template <class Sphere>
  COLLIDE_HD_INLINE bool is_far(int frame, Sphere const& shape) const {
    return mesh.frames[frame].is_far(shape.centre, shape.radius, path_length(shape));
  }

  template <class Sphere>
  COLLIDE_HD_INLINE bool is_empty_in(int frame, Sphere const& shape) const {
    return is_far(frame, shape) || whole.empty(mesh.seen_from(frame, shape, 0));
  }

  /// Goes on to the next frame that may have more.
  template <class Sphere>
  COLLIDE_HD_INLINE void skip_far(body_cursor& c, Sphere const& shape) const {
    c.has_begun = false;
    do ++c.frame;
    while (c.frame < mesh.frame_count && is_far(c.frame, shape));
    c.ended = c.frame == mesh.frame_count;
  }
};

template <class Triangles>
inline constexpr bool has_moving_mesh = false;
template <class S, class Triangles>
inline constexpr bool has_moving_mesh<bodies_ref<S, Triangles>> = true;

/// A sphere in the frame of a body at the end of the step; 0 is that of what rests.
template <class Triangles, class S>
COLLIDE_HD_INLINE sphere<S> seen_from([[maybe_unused]] Triangles const& open, [[maybe_unused]] int frame,
                                      sphere<S> const& s) {
  if constexpr (has_moving_mesh<Triangles>) return open.mesh.seen_from(frame, s, 1);
  return s;
}

/// The body of a triangle: 0 of what rests.
template <class Triangles>
COLLIDE_HD_INLINE int frame_in([[maybe_unused]] Triangles const& open, [[maybe_unused]] id triangle) {
  if constexpr (has_moving_mesh<Triangles>) return open.mesh.frame_of(triangle);
  return 0;
}

/// The next candidates of a sphere at the end of the step. False if there are none.
template <class Triangles, class S, class Cursor>
COLLIDE_HD_INLINE bool next_range(Triangles const& open, sphere<S> const& s, Cursor& cursor, candidate_range& range) {
  constexpr std::uint32_t max_count = 1u << 30;
  if constexpr (has_moving_mesh<Triangles>) {
    return open.next(s, 1, cursor, max_count, range);
  } else {
    return open.next(s, cursor, max_count, range);
  }
}

}  // namespace collide::detail
