/// \file
/// Pairs that were found by several queries, and the query of them that a sink runs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <collide/query/concepts.hpp>
#include <collide/query/detail/candidate_pipeline.hpp>
#include <collide/query/hit.hpp>
#include <collide/sinks/detail/output.hpp>
#include <collide/sinks/detail/search_mesh.hpp>
#include <collide/sinks/pairs.hpp>
#include <collide/spaces/detail/host_array.hpp>

namespace collide::detail {

/// An array of pairs in memory of a space, to which more are appended.
class pair_list {
 public:
  void clear() { size_ = 0; }

  /// Room for `n` more pairs; returns where.
  template <class Space>
  pair* append(Space const& space, std::size_t n) {
    std::size_t const before = size_;
    if (before + n > memory_.capacity()) {
      buffer<pair> larger;
      pair* const to = ensure_capacity(larger, space.resource(), before + n);
      space.for_each(before, copy_values<pair>{memory_.data(), to});
      space.synchronize();  // the old memory goes
      memory_ = std::move(larger);
    }
    size_ += n;
    return memory_.data() + before;
  }

  pair const* data() const { return memory_.data(); }
  std::size_t size() const { return size_; }

 private:
  buffer<pair> memory_;
  std::size_t size_ = 0;
};

/// A mesh of which some triangles are here, some of its own and others that were hit: a plain value.
template <class S>
struct partial_mesh {
  mesh_subset<S> own, others;
  std::size_t all;  ///< how many the whole mesh has

  COLLIDE_HD std::size_t size() const { return all; }

  /// Triangle number `t`, which is here.
  COLLIDE_HD triangle<S> operator[](std::size_t t) const {
    id const number = static_cast<id>(t), at = own.find(number);
    return own.has_at(at, number) ? own.triangles[at] : others.triangles[others.find(number)];
  }
};

template <class NarrowPhase, class S>
COLLIDE_HD hit<NarrowPhase, S> hit_of(pair p, partial_mesh<S> const& mesh,
                                      sphere_view_for<NarrowPhase, S> const& spheres) {
  id const at = mesh.own.find(p.triangle);
  if (mesh.own.has_at(at, p.triangle)) return {p, mesh.own.triangles, spheres, at};
  return {p, mesh.others.triangles, spheres, mesh.others.find(p.triangle)};
}

/// Kernel functor of `for_each` over pairs: hands them to a sink's output. `Mesh` is `partial_mesh` or `mesh_view`.
template <class NarrowPhase, class S, class Mesh, class Output>
struct hand_over {
  pair const* pairs;
  Mesh mesh;
  sphere_view_for<NarrowPhase, S> spheres;
  Output output;
#if defined(__CUDACC__)
#pragma nv_exec_check_disable
#endif
  COLLIDE_HD void operator()(std::size_t i) const {
    std::uint64_t const slot = output.allocate(1);
    if constexpr (stores_ids<Output>) {  // nothing need be looked up
      output.store(slot, pairs[i]);
    } else {
      output.store(slot, hit_of<NarrowPhase, S>(pairs[i], mesh, spheres));
    }
  }
};

/// One pass over the pairs, as a sink sees it; see concepts.hpp.
template <class NarrowPhase, class Space, class Mesh, class S>
struct found_query {
  using narrow_phase = NarrowPhase;
  using scalar = S;

  Space& space;
  Mesh mesh;
  sphere_view_for<NarrowPhase, S> spheres;
  pair const* pairs;
  std::size_t size;

  std::uint64_t expected_hits() const { return size; }

  template <class Output>
  void operator()(Output const& output) const {
    space.for_each(size, hand_over<NarrowPhase, S, Mesh, Output>{pairs, mesh, spheres, output});
    if constexpr (is_valid<end_pass_call, Output>) {
      if (wants_end_pass(output)) space.for_each(1, end_pass_kernel<Output>{output});
    }
  }
};

/// Pairs that were found, with the triangles in them, in memory of a space.
template <class S>
class found_pairs {
 public:
  /// The pairs are in memory of the space, `others` on the host. `all`: how many triangles the whole mesh has.
  template <class Space>
  void keep(Space const& space, pair const* pairs, std::size_t size, mesh_subset<S> const& own,
            std::vector<numbered_triangle<S>> const& others, std::size_t all) {
    numbers_.resize(others.size());
    corners_.resize(9 * others.size());
    for (std::size_t i = 0; i < others.size(); ++i) {
      numbers_[i] = others[i].number;
      std::copy_n(others[i].corners, 9, corners_.data() + 9 * i);
    }
    pairs_ = pairs;
    size_ = size;
    mesh_ = {own, {{}, {0, in_space(space, numbers_, number_memory_)}}, all};
    if (!others.empty()) {
      mesh_.others.triangles = triangle_soup(in_space(space, corners_, corner_memory_), others.size());
    }
  }

  template <class NarrowPhase, class Space>
  found_query<NarrowPhase, Space, partial_mesh<S>, S> query(Space& space,
                                                            sphere_view_for<NarrowPhase, S> const& spheres) const {
    return {space, mesh_, spheres, pairs_, size_};
  }

 private:
  std::vector<S> corners_;
  std::vector<id> numbers_;
  buffer<S> corner_memory_;
  buffer<id> number_memory_;
  pair const* pairs_ = nullptr;
  std::size_t size_ = 0;
  partial_mesh<S> mesh_{};
};

}  // namespace collide::detail
