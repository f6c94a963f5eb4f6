/// \file
/// A tree of boxes made by many threads at once: triangles in the order of a curve through space are divided where the
/// highest bit of their places changes, so that boxes overlap little (T. Karras, "Maximizing parallelism in the
/// construction of BVHs, octrees, and k-d trees", 2012; splits are known by the place before them, as C. Apetrei has
/// it, "Fast and simple agglomerative LBVH construction", 2014). Of that binary tree each node takes three levels; the
/// largest parts of at most eight triangles are a node each.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/detail/execution/aggregated_count.hpp>
#include <collide/detail/tree/curve_order.hpp>
#include <collide/detail/tree/tree_node.hpp>

// the numbers of elements of small arrays are int
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-conversion"

namespace collide::detail {

/// Triangles that follow each other in the order of the curve.
struct curve_range {
  id first, last;  ///< inclusive

  COLLIDE_HD_INLINE id size() const { return last - first + 1; }
};

/// Where the triangles of a range are divided, and what they are a part of. Split `i` lies between the triangles at `i`
/// and at `i + 1` in the order; each is of one range.
struct curve_splits {
  std::uint64_t const* places;  ///< in order
  id triangles;

  /// How many leading bits two places have in common; those of equal places, their numbers.
  COLLIDE_HD_INLINE int common(id i, id j) const {
    std::uint64_t const differ = places[i] ^ places[j];
    return differ != 0 ? leading_zeros(differ) : 64 + leading_zeros(i ^ j);
  }

  /// The range that is divided at split `i`: all that has more in common with either side than those two have.
  COLLIDE_HD id furthest(id from, id steps, bool up, int more_than) const {
    auto const at = [&](id d) { return up ? from + d : from - d; };
    auto const reaches = [&](id d) { return d <= steps && common(from, at(d)) > more_than; };
    id step = 1, d = 0;
    while (reaches(step)) step *= 2;
    for (; step != 0; step /= 2) d += reaches(d + step) ? step : 0;
    return at(d);
  }
  COLLIDE_HD curve_range range_of(id i) const {
    int const between = common(i, i + 1);
    return {furthest(i, i, false, between), furthest(i + 1, triangles - 2 - i, true, between)};
  }

  /// The split of a range of two triangles or more.
  COLLIDE_HD id split_of(curve_range const& r) const {
    return furthest(r.first, r.last - r.first, true, common(r.first, r.last));
  }

  COLLIDE_HD_INLINE bool is_whole(curve_range const& r) const { return r.first == 0 && r.last == triangles - 1; }

  /// The split whose range is divided into this one and another.
  COLLIDE_HD_INLINE id above(curve_range const& r) const {
    if (r.first == 0) return r.last;
    if (r.last == triangles - 1) return r.first - 1;
    return common(r.first - 1, r.first) > common(r.last, r.last + 1) ? r.first - 1 : r.last;
  }
};

/// Kernel functor of `for_each` over splits.
struct find_ranges {
  curve_splits splits;
  curve_range* ranges;

  COLLIDE_HD void operator()(std::size_t i) const { ranges[i] = splits.range_of(static_cast<id>(i)); }
};

/// Kernel functor of `for_each` over splits: gives those numbers that are nodes, 0 to the root.
struct number_nodes {
  curve_splits splits;
  curve_range const* ranges;
  std::uint32_t* numbers;  ///< of nodes, or `no_id`
  std::uint32_t* nodes;    ///< how many there are but for the root

  COLLIDE_HD void operator()(std::size_t i) const {
    bool const counts = is_node(ranges[i]);
    aggregated_count<1> count;
    count.match([](std::uint32_t) { return 0u; }, counts ? 1 : 0);
    count.add([&](std::uint32_t) { return nodes; });
    std::uint32_t const before = count.before(0);
    numbers[i] = counts ? 1 + before : (splits.is_whole(ranges[i]) ? 0 : no_id);
  }

 private:
  COLLIDE_HD bool is_node(curve_range r) const {
    if (splits.is_whole(r)) return false;
    bool const is_lowest = r.size() <= tree_node::width;
    r = ranges[splits.above(r)];
    if (is_lowest) return r.size() > tree_node::width;
    int levels = 1;
    for (; !splits.is_whole(r); ++levels) r = ranges[splits.above(r)];
    return levels % 3 == 0;
  }
};

/// Kernel functor of `for_each` over splits: sets what a node is, but for its boxes.
struct link_nodes {
  curve_splits splits;
  curve_range const* ranges;
  std::uint32_t const* numbers;
  id const* ids;  ///< of triangles, in order
  tree_node* nodes;
  std::uint32_t* slots;  ///< of triangles, in order: eight times the number of a node, and which of its boxes

