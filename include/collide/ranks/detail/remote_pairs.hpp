/// \file
/// The pairs of this rank's spheres and the triangles of all ranks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/detector.hpp>
#include <collide/detectors/detail/found_query.hpp>
#include <collide/ranks/detail/device_exchange_buffer.hpp>
#include <collide/ranks/detail/divided_mesh.hpp>
#include <collide/ranks/detail/sphere_send_plan.hpp>
#include <collide/sinks/pairs.hpp>

namespace collide::detail {

/// A sphere that is sent to another rank: centre, radius and, if it moves, displacement.
template <class S, bool Moves>
struct sent_sphere {
  static constexpr bool moves = Moves;
  static constexpr std::size_t size = Moves ? 7 : 4;
  S numbers[size];
};

/// Kernel functor of `for_each` over routes: their spheres, as they are sent.
template <class Spheres, class Sent>
struct pack_spheres {
  Spheres spheres;
  pair const* routes;
  Sent* to;
  COLLIDE_HD void operator()(std::size_t i) const {
    auto const s = spheres[item_of(routes[i])];
    for (int k = 0; k < 3; ++k) to[i].numbers[k] = s.centre[k];
    to[i].numbers[3] = s.radius;
    if constexpr (Sent::moves) {
      for (int k = 0; k < 3; ++k) to[i].numbers[4 + k] = s.displacement[k];
    }
  }
};

/// Packs the spheres of one of some rounds, those to each rank one after the other.
template <class Space, class Spheres, class Sent>
void pack_round(int ranks, Space const& space, Spheres const& spheres, sphere_send_plan const& sends,
                std::uint64_t round, std::uint64_t rounds, device_exchange_buffer<Sent>& packed) {
  packed.clear(ranks);
  for (std::size_t r = 0; r < packed.counts.size(); ++r) packed.counts[r] = sends.of(r, round, rounds).size;
  Sent* to = packed.resize(space);
  for (std::size_t r = 0; r < packed.counts.size(); ++r) {
    auto const part = sends.of(r, round, rounds);
    space.for_each(part.size, pack_spheres<Spheres, Sent>{spheres, part.first, to});
    to += part.size;
  }
}

/// Kernel functor of `for_each` over what has come back of some routes: pairs of this rank's spheres.
struct unpack_answers {
  pair const* answers;
  pair const* routes;
  pair* to;
  COLLIDE_HD void operator()(std::size_t i) const { to[i] = {item_of(routes[answers[i].sphere]), answers[i].triangle}; }
};

/// The search for these pairs. A rank queries its own triangles with its spheres where they are. Spheres near triangles
/// of other ranks are sent there, and pairs come back. So many go at a time that no rank needs more memory than for
/// about a `chunk` from each. Everything is in memory of the space, except for the triangles that come back.
template <class Detector>
class remote_pairs {
  using S = typename Detector::scalar;
  using space_type = typename Detector::execution_space;
  using view = typename Detector::spheres_type;
  static constexpr bool moves = !is_discrete<typename Detector::narrow_phase, S>;
  using sent = sent_sphere<S, moves>;
  static_assert(sizeof(sent) == sent::size * sizeof(S));

 public:
  /// All ranks call it. `with_triangles`: whether the triangles of the pairs come back, too.
  template <class Ranks>
  void find(Ranks const& ranks, Detector& detector, divided_mesh<S> const& mesh, view const& spheres, std::size_t chunk,
            bool with_triangles) {
    space_type& space = detector.space();
    triangles_.clear();
    together(ranks, [&] {
      sends_.find(space, mesh.lookup(), spheres, ranks.rank(), ranks.size());
      query_own(detector, mesh, spheres);
    });
    std::uint64_t const rounds = sends_.rounds(ranks, chunk);
    for (std::uint64_t round = 0; round < rounds; ++round) {
      together(ranks, [&] { pack_round(ranks.size(), space, spheres, sends_, round, rounds, sent_); });
      deliver(ranks, space, sent_, received_);
      together(ranks, [&] {
        query_received(detector);
        answer_all(space, mesh);
        if (with_triangles) name_triangles(mesh);
      });
      deliver(ranks, space, answers_, answered_);
      if (with_triangles) deliver(ranks, named_, learned_);
      together(ranks, [&] { take(space, round, rounds, with_triangles); });
    }
    together(ranks, [&] { sort_triangles(); });
  }

