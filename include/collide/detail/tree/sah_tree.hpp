/// \file
/// A tree of boxes for the host: triangles are divided where that costs a query least by the surface area heuristic, of
/// which some planes are tried (I. Wald, "On fast construction of SAH-based bounding volume hierarchies", 2007).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <collide/detail/execution/algorithms.hpp>
#include <collide/detail/execution/atomic.hpp>
#include <collide/detail/tree/tree_node.hpp>
#include <collide/memory.hpp>

// the numbers of elements of small arrays are int
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-conversion"

namespace collide::detail {

/// A triangle while the tree is made.
struct boxed_triangle {
  aabb<float> box;
  id triangle;

  /// Twice the middle of the box on an axis.
  float middle(int axis) const { return box.lower[axis] + box.upper[axis]; }
};

/// Triangles that follow each other, and the boxes around them and around the middles of theirs.
struct triangle_range {
  std::uint32_t begin, end;
  aabb<float> box, middles;

  std::uint32_t size() const { return end - begin; }

  void add(boxed_triangle const& t) {
    box = aabb<float>::merge{}(box, t.box);
    for (int k = 0; k < 3; ++k) {
      float const m = t.middle(k);
      middles.lower[k] = smaller(middles.lower[k], m);
      middles.upper[k] = larger(middles.upper[k], m);
    }
  }

  static triangle_range of(boxed_triangle const* from, std::uint32_t begin, std::uint32_t end) {
    triangle_range r{begin, end, aabb<float>::empty(), aabb<float>::empty()};
    for (std::uint32_t i = begin; i < end; ++i) r.add(from[i]);
    return r;
  }
};

/// Half the surface of a box; 0 of an empty one.
inline float half_surface(aabb<float> const& b) {
  if (b.is_empty()) return 0;
  float const x = b.upper[0] - b.lower[0], y = b.upper[1] - b.lower[1], z = b.upper[2] - b.lower[2];
  return x * y + (y * z + z * x);
}

/// Divides ranges of triangles. Nodes at the lowest level get as many as they have room for.
class range_divider {
 public:
  explicit range_divider(boxed_triangle* triangles) : all_{triangles} {}

  /// Divides a range of more triangles than a node has room for; `halves`: at its middle, however that is.
  void divide(triangle_range const& range, bool halves, triangle_range& left, triangle_range& right) {
    plane p{-1, 0, 0, 0};
    if (!halves) p = best_plane(range);
    std::uint32_t middle = range.begin + range.size() / 2;
    if (p.axis >= 0) {
      auto* const found = std::partition(all_ + range.begin, all_ + range.end,
                                         [&](boxed_triangle const& t) { return p.bin_of(t) <= p.bin; });
      middle = static_cast<std::uint32_t>(found - all_);
    }
    if (middle == range.begin || middle == range.end) middle = range.begin + range.size() / 2;
    constexpr std::uint32_t few = 8 * tree_node::width;
    bool const large = range.size() > 8 * few && middle - range.begin >= few && range.end - middle >= few;
    if (!large || p.axis < 0) middle = fill_nodes(range, middle, larger(p.axis, 0));
    left = triangle_range::of(all_, range.begin, middle);
    right = triangle_range::of(all_, middle, range.end);
  }

 private:
  static constexpr int bins = 16;

  struct plane {
    int axis;  ///< -1: none
    int bin;   ///< the last one before the plane
    float first, scale;

    int bin_of(boxed_triangle const& t) const {
      return smaller(static_cast<int>((t.middle(axis) - first) * scale), bins - 1);
    }
  };

  /// The plane where nodes are, of all in the range, least likely to be visited.
  plane best_plane(triangle_range const& range) const {
    plane best{-1, 0, 0, 0};
    float least = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      float const first = range.middles.lower[axis], extent = range.middles.upper[axis] - first;
      float const scale = bins * (1 - 0x1p-20f) / extent;
      if (!(extent > 0) || !is_finite(extent) || !is_finite(scale)) continue;
      plane p{axis, 0, first, scale};
      std::uint32_t counts[bins] = {};
      aabb<float> boxes[bins];
      for (auto& box : boxes) box = aabb<float>::empty();
      for (std::uint32_t i = range.begin; i < range.end; ++i) {
        int const b = p.bin_of(all_[i]);
        ++counts[b];
        boxes[b] = aabb<float>::merge{}(boxes[b], all_[i].box);
      }
      float behind[bins];  // what is behind a plane costs
      aabb<float> box = aabb<float>::empty();
      std::uint32_t n = 0;
      for (int b = bins - 1; b > 0; --b) {
        box = aabb<float>::merge{}(box, boxes[b]);
        behind[b - 1] = cost(box, n += counts[b]);
      }
      box = aabb<float>::empty();
      n = 0;
      for (p.bin = 0; p.bin < bins - 1; ++p.bin) {
        box = aabb<float>::merge{}(box, boxes[p.bin]);
        float const all = cost(box, n += counts[p.bin]) + behind[p.bin];
        if (n == 0 || n == range.size() || !(all < least)) continue;
        least = all;
        best = p;
      }
    }
    return best;
  }

