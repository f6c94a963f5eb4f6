/// \file
/// A tree of boxes whose nodes are full: triangles in the order of a curve through space, eight next to each other in a
/// node, eight of these in the next. For devices: all that is done is done for many at once, and alike in every run.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <collide/detail/grid/mesh_statistics.hpp>
#include <collide/detail/tree/tree_node.hpp>
#include <collide/memory.hpp>
#if defined(__CUDACC__)
#include <collide/detail/tree/sort_ids_cuda.cuh>
#endif

// the numbers of elements of small arrays are int
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-conversion"

namespace collide::detail {

/// The position of a place on Hilbert's curve through a cube, from coordinates of `Bits` bits (J. Skilling,
/// "Programming the Hilbert curve", 2004).
template <int Bits>
COLLIDE_HD_INLINE std::uint64_t place_on_curve(std::uint32_t (&x)[3]) {
  constexpr std::uint32_t top = 1u << (Bits - 1);
  for (std::uint32_t q = top; q > 1; q >>= 1) {
    for (auto& c : x) {
      std::uint32_t const t = (x[0] ^ c) & (q - 1);
      if ((c & q) != 0) {
        x[0] ^= q - 1;
      } else {
        x[0] ^= t;
        c ^= t;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t turned = 0;
  for (std::uint32_t q = top; q > 1; q >>= 1) turned ^= (x[2] & q) != 0 ? q - 1 : 0;
  std::uint64_t place = 0;
  for (int b = Bits - 1; b >= 0; --b) {
    for (auto const c : x) place = place << 1 | ((c ^ turned) >> b & 1);
  }
  return place;
}

/// Kernel functor of `for_each` over triangles: where each is on the curve, and its number.
template <class S>
struct find_places {
  static constexpr int bits = 16;                            ///< of a coordinate
  static constexpr std::uint64_t none = 1ull << (3 * bits);  ///< of what is not finite

  mesh_view<S> mesh;
  mesh_statistics<S> const* summary;
  std::uint64_t* places;
  id* ids;

  COLLIDE_HD void operator()(std::size_t i) const {
    aabb<S> const box = aabb_of(mesh[i]);
    ids[i] = static_cast<id>(i);
    places[i] = none;
    if (box.is_empty()) return;
    S extent = 0;
    for (int k = 0; k < 3; ++k) extent = max(extent, summary->upper_of(k) / 2 - summary->lower_of(k) / 2);
    std::uint32_t x[3];
    for (int k = 0; k < 3; ++k) {
      S const part = div_rn((box.lower[k] / 2 + box.upper[k] / 2 - summary->lower_of(k)) / 2, extent);
      x[k] = static_cast<std::uint32_t>(static_cast<std::int32_t>(saturate(part) * S((1 << bits) - 1)));
    }
    places[i] = place_on_curve<bits>(x);
  }
};

/// The levels of a packed tree, the root first: how many nodes each has, and the number of its first.
struct tree_levels {
  static constexpr int most = 12;

  std::size_t count[most], first[most];  ///< of level 0, with the triangles, and of those above
  int levels;
  std::size_t nodes;  ///< in all

  explicit tree_levels(std::size_t triangles) : levels{0}, nodes{0} {
    std::size_t n = triangles;
    do count[levels++] = n = (n + tree_node::width - 1) / tree_node::width;
    while (n > 1);
    for (int l = levels - 1; l >= 0; --l) {
      first[l] = nodes;
      nodes += count[l];
    }
  }

  /// The number of the first node above a level; of the root, its own.
  std::size_t above(int l) const { return l + 1 < levels ? first[l + 1] : 0; }
};

/// Sets what a node of a packed tree is, but for its boxes: number `i` of its level.
COLLIDE_HD_INLINE void place_node(tree_node& node, std::size_t i, std::size_t boxes, std::size_t first_above) {
  node.there = boxes < tree_node::width ? (1u << boxes) - 1 : 0xffu;
  node.parent = static_cast<std::uint32_t>(first_above + i / tree_node::width);
  node.slot = static_cast<std::uint32_t>(i % tree_node::width);
  node.continues = 0;
}

/// Kernel functor of `for_each` over the nodes of the lowest level.
template <class S>
struct pack_triangles_in_nodes {
  mesh_view<S> mesh;
  id const* ids;  ///< in order
  tree_node* to;
  std::size_t first_above;

  COLLIDE_HD void operator()(std::size_t i) const {
    std::size_t const first = i * tree_node::width, n = min<std::size_t>(tree_node::width, mesh.size() - first);
    tree_node& node = to[i];
    vec3<S> const origin = tree_origin(mesh);
    for (std::size_t k = 0; k < tree_node::width; ++k) {
      id const t = k < n ? ids[first + k] : 0;
      node.set(static_cast<int>(k), k < n ? tree_box_of(mesh[t], origin) : aabb<float>::empty(), t | tree_node::leaf);
    }
    place_node(node, i, n, first_above);
  }
};

/// Kernel functor of `for_each` over the nodes of a level above.
struct pack_nodes {
  tree_node* nodes;
  std::size_t first, first_below, below, first_above;  ///< numbers of nodes, and how many there are below

  COLLIDE_HD void operator()(std::size_t i) const {
    std::size_t const begin = i * tree_node::width, n = min<std::size_t>(tree_node::width, below - begin);
    tree_node& node = nodes[first + i];
    for (std::size_t k = 0; k < tree_node::width; ++k) {
      std::size_t const child = first_below + begin + k;
      node.set(static_cast<int>(k), k < n ? nodes[child].box() : aabb<float>::empty(),
               static_cast<std::uint32_t>(child));
    }
    place_node(node, i, n, first_above);
  }
};

/// Makes the tree.
template <class S>
class packed_tree {
 public:
  template <class Space>
  void build(Space& space, mesh_view<S> const& mesh, buffer<tree_node>& memory) {
    sort(space, mesh);
    tree_levels const l(mesh.size());
    memory.reserve(space.resource(), l.nodes);
    refit(space, mesh, memory);
  }

  /// Makes the boxes of a mesh with as many triangles as that of the last build, in the order that they had.
  /// O(triangles); allocates nothing.
  template <class Space>
  void refit(Space& space, mesh_view<S> const& mesh, buffer<tree_node>& memory) {
    tree_levels const l(mesh.size());
    tree_node* const nodes = memory.data();
    space.for_each(l.count[0], pack_triangles_in_nodes<S>{mesh, sorted_, nodes + l.first[0], l.above(0)});
    for (int k = 1; k < l.levels; ++k)
      space.for_each(l.count[k], pack_nodes{nodes, l.first[k], l.first[k - 1], l.count[k - 1], l.above(k)});
  }

  /// Puts triangles in the order of the curve, of equal places the lowest number first, and makes `summary`.
  template <class Space>
  void sort(Space& space, mesh_view<S> const& mesh) {
    std::size_t const n = mesh.size();
    auto* const summary = summary_.reserve(space.resource(), 1);
    mesh_statistics<S>::clear(space, summary);
    compute_mesh_statistics<S> const seen{mesh, summary, nullptr};
    space.launch(grid_size<Space>(n, seen), seen);
    std::uint64_t* const places = places_.reserve(space.resource(), 2 * n);
    id* const ids = ids_.reserve(space.resource(), 2 * n);
    space.for_each(n, find_places<S>{mesh, summary, places, ids});
    sorted_ = sort(space, places, ids, n);
  }

  /// The numbers of the triangles in order,
  id const* sorted() const { return sorted_; }
  /// and statistics of the mesh, in memory of the space.
  mesh_statistics<S> const* summary() const { return summary_.data(); }

 private:
  template <class Space>
  id const* sort([[maybe_unused]] Space& space, std::uint64_t* places, id* ids, std::size_t n) {
    if constexpr (Space::host_accessible) {
      std::stable_sort(ids, ids + n, [&](id a, id b) { return places[a] < places[b]; });
      return ids;
    } else {
#if defined(__CUDACC__)
      sort_ids_on_device(space.stream(), space.resource(), places, places + n, ids, ids + n, n,
                         3 * find_places<S>::bits + 1, scratch_);
      return ids + n;
#else
      throw error("collide: bvh: triangles in memory of a device are sorted where nvcc compiles the program");
#endif
    }
  }

  id const* sorted_ = nullptr;
  buffer<mesh_statistics<S>> summary_;
  buffer<std::uint64_t> places_;
  buffer<id> ids_;
  buffer<unsigned char> scratch_;
};

}  // namespace collide::detail

#pragma GCC diagnostic pop
