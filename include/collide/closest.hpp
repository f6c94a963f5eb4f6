/// \file
/// Sink: per sphere the nearest of the triangles that it collides with.
#pragma once

#include <vector>

#include <collide/detail/arithmetic.hpp>
#include <collide/detail/sink.hpp>

namespace collide {

/// The nearest colliding triangle of a sphere.
template <class S>
struct nearest {
  id triangle;  ///< `no_id` if the sphere touches nothing
  S distance;   ///< from the centre to the triangle; +infinity if the sphere touches nothing
};

namespace detail {

/// Kernel body of `for_each` over spheres: nothing is near yet. Memory of all ones has `no_id` for the triangle
/// already.
template <class S>
struct reset_nearest {
  nearest<S>* to;
  COLLIDE_HD void operator()(std::size_t i) const { to[i].distance = std::numeric_limits<S>::infinity(); }
};

/// Kernel body of `for_each` over pairs: the smallest distance of each sphere. Distances are not negative, so they sort
/// like their bits.
template <class NarrowPhase, class S>
struct find_distance {
  pair const* pairs;
  nearest<S>* to;
  mesh_view<S> mesh;
  sphere_view<S> spheres;
  COLLIDE_HD bits_of<S> distance(pair p) const {
    return bits(hit<NarrowPhase, S>(p, mesh, spheres).contact().distance);
  }
  COLLIDE_HD void operator()(std::size_t i) const {
    pair const p = pairs[i];
    fetch_min(reinterpret_cast<bits_of<S>*>(&to[p.sphere].distance), distance(p));
  }
};

/// Kernel body of `for_each` over pairs: the smallest id among the triangles at that distance.
template <class NarrowPhase, class S>
struct find_nearest {
  find_distance<NarrowPhase, S> found;
  COLLIDE_HD void operator()(std::size_t i) const {
    pair const p = found.pairs[i];
    nearest<S>& best = found.to[p.sphere];
    if (found.distance(p) == bits(best.distance)) fetch_min(&best.triangle, p.triangle);
  }
};

}  // namespace detail

/// Per sphere the colliding triangle that is nearest to its centre; of equally near ones that with the smallest id.
/// Distances are those of `contact::distance`.
template <class S = float>
class closest {
 public:
  /// One entry per sphere, in memory of the space.
  nearest<S> const* data() const { return own_.data(); }
  /// Number of spheres of the last query.
  std::size_t size() const { return size_; }
  /// How many pairs collide.
  std::uint64_t total() const { return collected_.total(); }
  /// A copy on the host.
  std::vector<nearest<S>> to_host() const { return download_(data(), size_); }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    static_assert(std::is_same<S, typename Query::scalar>::value,
                  "collide: closest<S> must have the scalar type of the detector");
    using narrow_phase = typename Query::narrow_phase;
    download_ = detail::downloader<nearest<S>>(space);
    size_ = query.spheres.size();
    collected_.fill(space, query);
    auto* const to = own_.reserve(space.resource(), size_);
    space.fill(to, 0xff, size_ * sizeof *to);
    space.for_each(size_, detail::reset_nearest<S>{to});
    detail::find_distance<narrow_phase, S> const step{collected_.data(), to, query.mesh, query.spheres};
    space.for_each(collected_.size(), step);
    space.for_each(collected_.size(), detail::find_nearest<narrow_phase, S>{step});
  }

 private:
  std::size_t size_ = 0;
  detail::collector collected_;
  buffer<nearest<S>> own_;
  detail::downloader<nearest<S>> download_;
};

}  // namespace collide
