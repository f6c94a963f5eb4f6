/// \file
/// For those who write a broad phase or an execution space: names that stay. See docs/development/extending.md.
#pragma once

#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>

#include <collide/broad/detail/per_sphere.hpp>
#include <collide/core/memory.hpp>
#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/exact/detail/geometry/bounding_sphere.hpp>
#include <collide/query/detail/candidate_pipeline.hpp>
#include <collide/spaces/atomic_add.hpp>
#include <collide/spaces/detail/atomic.hpp>
#include <collide/spaces/detail/block.hpp>
#include <collide/spaces/detail/tuning.hpp>

namespace collide {

namespace detail {

/// True for an index that is made of what the host alone can read.
COLLIDE_MEMBER_OR(is_host_only, host_only, false)

}  // namespace detail

/// A block of one thread, for spaces whose threads do not work together: `Items` items, and `HitCapacity` hits that are
/// gathered before they go to the sink. spaces/detail/block.hpp says what a block has.
template <int Items, int HitCapacity>
using serial_block = detail::serial_block<Items, HitCapacity>;

/// How many blocks cover `n` items of a kernel functor: each thread of a block has `Block::items` of them.
using detail::grid_size;

/// From candidates to hits, in a kernel of one's own: `reset(storage, thread)` first, by each thread;
/// `push(block, storage, {sphere, triangle}, sphere value)` for each candidate; `drain_if_full(block, storage)` by the
/// whole block, after each thread had at most as many candidates as the storage was made for; `drain(block, storage)`
/// last. Made as `{mesh, spheres, output}`.
template <class S, class NarrowPhase, class Output>
using candidate_pipeline = detail::candidate_pipeline<S, NarrowPhase, Output>;

/// The memory of a `candidate_pipeline`, a member of the kernel's scratch memory.
template <class Block, int CandidatesPerThread = 1>
using pipeline_storage = detail::pipeline_storage<Block, CandidatesPerThread>;

/// A conservative sphere around a triangle; no sphere reaches that of a triangle that is not finite.
template <class S>
class bounding_sphere {
 public:
  /// A sphere that is not set: assign one before it is used.
  bounding_sphere() = default;
  /// The sphere around `t`.
  COLLIDE_HD explicit bounding_sphere(triangle<S> const& t) : sphere_(detail::bounding_sphere_of(t)) {}

  /// True if the sphere can touch the triangle. Rounding never makes it false.
  COLLIDE_HD bool is_reached_by(sphere<S> const& s) const { return sphere_.overlaps(s.centre, s.radius); }

 private:
  detail::bounding_sphere<S> sphere_;
};

/// An axis-aligned box with room for rounding, see `conservative`.
template <class S>
struct conservative_box {
  S lower[3];  ///< the lowest coordinates
  S upper[3];  ///< the highest coordinates

  /// True if the boxes have a point in common. O(1).
  COLLIDE_HD bool overlaps(conservative_box const& other) const {
    bool meets = true;
    for (int k = 0; k < 3; ++k) meets = meets && lower[k] <= other.upper[k] && other.lower[k] <= upper[k];
    return meets;
  }
};

namespace detail {

/// A box, larger by a length on all sides, and by the rounding of that.
template <class S>
COLLIDE_HD_INLINE conservative_box<S> inflated(aabb<S> const& b, S by) {
  conservative_box<S> c;
  for (int k = 0; k < 3; ++k) {
    constexpr S slack = 4 * ieee_traits<S>::unit_roundoff;
    c.lower[k] = b.lower[k] - by - slack * ((b.lower[k] < 0 ? -b.lower[k] : b.lower[k]) + by);
    c.upper[k] = b.upper[k] + by + slack * ((b.upper[k] < 0 ? -b.upper[k] : b.upper[k]) + by);
  }
  return c;
}

}  // namespace detail

/// The box around a sphere, inflated such that it overlaps that of each triangle that a built-in narrow phase accepts
/// for the sphere: R3 in docs/development/numerics.md. A NaN or negative radius overlaps nothing. O(1).
template <class S>
COLLIDE_HD conservative_box<S> conservative(sphere<S> const& s) {
  S const nan = std::numeric_limits<S>::quiet_NaN(), r = detail::is_valid_radius(s.radius) ? s.radius : nan;
  detail::aabb<S> const centre{{s.centre.x(), s.centre.y(), s.centre.z()}, {s.centre.x(), s.centre.y(), s.centre.z()}};
  return detail::inflated(centre, detail::triangle_aabb<S>::padded_radius(r));
}

/// The box around a triangle, inflated likewise. That of a triangle that is not finite overlaps that of no finite
/// sphere. O(1).
template <class S>
COLLIDE_HD conservative_box<S> conservative(triangle<S> const& t) {
  detail::triangle_aabb<S> const b = detail::triangle_aabb_of(t);
  constexpr S far = std::numeric_limits<S>::infinity();
  if (b.is_empty()) return {{far, far, far}, {-far, -far, -far}};
  return detail::inflated<S>(b, b.padding);
}

/// Broad phase made of one that only enumerates: for all spaces, spheres at rest and moving ones, and simulations.
///
/// `Policy` holds the options, and a class template `index<S>` with
///   - `build(space, options, mesh)`, for every mesh that is not empty;
///   - `ref() const`: a trivially copyable value with a const member `template <class F> void
///     for_each_candidate(sphere<S>, F f)` that calls f(triangle) for all that the sphere could touch, each once. It
///     runs where the space is, so it is `COLLIDE_HD`. For a sphere that moves it is called with a sphere around all of
///     its motion, unless it takes a `moving_sphere<S>` too;
///   - `refit(space, options, mesh)`, if it has one: see `detector::refit`;
///   - `static constexpr bool host_only`, if there is one: true if `build` reads the mesh on the host. A detector in a
///     space whose memory the host cannot read then does not compile.
///
/// A query takes O(spheres * enumeration). In spaces with threads that work together an enumeration is made for every 8
/// candidates of a sphere, in simulations for every candidate, unless the value can go on where it was left. Then it
/// has also
///   - `begin(sphere<S>) const`: a trivially copyable value of at most 12 bytes, with a default constructor, that says
///     how far the candidates of the sphere have been gone through;
///   - `next(sphere<S>, value&, id& triangle) const`: gives the next candidate, or returns false if there is none.
///
/// For the sinks `nearest`, `contains` and `signed_distance` it has
///   - `for_each_nearer(vec3<S> point, S bound, F f) const`, which calls bound = f(triangle) for all triangles whose
///     squared distance from the point is at most `bound`, and for others as it likes. The bound only falls: to begin
///     with what is near saves most;
///   - `for_each_on_ray(vec3<S> point, F f) const`, which calls f(triangle) for all triangles whose box the ray from
///     the point along +z meets, each once, and for others as it likes, as long as that returns true.
template <class Policy>
struct per_sphere {
  Policy policy{};  ///< its options

