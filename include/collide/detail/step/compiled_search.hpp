/// \file
/// The search for contacts that a simulation links instead of compiling it; see compiled.hpp. Only on the host: on a
/// device a step is one kernel.
#pragma once

#include <collide/detail/bodies/bodies_ref.hpp>
#include <collide/detail/execution/block.hpp>
#include <collide/detail/grid/all_pairs_ref.hpp>
#include <collide/detail/grid/grid_ref.hpp>
#include <collide/detail/step/contact_search.hpp>
#include <collide/host.hpp>
#include <collide/karabassi.hpp>
#include <collide/karabassi_swept.hpp>

namespace collide::detail {

using block_of_host = host::block<void>;
template <class S, class NarrowPhase, class Triangles>
using scratch_on_host = typename contact_search<S, NarrowPhase, Triangles>::template scratch<block_of_host>;

}  // namespace collide::detail

// PREFIX is `template` where it is compiled, `extern template` elsewhere. All of these are for namespace
// collide::detail.

/// The search in what a look-up finds.
#define COLLIDE_SEARCH(PREFIX, SCALAR, NARROW_PHASE, ...)                                                \
  PREFIX void find_contacts(contact_search<SCALAR, NARROW_PHASE, __VA_ARGS__> const&, block_of_host&,    \
                            scratch_on_host<SCALAR, NARROW_PHASE, __VA_ARGS__>&, std::uint32_t, span_counts&);

/// The searches with a narrow phase, without and with moving bodies.
#define COLLIDE_SEARCHES(PREFIX, SCALAR, NARROW_PHASE)                                          \
  COLLIDE_SEARCH(PREFIX, SCALAR, NARROW_PHASE, bucket_ref<SCALAR>)                              \
  COLLIDE_SEARCH(PREFIX, SCALAR, NARROW_PHASE, all_pairs_ref<SCALAR>)                           \
  COLLIDE_SEARCH(PREFIX, SCALAR, NARROW_PHASE, bodies_ref<SCALAR, bucket_ref<SCALAR>>)          \
  COLLIDE_SEARCH(PREFIX, SCALAR, NARROW_PHASE, bodies_ref<SCALAR, all_pairs_ref<SCALAR>>)

/// All searches on the host.
#define COLLIDE_ALL_SEARCHES(PREFIX, SCALAR)                    \
  COLLIDE_SEARCHES(PREFIX, SCALAR, karabassi<exact>)            \
  COLLIDE_SEARCHES(PREFIX, SCALAR, karabassi<single_precision>) \
  COLLIDE_SEARCHES(PREFIX, SCALAR, karabassi<double_precision>) \
  COLLIDE_SEARCHES(PREFIX, SCALAR, karabassi_swept<exact>)

#if defined(COLLIDE_COMPILED)
namespace collide::detail {
COLLIDE_ALL_SEARCHES(extern template, float)
COLLIDE_ALL_SEARCHES(extern template, double)
}  // namespace collide::detail
#endif
