/// \file
/// Sink: how often a mesh winds around each point, for meshes that are not closed.
#pragma once

#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>

#include <collide/broad/detail/tree/winding_tree.hpp>
#include <collide/core/error.hpp>
#include <collide/mesh.hpp>
#include <collide/sinks/detail/array_in_space.hpp>
#include <collide/sinks/detail/search_mesh.hpp>
#include <collide/spheres.hpp>

namespace collide {

/// How often a mesh winds around a point.
template <class S>
struct winding {
  S value;  ///< 1 inside of a closed mesh whose normals point outwards, 0 outside; NaN if the point is not finite
  S error;  ///< how far `value` may be from that of real arithmetic, at most
};

namespace detail {

/// Search functor of `winding_number` for each point.
template <class S>
struct find_winding {
  winding_tree_ref<S> tree;
  double beta;
  winding<S>* to;

  template <class Search>
  COLLIDE_HD void operator()(std::size_t i, sphere<S> const& s, mesh_view<S> const& mesh, Search const&) const {
    constexpr double whole = 12.566370614359172;  // 4 pi
    constexpr S nan = std::numeric_limits<S>::quiet_NaN();
    if (!is_finite(s.centre)) {
      to[i] = {nan, nan};
      return;
    }
    solid_angle_sum const sum = tree.seen_from(mesh, s.centre, beta);
    double const value = div_rn(sum.angle, whole), size = value < 0 ? -value : value;
    double const rounding = mul_rn(size, 2 * static_cast<double>(ieee_traits<S>::unit_roundoff));
    to[i] = {static_cast<S>(value), static_cast<S>(mul_rn(div_rn(sum.error, whole) + rounding, 1.0000005))};
  }
};

template <class Query>
using query_windings = decltype(std::declval<Query const&>().windings());

}  // namespace detail

/// The winding number of each point: the solid angle of all triangles as seen from there, divided by 4 pi (A. Jacobson
/// et al., "Robust inside-outside segmentation using generalized winding numbers", ACM Transactions on Graphics 32(4),
/// 2013). Above 1/2 is inside. For meshes with holes and for triangle soups, of which `contains` makes no sense; the
/// triangles' normals must point outwards. Of a closed mesh it is whole, except for `error`; next to the surface that
/// may be 1/2, and `contains` is exact.
///
/// With `bvh` triangles far away are seen together, by moments of their normals up to the second (G. Barill et al.,
/// "Fast winding numbers for soups and clouds", ACM Transactions on Graphics 37(4), 2018): those in a sphere whose
/// centre is more than `beta` times its radius away. `error` bounds what that leaves out: with `beta` = 3 it was below
/// 0.04 on and around a ball of 81,920 triangles, and the value off by less than 0.0005. Twice the `beta` makes `error`
/// a tenth, and takes four times as long. O(points * log(triangles)); the first query after a `build` is
/// O(triangles) longer. With `all_pairs` each triangle is seen from each point: O(points * triangles).
///
/// In double, the same bits in all spaces. `query` does not wait. `S` is the scalar of the detector. Memory: an entry
/// for each point; `bvh` says what it keeps.
template <class S = float>
class winding_number : public detail::array_per_sphere<winding<S>> {
 public:
  /// `beta`: see above; from 2 to infinity, with which each triangle is seen. Throws `error` otherwise.
  explicit winding_number(double beta = 3) : beta_{beta} {
    if (!(beta >= 2)) throw error("collide: winding_number: beta is below 2 or NaN: pass 2 or more, such as 3");
  }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    static_assert(std::is_same<S, typename Query::scalar>::value,
                  "collide: winding_number<S> must have the scalar type of the detector");
    auto* const to = this->memory_for(space, query.spheres.size());
    detail::winding_tree_ref<S> tree;
    if constexpr (detail::is_valid<detail::query_windings, Query>) {
      if (query.mesh.size() != 0) tree = query.windings();
    }
    detail::search_mesh(query, detail::find_winding<S>{tree, beta_, to});
  }

 private:
  double beta_;
};

}  // namespace collide