  static float cost(aabb<float> const& box, std::uint32_t n) {
    return half_surface(box) * static_cast<float>((n + tree_node::width - 1) / tree_node::width);
  }

  /// Moves the end of the left part to where full nodes end, and triangles next to the plane to the other side.
  std::uint32_t fill_nodes(triangle_range const& range, std::uint32_t middle, int axis) {
    constexpr std::uint32_t n = tree_node::width;
    std::uint32_t const wanted = larger((middle - range.begin + n / 2) / n, 1u) * n, most = (range.size() - 1) / n * n;
    std::uint32_t const to = range.begin + smaller(wanted, most);
    if (to == middle) return to;
    auto const before = [&](boxed_triangle const& a, boxed_triangle const& b) { return a.middle(axis) < b.middle(axis); };
    bool const from_left = to < middle;
    std::nth_element(all_ + (from_left ? range.begin : middle), all_ + to, all_ + (from_left ? middle : range.end),
                     before);
    return to;
  }

  boxed_triangle* all_;
};

/// Makes the tree.
template <class S>
class sah_tree {
 public:
  /// Returns false if no triangle is finite: there is no tree then.
  template <class Space>
  bool build(Space& space, mesh_view<S> const& mesh, buffer<tree_node>& memory) {
    std::size_t const n = mesh.size();
    all_ = triangles_.reserve(space.resource(), n);
    vec3<S> const origin = tree_origin(mesh);
    space.for_each(n, [&](std::size_t i) { all_[i] = {tree_box_of(mesh[i], origin), static_cast<id>(i)}; });
    auto const* const end = std::partition(all_, all_ + n, [](boxed_triangle const& t) { return !t.box.is_empty(); });
    auto const finite = static_cast<std::uint32_t>(end - all_);
    if (finite == 0) return false;
    nodes_ = memory.reserve(space.resource(), most_nodes(finite));
    used_ = 1;
    tasks_ = 0;
    nodes_[0].parent = nodes_[0].slot = 0;
    most_at_once_ = larger(finite / 64, 4096u);
    task const root{triangle_range::of(all_, 0, finite), 0, 0};
    build_node(root, true);
    for_each_block(space, tasks_, [&](std::size_t i) { build_node(waiting_[i], false); });
    return true;
  }

 private:
  static constexpr int width = tree_node::width, most_tasks = 1024, most_uneven = 40;  // levels

  /// A node to be made.
  struct task {
    triangle_range range;
    std::uint32_t node;
    int level;
  };

  /// Of the parts of ranges that are divided anywhere, of at least 64 triangles, one node each is not full; and a node
  /// above the lowest level has at least two below.
  static std::size_t most_nodes(std::size_t triangles) { return triangles / 4 + triangles / 32 + 16; }

  /// Makes a node and all below. `postpones`: what has few triangles waits until threads do it.
  void build_node(task const& t, bool postpones) {
    if (postpones && t.range.size() <= most_at_once_ && tasks_ < most_tasks) {
      waiting_[tasks_++] = t;
      return;
    }
    tree_node& node = nodes_[t.node];
    triangle_range parts[width];
    int n = 0;
    if (t.range.size() <= width) {
      for (std::uint32_t i = t.range.begin; i < t.range.end; ++i)
        node.set(n++, all_[i].box, all_[i].triangle | tree_node::leaf);
    } else {
      n = divide(t, parts);
      for (int k = 0; k < n; ++k) {
        bool const one = parts[k].size() == 1;
        std::uint32_t const child = one ? all_[parts[k].begin].triangle | tree_node::leaf : fetch_add(&used_, 1u);
        node.set(k, parts[k].box, child);
      }
    }
    node.there = (1u << n) - 1;
    for (int k = n; k < width; ++k) node.set(k, aabb<float>::empty(), 0);
    for (int k = 0; k < n; ++k) {
      std::uint32_t const child = node.child[k];
      if ((child & tree_node::leaf) != 0) continue;
      nodes_[child].parent = t.node;
      nodes_[child].slot = static_cast<std::uint32_t>(k);
      build_node({parts[k], child, t.level + 1}, postpones);
    }
  }

  /// Divides a range into as many as a node has room for, always the one with the largest surface.
  int divide(task const& t, triangle_range (&parts)[width]) {
    bool const halves = t.level >= most_uneven;
    parts[0] = t.range;
    int n = 1;
    for (; n < width; ++n) {
      int chosen = -1;
      float most = -1;
      for (int k = 0; k < n; ++k) {
        if (parts[k].size() <= width) continue;
        float const size = halves ? static_cast<float>(parts[k].size()) : half_surface(parts[k].box);
        if (size > most || chosen < 0) most = size, chosen = k;
      }
      if (chosen < 0) break;
      triangle_range const whole = parts[chosen];
      range_divider(all_).divide(whole, halves, parts[chosen], parts[n]);
    }
    return n;
  }

  buffer<boxed_triangle> triangles_;
  boxed_triangle* all_ = nullptr;
  tree_node* nodes_ = nullptr;
  std::uint32_t used_ = 0;
  std::uint32_t most_at_once_ = 0;
  task waiting_[most_tasks];
  std::size_t tasks_ = 0;
};

}  // namespace collide::detail

#pragma GCC diagnostic pop
