/// \file
/// Sink: how often a mesh winds around each point, for meshes that are not closed.
#pragma once

#include <cstddef>
#include <limits>
#include <type_traits>

#include <collide/detail/nearest/solid_angle.hpp>
#include <collide/detail/sinks/array_in_space.hpp>
#include <collide/detail/sinks/search_mesh.hpp>
#include <collide/mesh.hpp>
#include <collide/spheres.hpp>

namespace collide {

/// How often a mesh winds around a point.
template <class S>
struct winding {
  S value;  ///< 1 inside of a closed mesh whose normals point outwards, 0 outside; NaN if the point is not finite
  S error;  ///< how far `value` may be from that of real arithmetic, at most
};

namespace detail {

/// What `winding_number` does for each point.
template <class S>
struct find_winding {
  winding<S>* to;

  template <class Search>
  COLLIDE_HD void operator()(std::size_t i, sphere<S> const& s, mesh_view<S> const& mesh, Search const&) const {
    constexpr double whole = 12.566370614359172;  // 4 pi
    constexpr S nan = std::numeric_limits<S>::quiet_NaN();
    if (!is_finite(s.centre)) {
      to[i] = {nan, nan};
      return;
    }
    solid_angle_sum sum;
    for (std::size_t t = 0; t < mesh.size(); ++t) {
      triangle<S> const shape = mesh[t];
      if (is_finite(shape)) sum.add(shape, s.centre);
    }
    double const value = div_rn(sum.angle, whole), size = value < 0 ? -value : value;
    double const rounding = mul_rn(size, 2 * static_cast<double>(ieee_traits<S>::unit_roundoff));
    to[i] = {static_cast<S>(value), static_cast<S>(mul_rn(div_rn(sum.error, whole) + rounding, 1.0000005))};
  }
};

}  // namespace detail

/// The winding number of each point: the solid angle of all triangles as seen from there, divided by 4 pi (A. Jacobson
/// et al., "Robust inside-outside segmentation using generalized winding numbers", ACM Transactions on Graphics 32(4),
/// 2013). Above 1/2 is inside. For meshes with holes and for triangle soups, of which `contains` makes no sense; the
/// triangles' normals must point outwards. Of a closed mesh it is whole, but for `error`; next to the surface that is
/// large, and `contains` is exact.
///
/// Every triangle is seen from every point, whatever the broad phase, in double: O(points * triangles), the same bits
/// in all spaces. With `bvh` or `all_pairs`. `query` does not wait. `S` is the scalar of the detector. Memory: an entry
/// for each point.
template <class S = float>
class winding_number : public detail::array_in_space<winding<S>> {
  using base = detail::array_in_space<winding<S>>;
  using base::data_, base::size_, base::download_;

 public:
  /// Makes room in memory of `space` for queries of up to so many points: they then allocate nothing.
  template <class Space>
  void reserve(Space const& space, std::size_t points, std::size_t /*pairs*/) {
    own_.reserve(space.resource(), points);
  }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    static_assert(std::is_same<S, typename Query::scalar>::value,
                  "collide: winding_number<S> must have the scalar type of the detector");
    download_ = detail::host_copier<winding<S>>(space);
    size_ = query.spheres.size();
    data_ = own_.reserve(space.resource(), size_);
    detail::search_mesh(query, detail::find_winding<S>{data_});
  }

 private:
  buffer<winding<S>> own_;
};

}  // namespace collide
