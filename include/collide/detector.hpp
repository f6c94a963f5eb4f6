/// \file
/// The detector: broad phase x narrow phase x execution space, composed at compile time.
#pragma once

#include <type_traits>
#include <utility>

#include <collide/core/error.hpp>
#include <collide/host.hpp>
#include <collide/karabassi.hpp>
#include <collide/mesh.hpp>
#include <collide/query/concepts.hpp>
#include <collide/query/detail/query_pass.hpp>
#include <collide/sinks/any_hit.hpp>
#include <collide/sinks/closest.hpp>
#include <collide/sinks/contacts.hpp>
#include <collide/sinks/count.hpp>
#include <collide/sinks/pairs.hpp>
#include <collide/sinks/visit.hpp>
#include <collide/spheres.hpp>
#if defined(__CUDACC__)
#include <collide/cuda.cuh>
#endif

namespace collide {

#if !defined(__CUDACC__)

namespace detail {

/// Cannot be made.
struct cuda_without_nvcc {
  template <class... Argument>
  explicit cuda_without_nvcc(Argument&&...) {
    static_assert(sizeof...(Argument) > 1000,
                  "collide: the spaces cuda and cuda_shared need nvcc: compile this source as CUDA, as name.cu or with "
                  "nvcc -x cu; with CMake, as LANGUAGE CUDA");
  }
};

}  // namespace detail

using cuda = detail::cuda_without_nvcc;
using cuda_shared = detail::cuda_without_nvcc;

#endif

/// Finds all colliding (sphere, triangle) pairs of a scene.
///
/// \tparam BroadPhase      which triangles a sphere could touch: `bucket` (bucket.cuh), `bvh` (bvh.cuh), `all_pairs`
///                         (all_pairs.cuh) or `automatic` (automatic.cuh)
/// \tparam NarrowPhase     whether a sphere touches a triangle: `karabassi<Precision>`, or `karabassi_swept<Precision>`
///                         for spheres that move
/// \tparam ExecutionSpace  where and how it runs: `host`, `cuda`, `cuda_shared`
/// \tparam Scalar          type of the coordinates: float or double; nothing is ever narrowed silently
///
/// Memory is taken from the space's resource and kept: once everything has run with the same sizes nothing is allocated
/// (on the host that takes two queries, as the second may go another way; see docs/development/design.md). `reserve`
/// takes it ahead, so that nothing is allocated as hits grow. A detector can be moved, but not copied.
///
/// In the CUDA spaces work is put on the space's stream, and the host waits only to read a size back: each sink says
/// when. What a call reads must stay valid and unchanged until that work is done; on the host, until the call returns.
///
/// One detector is for one thread at a time; several detectors may work at once, each with a stream of its own.
/// Everything thrown derives from `error`, except what the memory resource, or on the host the function of a `visit`,
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
  using broad_phase = BroadPhase;          ///< the first parameter
  using narrow_phase = NarrowPhase;        ///< the second parameter
  using execution_space = ExecutionSpace;  ///< the third parameter
  using scalar = Scalar;                   ///< the fourth parameter: the type of the coordinates
  /// `sphere_view`, or `moving_sphere_view` if the narrow phase judges spheres that move.
  using spheres_type = detail::sphere_view_for<NarrowPhase, Scalar>;

  /// A detector without a mesh. It keeps a copy of the space and of the options, and allocates nothing; the stream and
  /// the memory resource of the space must outlive it.
  ///
  /// \param space    where it runs; a CUDA space is for the device that is current when the space is made
  /// \param options  of the broad phase, such as the width of the cells of `bucket`
  /// \throws cuda_error  if a CUDA space finds no usable device (thrown where the space is made)
  explicit detector(ExecutionSpace space = ExecutionSpace(), BroadPhase options = BroadPhase())
      : space_(std::move(space)), options_(std::move(options)) {}