  COLLIDE_HD void operator()(std::size_t i) const {
    if (numbers[i] == no_id) return;
    curve_range parts[tree_node::width];
    std::uint32_t const n = divide(static_cast<id>(i), parts), number = numbers[i];
    tree_node& node = nodes[number];
    for (std::uint32_t k = 0; k < tree_node::width; ++k) {
      node.set(static_cast<int>(k), aabb<float>::empty(), tree_node::leaf);
      if (k >= n) continue;
      curve_range const part = parts[k];
      if (part.size() == 1) {
        node.child[k] = ids[part.first] | tree_node::leaf;
        slots[part.first] = tree_node::width * number + k;
      } else {
        std::uint32_t const child = node.child[k] = numbers[splits.split_of(part)];
        nodes[child].parent = number;
        nodes[child].slot = k;
      }
    }
    node.there = (1u << n) - 1;
    node.continues = node.arrived = 0;
    if (number == 0) node.parent = node.slot = 0;
  }

 private:
  /// What is in the boxes of a node: triangles, and ranges that are nodes.
  COLLIDE_HD std::uint32_t divide(id split, curve_range (&parts)[tree_node::width]) const {
    curve_range const whole = ranges[split];
    std::uint32_t n = 0;
    if (whole.size() <= tree_node::width) {
      for (id t = whole.first; t <= whole.last; ++t) parts[n++] = {t, t};
      return n;
    }
    parts[n++] = {whole.first, split};
    parts[n++] = {split + 1, whole.last};
    for (int level = 1; level < 3; ++level) {
      for (std::uint32_t k = n; k-- != 0;) {
        curve_range const part = parts[k];
        if (part.size() == 1) continue;
        id const at = splits.split_of(part);
        if (numbers[at] != no_id) continue;
        parts[k] = {part.first, at};
        parts[n++] = {at + 1, part.last};
      }
    }
    return n;
  }
};

/// Kernel functor of `for_each` over triangles in order: each makes its box; whoever is the last in a node goes on with
/// the box around all.
template <class S>
struct fit_boxes {
  mesh_view<S> mesh;
  id const* ids;
  std::uint32_t const* slots;
  tree_node* nodes;

  COLLIDE_HD void operator()(std::size_t i) const {
    aabb<float> box = tree_box_of(mesh[ids[i]], tree_origin(mesh));
    for (std::uint32_t slot = slots[i];;) {
      tree_node& node = nodes[slot / tree_node::width];
      node.set_box(static_cast<int>(slot % tree_node::width), box);
      thread_fence();
      std::uint32_t const arrived = fetch_add(&node.arrived, 1u) + 1;
      if ((1u << arrived) - 1 != node.there) return;
      thread_fence();
      node.arrived = 0;
      if (slot < tree_node::width) return;  // of the root
      box = node.box();
      slot = node.parent * tree_node::width + node.slot;
    }
  }
};

/// Makes the tree.
template <class S>
class radix_tree {
 public:
  /// The most nodes of a tree. Those of triangles have two at least, and where they have two the others are not more
  /// than a third of them.
  static std::size_t most_nodes(std::size_t triangles) { return triangles / 3 * 2 + 3; }

  /// O(triangles).
  template <class Space>
  void build(Space& space, mesh_view<S> const& mesh, buffer<tree_node>& memory) {
    std::size_t const n = mesh.size();
    if (n == 0) return;
    order_.sort(space, mesh);
    curve_splits const splits{order_.places(), static_cast<id>(n)};
    auto* const nodes = memory.reserve(space.resource(), most_nodes(n));
    auto* const ranges = ranges_.reserve(space.resource(), n);
    auto* const numbers = numbers_.reserve(space.resource(), n + 1);  // and how many there are
    auto* const slots = slots_.reserve(space.resource(), n);
    space.fill(numbers + n, 0, sizeof *numbers);
    if (n == 1) {
      space.fill(ranges, 0, sizeof *ranges);
    } else {
      space.for_each(n - 1, find_ranges{splits, ranges});
    }
    std::size_t const count = n == 1 ? 1 : n - 1;
    space.for_each(count, number_nodes{splits, ranges, numbers, numbers + n});
    space.for_each(count, link_nodes{splits, ranges, numbers, order_.ids(), nodes, slots});
    refit(space, mesh, memory);
  }

  /// Makes the boxes of a mesh with as many triangles as that of the last build, in the order that they had.
  /// O(triangles); allocates nothing.
  template <class Space>
  void refit(Space& space, mesh_view<S> const& mesh, buffer<tree_node>& memory) {
    if (mesh.size() == 0) return;
    space.for_each(mesh.size(), fit_boxes<S>{mesh, order_.ids(), slots_.data(), memory.data()});
  }

 private:
  curve_order<S> order_;
  buffer<curve_range> ranges_;
  buffer<std::uint32_t> numbers_, slots_;
};

}  // namespace collide::detail

#pragma GCC diagnostic pop
