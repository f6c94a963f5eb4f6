/// \file
/// A tree of boxes for the host: triangles are divided where that costs a query least by the surface area heuristic, of
/// which some planes are tried (I. Wald, "On fast construction of SAH-based bounding volume hierarchies", 2007).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <collide/broad/detail/tree/tree_node.hpp>
#include <collide/broad/detail/tree/triangle_pieces.hpp>
#include <collide/core/memory.hpp>
#include <collide/spaces/detail/algorithms.hpp>
#include <collide/spaces/detail/atomic.hpp>
#include <collide/spaces/detail/multiversion.hpp>

namespace collide::detail {

/// A box as what is largest of it: -lower, a gap, upper, a gap. So a loop of one kind merges two.
struct box_ends {
  static constexpr int size = 8;
  float ends[size];

  static box_ends empty() {
    constexpr float far = -std::numeric_limits<float>::infinity();
    return {{far, far, far, far, far, far, far, far}};
  }
  static box_ends of(aabb<float> const& b) {
    return {{-b.lower[0], -b.lower[1], -b.lower[2], 0, b.upper[0], b.upper[1], b.upper[2], 0}};
  }
  aabb<float> box() const { return {{-ends[0], -ends[1], -ends[2]}, {ends[4], ends[5], ends[6]}}; }

  void add(box_ends const& other) {
    for (int k = 0; k < size; ++k) ends[k] = max(ends[k], other.ends[k]);
  }

  /// Twice the middle on an axis.
  float middle(int axis) const { return ends[4 + axis] - ends[axis]; }

  /// Half the surface; 0 of nothing.
  float half_surface() const {
    float const x = ends[0] + ends[4], y = ends[1] + ends[5], z = ends[2] + ends[6];
    return x >= 0 ? x * y + (y * z + z * x) : 0.0f;
  }
};

/// A triangle, or a piece of one, while the tree is made.
struct boxed_triangle {
  box_ends box;
  id triangle;  ///< or the number of the piece

  float middle(int axis) const { return box.middle(axis); }
};

/// Triangles that follow each other, and the boxes around them and around the middles of theirs.
struct triangle_range {
  std::uint32_t begin, end;
  box_ends box, middles;

  std::uint32_t size() const { return end - begin; }
};

/// Divides ranges of triangles. Nodes at the lowest level get as many as they have room for.
class range_divider {
 public:
  explicit range_divider(boxed_triangle* triangles) : all_{triangles} {}

  triangle_range range_of(std::uint32_t begin, std::uint32_t end) const {
    triangle_range r{begin, end, box_ends::empty(), box_ends::empty()};
    multiversioned([&] {
      for (std::uint32_t i = begin; i < end; ++i) {
        box_ends const& b = all_[i].box;
        r.box.add(b);
        box_ends middle{};
        for (int k = 0; k < 4; ++k) middle.ends[k + 4] = b.ends[k + 4] - b.ends[k];
        for (int k = 0; k < 4; ++k) middle.ends[k] = -middle.ends[k + 4];
        r.middles.add(middle);
      }
    });
    return r;
  }

  /// Divides a range of more triangles than a node has room for; `halves`: at its middle, however that is.
  void divide(triangle_range const& range, bool halves, triangle_range& left, triangle_range& right) {
    plane p{-1, 0, 0, 0};
    if (!halves) p = best_plane(range);
    std::uint32_t middle = range.begin + range.size() / 2;
    if (p.axis >= 0) {
      auto* const found = std::partition(all_ + range.begin, all_ + range.end,
                                         [&](boxed_triangle const& t) { return p.bin_of(t, p.axis) <= p.bin; });
      middle = static_cast<std::uint32_t>(found - all_);
    }
    if (middle == range.begin || middle == range.end) middle = range.begin + range.size() / 2;
    constexpr std::uint32_t few = 8 * tree_node::width;
    bool const large = range.size() > 8 * few && middle - range.begin >= few && range.end - middle >= few;
    if (!large || p.axis < 0) middle = fill_nodes(range, middle, max(p.axis, 0));
    left = range_of(range.begin, middle);
    right = range_of(middle, range.end);
  }

 private:
  static constexpr int bins = 16;

  struct plane {
    int axis;  ///< -1: none
    int bin;   ///< the last one before the plane
    float first, scale;

    int bin_of(boxed_triangle const& t, int of_axis) const {
      float const x = (t.middle(of_axis) - first) * scale;
      return static_cast<int>(select(x > 0, min(x, float(bins - 1)), 0.0f));  // 0 where it is NaN
    }
  };