  /// Prepares what depends on the mesh only. Call it before the first query, and again when the mesh has moved.
  ///
  /// \param mesh  triangles in memory of the space, which are not copied: it must stay valid and unchanged until the
  ///              work of the last query is done. A mesh without triangles is one that nothing touches.
  /// \throws error  if the options make no sense, such as a negative width of cells
  /// \throws cuda_error  if a CUDA call fails
  ///
  /// After an exception, also one of the memory resource, the detector has no mesh, and can be built again.
  /// \complexity O(triangles). Allocates if there were fewer triangles before.
  /// \sync None but what allocating takes: the work is put on the space's stream.
  void build(mesh_view<Scalar> mesh) {
    mesh_ = {};
    is_built_ = false;
    if (mesh.size() != 0) detail::build_index(index_, space_, options_, mesh);
    mesh_ = mesh;
    is_built_ = true;
  }

  /// Prepares what depends on the mesh, for spheres at rest of up to a radius. The radius is a hint: results are the
  /// same. On a device only the first query then looks at the radii, if they differ, and later ones are expected to
  /// have such radii, too; on the host, without a memory budget, only `automatic` uses it. If the mesh changes,
  /// capture `build` and the query in one CUDA graph, as the query completes the index.
  ///
  /// \param mesh    triangles in memory of the space, not copied: valid and unchanged until the last query is done
  /// \param radius  the largest usual radius, in the units of the coordinates, not negative. Larger spheres are found
  ///                too, but more slowly; with an infinite one `bucket` tests every triangle on a device.
  /// \throws error  if `radius` is negative or NaN, or the options make no sense
  /// \throws cuda_error  if a CUDA call fails
  /// \complexity O(triangles). Allocates if something has grown.
  /// \sync None but what allocating takes: the work is put on the space's stream.
  void build(mesh_view<Scalar> mesh, Scalar radius) {
    if (!(radius >= 0)) throw error("collide: detector: the radius passed to build is negative or NaN");
    build(mesh);
    if (mesh.size() != 0) detail::prepare_index(index_, space_, options_, radius);
  }

  /// As `build`, for a mesh that has deformed since: the index of the broad phase stays and its boxes follow, on the
  /// host in a sixth to an eighth of the time. Queries give the same; the farther triangles have moved from each other
  /// the longer they take, until the next `build`. For `bvh`.
  ///
  /// \param mesh  triangles in memory of the space, not copied, as for `build`: as many as the last build had, in the
  ///              same order, at the same or another place
  /// \throws error  if there was no `build`, the last one failed, or it was of another number of triangles
  /// \throws cuda_error  if a CUDA call fails
  /// \complexity O(triangles). Allocates nothing, but where the last build was of triangles that were not finite.
  /// \sync None.
  void refit(mesh_view<Scalar> mesh) {
    using index = typename BroadPhase::template index<Scalar>;
    static_assert(detail::is_valid<detail::index_refit, index, ExecutionSpace, BroadPhase, Scalar>,
                  "collide: refit is for a broad phase that moves its tree along, bvh: with others build again");
    if (!is_built_ || mesh.size() != mesh_.size())
      throw error("collide: detector: refit needs a mesh with as many triangles as the last build had: call build");
    is_built_ = false;
    if (mesh.size() != 0) index_.refit(space_, options_, mesh);
    mesh_ = mesh;
    is_built_ = true;
  }

  /// Makes room for queries ahead: what depends on the numbers of spheres and pairs alone is then not allocated by a
  /// query. What depends on the mesh, or on the radii, is allocated by `build` and the first two queries; `automatic`
  /// may make its index in a later one.
  ///
  /// \param spheres  the largest number of spheres of a query
  /// \param pairs    the largest number of pairs that a sink keeps
  /// \param sinks    those of later queries, kept by the caller: each gets its room too
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

