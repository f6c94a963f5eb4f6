/// \file
/// The bodies of a simulation's mesh in memory of a space, and the kernels that move them.
#pragma once

#include <string>
#include <vector>

#include <collide/core/memory.hpp>
#include <collide/effects/detail/host_members.hpp>
#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/simulation/detail/bodies/bodies_ref.hpp>
#include <collide/spaces/detail/atomic.hpp>

namespace collide::detail {

struct body_record {
  body_motion motion;
  vec3<double> centre;  ///< of its bounding sphere, in its frame
  double radius;
};

/// The box of a body's triangles, as ordered bits; memory of zeros is that of none. See `mesh_statistics`.
template <class S>
struct body_box {
  uint_for<S> lower[3], upper[3];
};

/// Kernel functor of `for_each` over groups of triangles: adds them to the boxes of their bodies.
template <class S>
struct bound_bodies {
  static constexpr std::size_t group = 64;

  mesh_view<S> mesh;
  std::uint8_t const* frame_numbers;
  body_box<S>* boxes;

  COLLIDE_HD void operator()(std::size_t g) const {
    std::size_t i = g * group;
    std::size_t const end = min(i + group, mesh.size());
    while (i < end) {
      std::uint8_t const frame = frame_numbers[i];
      aabb<S> all = aabb<S>::empty();
      for (; i < end && frame_numbers[i] == frame; ++i) {
        triangle_aabb<S> const b = triangle_aabb_of(mesh[i]);
        if (!b.is_empty()) all = typename aabb<S>::merge{}(all, b);
      }
      if (all.is_empty()) continue;
      for (int k = 0; k < 3; ++k) {
        fetch_max(&boxes[frame].lower[k], static_cast<uint_for<S>>(~to_ordered_bits(all.lower[k])));
        fetch_max(&boxes[frame].upper[k], to_ordered_bits(all.upper[k]));
      }
    }
  }
};

/// Makes the rotation's length 1. False if it is not nearly that, or something is not finite.
COLLIDE_HD_INLINE bool make_unit(body_state& s) {
  double(&q)[4] = s.at.rotation;
  double const squared = mul_rn(q[0], q[0]) + mul_rn(q[1], q[1]) + mul_rn(q[2], q[2]) + mul_rn(q[3], q[3]);
  bool sound = is_finite(squared) && squared > 1 - 1e-4 && squared < 1 + 1e-4;
  for (int k = 0; k < 3; ++k) {
    sound = sound && is_finite(s.at.position[k]) && is_finite(s.moving.linear[k]) && is_finite(s.moving.angular[k]) &&
            is_finite(s.belt[k]);
  }
  if (!sound) return false;
  double const length = sqrt_rn(squared);
  for (double& c : q) c = div_rn(c, length);
  return true;
}

/// |R x - x| / |x| of the rotation from one pose to another.
COLLIDE_HD_INLINE double turn_between(frame_pose const& a, frame_pose const& b) {
  // the sine of half the angle between the two: from its cosine, small angles would be lost
  return 2 * length_of<double>(scaled(b.axis, a.w) - scaled(a.axis, b.w) - cross(a.axis, b.axis));
}

/// Kernel functor of `for_each` over bodies: where each is at the end of the step, or, if it `starts`, now.
template <class S, class Motion>
struct advance_bodies {
  body_record const* records;
  body_state* states;
  body_frame<S>* frames;
  float_frame<S>* quick;
  body_report* report;
  double const* time;
  double dt;
  Motion motion;
  S limit;  ///< a body may move by in a step: the radius of the smallest particle
  bool swept;
  bool starts, is_placed;  ///< `before` the step it was not where it was told to be last

  COLLIDE_HD void operator()(std::size_t i) const {
    body_state s = state_at(i, *time + dt);
    body_frame<S>& f = frames[i + 1];
    if (!make_unit(s)) {
      fetch_add(&report->refused_poses, 1u);
      s = at_rest(f.now);
    }
    states[i] = s;
    frame_pose const now = frame_pose_of(s.at);
    f.before = is_placed ? f.now : now;
    f.moved = is_placed ? f.moving : s.moving;
    f.now = now;
    f.moving = s.moving;
    f.conveyor_velocity = vector_of(s.belt);
    bound(f, records[i]);
    if (!swept) quick[i + 1] = float_frame<S>::of(f);
  }

