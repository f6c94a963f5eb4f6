/// \file
/// One pass of a query, as a sink calls it.
#pragma once

#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/query/concepts.hpp>
#include <collide/query/detail/candidate_pipeline.hpp>
#include <collide/query/detail/deferred_pairs.hpp>
#include <collide/spaces/detail/tuning.hpp>

namespace collide::detail {

// What a program may link instead of compiling it: functions that are not inline, which an `extern template` declares
// in compiled.hpp.

/// Makes of a mesh what an index keeps of it.
template <class Index, class Space, class Options, class S>
void build_index(Index& index, Space& space, Options const& options, mesh_view<S> const& mesh) {
  index.build(space, options, mesh);
}

/// Makes what an index needs for a radius, or for spheres.
template <class Index, class Space, class Options, class Spheres>
void prepare_index(Index& index, Space& space, Options const& options, Spheres const& spheres) {
  index.prepare(space, options, spheres);
}

/// Lets a sink run its passes.
template <class Sink, class Space, class Pass>
void run_sink(Sink& sink, Space& space, Pass const& pass) {
  sink.run(space, pass);
}

/// One pass of a query over the scene, as a sink sees it; see concepts.hpp.
template <class Index, class NarrowPhase, class Space, class S>
struct query_pass {
  using narrow_phase = NarrowPhase;
  using scalar = S;

  Index& index;
  Space& space;
  mesh_view<S> mesh;
  sphere_view_for<NarrowPhase, S> spheres;
  deferred_pair_buffer& deferred;

  template <class Output>
  void operator()(Output const& output) const;

  /// About how many hits there are, rather too many; 0 if the index cannot tell.
  std::uint64_t expected_hits() const;

  /// Calls f(i, sphere, mesh, search) for every sphere i, from many threads, where search(bound, consider) calls bound
  /// = consider(triangle) for all triangles whose squared distance from the centre is at most `bound`, which only
  /// falls, and search.on_ray(consider) calls consider(triangle) for all triangles whose box the ray from the centre
  /// along +z meets, as long as that returns true.
  template <class F>
  void search(F const& f) const;

  /// A tree for winding numbers of a mesh that is not empty, if the index has one.
  template <class I = Index>
  auto windings() const -> std::decay_t<decltype(std::declval<I&>().windings(space))> {
    return index.windings(space);
  }
};

template <class Index, class S>
using index_for_each_nearer = decltype(std::declval<Index const&>().ref().for_each_nearer(
    std::declval<vec3<S> const&>(), S(), std::declval<S (&)(id)>()));

template <class Index, class S>
using index_for_each_on_ray = decltype(std::declval<Index const&>().ref().for_each_on_ray(
    std::declval<vec3<S> const&>(), std::declval<bool (&)(id)>()));

/// The box of the points whose search goes on beyond the box of a mesh: everything, unless the search functor tells.
template <class F>
struct searched_by {
  F const& f;

  template <class G>
  using call = decltype(std::declval<G const&>().searched_box(aabb<float>{}));

  aabb<float> operator()([[maybe_unused]] aabb<float> const& mesh) const {
    if constexpr (is_valid<call, F>) {
      return f.searched_box(mesh);
    } else {
      constexpr float far = std::numeric_limits<float>::infinity();
      return {{-far, -far, -far}, {far, far, far}};
    }
  }
};

template <class Index, class Space, class S, class F>
using index_search_order = decltype(std::declval<Index&>().search_order(
    std::declval<Space&>(), std::declval<sphere_view<S> const&>(), std::declval<searched_by<F> const&>()));

template <class Index, class NarrowPhase, class Space, class Spheres>
using index_expected_hits = decltype(std::declval<Index&>().template expected_hits<NarrowPhase>(
    std::declval<Space&>(), std::declval<Spheres const&>()));

template <class Index, class NarrowPhase, class Space, class S>
std::uint64_t query_pass<Index, NarrowPhase, Space, S>::expected_hits() const {
  if constexpr (is_valid<index_expected_hits, Index, NarrowPhase, Space, sphere_view_for<NarrowPhase, S>>) {
    if (mesh.size() != 0 && spheres.size() != 0) return index.template expected_hits<NarrowPhase>(space, spheres);
  }
  return 0;
}

/// The triangles near a point, or above it.
template <class S, class Ref>
struct mesh_search {
  Ref const& ref;
  vec3<S> const& point;

