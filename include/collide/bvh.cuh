/// \file
/// Broad phase: a tree of boxes. Includes the detector and everything to use it with: with nvcc the CUDA spaces too.
#pragma once

#include <cstddef>

#include <collide/broad/detail/tree/radix_tree.hpp>
#include <collide/broad/detail/tree/sah_tree.hpp>
#include <collide/broad/detail/tree/tree_ref.hpp>
#include <collide/broad/detail/tree/winding_tree.hpp>
#include <collide/broad/extend.hpp>
#include <collide/detector.hpp>

namespace collide {

namespace detail {

/// The enumerating part of `bvh`.
struct tree_policy {
  template <class S>
  class index {
   public:
    template <class Space>
    void build(Space& space, tree_policy const&, mesh_view<S> mesh) {
      constexpr bool divides = bvh_tuning<Space>::divides_by_area;
      if (mesh.size() >= std::size_t{1} << 29) throw error("collide: bvh: a mesh has fewer than 2^29 triangles");
      mesh_ = mesh;
      has_tree_ = false;
      before_ = nullptr;
      if constexpr (divides) {
        has_tree_ = divided_.build(space, mesh, nodes_);
        before_ = divided_.before();
      } else {
        radix_.build(space, mesh, nodes_);
        has_tree_ = true;
      }
      has_windings_ = false;
    }

    /// See `detector::refit`.
    template <class Space>
    void refit(Space& space, tree_policy const&, mesh_view<S> mesh) {
      mesh_ = mesh;
      if constexpr (bvh_tuning<Space>::divides_by_area) {
        has_tree_ = divided_.refit(space, mesh, nodes_);
        before_ = divided_.before();
      } else {
        radix_.refit(space, mesh, nodes_);
      }
      has_windings_ = false;
    }

    /// For winding numbers; made when first asked for after a build.
    template <class Space>
    winding_tree_ref<S> const& windings(Space& space) {
      if (!has_windings_) windings_.build(space, mesh_);
      has_windings_ = true;
      return windings_.ref();
    }

    /// An order of many points in which neighbours search the same nodes; null where the one that they have will do.
    /// Points outside of searched(box of the mesh) end at the root.
    template <class Space, class Searched>
    id const* search_order(Space& space, sphere_view<S> const& spheres, [[maybe_unused]] Searched const& searched) {
      if (spheres.size() < bvh_tuning<Space>::min_sorted_points) return nullptr;
      if constexpr (bvh_tuning<Space>::divides_by_area) {
        // the fewer triangles there are the less is saved by each point that looks for them
        double const fewest = bvh_tuning<Space>::min_triangles_to_sort / static_cast<double>(mesh_.size());
        if (!has_tree_ || fewest > 1) return nullptr;
        aabb<float> const around = nodes_.data()->box();
        return on_curve_.sort(space, spheres, around, searched(around), fewest, tree_origin(mesh_));
      } else {
        return points_.sort(space, spheres, radix_.summary());
      }
    }
    template <class Space>
    void reserve(Space& space, std::size_t spheres) {
      if (spheres < bvh_tuning<Space>::min_sorted_points) return;
      if constexpr (bvh_tuning<Space>::divides_by_area) {
        on_curve_.reserve(space, spheres);
      } else {
        points_.reserve(space, spheres);
      }
    }

    tree_ref<S> ref() const { return {mesh_, has_tree_ ? nodes_.data() : nullptr, before_}; }

   private:
    mesh_view<S> mesh_;
    bool has_tree_ = false, has_windings_ = false;
    boxes_before const* before_ = nullptr;
    buffer<tree_node> nodes_;
    sah_tree<S> divided_;
    radix_tree<S> radix_;
    point_order<S> points_;
    points_on_curve<S> on_curve_;
    winding_tree<S> windings_;
  };
};

}  // namespace detail

/// Broad phase: a tree of boxes around the triangles, eight to a node, in float, rounded outward. For meshes that a
/// grid does not suit: long thin triangles, a few that are very large beside many small ones, spheres of very different
/// sizes; and to find the nearest triangle. The host divides the triangles by the surface area heuristic, O(n log n),
/// long thin ones in up to 64 pieces; devices sort them along Hilbert's curve and make a radix tree of groups of them,
/// O(n). Query O(spheres * (log(triangles) + candidates)). `detector::refit` lets the tree of a mesh that deforms stay
/// as it is. On a device 2^18 points or more that search, for `nearest` and others, are put in order first; on the host
/// 4,096, unless they have an order, of a mesh of as many triangles.
///
/// Memory: at most 100 bytes for each triangle on a device, and 40 for each point that is put in order, 16 on the host;
/// 110 for each triangle on the host; where triangles are cut 210 for each piece, of which there are at most 4 for each
/// triangle, or 2^18 more than triangles in small meshes; there is no budget for that, as `bucket` has one; with
/// `winding_number` 61 more. A mesh has fewer than 2^29 triangles.
struct bvh : per_sphere<detail::tree_policy> {};

}  // namespace collide
