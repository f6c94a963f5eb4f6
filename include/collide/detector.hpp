/// \file
/// The detector: broad phase x narrow phase x execution space, composed at compile time.
#pragma once

#include <type_traits>
#include <utility>

#include <collide/any_hit.hpp>
#include <collide/closest.hpp>
#include <collide/concepts.hpp>
#include <collide/contacts.hpp>
#include <collide/count.hpp>
#include <collide/detail/query/query_pass.hpp>
#include <collide/error.hpp>
#include <collide/host.hpp>
#include <collide/karabassi.hpp>
#include <collide/mesh.hpp>
#include <collide/pairs.hpp>
#include <collide/spheres.hpp>
#include <collide/visit.hpp>
#if defined(__CUDACC__)
#include <collide/cuda.cuh>
#else
#include <collide/detail/execution/cuda_without_nvcc.hpp>
#endif

namespace collide {

/// Finds all colliding (sphere, triangle) pairs of a scene.
///
/// \tparam BroadPhase      which triangles a sphere could touch: `bucket` (bucket.cuh) or `all_pairs` (all_pairs.cuh)
/// \tparam NarrowPhase     whether a sphere touches a triangle: `karabassi<Precision>`
/// \tparam ExecutionSpace  where and how it runs: `host`, `cuda`, `cuda_shared`
/// \tparam Scalar          type of the coordinates: float or double; nothing is ever narrowed silently
///
/// Memory is taken from the space's resource and kept: once everything has run with the same sizes nothing is allocated
/// (on the host that takes two queries, as the second may go another way; see docs/design.md). `reserve` takes it
/// ahead, so that nothing is allocated as hits grow.
/// In the CUDA spaces work is put on the space's stream and the host waits only to read a size back (see each sink).
/// One detector is for one thread at a time. Everything thrown derives from `error`, except what the memory resource
/// throws.
template <class BroadPhase, class NarrowPhase = karabassi<>, class ExecutionSpace = host, class Scalar = float>
class detector {
  static_assert(std::is_same<Scalar, float>::value || std::is_same<Scalar, double>::value,
                "collide: the fourth parameter of a detector is the type of the coordinates, float or double");
  static_assert(detail::is_execution_space<ExecutionSpace>,
                "collide: the third parameter of a detector is an execution space: host, cuda or cuda_shared");
  static_assert(
      detail::is_broad_phase<BroadPhase, Scalar>,
      "collide: the first parameter of a detector is a broad phase, such as bucket or all_pairs: a class with a "
      "member template index<Scalar>");
  static_assert(
      detail::has_intersects<NarrowPhase, Scalar, moving_sphere<Scalar>>::value,
      "collide: the second parameter of a detector is a narrow phase, such as karabassi<>: a class with a static "
      "member intersects(triangle, sphere) that returns bool");
  static_assert(detail::check_space<ExecutionSpace>());
  static_assert(detail::check_broad_phase<BroadPhase, NarrowPhase, ExecutionSpace, Scalar>());

 public:
  using broad_phase = BroadPhase;
  using narrow_phase = NarrowPhase;
  using execution_space = ExecutionSpace;
  using scalar = Scalar;
  /// `sphere_view`, or `moving_sphere_view` if the narrow phase judges spheres that move.
  using spheres_type = detail::sphere_view_for<NarrowPhase, Scalar>;

  /// Throws what making the space throws: `cuda_error` if a CUDA space finds no usable device.
  explicit detector(ExecutionSpace space = ExecutionSpace(), BroadPhase options = BroadPhase())
      : space_(std::move(space)), options_(std::move(options)) {}

  /// Prepares what depends on the mesh only. Call it before the first query, and again when the mesh has moved. The
  /// mesh's memory must stay as it is until the last query. O(triangles).
  void build(mesh_view<Scalar> mesh);

  /// Prepares what depends on the mesh, and what spheres at rest of radius up to `radius` need, so that a query has
  /// nothing left to prepare. Larger spheres are tested too, but more slowly. Many spheres that move may still want a
  /// grid of their own on the host. Throws `error` if `radius` is negative or NaN. O(triangles).
  void build(mesh_view<Scalar> mesh, Scalar radius);

  /// Makes room for queries of up to so many spheres, and in the sinks for up to so many pairs: what depends on the
  /// numbers of spheres and pairs alone is then not allocated by a query. What depends on the mesh, or on the radii, is
  /// by `build` and the first two queries.
  template <class... Sink>
  void reserve(std::size_t spheres, [[maybe_unused]] std::size_t pairs, Sink&... sinks) {
    static_assert((detail::is_valid<detail::sink_reserve, Sink, ExecutionSpace> && ...),
                  "collide: what reserve makes room in are sinks with a member reserve(space, spheres, pairs)");
    using index = typename BroadPhase::template index<Scalar>;
    if constexpr (detail::is_valid<detail::index_reserve, index, ExecutionSpace>) index_.reserve(space_, spheres);
    if constexpr (query_tuning<ExecutionSpace>::defers_exact_tests && detail::filtered_predicate<NarrowPhase>::value) {
      deferred_.reserve(space_, spheres);
    }
    (sinks.reserve(space_, spheres, pairs), ...);
  }

