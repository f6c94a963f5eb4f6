/// \file
/// A mesh with parts that move: frames in which these rest, and how particles and contacts look from there.
///
/// Within a step a body moves along the screw that leads from one pose to another (M. Chasles), the angle as on the
/// chord of the quaternions: so what turns around a point does not leave it, wherever the origin of the mesh is. A
/// particle's path in a body's frame is the straight line from where it begins to where it ends there. So it is exact
/// for bodies that shift, and off by at most the sagitta of the arc for bodies that turn; but in a body's frame what
/// moves never jumps.
#pragma once

#include <cstdint>

#include <collide/effects/bodies.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/mesh.hpp>

namespace collide::detail {

COLLIDE_HD_INLINE vec3<double> vector_of(double const* x) { return {x[0], x[1], x[2]}; }

/// A pose as arithmetic has it.
struct frame_pose {
  vec3<double> position;
  double w;
  vec3<double> axis;

  COLLIDE_HD_INLINE vec3<double> rotated(vec3<double> const& x) const {
    vec3<double> const twice = scaled(cross(axis, x), 2.0);
    return x + scaled(twice, w) + cross(axis, twice);
  }
  COLLIDE_HD_INLINE vec3<double> rotated_back(vec3<double> const& x) const {
    vec3<double> const twice = scaled(cross(axis, x), 2.0);
    return x - scaled(twice, w) + cross(axis, twice);
  }
  COLLIDE_HD_INLINE vec3<double> to_world(vec3<double> const& x) const { return position + rotated(x); }
  COLLIDE_HD_INLINE vec3<double> to_local(vec3<double> const& x) const { return rotated_back(x - position); }
  COLLIDE_HD_INLINE bool operator==(frame_pose const& o) const {
    return position == o.position && w == o.w && axis == o.axis;
  }
};

COLLIDE_HD_INLINE frame_pose frame_pose_of(pose const& p) {
  return {vector_of(p.position), p.rotation[0], vector_of(p.rotation + 1)};
}

/// The pose at a fraction of the motion from one to another.
COLLIDE_HD_INLINE frame_pose between(frame_pose const& a, frame_pose const& b, double t) {
  double const same = mul_rn(a.w, b.w) + dot(a.axis, b.axis) < 0 ? -1.0 : 1.0, s = 1 - t;
  double const w = mul_rn(s, a.w) + mul_rn(mul_rn(t, same), b.w);
  vec3<double> const axis = scaled(a.axis, s) + scaled(b.axis, mul_rn(t, same));
  double const squared = mul_rn(w, w) + dot(axis, axis), length = sqrt_rn(squared);
  vec3<double> const unit(div_rn(axis.x(), length), div_rn(axis.y(), length), div_rn(axis.z(), length));
  // the rotation from b back to a, half of which turns what the body moves across its axis
  double const back = mul_rn(same, mul_rn(a.w, b.w) + dot(a.axis, b.axis));
  vec3<double> const turn = scaled(scaled(a.axis, b.w) - scaled(b.axis, a.w) - cross(a.axis, b.axis), mul_rn(same, s));
  double const turn_squared = dot(turn, turn);
  vec3<double> const shift = b.position - a.position;
  vec3<double> const along = scaled(turn, turn_squared > 0 ? div_rn(dot(shift, turn), turn_squared) : 0.0);
  vec3<double> const across = shift - along, turned = scaled(across, mul_rn(s, back) + t) + cross(turn, across);
  return {a.position + scaled(turned, div_rn(t, squared)) + scaled(along, t), div_rn(w, length), unit};
}

/// The velocity of what is at `x` in a body with this pose.
COLLIDE_HD_INLINE vec3<double> velocity_at(twist const& t, frame_pose const& p, vec3<double> const& x) {
  return vector_of(t.linear) + cross(vector_of(t.angular), vec3<double>(x - p.position));
}

/// A body in a step. Number 0 of a mesh is what rests.
template <class S>
struct body_frame {
  frame_pose before, now;  ///< when the step begins, and ends
  twist moved, moving;     ///< its twists at these times
  vec3<double> conveyor_velocity;
  vec3<S> centre;     ///< of a bounding sphere of the body when the step begins; if not `swept`, when it ends
  S reach;            ///< no particle of radius r that moves by d can touch the body in the step if `shrink` times its
  S shrink;           ///< distance from the centre is above reach + r + d
  uint_for<S> moves;  ///< not 0: in this step. So large that no byte of a checkpoint is padding