  template <class S>
  class index {
    using policy_index = typename Policy::template index<S>;

   public:
    template <class Space>
    void build(Space& space, per_sphere const& options, mesh_view<S> mesh) {
      using ref_type = decltype(index_.ref());
      static_assert(!detail::is_host_only<policy_index> || Space::host_accessible,
                    "collide: this per_sphere policy is host_only: its index reads the mesh on the host, which in this "
                    "space cannot be read there");
      static_assert(std::is_trivially_copyable<ref_type>::value && std::is_default_constructible<ref_type>::value,
                    "collide: what ref() of a per_sphere policy returns is a trivially copyable value, and has a "
                    "default constructor");
      static_assert(detail::enumerates_candidates_of<ref_type, sphere<S>>::value,
                    "collide: what ref() of a per_sphere policy returns has a const member "
                    "for_each_candidate(sphere<S>, f)");
      mesh_ = mesh;
      index_.build(space, options.policy, mesh);
    }

    /// Moves to a mesh that has deformed, if the policy's index can.
    template <class Space, class Index = policy_index>
    auto refit(Space& space, per_sphere const& options, mesh_view<S> mesh)
        -> decltype(std::declval<Index&>().refit(space, options.policy, mesh)) {
      mesh_ = mesh;
      index_.refit(space, options.policy, mesh);
    }

    template <class Space, class RadiusOrSpheres>
    void prepare(Space&, per_sphere const&, RadiusOrSpheres const&) {}

    template <class NarrowPhase, class Space, class Output>
    void query(Space& space, detail::sphere_view_for<NarrowPhase, S> const& spheres, Output const& output) const {
      using ref_type = decltype(index_.ref());
      using shared = detail::per_sphere_query<S, NarrowPhase, Output, ref_type>;
      using batched = detail::batched_per_sphere_query<S, NarrowPhase, Output, ref_type>;
      constexpr bool batches = Space::host_accessible && Space::template block<batched>::num_threads == 1;
      std::conditional_t<batches, batched, shared> const kernel{{mesh_, spheres, output}, index_.ref()};
      space.launch(detail::grid_size<Space>(spheres.size(), kernel), kernel);
    }

    /// The triangles near a single sphere, for a kernel of a simulation; valid until the next build.
    auto mesh_lookup() const {
      return detail::per_sphere_ref<S, decltype(index_.ref())>{{mesh_, nullptr}, index_.ref()};
    }

    /// A tree for winding numbers, if the policy has one.
    template <class Space, class Index = policy_index>
    auto windings(Space& space) -> decltype(std::declval<Index&>().windings(space)) {
      return index_.windings(space);
    }

    /// An order in which points search faster, or null, if the policy has one, and room for it.
    template <class Space, class Searched, class Index = policy_index>
    auto search_order(Space& space, sphere_view<S> const& spheres, Searched const& searched)
        -> decltype(std::declval<Index&>().search_order(space, spheres, searched)) {
      return index_.search_order(space, spheres, searched);
    }
    template <class Space, class Index = policy_index>
    auto reserve(Space& space, std::size_t spheres) -> decltype(std::declval<Index&>().reserve(space, spheres)) {
      index_.reserve(space, spheres);
    }

    /// A reference for kernels to the triangles near a point, see `nearest`; valid until the next build.
    auto ref() const { return index_.ref(); }

    template <class Space>
    double cell_width(Space&) const {
      return 0;
    }

   private:
    mesh_view<S> mesh_;
    policy_index index_;
  };
};

}  // namespace collide