  template <class F>
  COLLIDE_HD void operator()(S bound, F const& consider) const {
    ref.for_each_nearer(point, bound, consider);
  }
  template <class F>
  COLLIDE_HD void on_ray(F const& consider) const {
    ref.for_each_on_ray(point, consider);
  }
};

/// A search functor of which a device makes two kernels: its members `search_pass`, a search functor, and
/// `measure_pass`, a functor of `for_each` over spheres.
template <class F>
using search_passes = std::enable_if_t<!std::is_void<typename F::search_pass>::value>;

/// How many blocks of a search a processor should hold: the functor's `min_blocks`, or 12. Decisions in integers need
/// more registers and are rare, so more resident threads gain more.
template <class F, class = void>
inline constexpr int min_blocks_of_search = 12;
template <class F>
inline constexpr int min_blocks_of_search<F, std::enable_if_t<(F::min_blocks > 0)>> = F::min_blocks;

/// Kernel functor of `for_each` over spheres.
template <class S, class Ref, class F>
struct search_of_sphere {
  template <class>
  static constexpr int min_blocks_per_sm = min_blocks_of_search<F>;

  Ref ref;
  mesh_view<S> mesh;
  sphere_view<S> spheres;
  F f;
  id const* order;  ///< of the spheres, or null

  COLLIDE_HD void operator()(std::size_t k) const {
    std::size_t const i = order != nullptr ? order[k] : k;
#if !defined(__CUDA_ARCH__)
    constexpr std::size_t ahead = 16;
    if (order != nullptr && k + ahead < spheres.size()) __builtin_prefetch(spheres.centres().address(order[k + ahead]));
#endif
    sphere<S> const own = spheres[i];
    f(i, own, mesh, mesh_search<S, Ref>{ref, own.centre});
  }
};

template <class Index, class NarrowPhase, class Space, class S>
template <class F>
void query_pass<Index, NarrowPhase, Space, S>::search(F const& f) const {
  static_assert(is_valid<index_for_each_nearer, Index, S> && is_valid<index_for_each_on_ray, Index, S>,
                "collide: nearest, contains, signed_distance and winding_number need a broad phase that finds what is "
                "near, at any "
                "distance: bvh, or all_pairs");
  static_assert(is_discrete<NarrowPhase, S>,
                "collide: nearest, contains, signed_distance and winding_number are for points and spheres that rest");
  using ref_type = decltype(index.ref());
  ref_type const ref = mesh.size() != 0 ? index.ref() : ref_type{};
  id const* order = nullptr;
  if constexpr (is_valid<index_search_order, Index, Space, S, F>) {
    if (mesh.size() != 0) order = index.search_order(space, spheres, searched_by<F>{f});
  }
  if constexpr (query_tuning<Space>::defers_exact_tests && is_valid<search_passes, F>) {
    using first = typename F::search_pass;
    space.for_each(spheres.size(), search_of_sphere<S, ref_type, first>{ref, mesh, spheres, first{f}, order});
    space.for_each(spheres.size(), typename F::measure_pass{f, mesh, spheres});
  } else {
    space.for_each(spheres.size(), search_of_sphere<S, ref_type, F>{ref, mesh, spheres, f, order});
  }
}

template <class Index, class NarrowPhase, class Space, class S>
template <class Output>
void query_pass<Index, NarrowPhase, Space, S>::operator()(Output const& output) const {
  static_assert(
      is_valid<output_allocate, Output>,
      "collide: what a sink passes to query has a const member allocate(n) that returns the number of a slot");
  static_assert(stores_ids<Output> || is_valid<output_store, Output, hit<NarrowPhase, S>>,
                "collide: what a sink passes to query has a const member store(slot, hit)");
  static_assert(is_plain<Output> || Space::host_accessible,
                "collide: what a sink hands to the device must be a plain value");
  if (mesh.size() != 0 && spheres.size() != 0) {
    if constexpr (query_tuning<Space>::defers_exact_tests && filtered_predicate<NarrowPhase>::value) {
      query_two_pass<NarrowPhase>(space, index, mesh, spheres, output, deferred);
      return;
    } else {
      index.template query<NarrowPhase>(space, spheres, output);
    }
  }
  if constexpr (is_valid<end_pass_call, Output>) {
    if (wants_end_pass(output)) space.for_each(1, end_pass_kernel<Output>{output});
  }
}

}  // namespace collide::detail
