/// \file
/// Queries, and the part of simulations that does not depend on their effects, which a program links instead of
/// compiling them: the CMake target `collide::compiled` has them, and defines COLLIDE_COMPILED for those that link it,
/// and COLLIDE_COMPILED_CUDA where it has those of the CUDA spaces. Broad phases include this file; there is no need to
/// include it.
#pragma once

#include <collide/detector.hpp>

namespace collide {

template <class Precision>
struct karabassi_swept;

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
struct lookup_space;

}  // namespace detail

}  // namespace collide

// PREFIX is `template` where it is compiled, `extern template` elsewhere. All of these are for namespace collide.

/// Code that an index keeps of a mesh, and for spheres at rest; SPACE is the space, or that of look-ups.
#define COLLIDE_INDEX(PREFIX, BROAD_PHASE, SPACE, SCALAR)                                                             \
  PREFIX void detail::build_index(BROAD_PHASE::index<SCALAR>&, SPACE&, BROAD_PHASE const&, mesh_view<SCALAR> const&); \
  PREFIX void detail::prepare_index(BROAD_PHASE::index<SCALAR>&, SPACE&, BROAD_PHASE const&, SCALAR const&);          \
  PREFIX void detail::prepare_index(BROAD_PHASE::index<SCALAR>&, SPACE&, BROAD_PHASE const&,                          \
                                    sphere_view<SCALAR> const&);

/// A query with a sink.
#define COLLIDE_QUERY(PREFIX, SINK, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR) \
  PREFIX void detail::run_sink(SINK&, SPACE&,                                 \
                               detail::query_pass<BROAD_PHASE::index<SCALAR>, NARROW_PHASE, SPACE, SCALAR> const&);

/// Queries with the sinks that go with any narrow phase,
#define COLLIDE_QUERIES(PREFIX, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)  \
  COLLIDE_QUERY(PREFIX, count, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)   \
  COLLIDE_QUERY(PREFIX, any_hit, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR) \
  COLLIDE_QUERY(PREFIX, pairs, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)   \
  COLLIDE_QUERY(PREFIX, csr, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)     \
  COLLIDE_QUERY(PREFIX, contacts<SCALAR>, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)

/// of spheres at rest,
#define COLLIDE_QUERIES_AT_REST(PREFIX, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)  \
  COLLIDE_QUERIES(PREFIX, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)                \
  COLLIDE_QUERY(PREFIX, closest<SCALAR>, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR) \
  COLLIDE_QUERY(PREFIX, closest_contact<SCALAR>, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)

/// The linked functions of a broad phase in a space, for spheres at rest.
#define COLLIDE_ALL_AT_REST(PREFIX, BROAD_PHASE, SPACE, SCALAR)                            \
  COLLIDE_INDEX(PREFIX, BROAD_PHASE, SPACE, SCALAR)                                        \
  COLLIDE_QUERIES_AT_REST(PREFIX, BROAD_PHASE, karabassi<exact>, SPACE, SCALAR)            \
  COLLIDE_QUERIES_AT_REST(PREFIX, BROAD_PHASE, karabassi<single_precision>, SPACE, SCALAR) \
  COLLIDE_QUERIES_AT_REST(PREFIX, BROAD_PHASE, karabassi<double_precision>, SPACE, SCALAR)

/// The linked functions of a broad phase in a space, for spheres that move.
#define COLLIDE_ALL_IN_MOTION(PREFIX, BROAD_PHASE, SPACE, SCALAR)                             \
  PREFIX void detail::prepare_index(BROAD_PHASE::index<SCALAR>&, SPACE&, BROAD_PHASE const&,  \
                                    moving_sphere_view<SCALAR> const&);                       \
  COLLIDE_QUERIES(PREFIX, BROAD_PHASE, karabassi_swept<exact>, SPACE, SCALAR)                 \
  COLLIDE_QUERY(PREFIX, impacts<SCALAR>, BROAD_PHASE, karabassi_swept<exact>, SPACE, SCALAR)  \
  COLLIDE_QUERY(PREFIX, earliest<SCALAR>, BROAD_PHASE, karabassi_swept<exact>, SPACE, SCALAR) \
  COLLIDE_QUERY(PREFIX, earliest_impact<SCALAR>, BROAD_PHASE, karabassi_swept<exact>, SPACE, SCALAR)

/// Declares all queries with a broad phase in a space as compiled elsewhere, and what is for look-ups,
#define COLLIDE_ELSEWHERE_IN(BROAD_PHASE, SPACE, SCALAR)             \
  COLLIDE_ALL_AT_REST(extern template, BROAD_PHASE, SPACE, SCALAR)   \
  COLLIDE_ALL_IN_MOTION(extern template, BROAD_PHASE, SPACE, SCALAR) \
  COLLIDE_INDEX(extern template, BROAD_PHASE, detail::lookup_space<SPACE>, SCALAR)

/// in all spaces.
#if defined(__CUDACC__) && defined(COLLIDE_COMPILED_CUDA)
#define COLLIDE_ELSEWHERE(BROAD_PHASE)                  \
  COLLIDE_ELSEWHERE_IN(BROAD_PHASE, host, float)        \
  COLLIDE_ELSEWHERE_IN(BROAD_PHASE, host, double)       \
  COLLIDE_ELSEWHERE_IN(BROAD_PHASE, cuda, float)        \
  COLLIDE_ELSEWHERE_IN(BROAD_PHASE, cuda, double)       \
  COLLIDE_ELSEWHERE_IN(BROAD_PHASE, cuda_shared, float) \
  COLLIDE_ELSEWHERE_IN(BROAD_PHASE, cuda_shared, double)
#else
#define COLLIDE_ELSEWHERE(BROAD_PHASE)           \
  COLLIDE_ELSEWHERE_IN(BROAD_PHASE, host, float) \
  COLLIDE_ELSEWHERE_IN(BROAD_PHASE, host, double)
#endif