 private:
  COLLIDE_HD_INLINE body_state state_at(std::size_t i, [[maybe_unused]] double at) const {
    if constexpr (std::is_same<Motion, driven>::value) {
      return states[i];
    } else if constexpr (std::is_same<Motion, body_motion>::value) {
      return records[i].motion(at);
    } else {
      return motion(i, at);
    }
  }

  static COLLIDE_HD_INLINE body_state at_rest(frame_pose const& at) {
    body_state s;
    s.at.rotation[0] = at.w;
    for (int k = 0; k < 3; ++k) {
      s.at.position[k] = at.position[k];
      s.at.rotation[k + 1] = at.axis[k];
    }
    return s;
  }

  /// The bounding sphere of a body, and how far it moves.
  COLLIDE_HD_INLINE void bound(body_frame<S>& f, body_record const& r) const {
    constexpr double eps = std::numeric_limits<S>::epsilon();
    vec3<double> const shift = f.now.position - f.before.position;
    double const turned = turn_between(f.before, f.now);
    double const shifted = length_of(shift), moved = shifted + mul_rn(turned, length_of(r.centre));
    vec3<double> const from = f.before.to_world(r.centre), to = f.now.to_world(r.centre), by = to - from;
    f.moves = !(f.before == f.now) || dot(f.conveyor_velocity, f.conveyor_velocity) > 0 ? 1 : 0;
    f.centre = rounded_to<S>(swept ? from : to);
    double const reach = swept ? r.radius + 2 * moved : r.radius;
    // squares of what is smaller lose digits, or vanish
    double const tiny = 16 * sqrt_rn(static_cast<double>(std::numeric_limits<S>::min()));
    f.reach = static_cast<S>(mul_rn(reach, 1 + 1e-5) + mul_rn(16 * eps, length_of(from) + length_of(to)) + tiny);
    f.shrink = static_cast<S>(swept ? 1 - 1e-5 - turned : 1 - 1e-5);
    if (starts) return;
    double const radius = static_cast<double>(limit);
    if (!swept && length_of(by) + mul_rn(turned, r.radius) > radius) fetch_add(&report->fast_steps, 1u);
    double const units = turned > 1.5 ? 2048 : 512;
    bool const is_rough = mul_rn(units * eps, length_of(from) + length_of(to) + r.radius) > radius;
    if (swept && is_rough && turned > 0.05) fetch_add(&report->rough_steps, 1u);
  }
};

/// The bodies of a simulation's mesh.
template <class S, class Motion>
class body_memory {
 public:
  using motion = Motion;
  static constexpr bool exist = true;

  /// States of the bodies in memory of the space: poses at the end of the last step. With `moving_bodies<driven>`
  /// kernels of yours write there, before a step, what is to be at its end. Valid until the next `set_mesh`.
  body_state* states() const { return states_.data(); }
  /// How many bodies there are.
  std::size_t size() const { return count_; }

  /// A copy of the states. Waits.
  template <class Space>
  std::vector<body_state> to_host(Space const& space) const {
    std::vector<body_state> copy(count_);
    if (count_ != 0) space.copy_to_host(copy.data(), states_.data(), count_);
    return copy;
  }

  /// The report of what has gone wrong since `set_mesh`. Waits.
  template <class Space>
  body_report report(Space const& space) const {
    return report_.data() != nullptr ? space.read(report_.data()) : body_report();
  }

  /// f(name, elements, number of them) for what steps leave in memory of the space.
  template <class F>
  void for_each_saved(F const& f) const {
    std::size_t const made = frames_.data() != nullptr ? 1 : 0;
    f("poses of bodies", states_.data(), count_);
    f("frames of bodies", frames_.data(), count_ + made);
    f("report on bodies", report_.data(), made);
  }

