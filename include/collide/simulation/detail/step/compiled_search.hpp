/// \file
/// The search for contacts that a simulation links instead of compiling it; see compiled.hpp. Only on the host: on a
/// device a step is one kernel.
#pragma once

#include <collide/broad/detail/grid/grid_ref.hpp>
#include <collide/broad/detail/mesh_lookup.hpp>
#include <collide/host.hpp>
#include <collide/karabassi.hpp>
#include <collide/karabassi_swept.hpp>
#include <collide/simulation/detail/bodies/bodies_ref.hpp>
#include <collide/simulation/detail/step/contact_search.hpp>
#include <collide/simulation/detail/step/integrate.hpp>
#include <collide/spaces/detail/block.hpp>

namespace collide::detail {

using block_of_host = host::block<void>;

}  // namespace collide::detail

// PREFIX is `template` where it is compiled, `extern template` elsewhere. All of these are for namespace
// collide::detail.

/// The search in what a look-up finds.
#define COLLIDE_SEARCH(PREFIX, SCALAR, NARROW_PHASE, IS_SWEPT, HAS_BODIES, ...)                           \
  PREFIX void find_contacts(contact_search<SCALAR, NARROW_PHASE, __VA_ARGS__> const&, block_of_host&,     \
                            contact_scratch<SCALAR, IS_SWEPT, HAS_BODIES, block_of_host>&, std::uint32_t, \
                            span_counts&);

/// The searches with a narrow phase, without and with moving bodies.
#define COLLIDE_SEARCHES(PREFIX, SCALAR, NARROW_PHASE, IS_SWEPT)                                       \
  COLLIDE_SEARCH(PREFIX, SCALAR, NARROW_PHASE, IS_SWEPT, false, bucket_ref<SCALAR>)                    \
  COLLIDE_SEARCH(PREFIX, SCALAR, NARROW_PHASE, IS_SWEPT, false, all_pairs_ref<SCALAR>)                 \
  COLLIDE_SEARCH(PREFIX, SCALAR, NARROW_PHASE, IS_SWEPT, true, bodies_ref<SCALAR, bucket_ref<SCALAR>>) \
  COLLIDE_SEARCH(PREFIX, SCALAR, NARROW_PHASE, IS_SWEPT, true, bodies_ref<SCALAR, all_pairs_ref<SCALAR>>)

/// Tells which particles are near a mesh that rests: of as many as a step asks about at a time.
#define COLLIDE_NEAR_TRIANGLES(PREFIX, SCALAR, SHAPE)                                         \
  PREFIX std::uint32_t near_triangles(bucket_ref<SCALAR> const&, SHAPE<SCALAR> const(&)[16]); \
  PREFIX std::uint32_t near_triangles(all_pairs_ref<SCALAR> const&, SHAPE<SCALAR> const(&)[16]);

/// All of these, on the host.
#define COLLIDE_ALL_SEARCHES(PREFIX, SCALAR)                           \
  COLLIDE_NEAR_TRIANGLES(PREFIX, SCALAR, sphere)                       \
  COLLIDE_NEAR_TRIANGLES(PREFIX, SCALAR, moving_sphere)                \
  COLLIDE_SEARCHES(PREFIX, SCALAR, karabassi<exact>, false)            \
  COLLIDE_SEARCHES(PREFIX, SCALAR, karabassi<single_precision>, false) \
  COLLIDE_SEARCHES(PREFIX, SCALAR, karabassi<double_precision>, false) \
  COLLIDE_SEARCHES(PREFIX, SCALAR, karabassi_swept<exact>, true)

#if defined(COLLIDE_COMPILED)
namespace collide::detail {
COLLIDE_ALL_SEARCHES(extern template, float)
COLLIDE_ALL_SEARCHES(extern template, double)
}  // namespace collide::detail
#endif