  /// Hands every colliding pair to the sink, each exactly once, in unspecified order. It gives what this gives:
  ///
  ///     for each sphere s and each triangle t: if (NarrowPhase::intersects(t, s)) sink gets (s, t)
  ///
  /// \param spheres  n spheres in memory of the space: valid and unchanged until the work is done, at the latest when
  ///                 the sink is read. There may be none.
  /// \param sink     where pairs go: `count`, `any_hit`, `pairs`, `csr`, `contacts`, `impacts`, `closest`, `earliest`,
  ///                 `visit`, or one of your own; or a search of the mesh for each sphere: `nearest`, `k_nearest`,
  ///                 `contains`, `signed_distance`, `winding_number`
  /// \return the sink: by reference if it was given as an lvalue (its memory is then used again), else by value
  /// \throws error  if there was no `build`, or the last one failed
  /// \throws cuda_error  if a CUDA call fails
  ///
  /// After an exception the detector can be used again; what the sink holds is then unspecified.
  /// \complexity That of the broad phase: O(n + candidates) for `bucket`, O(n * triangles) for `all_pairs`.
  /// \sync As the sink says. `bucket` waits for a size where it makes a grid for more than 2^18 triangles, or
  /// cells of a given width; there it waits for the range of radii, too, if they differ and `build` was given none.
  template <class Sink>
  Sink query(spheres_type const& spheres, Sink&& sink) {
    using pass = detail::query_pass<typename BroadPhase::template index<Scalar>, NarrowPhase, ExecutionSpace, Scalar>;
    static_assert(detail::is_valid<detail::sink_run, std::remove_reference_t<Sink>, ExecutionSpace, pass>,
                  "collide: the second argument of query is a sink, such as count, any_hit, pairs, contacts, closest "
                  "or visit: an "
                  "object with a member run(space, query)");
    prepare(spheres);
    detail::run_sink(sink, space_, pass{index_, space_, mesh_, spheres, deferred_});
    return std::forward<Sink>(sink);
  }

  /// Queries points, which are spheres of radius 0, for sinks such as `nearest`; as for spheres otherwise.
  template <class Sink>
  Sink query(point_view<Scalar> const& points, Sink&& sink) {
    static_assert(std::is_same<spheres_type, sphere_view<Scalar>>::value,
                  "collide: this narrow phase judges spheres that move: give query a moving_sphere_view, see "
                  "`with_displacements`");
    return query(spheres_type(points, nullptr, 0, Scalar(0)), std::forward<Sink>(sink));
  }

  /// `build(mesh)` and `query(spheres, sink)` in one call; each says what it needs, takes and throws.
  ///
  /// \param mesh     as for `build`
  /// \param spheres  as for `query`
  /// \param sink     as for `query`
  /// \return the sink, as `query` does
  template <class Mesh, class Spheres, class Sink>
  Sink detect(Mesh const& mesh, Spheres const& spheres, Sink&& sink) {
    build(mesh);
    return query(spheres, std::forward<Sink>(sink));
  }

  /// The width of the finest cells in use, in the units of the coordinates; 0 if there are none. In the CUDA spaces it
  /// waits for the device.
  double cell_width() const { return mesh_.size() == 0 ? 0.0 : index_.cell_width(space_); }

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
  Sink query(point_view<S> const&, Sink&&) {
    reject<S>();
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
            class = detail::if_not_made_of<point_view, T, spheres_type>,
            class = detail::if_not_made_of<moving_sphere_view, T, spheres_type>>
  Sink query(T const&, Sink&&) {
    static_assert(sizeof(T) == 0,
                  "collide: the first argument of query is spheres, such as spheres_xyz gives, and the second a sink; "
                  "a mesh goes to build");
  }

  /// The space, to wait for it, or to put work of your own on its stream.
  ExecutionSpace& space() { return space_; }
  /// The space; see above.
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
  void prepare(spheres_type const& spheres) {
    if (!is_built_) throw error("collide: detector: query needs a mesh: call build before it");
    if (mesh_.size() != 0 && spheres.size() != 0) detail::prepare_index(index_, space_, options_, spheres);
  }

  ExecutionSpace space_;
  BroadPhase options_;
  mesh_view<Scalar> mesh_;
  bool is_built_ = false;
  typename BroadPhase::template index<Scalar> index_;
  detail::deferred_pair_buffer deferred_;
};

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
