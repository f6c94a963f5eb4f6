#pragma once

#include <collide/all_pairs.cuh>
#include <collide/sinks/count.hpp>
#include <collide/spaces/upload.hpp>

#if defined(__CUDACC__)
using space = collide::cuda_shared;
#else
using space = collide::host;
#endif

namespace {

/// One triangle, one sphere that touches it and one that does not.
std::uint64_t hits() {
  space here;
  float const corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  float const centres[] = {0.25F, 0.25F, 0.5F, 5, 5, 5};
  auto const mesh = collide::upload(here, collide::triangle_soup(corners, 1));
  auto const spheres = collide::upload(here, collide::spheres_xyz(centres, 2, 0.75F));
  collide::detector<collide::all_pairs, collide::karabassi<>, space> detector(here);
  return detector.detect(mesh.view(), spheres.view(), collide::count()).total();
}

}  // namespace
