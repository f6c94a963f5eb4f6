/// \file
/// A tree of the moments of triangles' normals, for winding numbers: triangles in the order of a curve through space,
/// eight next to each other in a node, eight of these in the next. The same bits in every space.
#pragma once

#include <cstddef>

#include <collide/broad/detail/tree/curve_order.hpp>
#include <collide/narrow/detail/normal_moments.hpp>

namespace collide::detail {

/// The levels of a tree whose nodes are full, the root first: how many nodes each has, and the number of its first.
struct tree_levels {
  static constexpr int max_levels = 12;
  static constexpr std::size_t width = 8;

  std::size_t count[max_levels], first[max_levels];  ///< of level 0, with the triangles, and of those above
  int levels;
  std::size_t nodes;  ///< in all

  explicit tree_levels(std::size_t triangles) : levels{0}, nodes{0} {
    std::size_t n = triangles;
    do count[levels++] = n = (n + width - 1) / width;
    while (n > 1);
    for (int l = levels - 1; l >= 0; --l) {
      first[l] = nodes;
      nodes += count[l];
    }
  }
};

/// A point, times the power of two that makes the coordinates of a mesh at most 2: exact, except for what underflows.
template <class S>
COLLIDE_HD_INLINE vec3<double> in_unit_range(vec3<S> const& x, mesh_statistics<S> const* mesh) {
  return scaled(cast_to<double>(x), inverse_power_of_two(static_cast<double>(mesh->largest_coordinate())));
}

/// Kernel functor of `for_each` over the nodes of a level: the moments of what is in each.
template <class S>
struct make_moments {
  mesh_view<S> mesh;
  id const* ids;  ///< in order
  mesh_statistics<S> const* summary;
  normal_moments* nodes;
  tree_levels levels;
  int level;

  COLLIDE_HD void operator()(std::size_t i) const {
    constexpr std::size_t width = tree_levels::width;
    std::size_t const begin = i * width, below = level == 0 ? mesh.size() : levels.count[level - 1];
    std::size_t const end = min(begin + width, below);
    normal_moments parts[width];
    int n = 0;
    for (std::size_t k = begin; k < end; ++k) {
      if (level > 0) {
        parts[n] = nodes[levels.first[level - 1] + k];
        n += parts[n].radius > 0 ? 1 : 0;
        continue;
      }
      triangle<S> const t = mesh[ids[k]];
      if (!is_finite(t)) continue;
      auto const place = [&](vec3<S> const& x) { return in_unit_range(x, summary); };
      parts[n++] = normal_moments::of({place(t.a), place(t.b), place(t.c)});
    }
    normal_moments all;
    all.centre = middle_of(parts, n);
    all.lower = parts[0].lower, all.upper = parts[0].upper;
    for (int k = 0; k < n; ++k) all.add(parts[k]);
    all.limit_radius();
    nodes[levels.first[level] + i] = all;
  }

 private:
  /// The middle of their area.
  static COLLIDE_HD vec3<double> middle_of(normal_moments const* parts, int n) {
    vec3<double> const first = parts[0].centre;
    vec3<double> sum{0, 0, 0};
    double area = 0;
    for (int k = 0; k < n; ++k) {
      sum += scaled(vec3<double>(parts[k].centre - first), parts[k].area);
      area += parts[k].area;
    }
    return area > 0 ? vec3<double>(first + scaled(sum, div_rn(1.0, area))) : first;
  }
};

/// The tree, as kernels have it.
template <class S>
struct winding_tree_ref {
  id const* ids = nullptr;
  mesh_statistics<S> const* summary = nullptr;
  normal_moments const* nodes = nullptr;  ///< null if there is no tree: all triangles are seen then
  tree_levels levels{0};

  /// The solid angle of the mesh as seen from a finite point; the farther away, as told by `beta`, the more triangles
  /// are seen together.
  COLLIDE_HD solid_angle_sum seen_from(mesh_view<S> const& mesh, vec3<S> const& point, double beta) const {
    solid_angle_sum sum;
    if (nodes == nullptr) {
      for (std::size_t t = 0; t < mesh.size(); ++t) sum.add(mesh[t], point);
      sum.settle();
      return sum;
    }
    vec3<double> const p = in_unit_range(point, summary);
    if (!(max_norm(p) < 0x1p100)) {
      sum.error = 0x1p-150;  // fewer than 2^32 triangles, of an area of 8 each
      return sum;
    }
    int level = levels.levels - 1;
    for (std::size_t i = 0;;) {
      normal_moments const& node = nodes[levels.first[level] + i];
      if (node.is_far(p, beta)) {
        node.add_to(sum, p);
      } else if (level > 0) {
        --level;
        i *= tree_levels::width;
        continue;
      } else {
        std::size_t const begin = i * tree_levels::width, end = min(begin + tree_levels::width, mesh.size());
        for (std::size_t k = begin; k < end; ++k) sum.add(mesh[ids[k]], point);
      }
      // the next node of this level, or the one behind that above
      while (++i % tree_levels::width == 0 || i == levels.count[level]) {
        if (++level >= levels.levels) {
          sum.settle();
          return sum;
        }
        i = (i - 1) / tree_levels::width;
      }
    }
  }
};

template <class S>
class winding_tree {
 public:
  /// O(triangles), and to sort them.
  template <class Space>
  void build(Space& space, mesh_view<S> const& mesh) {
    order_.sort(space, mesh);
    tree_levels const l(mesh.size());
    ref_ = {order_.ids(), order_.summary(), nodes_.reserve(space.resource(), l.nodes), l};
    for (int k = 0; k < l.levels; ++k)
      space.for_each(l.count[k], make_moments<S>{mesh, ref_.ids, ref_.summary, nodes_.data(), l, k});
  }

  winding_tree_ref<S> const& ref() const { return ref_; }

 private:
  curve_order<S> order_;
  buffer<normal_moments> nodes_;
  winding_tree_ref<S> ref_;
};

}  // namespace collide::detail
