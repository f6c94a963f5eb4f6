/// \file
/// A reference to the triangles near a single sphere, by cells or by a tree, whichever was made. The members are those
/// of mesh_lookup.hpp.
#pragma once

#include <collide/broad/detail/grid/grid_ref.hpp>
#include <collide/broad/detail/per_sphere.hpp>

namespace collide::detail {

/// The lookup of `automatic`. Which of the two is asked is the same for all spheres.
template <class S, class Tree>
struct grid_or_tree_ref : bucket_ref<S> {
  per_sphere_ref<S, Tree> tree;  ///< of a mesh without triangles if the cells are asked

  COLLIDE_HD_INLINE bool asks_tree() const {
#if defined(__CUDA_ARCH__)
    return false;  // `automatic` makes none on a device
#else
    return tree.mesh.size() != 0;
#endif
  }

  COLLIDE_HD grid_or_tree_ref opened() const { return {bucket_ref<S>::opened(), tree}; }
  COLLIDE_HD_INLINE bool has_single_cell_lookup(S radius) const {
    return !asks_tree() && bucket_ref<S>::has_single_cell_lookup(radius);
  }
  template <class Sphere>
  COLLIDE_HD bool empty(Sphere const& s) const {
    return asks_tree() ? tree.empty(s) : bucket_ref<S>::empty(s);
  }
  template <class Sphere>
  COLLIDE_HD candidate_cursor begin(Sphere const& s) const {
    return asks_tree() ? tree.begin(s) : bucket_ref<S>::begin(s);
  }
  template <class Sphere>
  COLLIDE_HD bool next(Sphere const& s, candidate_cursor& c, std::uint32_t most, candidate_range& range) const {
    return asks_tree() ? tree.next(s, c, most, range) : bucket_ref<S>::next(s, c, most, range);
  }
};

}  // namespace collide::detail
