/// \file
/// A tree of boxes made by many threads at once. Triangles in the order of a curve through space are cut into groups of
/// about 32, and these into parts of at most eight, where the highest bit of their places changes: so boxes overlap
/// little, and nodes are rather full. Above the groups is a radix tree (T. Karras, "Maximizing parallelism in the
/// construction of BVHs, octrees, and k-d trees", 2012; splits are known by the place before them, as C. Apetrei has
/// it, "Fast and simple agglomerative LBVH construction", 2014), of which each node takes three levels.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/broad/detail/tree/curve_order.hpp>
#include <collide/broad/detail/tree/tree_node.hpp>
#include <collide/spaces/detail/atomic.hpp>

namespace collide::detail {

/// Places along the curve, in order.
struct curve_places {
  std::uint64_t const* places;

  /// How many leading bits two places have in common; those of equal places, their numbers.
  COLLIDE_HD_INLINE int common(id i, id j) const {
    std::uint64_t const differ = places[i] ^ places[j];
    return differ != 0 ? leading_zeros(differ) : 64 + leading_zeros(i ^ j);
  }

  /// The best cut between two: before the one that has the least in common with the one before, from `from` to `to`.
  COLLIDE_HD_INLINE id best_cut(id from, id to) const {
    id best = from;
    int fewest = common(from - 1, from);
    for (id i = from + 1; i <= to; ++i) {
      int const here = common(i - 1, i);
      best = here < fewest ? i : best;
      fewest = min(here, fewest);
    }
    return best;
  }
};

/// Groups of triangles, and the numbers of nodes: those above groups first, then one for each group, then
/// those that have nothing but triangles.
struct curve_groups {
  static constexpr id size = 32;  ///< of a group, about: from 1 to twice as much less one

  id triangles, count;

  explicit curve_groups(std::size_t n)
      : triangles{static_cast<id>(n)}, count{n < size ? 1 : static_cast<id>((n + size / 2) / size)} {}

  std::size_t nodes() const { return std::size_t{3} * count + triangles / tree_node::width; }
  COLLIDE_HD_INLINE std::uint32_t node_of(id group) const { return count == 1 ? 0 : count + group; }
  /// The first of the nodes with the triangles of a group, whose first triangle is at place `first`: each group has
  /// room for one node more than it fills.
  COLLIDE_HD_INLINE std::uint32_t first_part_of(id group, id first) const {
    return 2 * count + group + first / tree_node::width;
  }
};

/// Kernel functor of `for_each` over groups and what is behind the last.
struct cut_groups {
  curve_groups groups;
  curve_places triangles;
  id* firsts;             ///< the first triangle of each group
  std::uint64_t* places;  ///< of groups

  COLLIDE_HD void operator()(std::size_t i) const {
    id const group = static_cast<id>(i), middle = group * curve_groups::size, half = curve_groups::size / 2;
    id first = 0;
    if (group == groups.count) {
      first = groups.triangles;
    } else if (group != 0) {
      first = triangles.best_cut(middle - half, min(middle + half, groups.triangles) - 1);
    }
    firsts[group] = first;
    if (group < groups.count) places[group] = triangles.places[first];
  }
};

/// Groups that follow each other.
struct curve_range {
  id first, last;  ///< inclusive

  COLLIDE_HD_INLINE id size() const { return last - first + 1; }
};

/// Splits of ranges of groups, and what ranges are a part of. Split `i` lies between the groups `i` and `i + 1`;
/// each is of one range.
struct curve_splits {
  curve_places groups;
  id count;

  COLLIDE_HD curve_range range_of(id i) const {
    int const between = groups.common(i, i + 1);
    return {furthest(i, i, false, between), furthest(i + 1, count - 2 - i, true, between)};
  }

  COLLIDE_HD id split_of(curve_range const& r) const {
    return furthest(r.first, r.last - r.first, true, groups.common(r.first, r.last));
  }

  COLLIDE_HD_INLINE bool is_whole(curve_range const& r) const { return r.size() == count; }

  /// The split whose range is divided into this one and another.
  COLLIDE_HD_INLINE id above(curve_range const& r) const {
    if (r.first == 0) return r.last;
    if (r.last == count - 1) return r.first - 1;
    return groups.common(r.first - 1, r.first) > groups.common(r.last, r.last + 1) ? r.first - 1 : r.last;
  }

 private:
  /// The last group, at most some steps up or down, that has more in common with one than so many bits.
  COLLIDE_HD id furthest(id from, id steps, bool up, int more_than) const {
    auto const at = [&](id d) { return up ? from + d : from - d; };
    auto const reaches = [&](id d) { return d <= steps && groups.common(from, at(d)) > more_than; };
    id step = 1, d = 0;
    while (reaches(step)) step *= 2;
    for (; step != 0; step /= 2) d += reaches(d + step) ? step : 0;
    return at(d);
  }
};

/// Kernel functor of `for_each` over splits.
struct find_ranges {
  curve_splits splits;
  curve_range* ranges;

  COLLIDE_HD void operator()(std::size_t i) const { ranges[i] = splits.range_of(static_cast<id>(i)); }
};

/// Kernel functor of `for_each` over splits: which are nodes, and their numbers.
struct number_nodes {
  curve_splits splits;
  curve_range const* ranges;
  std::uint32_t* numbers;  ///< of nodes, 0 the root, or `no_id`

  COLLIDE_HD void operator()(std::size_t i) const {
    int levels = 0;
    for (curve_range r = ranges[i]; !splits.is_whole(r); ++levels) r = ranges[splits.above(r)];
    numbers[i] = levels == 0 ? 0 : (levels % 3 == 0 ? static_cast<std::uint32_t>(i) + 1 : no_id);
  }
};

/// Sets what is in the boxes of a node, and where it is: its boxes come later.
struct node_links {
  tree_node* nodes;
  std::uint32_t number;