  /// The plane where nodes are, of all in the range, least likely to be visited.
  plane best_plane(triangle_range const& range) const {
    plane planes[3];
    std::uint32_t counts[3][bins] = {};
    box_ends boxes[3][bins];
    for (int axis = 0; axis < 3; ++axis) {
      float const first = -range.middles.ends[axis], extent = range.middles.ends[4 + axis] - first;
      float const scale = bins * (1 - 0x1p-20f) / extent;
      bool const divides = extent > 0 && is_finite(extent) && is_finite(scale);
      planes[axis] = {divides ? axis : -1, 0, first, divides ? scale : 0};
      for (auto& box : boxes[axis]) box = box_ends::empty();
    }
    multiversioned([&] {
      for (std::uint32_t i = range.begin; i < range.end; ++i) {
        boxed_triangle const& t = all_[i];
        for (int axis = 0; axis < 3; ++axis) {
          int const b = planes[axis].bin_of(t, axis);
          ++counts[axis][b];
          boxes[axis][b].add(t.box);
        }
      }
    });
    plane best{-1, 0, 0, 0};
    float lowest = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      plane p = planes[axis];
      if (p.axis < 0) continue;
      float behind[bins];  // what is behind a plane costs
      box_ends box = box_ends::empty();
      std::uint32_t n = 0;
      for (int b = bins - 1; b > 0; --b) {
        box.add(boxes[axis][b]);
        behind[b - 1] = cost(box, n += counts[axis][b]);
      }
      box = box_ends::empty();
      n = 0;
      for (p.bin = 0; p.bin < bins - 1; ++p.bin) {
        box.add(boxes[axis][p.bin]);
        float const all = cost(box, n += counts[axis][p.bin]) + behind[p.bin];
        if (n == 0 || n == range.size() || !(all < lowest)) continue;
        lowest = all;
        best = p;
      }
    }
    return best;
  }

  static float cost(box_ends const& box, std::uint32_t n) {
    return box.half_surface() * static_cast<float>((n + tree_node::width - 1) / tree_node::width);
  }

  /// Moves the end of the left part to where full nodes end, and triangles next to the plane to the other side.
  std::uint32_t fill_nodes(triangle_range const& range, std::uint32_t middle, int axis) {
    constexpr std::uint32_t n = tree_node::width;
    std::uint32_t const wanted = max((middle - range.begin + n / 2) / n, 1u) * n, largest = (range.size() - 1) / n * n;
    std::uint32_t const to = range.begin + min(wanted, largest);
    if (to == middle) return to;
    auto const before = [&](boxed_triangle const& a, boxed_triangle const& b) {
      return a.middle(axis) < b.middle(axis);
    };
    bool const from_left = to < middle;
    std::nth_element(all_ + (from_left ? range.begin : middle), all_ + to, all_ + (from_left ? middle : range.end),
                     before);
    return to;
  }

  boxed_triangle* all_;
};

template <class S>
class sah_tree {
 public:
  /// Returns false if no triangle is finite: there is no tree then.
  template <class Space>
  bool build(Space& space, mesh_view<S> const& mesh, buffer<tree_node>& memory) {
    std::size_t const cut = pieces_.build(space, mesh), n = cut != 0 ? cut : mesh.size();
    is_cut_ = cut != 0;
    all_ = triangles_.reserve(space.resource(), n);
    vec3<S> const origin = tree_origin(mesh);
    space.for_each(n, [&](std::size_t i) {
      all_[i] = {box_ends::of(is_cut_ ? pieces_.data()[i].box : tree_box_of(mesh[i], origin)), static_cast<id>(i)};
    });
    auto const* const end =
        std::partition(all_, all_ + n, [](boxed_triangle const& t) { return !t.box.box().is_empty(); });
    auto const finite = static_cast<std::uint32_t>(end - all_);
    leaves_out_ = finite != n;
    if (finite == 0) return false;
    nodes_ = memory.reserve(space.resource(), max_nodes(finite));
    if (is_cut_) {
      before_.reserve(space.resource(), max_nodes(finite));
      piece_of_.reserve(space.resource(), width * max_nodes(finite));
    }
    used_ = 1;
    tasks_ = 0;
    nodes_[0].parent = nodes_[0].slot = 0;
    max_at_once_ = max(finite / 64, 4096u);
    waiting_.reserve(space.resource(), max_tasks);
    task const root{range_divider(all_).range_of(0, finite), 0, 0};
    build_node(root, true);
    for_each_block(space, tasks_, [&](std::size_t i) { build_node(waiting_.data()[i], false); });
    return true;
  }

  /// As `build`, of a mesh with as many triangles as the last one, which have moved: the tree stays, and its boxes
  /// follow. O(triangles); allocates nothing, but where some triangle was not finite: then it builds.
  template <class Space>
  bool refit(Space& space, mesh_view<S> const& mesh, buffer<tree_node>& memory) {
    if (leaves_out_) return build(space, mesh, memory);
    if (is_cut_) pieces_.refit(space, mesh);
    vec3<S> const origin = tree_origin(mesh);
    space.for_each(used_, [&](std::size_t i) { move_leaves(mesh, origin, static_cast<std::uint32_t>(i)); });
    for (std::uint32_t i = used_; i-- > 0;) {  // what is below a node has a higher number
      for_each_box(nodes_[i], [&](int k, std::uint32_t child) {
        if ((child & tree_node::leaf) == 0) nodes_[i].set(k, nodes_[child].box(), child);
      });
    }
    return true;
  }

