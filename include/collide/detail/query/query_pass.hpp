/// \file
/// One pass of a query, as a sink calls it.
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include <collide/concepts.hpp>
#include <collide/detail/execution/tuning.hpp>
#include <collide/detail/query/candidate_pipeline.hpp>
#include <collide/detail/query/deferred_pairs.hpp>

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

  template <class Handle>
  void operator()(Handle const& handle) const;

  /// About how many hits there are, rather too many; 0 if the index cannot tell.
  std::uint64_t expected_hits() const;
};

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

template <class Index, class NarrowPhase, class Space, class S>
template <class Handle>
void query_pass<Index, NarrowPhase, Space, S>::operator()(Handle const& handle) const {
  static_assert(
      is_valid<output_allocate, Handle>,
      "collide: what a sink passes to query has a const member allocate(n) that returns the number of a slot");
  static_assert(is_valid<output_store, Handle, hit<NarrowPhase, S>>,
                "collide: what a sink passes to query has a const member store(slot, hit)");
  static_assert(is_plain<Handle> || Space::host_accessible,
                "collide: what a sink hands to the device must be a plain value");
  if (mesh.size() != 0 && spheres.size() != 0) {
    if constexpr (query_tuning<Space>::defers_exact_tests && filtered_predicate<NarrowPhase>::value) {
      query_two_pass<NarrowPhase>(space, index, mesh, spheres, handle, deferred);
      return;
    } else {
      index.template query<NarrowPhase>(space, spheres, handle);
    }
  }
  if constexpr (finishes<Handle>::value) {
    if (has_end_pass(handle)) space.for_each(1, finish_only<Handle>{handle});
  }
}

}  // namespace collide::detail
