/// \file
/// Detectors, and the part of simulations that does not depend on their effects, that a program links instead of
/// compiling them: the CMake target `collide::compiled` has them, and defines COLLIDE_COMPILED for those that link it
/// (COLLIDE_COMPILED_CUDA where it has those of the CUDA spaces). Broad phases and simulations include this file; there
/// is no need to include it.
#pragma once

#include <collide/detector.hpp>
#include <collide/karabassi_swept.hpp>

namespace collide {

class any_hit;
class count;
class csr;
class pairs;
template <class S>
class closest;
template <class S>
class closest_contact;
template <class S>
class contacts;
template <class S>
class earliest;
template <class S>
class earliest_impact;
template <class S>
class impacts;

namespace detail {

template <class Space>
struct lookup_tuning;
template <class Index, class Space, class Options, class S>
void build_lookup(Index&, lookup_tuning<Space>&, Options const&, mesh_view<S> const&);
template <class Index, class Space, class Options, class S>
void prepare_lookup(Index&, lookup_tuning<Space>&, Options const&, sphere_view<S> const&);

}  // namespace detail

}  // namespace collide

// PREFIX is `template` where it is compiled, `extern template` elsewhere. All of these are for namespace collide.

/// A query with a sink.
#define COLLIDE_QUERY(PREFIX, SINK, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)                             \
  PREFIX void detail::run_sink(SINK&, SPACE&,                                                             \
                               detail::query_pass<BROAD_PHASE::index<SCALAR>, NARROW_PHASE, SPACE, SCALAR> const&);

/// A detector, with the sinks that go with any narrow phase.
#define COLLIDE_DETECTOR(PREFIX, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)                                          \
  PREFIX class detector<BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR>;                                                  \
  PREFIX void detail::query_pass<BROAD_PHASE::index<SCALAR>, NARROW_PHASE, SPACE, SCALAR>::operator()(              \
      detail::output const&) const;                                                                                 \
  PREFIX std::uint64_t detail::query_pass<BROAD_PHASE::index<SCALAR>, NARROW_PHASE, SPACE, SCALAR>::expected_hits() \
      const;                                                                                                        \
  COLLIDE_QUERY(PREFIX, count, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)                                            \
  COLLIDE_QUERY(PREFIX, any_hit, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)                                          \
  COLLIDE_QUERY(PREFIX, pairs, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)                                            \
  COLLIDE_QUERY(PREFIX, csr, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)                                              \
  COLLIDE_QUERY(PREFIX, contacts<SCALAR>, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)

/// A detector of spheres at rest,
#define COLLIDE_DISCRETE_DETECTOR(PREFIX, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)      \
  COLLIDE_DETECTOR(PREFIX, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)                     \
  COLLIDE_QUERY(PREFIX, closest<SCALAR>, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)       \
  COLLIDE_QUERY(PREFIX, closest_contact<SCALAR>, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)

/// and one of spheres that move.
#define COLLIDE_SWEPT_DETECTOR(PREFIX, BROAD_PHASE, SPACE, SCALAR)                                \
  COLLIDE_DETECTOR(PREFIX, BROAD_PHASE, karabassi_swept<exact>, SPACE, SCALAR)                    \
  COLLIDE_QUERY(PREFIX, impacts<SCALAR>, BROAD_PHASE, karabassi_swept<exact>, SPACE, SCALAR)      \
  COLLIDE_QUERY(PREFIX, earliest<SCALAR>, BROAD_PHASE, karabassi_swept<exact>, SPACE, SCALAR)     \
  COLLIDE_QUERY(PREFIX, earliest_impact<SCALAR>, BROAD_PHASE, karabassi_swept<exact>, SPACE, SCALAR)

/// The detectors of spheres at rest of a broad phase.
#define COLLIDE_DISCRETE_DETECTORS(PREFIX, BROAD_PHASE, SPACE, SCALAR)                       \
  COLLIDE_DISCRETE_DETECTOR(PREFIX, BROAD_PHASE, karabassi<exact>, SPACE, SCALAR)            \
  COLLIDE_DISCRETE_DETECTOR(PREFIX, BROAD_PHASE, karabassi<single_precision>, SPACE, SCALAR) \
  COLLIDE_DISCRETE_DETECTOR(PREFIX, BROAD_PHASE, karabassi<double_precision>, SPACE, SCALAR)

/// The look-ups of simulations with a broad phase.
#define COLLIDE_LOOKUP(PREFIX, BROAD_PHASE, SPACE, SCALAR)                                                            \
  PREFIX void detail::build_lookup(BROAD_PHASE::index<SCALAR>&, detail::lookup_tuning<SPACE>&, BROAD_PHASE const&,    \
                                   mesh_view<SCALAR> const&);                                                         \
  PREFIX void detail::prepare_lookup(BROAD_PHASE::index<SCALAR>&, detail::lookup_tuning<SPACE>&, BROAD_PHASE const&, \
                                     sphere_view<SCALAR> const&);

/// Declares the detectors of a broad phase in a space as compiled elsewhere,
#define COLLIDE_DETECTORS_ELSEWHERE(BROAD_PHASE, SPACE)                  \
  COLLIDE_DISCRETE_DETECTORS(extern template, BROAD_PHASE, SPACE, float)  \
  COLLIDE_DISCRETE_DETECTORS(extern template, BROAD_PHASE, SPACE, double) \
  COLLIDE_SWEPT_DETECTOR(extern template, BROAD_PHASE, SPACE, float)      \
  COLLIDE_SWEPT_DETECTOR(extern template, BROAD_PHASE, SPACE, double)

/// and those of all spaces,
#if defined(__CUDACC__) && defined(COLLIDE_COMPILED_CUDA)
#define COLLIDE_COMPILED_DETECTORS(BROAD_PHASE)   \
  COLLIDE_DETECTORS_ELSEWHERE(BROAD_PHASE, host) \
  COLLIDE_DETECTORS_ELSEWHERE(BROAD_PHASE, cuda) \
  COLLIDE_DETECTORS_ELSEWHERE(BROAD_PHASE, cuda_shared)
#else
#define COLLIDE_COMPILED_DETECTORS(BROAD_PHASE) COLLIDE_DETECTORS_ELSEWHERE(BROAD_PHASE, host)
#endif

/// and its look-ups.
#define COLLIDE_LOOKUPS_ELSEWHERE(BROAD_PHASE, SPACE)        \
  COLLIDE_LOOKUP(extern template, BROAD_PHASE, SPACE, float) \
  COLLIDE_LOOKUP(extern template, BROAD_PHASE, SPACE, double)
#if defined(__CUDACC__) && defined(COLLIDE_COMPILED_CUDA)
#define COLLIDE_COMPILED_LOOKUPS(BROAD_PHASE)  \
  COLLIDE_LOOKUPS_ELSEWHERE(BROAD_PHASE, host) \
  COLLIDE_LOOKUPS_ELSEWHERE(BROAD_PHASE, cuda) \
  COLLIDE_LOOKUPS_ELSEWHERE(BROAD_PHASE, cuda_shared)
#else
#define COLLIDE_COMPILED_LOOKUPS(BROAD_PHASE) COLLIDE_LOOKUPS_ELSEWHERE(BROAD_PHASE, host)
#endif
