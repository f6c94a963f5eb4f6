/// \file
/// Detectors that a program links instead of compiling them: the CMake target `collide::compiled` has them, and defines
/// COLLIDE_COMPILED for those that link it. Broad phases include this file; there is no need to include it.
#pragma once

#include <collide/detector.hpp>
#include <collide/karabassi_swept.hpp>

/// One detector, with all built-in sinks. PREFIX is `template` where it is compiled, `extern template` elsewhere.
#define COLLIDE_DETECTOR(PREFIX, BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR)                                          \
  PREFIX class detector<BROAD_PHASE, NARROW_PHASE, SPACE, SCALAR>;                                                  \
  PREFIX void detail::query_pass<BROAD_PHASE::index<SCALAR>, NARROW_PHASE, SPACE, SCALAR>::operator()(              \
      detail::output const&) const;                                                                                 \
  PREFIX std::uint64_t detail::query_pass<BROAD_PHASE::index<SCALAR>, NARROW_PHASE, SPACE, SCALAR>::expected_hits() \
      const;

/// The detectors of a broad phase, in namespace collide.
#define COLLIDE_DETECTORS(PREFIX, BROAD_PHASE, SPACE, SCALAR)                       \
  COLLIDE_DETECTOR(PREFIX, BROAD_PHASE, karabassi<exact>, SPACE, SCALAR)            \
  COLLIDE_DETECTOR(PREFIX, BROAD_PHASE, karabassi<single_precision>, SPACE, SCALAR) \
  COLLIDE_DETECTOR(PREFIX, BROAD_PHASE, karabassi<double_precision>, SPACE, SCALAR) \
  COLLIDE_DETECTOR(PREFIX, BROAD_PHASE, karabassi_swept<exact>, SPACE, SCALAR)

/// Declares the detectors of a broad phase in a space as compiled elsewhere, in namespace collide.
#define COLLIDE_COMPILED_ELSEWHERE(BROAD_PHASE, SPACE)          \
  COLLIDE_DETECTORS(extern template, BROAD_PHASE, SPACE, float) \
  COLLIDE_DETECTORS(extern template, BROAD_PHASE, SPACE, double)
