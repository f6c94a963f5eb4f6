/// \file
/// Sink: the k nearest triangles of each point or sphere, at any distance.
#pragma once

#include <cstddef>
#include <limits>
#include <type_traits>

#include <collide/sinks/nearest.hpp>

namespace collide {

namespace detail {

inline constexpr int max_nearest = 32;  ///< of a point

/// The nearest triangles seen so far to one point, by rising distance; of equally near ones those with the lowest
/// numbers. Where distances as they are measured are too close to tell, a search among the two decides.
template <class S, class Precision>
class k_nearest_search {
 public:
  COLLIDE_HD k_nearest_search(vec3<S> const& point, S max_distance, mesh_view<S> const& mesh, int k)
      : point_{point}, reach_{max_distance}, mesh_{mesh}, k_{k} {}

  COLLIDE_HD void consider(id number) {
    nearest_search<S, Precision> one(point_, reach_);
    one.consider(mesh_[number], number);
    nearest_triangle<S> const found = one.result();
    if (found.triangle == no_id) return;
    for (int i = 0; i < size_; ++i) {
      if (numbers_[i] == number) return;  // it may come more than once
    }
    int place = size_;
    for (; place > 0 && comes_before(found.distance, number, place - 1); --place) {
      if (place == k_) continue;
      distances_[place] = distances_[place - 1];
      numbers_[place] = numbers_[place - 1];
    }
    if (place == k_) return;
    distances_[place] = found.distance;
    numbers_[place] = number;
    if (size_ < k_) ++size_;
    // rounded up: the last one itself is in reach
    if (size_ == k_) reach_ = min(reach_, distances_[k_ - 1] * (1 + doubt) + std::numeric_limits<S>::min());
  }

  /// The square of a distance, rounded down, beyond which no triangle counts; see `nearest_search`.
  COLLIDE_HD S squared_bound() const { return nearest_search<S, Precision>(point_, reach_).squared_bound(); }

  COLLIDE_HD int size() const { return size_; }
  COLLIDE_HD nearest_triangle<S> operator[](int i) const {
    nearest_search<S, Precision> one(point_, std::numeric_limits<S>::infinity());
    one.consider(mesh_[numbers_[i]], numbers_[i]);
    return one.result();
  }

 private:
  static constexpr S doubt = 8 * ieee_traits<S>::unit_roundoff;  ///< two distances are each off by less than half of it

  COLLIDE_HD bool comes_before(S distance, id number, int i) const {
    if (distance > distances_[i] * (1 + doubt)) return false;
    if (distance * (1 + doubt) < distances_[i]) return true;
    nearest_search<S, Precision> two(point_, std::numeric_limits<S>::infinity());
    two.consider(mesh_[number], number);
    two.consider(mesh_[numbers_[i]], numbers_[i]);
    return two.result().triangle == number;
  }

  vec3<S> point_;
  S reach_;
  mesh_view<S> mesh_;
  int k_, size_ = 0;
  S distances_[max_nearest];
  id numbers_[max_nearest];
};

/// Search functor of `k_nearest` for each sphere.
template <class S, class Precision>
struct find_k_nearest {
  static constexpr int min_blocks = 3;  ///< with fewer registers a search takes longer

  S max_distance;
  int k;
  nearest_triangle<S>* to;

  template <class Search>
  COLLIDE_HD void operator()(std::size_t i, sphere<S> const& s, mesh_view<S> const& mesh, Search const& search) const {
    k_nearest_search<S, Precision> best(s.centre, is_valid_radius(s.radius) ? max_distance + s.radius : S(-1), mesh, k);
    search(best.squared_bound(), [&](id t) {
      best.consider(t);
      return best.squared_bound();
    });
    nearest_triangle<S>* const row = to + i * static_cast<std::size_t>(k);
    for (int j = 0; j < k; ++j) {
      row[j] = j < best.size() ? best[j] : no_nearest_triangle<S>();
      if (j < best.size() && s.radius != 0) row[j].distance -= s.radius;
    }
  }
};

}  // namespace detail

/// The k nearest triangles of each point, by rising distance; of equally near ones that with the smaller id comes
/// first. Each has what `nearest` gives. Results are rows of k entries, row i for point i; where fewer than k triangles
/// are in reach, those at the end of the row have `no_id` and a distance of +infinity. What `nearest` says of spheres,
/// of precision and of broad phases holds here too. Memory: k entries for each point.
template <class S = float>
class k_nearest : public detail::array_per_sphere<nearest_triangle<S>> {
  using base = detail::array_per_sphere<nearest_triangle<S>>;

 public:
  /// The k nearest triangles of each point, k at most 32, up to `max_distance` from it, inclusive. Throws `error` if
  /// `k` is not 1 to 32, or the distance negative or NaN.
  explicit k_nearest(int k, std::common_type_t<S> max_distance = std::numeric_limits<S>::infinity())
      : base{nullptr, static_cast<std::size_t>(k)}, k_{k}, max_distance_{max_distance} {
    if (k < 1 || k > detail::max_nearest) throw error("collide: k_nearest: k is not from 1 to 32");
    if (!(max_distance >= 0)) throw error("collide: k_nearest: the largest distance is negative or NaN");
  }

  /// How many entries a row has.
  int k() const { return k_; }
  /// How many rows there are: the points of the last query.
  std::size_t rows() const { return this->size() / static_cast<std::size_t>(k_); }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    static_assert(std::is_same<S, typename Query::scalar>::value,
                  "collide: k_nearest<S> must have the scalar type of the detector");
    using precision = typename detail::nearest_precision<typename Query::narrow_phase>::type;
    auto* const to = this->memory_for(space, query.spheres.size());
    detail::search_mesh(query, detail::find_k_nearest<S, precision>{max_distance_, k_, to});
  }

 private:
  int k_;
  S max_distance_;
};

}  // namespace collide