  /// The pairs, in no certain order, in memory of the space: numbers of this rank's spheres, and of triangles among
  /// those of all ranks.
  pair const* found() const { return found_.data(); }
  std::size_t size() const { return found_.size(); }
  /// Triangles of other ranks in them, each once, by rising number, if they were asked for.
  std::vector<numbered_triangle<S>> const& triangles() const { return triangles_; }

 private:
  void query_own(Detector& detector, divided_mesh<S> const& mesh, view const& spheres) {
    space_type& space = detector.space();
    detector.query(spheres, hits_);
    found_.clear();
    pair* const to = found_.append(space, hits_.size());
    space.for_each(hits_.size(), renumber_pairs{hits_.data(), {0, nullptr}, {0, mesh.numbers()}, to});
  }

  /// Finds the pairs of what was received, and which of them are of which rank.
  void query_received(Detector& detector) {
    std::size_t const n = received_.size();
    starts_.assign(received_.counts.size() + 1, 0);
    for (std::size_t r = 0; r + 1 < starts_.size(); ++r) starts_[r + 1] = starts_[r] + received_.counts[r];
    ends_.assign(starts_.size(), 0);
    if (n == 0) return;
    S const* const at = received_.data()->numbers;
    sphere_view<S> const spheres(points(at, n, sent::size), at + 3, sent::size, S(0));
    if constexpr (moves) {
      detector.query(view(spheres, points(at + 4, n, sent::size)), received_hits_);
    } else {
      detector.query(spheres, received_hits_);
    }
    ends_ = starts_;
    bounds_.find(detector.space(), received_hits_.data(), received_hits_.size(), ends_);
  }

  void answer_all(space_type const& space, divided_mesh<S> const& mesh) {
    std::size_t const ranks = received_.counts.size();
    answers_.clear(static_cast<int>(ranks));
    for (std::size_t r = 0; r < ranks; ++r) answers_.counts[r] = ends_[r + 1] - ends_[r];
    pair* const to = answers_.resize(space);
    for (std::size_t r = 0; r < ranks; ++r) {
      numbering const in_message{0 - static_cast<id>(starts_[r]), nullptr};  // from 0 on, modulo 2^32
      space.for_each(static_cast<std::size_t>(answers_.counts[r]),
                     renumber_pairs{received_hits_.data() + ends_[r], in_message, {0, mesh.numbers()}, to + ends_[r]});
    }
  }

  /// The triangles of the answers to each rank, each once.
  void name_triangles(divided_mesh<S> const& mesh) {
    named_.clear(static_cast<int>(received_.counts.size()));
    if (ends_.back() == 0) return;
    auto const hits = received_hits_.to_host();
    std::vector<id> local;
    for (std::size_t r = 0; r < named_.counts.size(); ++r) {
      local.clear();
      for (std::uint64_t k = ends_[r]; k < ends_[r + 1]; ++k)
        local.push_back(hits[static_cast<std::size_t>(k)].triangle);
      std::sort(local.begin(), local.end());
      local.erase(std::unique(local.begin(), local.end()), local.end());
      for (id const t : local) named_.items.push_back(mesh[t]);
      named_.counts[r] = local.size();
    }
  }

  /// Adds what has come back to what was found.
  void take(space_type const& space, std::uint64_t round, std::uint64_t rounds, bool with_triangles) {
    pair const* from = answered_.data();
    pair* to = found_.append(space, answered_.size());
    for (std::size_t r = 0; r < answered_.counts.size(); ++r) {
      auto const n = static_cast<std::size_t>(answered_.counts[r]);
      space.for_each(n, unpack_answers{from, sends_.of(r, round, rounds).first, to});
      from += n;
      to += n;
    }
    if (with_triangles) triangles_.insert(triangles_.end(), learned_.items.begin(), learned_.items.end());
  }

  void sort_triangles() {
    std::sort(triangles_.begin(), triangles_.end());
    auto const same = [](auto const& a, auto const& b) { return a.number == b.number; };
    triangles_.erase(std::unique(triangles_.begin(), triangles_.end(), same), triangles_.end());
  }

  sphere_send_plan sends_;
  device_exchange_buffer<sent> sent_, received_;
  pairs hits_, received_hits_{order::canonical};
  std::vector<std::uint64_t> starts_, ends_;  ///< of each rank's spheres received, and of their hits
  pair_bounds bounds_;
  device_exchange_buffer<pair> answers_, answered_;
  exchange_buffer<numbered_triangle<S>> named_, learned_;
  pair_list found_;
  std::vector<numbered_triangle<S>> triangles_;
};

}  // namespace collide::detail
