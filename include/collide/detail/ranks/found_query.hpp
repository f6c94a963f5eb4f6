/// \file
/// Pairs that are known, as a query that a sink runs.
#pragma once

#include <cstddef>
#include <vector>

#include <collide/concepts.hpp>
#include <collide/detail/query/candidate_pipeline.hpp>
#include <collide/detail/ranks/divided_mesh.hpp>
#include <collide/hit.hpp>

namespace collide::detail {

/// A mesh of which some triangles are here, with the numbers that they have in the whole: a plain value.
template <class S>
struct partial_mesh {
  mesh_view<S> part;
  id const* numbers;  ///< of its triangles; they rise
  std::size_t all;    ///< how many the whole mesh has

  COLLIDE_HD std::size_t size() const { return all; }

  /// Triangle number `t`, which is here.
  COLLIDE_HD triangle<S> operator[](std::size_t t) const { return part[find(static_cast<id>(t))]; }

  /// Place of triangle number `t` in the part, which has it.
  COLLIDE_HD id find(id t) const {
    std::size_t low = 0, high = part.size();
    while (high - low > 1) {
      std::size_t const middle = (low + high) / 2;
      (numbers[middle] <= t ? low : high) = middle;
    }
    return static_cast<id>(low);
  }
};

/// A pair with its geometry.
template <class NarrowPhase, class S>
COLLIDE_HD hit<NarrowPhase, S> hit_of(pair p, partial_mesh<S> const& mesh,
                                      sphere_view_for<NarrowPhase, S> const& spheres) {
  return {p, mesh.part, spheres, mesh.find(p.triangle)};
}

/// Kernel body of `for_each` over pairs: hands them to a sink's output.
template <class NarrowPhase, class S, class Output>
struct hand_over {
  pair const* pairs;
  partial_mesh<S> mesh;
  sphere_view_for<NarrowPhase, S> spheres;
  Output output;
#if defined(__CUDACC__)
#pragma nv_exec_check_disable
#endif
  COLLIDE_HD void operator()(std::size_t i) const {
    std::uint64_t const slot = output.allocate(1);
    output.store(slot, hit_of<NarrowPhase, S>(pairs[i], mesh, spheres));
  }
};

/// One pass over the pairs, as a sink sees it; see concepts.hpp.
template <class NarrowPhase, class Space, class S>
struct found_query {
  using narrow_phase = NarrowPhase;
  using scalar = S;

  Space& space;
  partial_mesh<S> mesh;
  sphere_view_for<NarrowPhase, S> spheres;
  pair const* pairs;
  std::size_t size;

  template <class Output>
  void operator()(Output const& output) const {
    space.for_each(size, hand_over<NarrowPhase, S, Output>{pairs, mesh, spheres, output});
    if constexpr (finishes<Output>::value) {
      if (has_end_pass(output)) space.for_each(1, finish_only<Output>{output});
    }
  }
};

/// The pairs that were found in memory of a space.
template <class S>
class found_pairs {
 public:
  template <class Space>
  void keep(Space const& space, std::vector<pair> const& pairs, std::vector<numbered_triangle<S>> const& triangles,
            std::size_t all) {
    std::vector<S> corners(9 * triangles.size());
    numbers_.resize(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      numbers_[i] = triangles[i].number;
      std::copy_n(triangles[i].corners, 9, corners.data() + 9 * i);
    }
    corners_ = std::move(corners);
    pairs_ = in_space(space, pairs, pair_memory_);
    size_ = pairs.size();
    mesh_ = {{}, in_space(space, numbers_, number_memory_), all};
    if (!triangles.empty()) mesh_.part = triangle_soup(in_space(space, corners_, corner_memory_), triangles.size());
  }

  template <class NarrowPhase, class Space>
  found_query<NarrowPhase, Space, S> query(Space& space, sphere_view_for<NarrowPhase, S> const& spheres) const {
    return {space, mesh_, spheres, pairs_, size_};
  }

 private:
  std::vector<S> corners_;
  std::vector<id> numbers_;
  buffer<S> corner_memory_;
  buffer<id> number_memory_;
  buffer<pair> pair_memory_;
  pair const* pairs_ = nullptr;
  std::size_t size_ = 0;
  partial_mesh<S> mesh_{};
};

}  // namespace collide::detail