  template <class Vector>
  COLLIDE_HD_INLINE bool is_far(Vector const& x, S r, S path) const {
    S const at_least = reach + r + path;
    vec3<S> const apart = x - centre;
    return shrink > 0 && mul_rn(dot(apart, apart), mul_rn(shrink, shrink)) > mul_rn(at_least, at_least);
  }
};

/// A mesh of which bodies are parts. Its triangles are in the frames of their bodies.
template <class S>
struct moving_mesh : mesh_view<S> {
  body_frame<S> const* frames;
  std::uint8_t const* frame_numbers;  ///< of each triangle
  S const* vertex_velocities;         ///< of what is in no body, if that deforms, else null
  int first_frame, frame_count;       ///< frames from the first that has triangles to before the last number
  S dt;                               ///< of the step

  moving_mesh() = default;
  moving_mesh(mesh_view<S> const& mesh, body_frame<S> const* f, std::uint8_t const* numbers, S const* velocities,
              int first, int count, S step)
      : mesh_view<S>(mesh),
        frames{f},
        frame_numbers{numbers},
        vertex_velocities{velocities},
        first_frame{first},
        frame_count{count},
        dt{step} {}

  COLLIDE_HD_INLINE int frame_of(id triangle) const { return frame_numbers[triangle]; }

  /// The velocity of a point of a triangle that deforms, of those of its corners.
  COLLIDE_HD_INLINE vec3<double> velocity_of(id triangle, vec3<S> const& point) const {
    auto const t = (*this)[triangle];
    vec3<double> const a = t.a.template cast<double>();
    vec3<double> const ab = t.b.template cast<double>() - a, ac = t.c.template cast<double>() - a;
    vec3<double> const to_point = point.template cast<double>() - a, normal = cross(ab, ac);
    double const area = dot(normal, normal);
    auto const fraction = [&](vec3<double> const& opposite) {
      double const p = area > 0 ? div_rn(dot(opposite, normal), area) : 0;
      return p > 0 ? min(p, 1.0) : 0.0;
    };
    double const b = fraction(cross(to_point, ac)), c = fraction(cross(ab, to_point));
    auto const of_corner = [&](unsigned k) {
      S const* const v = vertex_velocities + 3 * this->corner(triangle, k);
      return vec3<double>(static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2]));
    };
    return scaled(of_corner(0), max(1 - b - c, 0.0)) + scaled(of_corner(1), b) + scaled(of_corner(2), c);
  }

  COLLIDE_HD_INLINE frame_pose pose_at(int frame, double fraction) const {
    body_frame<S> const& f = frames[frame];
    return fraction <= 0 ? f.before : fraction >= 1 ? f.now : between(f.before, f.now, fraction);
  }

  /// A sphere as a body sees it at the end of the step.
  COLLIDE_HD_INLINE sphere<S> seen_from(int frame, sphere<S> const& s, double) const {
    if (frame == 0) return s;
    return {rounded_to<S>(frames[frame].now.to_local(s.centre.template cast<double>())), s.radius};
  }
  /// A sphere as a body sees it at the beginning of the step; of one that moves, the whole path.
  COLLIDE_HD_INLINE sphere<S> seen_from_start(int frame, sphere<S> const& s) const {
    return {rounded_to<S>(frames[frame].before.to_local(s.centre.template cast<double>())), s.radius};
  }
  COLLIDE_HD_INLINE moving_sphere<S> seen_from_start(int frame, moving_sphere<S> const& s) const {
    return seen_from(frame, s, 0);
  }
  /// A sphere that moves for the rest of the step from a part of it on, as a body sees it.
  COLLIDE_HD_INLINE moving_sphere<S> seen_from(int frame, moving_sphere<S> const& s, double fraction) const {
    if (frame == 0) return s;
    vec3<double> const begin = s.centre.template cast<double>(), displacement = s.displacement.template cast<double>();
    vec3<double> const from = pose_at(frame, fraction).to_local(begin);
    vec3<double> const to = frames[frame].now.to_local(begin + displacement);
    return {{rounded_to<S>(from), s.radius}, rounded_to<S>(to - from)};
  }

  /// A point of a body's frame, where it is in the world at a part of the step.
  COLLIDE_HD_INLINE vec3<S> in_world(int frame, vec3<S> const& x, double fraction) const {
    return frame == 0 ? x : rounded_to<S>(pose_at(frame, fraction).to_world(x.template cast<double>()));
  }

  /// A contact in a body's frame at a part of the step, as it is in the world.
  COLLIDE_HD_INLINE void to_world(contact<S>& c, int frame, double fraction) const {
    if (frame == 0) return;
    frame_pose const p = pose_at(frame, fraction);
    c.point = rounded_to<S>(p.to_world(c.point.template cast<double>()));
    c.normal = rounded_to<S>(p.rotated(c.normal.template cast<double>()));
  }
};

template <class Mesh>
inline constexpr bool is_moving_mesh = false;
template <class S>
inline constexpr bool is_moving_mesh<moving_mesh<S>> = true;

}  // namespace collide::detail