  /// Bytes of memory of the space.
  std::size_t bytes() const {
    return numbers_.bytes() + boxes_.bytes() + records_.bytes() + states_.bytes() + frames_.bytes() + quick_.bytes() +
           report_.bytes();
  }

  /// Throws `error` unless these can be bodies of a mesh of so many triangles. `call`: what gets them, for messages.
  static void check(std::vector<body> const& bodies, std::size_t triangles, S const*, char const* call = "set_mesh") {
    constexpr std::size_t limit = moving_bodies<Motion>::max_bodies;
    if (bodies.size() > limit) throw error("collide: " + std::string(call) + ": there are more than 64 bodies");
    std::vector<bool> taken(triangles);
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      body const& b = bodies[k];
      std::string const name = "collide: " + std::string(call) + ": body " + std::to_string(k);
      if (b.first > triangles || b.size > triangles - b.first)
        throw error(name + " has triangles that the mesh does not have");
      for (std::size_t i = b.first; i < b.first + b.size; ++i) {
        if (taken[i]) throw error(name + " has a triangle of another body: " + std::to_string(i));
        taken[i] = true;
      }
      if (!is_finite_motion(b.motion)) throw error(name + " has a motion that is not finite");
    }
  }

  /// Takes over the bodies of a mesh, which `check` has let through. Waits.
  template <class Space>
  void build(Space& space, mesh_view<S> const& mesh, std::vector<body> const& bodies, S const* velocities) {
    auto* const resource = space.resource();
    vertex_velocities_ = velocities;
    count_ = bodies.size();
    std::size_t const frames = count_ + 1;
    auto* const numbers = numbers_.reserve(resource, mesh.size());
    space.fill(numbers, 0, mesh.size());
    std::size_t moving = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      space.fill(numbers + bodies[k].first, static_cast<unsigned char>(k + 1), bodies[k].size);
      moving += bodies[k].size;
    }
    auto* const boxes = boxes_.reserve(resource, frames);
    space.fill(boxes, 0, frames * sizeof *boxes);
    std::size_t const groups = (mesh.size() + bound_bodies<S>::group - 1) / bound_bodies<S>::group;
    space.for_each(groups, bound_bodies<S>{mesh, numbers, boxes});
    std::vector<body_box<S>> found(frames);
    space.copy_to_host(found.data(), boxes, frames);
    std::vector<body_record> records;
    for (std::size_t k = 0; k < count_; ++k) records.push_back(record_of(bodies[k], found[k + 1]));
    std::vector<body_frame<S>> at_rest(
        frames, body_frame<S>{
                    identity(), identity(), {}, {}, {0, 0, 0}, {0, 0, 0}, std::numeric_limits<S>::infinity(), S(0), 0});
    std::vector<float_frame<S>> quick(frames, float_frame<S>::at_rest());
    for (std::size_t k = 1; k < frames; ++k) quick[k].slack = std::numeric_limits<S>::infinity();  // not known yet
    double extent = 0;
    for (body_record const& r : records) extent = max(extent, length_of(r.centre) + r.radius);
    margin_ = float_frame_margin<S>(extent);
    std::vector<body_state> const states(count_);
    marked_.resize(count_);
    space.copy_from_host(records_.reserve(resource, count_), records.data(), count_);
    space.copy_from_host(states_.reserve(resource, count_), states.data(), count_);
    space.copy_from_host(frames_.reserve(resource, frames), at_rest.data(), frames);
    space.copy_from_host(quick_.reserve(resource, frames), quick.data(), frames);
    space.fill(report_.reserve(resource, 1), 0, sizeof(body_report));
    space.synchronize();  // the vectors go
    first_ = moving == mesh.size() ? 1 : 0;
    is_placed_ = false;
  }

  /// Moves the bodies to where they are `dt` later; see `advance_bodies`.
  template <class Space>
  void advance(Space& space, Motion const& of_all, double const* time, double dt, S limit, bool swept, bool starts) {
    if (count_ == 0) return;
    bool const is_placed = is_placed_ && !starts;
    is_placed_ = !(starts && are_driven());
    space.for_each(count_,
                   advance_bodies<S, Motion>{records_.data(), states_.data(), frames_.data(), quick_.data(),
                                             report_.data(), time, dt, of_all, limit, swept, starts, is_placed});
  }

  template <class Triangles>
  bodies_ref<S, Triangles> ref(Triangles const& whole, mesh_view<S> const& mesh, S dt) const {
    return {whole, moving(mesh, dt), {quick_.data(), margin_}};
  }

  /// The mesh, for kernels, with the frames of its bodies.
  moving_mesh<S> moving(mesh_view<S> const& mesh, S dt) const {
    return {mesh, frames_.data(), numbers_.data(), vertex_velocities_, first_, static_cast<int>(count_) + 1, dt};
  }

  /// True if bodies have begun where the caller drives them.
  bool are_placed() const { return is_placed_; }
  void place(bool placed) { is_placed_ = placed; }

  /// True if the caller says where they are.
  static constexpr bool are_driven() { return std::is_same<Motion, driven>::value; }

  /// On the host: keeps where bodies are.
  void mark() {
    for (std::size_t k = 0; k < count_; ++k) marked_[k] = frames_.data()[k + 1].now;
  }
  /// On the host: how far a point of a body may be from where it was at the last `mark`.
  double moved() const {
    double farthest = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      frame_pose const &before = marked_[k], &now = frames_.data()[k + 1].now;
      body_record const& r = records_.data()[k];
      double const shifted = length_of<double>(now.to_world(r.centre) - before.to_world(r.centre));
      farthest = max(farthest, shifted + turn_between(before, now) * r.radius);
    }
    return farthest;
  }

  /// How much larger than the particles' the radius is that the mesh is to be indexed for.
  S margin() const { return margin_; }

 private:
  static frame_pose identity() { return {{0, 0, 0}, 1, {0, 0, 0}}; }

  static bool is_finite_motion(body_motion const& m) {
    bool finite = is_finite(m.rate) && is_finite(m.swing) && is_finite(m.frequency) && is_finite(m.phase);
    for (int k = 0; k < 3; ++k) {
      finite = finite && is_finite(m.pivot[k]) && is_finite(m.velocity[k]) && is_finite(m.axis[k]) &&
               is_finite(m.amplitude[k]) && is_finite(m.belt[k]);
    }
    return finite;
  }

  static body_record record_of(body const& b, body_box<S> const& box) {
    body_record r{b.motion, {0, 0, 0}, 0};
    if (box.upper[0] == 0) return r;  // nothing that could be touched
    vec3<double> half;
    for (int k = 0; k < 3; ++k) {
      double const lower = static_cast<double>(from_ordered_bits<S>(static_cast<uint_for<S>>(~box.lower[k])));
      double const upper = static_cast<double>(from_ordered_bits<S>(box.upper[k]));
      r.centre[k] = lower / 2 + upper / 2;
      half[k] = upper / 2 - lower / 2;
    }
    r.radius = length_of(half);
    return r;
  }

  std::size_t count_ = 0;
  int first_ = 0;                         ///< the first frame that has triangles: 1 if none rests
  S const* vertex_velocities_ = nullptr;  ///< of the caller
  buffer<std::uint8_t> numbers_;
  buffer<body_box<S>> boxes_;
  buffer<body_record> records_;
  buffer<body_state> states_;
  buffer<body_frame<S>> frames_;
  buffer<float_frame<S>> quick_;
  std::vector<frame_pose> marked_;
  S margin_ = 0;
  bool is_placed_ = false;  ///< of bodies that the caller drives: they have begun where the caller wants them
  buffer<body_report> report_;
};

template <class S, class... Effect>
struct bodies_of : no_bodies {};
template <class S, class Motion, class... Effect>
struct bodies_of<S, moving_bodies<Motion>, Effect...> : body_memory<S, Motion> {
  static_assert(!(is_moving_bodies<Effect> || ...),
                "collide: a simulation has one effect moving_bodies, with one kind of motion");
};
template <class S, class Other, class... Effect>
struct bodies_of<S, Other, Effect...> : bodies_of<S, Effect...> {};

}  // namespace collide::detail