  /// Hands every colliding pair, exactly once, to the sink (`count`, `any_hit`, `pairs`, `contacts`, `closest`,
  /// `visit`, or one of your own). Returns the sink: by reference if it was given as an lvalue (its memory is then used
  /// again), else by value. Throws `error` if there was no `build`, or the last one failed.
  template <class Sink>
  Sink query(spheres_type const& spheres, Sink&& sink) {
    using pass = detail::query_pass<typename BroadPhase::template index<Scalar>, NarrowPhase, ExecutionSpace, Scalar>;
    static_assert(detail::is_valid<detail::sink_run, std::remove_reference_t<Sink>, ExecutionSpace, pass>,
                  "collide: the second argument of query is a sink, such as count, any_hit, pairs, contacts, closest "
                  "or visit: an "
                  "object with a member run(space, query)");
    prepare(spheres);
    sink.run(space_, pass{index_, space_, mesh_, spheres, deferred_});
    return std::forward<Sink>(sink);
  }

  /// `build(mesh)` and `query(spheres, sink)` in one call.
  template <class Mesh, class Spheres, class Sink>
  Sink detect(Mesh const& mesh, Spheres const& spheres, Sink&& sink) {
    build(mesh);
    return query(spheres, std::forward<Sink>(sink));
  }

  /// The width of the finest cells in use; 0 if there are none. In the CUDA spaces it waits for the device.
  double cell_width() const;

  // What makes no sense ends here, with a sentence instead of a list of candidates: another scalar type,
  template <class S, class = std::enable_if_t<!std::is_same<S, Scalar>::value>>
  void build(mesh_view<S>, double = 0) {
    reject<S>();
  }
  template <class S, class Sink>
  Sink query(sphere_view<S> const&, Sink&&) {
    reject<S>();
    static_assert(detail::is_discrete<NarrowPhase, Scalar>,
                  "collide: this narrow phase judges spheres that move: give query a moving_sphere_view, see "
                  "`with_displacements`");
  }
  template <class S, class Sink>
  Sink query(moving_sphere_view<S> const&, Sink&&) {
    reject<S>();
    static_assert(
        !detail::is_discrete<NarrowPhase, Scalar>,
        "collide: this narrow phase judges spheres that rest: for spheres that move there is karabassi_swept");
  }

  // and arguments of another kind, or in another order.
  template <class T, class... Radius, class = detail::if_not_made_of<mesh_view, T, mesh_view<Scalar>>>
  void build(T const&, Radius const&...) {
    static_assert(sizeof(T) == 0,
                  "collide: the first argument of build is a mesh, such as indexed_mesh or triangle_soup gives");
  }
  template <class T, class Sink, class = detail::if_not_made_of<sphere_view, T, spheres_type>,
            class = detail::if_not_made_of<moving_sphere_view, T, spheres_type>>
  Sink query(T const&, Sink&&) {
    static_assert(sizeof(T) == 0,
                  "collide: the first argument of query is spheres, such as spheres_xyz gives, and the second a sink; "
                  "a mesh goes to build");
  }

  ExecutionSpace& space() { return space_; }
  ExecutionSpace const& space() const { return space_; }

 private:
  template <class S>
  static void reject() {
    static_assert(
        std::is_same<S, Scalar>::value,
        "collide: mesh and spheres must have the scalar type of the detector, its fourth parameter: nothing is "
        "narrowed silently. For float centres and a double mesh take a detector of double and copy the centres to "
        "double, which is exact");
  }

  /// Prepares what depends on the spheres.
  void prepare(spheres_type const& spheres);

  ExecutionSpace space_;
  BroadPhase options_;
  mesh_view<Scalar> mesh_;
  bool is_built_ = false;
  typename BroadPhase::template index<Scalar> index_;
  detail::deferred_pair_buffer deferred_;
};

// What follows is not in the class, for then it would be inline, and compiled also where an `extern template` says that
// it is compiled elsewhere; see compiled.hpp.

template <class BroadPhase, class NarrowPhase, class ExecutionSpace, class Scalar>
void detector<BroadPhase, NarrowPhase, ExecutionSpace, Scalar>::build(mesh_view<Scalar> mesh) {
  mesh_ = {};
  is_built_ = false;
  if (mesh.size() != 0) index_.build(space_, options_, mesh);
  mesh_ = mesh;
  is_built_ = true;
}

template <class BroadPhase, class NarrowPhase, class ExecutionSpace, class Scalar>
void detector<BroadPhase, NarrowPhase, ExecutionSpace, Scalar>::build(mesh_view<Scalar> mesh, Scalar radius) {
  if (!(radius >= 0)) throw error("collide: detector: the radius passed to build is negative or NaN");
  build(mesh);
  if (mesh.size() != 0) index_.prepare(space_, options_, radius);
}

template <class BroadPhase, class NarrowPhase, class ExecutionSpace, class Scalar>
void detector<BroadPhase, NarrowPhase, ExecutionSpace, Scalar>::prepare(spheres_type const& spheres) {
  if (!is_built_) throw error("collide: detector: query needs a mesh: call build before it");
  if (mesh_.size() != 0 && spheres.size() != 0) index_.prepare(space_, options_, spheres);
}

template <class BroadPhase, class NarrowPhase, class ExecutionSpace, class Scalar>
double detector<BroadPhase, NarrowPhase, ExecutionSpace, Scalar>::cell_width() const {
  return mesh_.size() == 0 ? 0.0 : index_.cell_width(space_);
}

#if !defined(__CUDACC__)
/// Ends with a sentence; that it is a detector keeps the compiler from saying more.
template <class BroadPhase, class NarrowPhase, class Scalar>
class detector<BroadPhase, NarrowPhase, detail::cuda_without_nvcc, Scalar>
    : public detector<BroadPhase, NarrowPhase, host, Scalar> {
  static_assert(sizeof(BroadPhase) == 0,
                "collide: the spaces cuda and cuda_shared need nvcc: compile this source as CUDA, as name.cu or with "
                "nvcc -x cu; with CMake, as LANGUAGE CUDA");
};
#endif

}  // namespace collide
