/// \file
/// The nearest triangles of this rank's spheres among those of all ranks.
#pragma once

#include <cstddef>
#include <cstdint>

#include <collide/core/contact.hpp>
#include <collide/ranks/detail/remote_pairs.hpp>
#include <collide/sinks/detail/search_mesh.hpp>

namespace collide::detail {

/// Kernel functor of `for_each` over spheres: how far from the centre a triangle may be that is as near as the nearest
/// so far, rounded up; below 0 if none may be.
template <class S>
struct find_reaches {
  S max_distance;
  sphere_view<S> spheres;
  nearest_triangle<S> const* so_far;
  S* to;

  COLLIDE_HD void operator()(std::size_t i) const {
    S const radius = spheres[i].radius, distance = so_far[i].distance;
    if (!is_valid_radius(radius)) {
      to[i] = -1;
      return;
    }
    S reach = max_distance + radius;
    if (so_far[i].triangle != no_id) {
      S const slack = 8 * ieee_traits<S>::unit_roundoff * ((distance < 0 ? -distance : distance) + radius);
      reach = min(reach, distance + radius + slack + std::numeric_limits<S>::min());
    }
    to[i] = max(reach, S(0));
  }
};

/// Kernel functor of `for_each` over spheres that were received: the nearest triangle of this rank, which goes back;
/// its number is `no_id` if there is none.
template <class S>
struct pack_nearest {
  mesh_view<S> mesh;
  id const* numbers;
  nearest_triangle<S> const* found;
  numbered_triangle<S>* to;

  COLLIDE_HD void operator()(std::size_t i) const {
    id const t = found[i].triangle;
    if (t == no_id) {
      to[i] = {no_id, {}};
    } else {
      to[i] = numbered_triangle<S>::of(numbers[t], mesh[t]);
    }
  }
};

/// Kernel functor of `for_each` over what has come back of some routes. `SoFar` is a `nearest_so_far`.
template <class S, class SoFar>
struct take_nearest {
  numbered_triangle<S> const* answers;
  pair const* routes;
  SoFar so_far;

  COLLIDE_HD void operator()(std::size_t i) const {
    if (answers[i].number == no_id) return;
    so_far.consider(item_of(routes[i]), answers[i].shape(), answers[i].number);
  }
};

/// The search for these triangles. A rank searches its own first. Spheres go to those others that may have a triangle
/// as near, and the nearest of each comes back; about `chunk` spheres of a rank at a time.
template <class Detector>
class remote_nearest {
  using S = typename Detector::scalar;
  using space_type = typename Detector::execution_space;
  using view = sphere_view<S>;
  using sent = sent_sphere<S, false>;

 public:
  /// All ranks call it, each with a functor that a sink gave to `search`.
  template <class Ranks, class F>
  void search(Ranks const& ranks, Detector& detector, divided_mesh<S> const& mesh, view const& spheres,
              std::size_t chunk, F const& f) {
    space_type& space = detector.space();
    std::size_t const n = spheres.size();
    typename F::so_far so_far{f.max_distance, spheres, f.to, nullptr};
    view wanted;
    together(ranks, [&] {
      so_far.corners = corners_.reserve(space.resource(), n);
      search_part<F> own{f};
      own.f.to = found_.reserve(space.resource(), n);
      detector.query(spheres, own);
      space.for_each(n, typename F::join{so_far, {mesh.view(), {0, mesh.numbers()}}, own.f.to, true});
      S* const reaches = reaches_.reserve(space.resource(), n);
      space.for_each(n, find_reaches<S>{f.max_distance, spheres, f.to, reaches});
      wanted = view(spheres.centres(), reaches, 1, S(0));
      sends_.find(space, mesh.lookup(), wanted, ranks.rank(), ranks.size());
    });
    std::uint64_t const rounds = sends_.rounds(ranks, chunk);
    for (std::uint64_t round = 0; round < rounds; ++round) {
      together(ranks, [&] { pack_round(ranks.size(), space, wanted, sends_, round, rounds, sent_); });
      deliver(ranks, space, sent_, received_);
      together(ranks, [&] { answer(detector, mesh, f); });
      deliver(ranks, space, answers_, answered_);
      together(ranks, [&] { take(space, round, rounds, so_far); });
    }
  }

 private:
  /// Searches for what was received: what is sent as a radius is a distance from the centre.
  template <class F>
  void answer(Detector& detector, divided_mesh<S> const& mesh, F const& f) {
    space_type& space = detector.space();
    std::size_t const n = received_.size();
    answers_.counts = received_.counts;
    numbered_triangle<S>* const to = answers_.resize(space);
    if (n == 0) return;
    S const* const at = received_.data()->numbers;
    search_part<F> here{f};
    here.f.max_distance = 0;
    here.f.to = found_.reserve(space.resource(), n);
    detector.query(view(points(at, n, sent::size), at + 3, sent::size, S(0)), here);
    space.for_each(n, pack_nearest<S>{mesh.view(), mesh.numbers(), here.f.to, to});
  }

  template <class SoFar>
  void take(space_type const& space, std::uint64_t round, std::uint64_t rounds, SoFar const& so_far) {
    numbered_triangle<S> const* from = answered_.data();
    for (std::size_t r = 0; r < answered_.counts.size(); ++r) {
      auto const n = static_cast<std::size_t>(answered_.counts[r]);
      space.for_each(n, take_nearest<S, SoFar>{from, sends_.of(r, round, rounds).first, so_far});
      from += n;
    }
  }

  sphere_send_plan sends_;
  device_exchange_buffer<sent> sent_, received_;
  device_exchange_buffer<numbered_triangle<S>> answers_, answered_;
  buffer<nearest_triangle<S>> found_;
  buffer<triangle<S>> corners_;
  buffer<S> reaches_;
};

}  // namespace collide::detail
