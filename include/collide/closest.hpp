/// \file
/// Sink: per sphere the nearest of the triangles that it collides with.
#pragma once

#include <collide/detail/arithmetic.hpp>
#include <collide/detail/sink.hpp>

#include <vector>

namespace collide {

/// The nearest colliding triangle of a sphere.
template <class S>
struct nearest {
  id triangle;  ///< `no_id` if the sphere touches nothing
  S distance;   ///< from the centre to the triangle; +infinity if the sphere touches nothing
};

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
    space.for_each(size_, reset{to});
    measure<narrow_phase> const step{collected_.data(), to, query.mesh, query.spheres};
    space.for_each(collected_.size(), step);
    space.for_each(collected_.size(), choose<narrow_phase>{step});
  }

 private:
  using distance_bits = detail::bits_of<S>;  // of distances, which are not negative and so sort like their bits

  struct reset {
    nearest<S>* to;
    COLLIDE_HD void operator()(std::size_t i) const { to[i] = {no_id, std::numeric_limits<S>::infinity()}; }
  };

  /// First pass: the smallest distance of each sphere.
  template <class NarrowPhase>
  struct measure {
    pair const* pairs;
    nearest<S>* to;
    mesh_view<S> mesh;
    sphere_view<S> spheres;
    COLLIDE_HD S distance(pair p) const { return hit<NarrowPhase, S>(p, mesh, spheres).contact().distance; }
    COLLIDE_HD void operator()(std::size_t i) const {
      pair const p = pairs[i];
      detail::fetch_min(reinterpret_cast<distance_bits*>(&to[p.sphere].distance), detail::bits(distance(p)));
    }
  };

  /// Second pass: the smallest id among the triangles at that distance.
  template <class NarrowPhase>
  struct choose {
    measure<NarrowPhase> found;
    COLLIDE_HD void operator()(std::size_t i) const {
      pair const p = found.pairs[i];
      nearest<S>& best = found.to[p.sphere];
      if (detail::bits(found.distance(p)) == detail::bits(best.distance)) detail::fetch_min(&best.triangle, p.triangle);
    }
  };

  std::size_t size_ = 0;
  detail::collector collected_;
  buffer<nearest<S>> own_;
  detail::downloader<nearest<S>> download_;
};

}  // namespace collide