  /// Box `k` is of a node.
  COLLIDE_HD_INLINE void set_node(std::uint32_t k, std::uint32_t child) const {
    nodes[number].child[k] = child;
    nodes[child].parent = number;
    nodes[child].slot = k;
  }

  /// There are `n` boxes. The root has nothing above it.
  COLLIDE_HD_INLINE void finish(std::uint32_t n) const {
    tree_node& node = nodes[number];
    for (std::uint32_t k = n; k < tree_node::width; ++k)
      node.set(static_cast<int>(k), aabb<float>::empty(), tree_node::leaf);
    node.there = (1u << n) - 1;
    node.continues = node.arrived = 0;
    if (number == 0) node.parent = node.slot = 0;
  }
};

/// Kernel functor of `for_each` over splits: the nodes above groups.
struct link_nodes {
  curve_groups groups;
  curve_splits splits;
  curve_range const* ranges;
  std::uint32_t const* numbers;
  tree_node* nodes;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (numbers[i] == no_id) return;
    auto const split = static_cast<id>(i);
    curve_range parts[tree_node::width] = {{ranges[i].first, split}, {split + 1, ranges[i].last}};
    std::uint32_t n = 2;
    for (int level = 1; level < 3; ++level) {
      for (std::uint32_t k = n; k-- != 0;) {
        curve_range const part = parts[k];
        if (part.size() == 1) continue;
        id const at = splits.split_of(part);
        parts[k] = {part.first, at};
        parts[n++] = {at + 1, part.last};
      }
    }
    node_links const links{nodes, numbers[i]};
    for (std::uint32_t k = 0; k < n; ++k)
      links.set_node(k, parts[k].size() == 1 ? groups.node_of(parts[k].first) : numbers[splits.split_of(parts[k])]);
    links.finish(n);
  }
};

/// Kernel functor of `for_each` over groups: the nodes of a group, and of its triangles.
struct divide_groups {
  curve_groups groups;
  curve_places triangles;
  id const* ids;     ///< of triangles, in order
  id const* firsts;  ///< of groups
  tree_node* nodes;
  std::uint32_t* slots;  ///< of triangles, in order: eight times the number of a node, and which of its boxes

  COLLIDE_HD void operator()(std::size_t i) const {
    auto const group = static_cast<id>(i);
    id const end = firsts[i + 1];
    id at = firsts[i];
    std::uint32_t const own = groups.node_of(group), parts = (end - at + width - 1) / width;
    if (parts == 1) {
      set_triangles(own, at, end);
      return;
    }
    std::uint32_t part = groups.first_part_of(group, at);
    node_links const links{nodes, own};
    for (std::uint32_t k = 0; k < parts; ++k, ++part) {
      id const left = parts - 1 - k;  // as many of the parts are to come
      id const next =
          left == 0 ? end : triangles.best_cut(at + 1 + overflow(end - at - 1, left), min(at + width, end - left));
      links.set_node(k, part);
      set_triangles(part, at, next);
      at = next;
    }
    links.finish(parts);
  }

 private:
  static constexpr id width = tree_node::width;

  /// How many of `n` triangles have no room in so many parts.
  static COLLIDE_HD_INLINE id overflow(id n, id parts) { return n > parts * width ? n - parts * width : 0; }

  COLLIDE_HD_INLINE void set_triangles(std::uint32_t number, id first, id end) const {
    for (id t = first; t < end; ++t) {
      nodes[number].child[t - first] = ids[t] | tree_node::leaf;
      slots[t] = tree_node::width * number + (t - first);
    }
    node_links{nodes, number}.finish(end - first);
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

template <class S>
class radix_tree {
 public:
  /// O(triangles).
  template <class Space>
  void build(Space& space, mesh_view<S> const& mesh, buffer<tree_node>& memory) {
    if (mesh.size() == 0) return;
    order_.sort(space, mesh);
    curve_places const triangles{order_.places()};
    curve_groups const groups(mesh.size());
    auto* const nodes = memory.reserve(space.resource(), groups.nodes());
    auto* const slots = slots_.reserve(space.resource(), mesh.size());
    auto* const firsts = firsts_.reserve(space.resource(), groups.count + 1);
    auto* const places = places_.reserve(space.resource(), groups.count);
    space.for_each(groups.count + 1, cut_groups{groups, triangles, firsts, places});
    space.for_each(groups.count, divide_groups{groups, triangles, order_.ids(), firsts, nodes, slots});
    if (id const count = groups.count - 1; count != 0) {
      curve_splits const splits{{places}, groups.count};
      auto* const ranges = ranges_.reserve(space.resource(), count);
      auto* const numbers = numbers_.reserve(space.resource(), count);
      space.for_each(count, find_ranges{splits, ranges});
      space.for_each(count, number_nodes{splits, ranges, numbers});
      space.for_each(count, link_nodes{groups, splits, ranges, numbers, nodes});
    }
    refit(space, mesh, memory);
  }

  /// Makes the boxes of a mesh with as many triangles as that of the last build, in the order that they had.
  /// O(triangles); allocates nothing.
  template <class Space>
  void refit(Space& space, mesh_view<S> const& mesh, buffer<tree_node>& memory) {
    if (mesh.size() == 0) return;
    space.for_each(mesh.size(), fit_boxes<S>{mesh, order_.ids(), slots_.data(), memory.data()});
  }

  mesh_statistics<S> const* summary() const { return order_.summary(); }

 private:
  curve_order<S> order_;
  buffer<id> firsts_;
  buffer<std::uint64_t> places_;
  buffer<curve_range> ranges_;
  buffer<std::uint32_t> numbers_, slots_;
};

}  // namespace collide::detail