  /// The boxes before, of each node; null if no triangle is cut.
  boxes_before const* before() const { return is_cut_ ? before_.data() : nullptr; }

 private:
  static constexpr int width = tree_node::width, max_tasks = 1024, max_imbalance = 40;  // levels

  struct task {
    triangle_range range;
    std::uint32_t node;
    int level;
  };

  /// An upper bound: of the parts of ranges that are divided anywhere, of at least 64 triangles, one node each is not
  /// full; and a node above the lowest level has at least two below.
  static std::size_t max_nodes(std::size_t triangles) { return triangles / 4 + triangles / 32 + 16; }

  /// Makes a node and all below. `postpones`: what has few triangles waits until threads do it.
  void build_node(task const& t, bool postpones) {
    if (postpones && t.range.size() <= max_at_once_ && tasks_ < max_tasks) {
      waiting_.data()[tasks_++] = t;
      return;
    }
    tree_node& node = nodes_[t.node];
    node.continues = 0;
    triangle_range parts[width];
    int n = 0;
    if (t.range.size() <= width) {
      for (std::uint32_t i = t.range.begin; i < t.range.end; ++i) set_leaf(t.node, n++, all_[i]);
    } else {
      n = divide(t, parts);
      for (int k = 0; k < n; ++k) {
        if (parts[k].size() == 1) {
          set_leaf(t.node, k, all_[parts[k].begin]);
        } else {
          node.set(k, parts[k].box.box(), fetch_add(&used_, 1u));
        }
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

  void set_leaf(std::uint32_t number, int k, boxed_triangle const& t) {
    tree_node& node = nodes_[number];
    triangle_piece const* const piece = is_cut_ ? pieces_.data() + t.triangle : nullptr;
    node.set(k, t.box.box(), (is_cut_ ? piece->triangle : t.triangle) | tree_node::leaf);
    if (is_cut_) piece_of_.data()[width * number + static_cast<std::uint32_t>(k)] = t.triangle;
    if (!is_cut_ || piece->before == 0) return;
    node.continues |= 1u << k;
    before_.data()[number].of[k] = (piece - 1)->box;
  }

  template <class F>
  static void for_each_box(tree_node const& node, F const& f) {
    for (int k = 0; k < width; ++k) {
      if ((node.there >> k & 1) != 0) f(k, node.child[k]);
    }
  }

  /// Sets the boxes of a node that are of triangles, or of pieces, to where these are now.
  void move_leaves(mesh_view<S> const& mesh, vec3<S> const& origin, std::uint32_t number) {
    tree_node& node = nodes_[number];
    for_each_box(node, [&](int k, std::uint32_t child) {
      if ((child & tree_node::leaf) == 0) return;
      if (!is_cut_) return node.set(k, tree_box_of(mesh[child & ~tree_node::leaf], origin), child);
      triangle_piece const* const piece =
          pieces_.data() + piece_of_.data()[width * number + static_cast<std::uint32_t>(k)];
      node.set(k, piece->box, child);
      if (piece->before != 0) before_.data()[number].of[k] = (piece - 1)->box;
    });
  }

  /// Divides a range into as many as a node has room for, always the one with the largest surface.
  int divide(task const& t, triangle_range (&parts)[width]) {
    bool const halves = t.level >= max_imbalance;
    parts[0] = t.range;
    int n = 1;
    for (; n < width; ++n) {
      int chosen = -1;
      float largest = -1;
      for (int k = 0; k < n; ++k) {
        if (parts[k].size() <= width) continue;
        float const size = halves ? static_cast<float>(parts[k].size()) : parts[k].box.half_surface();
        if (size > largest || chosen < 0) largest = size, chosen = k;
      }
      if (chosen < 0) break;
      triangle_range const whole = parts[chosen];
      range_divider(all_).divide(whole, halves, parts[chosen], parts[n]);
    }
    return n;
  }

  triangle_pieces<S> pieces_;
  buffer<boxes_before> before_;
  buffer<std::uint32_t> piece_of_;  ///< of each box of each node, where triangles are in pieces
  bool is_cut_ = false;
  bool leaves_out_ = false;  ///< triangles that are not finite
  buffer<boxed_triangle> triangles_;
  boxed_triangle* all_ = nullptr;
  tree_node* nodes_ = nullptr;
  std::uint32_t used_ = 0;
  std::uint32_t max_at_once_ = 0;
  buffer<task> waiting_;
  std::size_t tasks_ = 0;
};

}  // namespace collide::detail
