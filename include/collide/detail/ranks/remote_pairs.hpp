/// \file
/// The pairs of this rank's spheres and the triangles of all ranks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/detail/ranks/divided_mesh.hpp>
#include <collide/detector.hpp>

namespace collide::detail {

/// A sphere that is sent to another rank: centre, radius and, if it moves, displacement.
template <class S, bool Moves>
struct sent_sphere {
  static constexpr bool moves = Moves;
  static constexpr std::size_t size = Moves ? 7 : 4;
  S numbers[size];

  aabb<double> reach(double extent) const {
    vec3<S> displacement(0, 0, 0);
    if constexpr (Moves) displacement = {numbers[4], numbers[5], numbers[6]};
    return reach_of(sphere<S>{{numbers[0], numbers[1], numbers[2]}, numbers[3]}, displacement, extent);
  }
};

/// Kernel body of `for_each` over spheres: as they are sent.
template <class Spheres, class Sent>
struct pack_spheres {
  Spheres spheres;
  Sent* to;
  COLLIDE_HD void operator()(std::size_t i) const {
    auto const s = spheres[i];
    for (int k = 0; k < 3; ++k) to[i].numbers[k] = s.centre[k];
    to[i].numbers[3] = s.radius;
    if constexpr (Sent::moves) {
      for (int k = 0; k < 3; ++k) to[i].numbers[4 + k] = s.displacement[k];
    }
  }
};

/// A hit that is sent back: which of the spheres of a message, and the triangle.
struct answer {
  id place, triangle;
};

/// Finds them: spheres go to the ranks that may have triangles for them, which query their own detectors, and pairs
/// come back. So many spheres go at a time that no rank needs more memory than for a `chunk` from each.
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
    found_.clear();
    triangles_.clear();
    std::uint64_t const mine = (spheres.size() + chunk - 1) / chunk;
    std::uint64_t rounds = 0;
    ranks.reduce(&mine, &rounds, 1, reduction::max);
    for (std::uint64_t round = 0; round < rounds; ++round) {
      std::size_t const first = std::min(spheres.size(), static_cast<std::size_t>(round) * chunk);
      view const part = spheres.subview(first, std::min(chunk, spheres.size() - first));
      together(ranks, [&] { sort_spheres(ranks.size(), detector.space(), mesh.map(), part); });
      deliver(ranks, sent_, received_);
      together(ranks, [&] {
        query(detector);
        answer_all(mesh, with_triangles);
      });
      deliver(ranks, answers_, answered_);
      if (with_triangles) deliver(ranks, named_, learned_);
      together(ranks, [&] { take(first); });
    }
    together(ranks, [&] { sort_triangles(); });
  }

  /// The pairs, in no certain order: numbers of this rank's spheres, and of triangles among those of all ranks.
  std::vector<pair> const& found() const { return found_; }
  /// The triangles in them, each once, by rising number, if they were asked for.
  std::vector<numbered_triangle<S>> const& triangles() const { return triangles_; }

 private:
  void sort_spheres(int ranks, space_type const& space, rank_map const& map, view const& part) {
    packed_ = packed_on_host<sent>(space, part.size(), memory_, [&](sent* to) {
      space.for_each(part.size(), pack_spheres<view, sent>{part, to});
    });
    double const extent = map.grid().meets(map.grid().frame()) ? map.grid().frame().max_extent() : 0;
    auto const sort = [&](auto const& put) {
      for (std::size_t i = 0; i < packed_.size(); ++i) {
        map.for_each_rank(packed_[i].reach(extent), [&](int rank) { put(rank, i); });
      }
    };
    fill_mail(sent_, ranks, [&](auto const& put) { sort([&](int rank, std::size_t i) { put(rank, packed_[i]); }); });
    fill_mail(numbers_, ranks,
              [&](auto const& put) { sort([&](int rank, std::size_t i) { put(rank, static_cast<id>(i)); }); });
  }

  /// Finds the pairs of what was received.
  void query(Detector& detector) {
    std::size_t const n = received_.items.size();
    hits_.clear();
    if (n == 0) return;
    S const* const at = in_space(detector.space(), received_.items, memory_)->numbers;
    sphere_view<S> const spheres(points(at, n, sent::size), at + 3, sent::size, S(0));
    if constexpr (moves) {
      detector.query(view(spheres, points(at + 4, n, sent::size)), local_);
    } else {
      detector.query(spheres, local_);
    }
    hits_ = local_.to_host();
    std::sort(hits_.begin(), hits_.end());
  }

  void answer_all(divided_mesh<S> const& mesh, bool with_triangles) {
    answers_.clear(static_cast<int>(received_.counts.size()));
    named_.clear(static_cast<int>(received_.counts.size()));
    answers_.items.reserve(hits_.size());
    std::vector<id> local;
    std::uint64_t first = 0;
    std::size_t h = 0;
    for (std::size_t r = 0; r < received_.counts.size(); ++r) {
      std::uint64_t const end = first + received_.counts[r];
      std::size_t const before = h;
      for (; h < hits_.size() && end > hits_[h].sphere; ++h) {
        answers_.items.push_back({static_cast<id>(hits_[h].sphere - first), hits_[h].triangle});
      }
      if (with_triangles) {
        local.clear();
        for (std::size_t k = before; k < h; ++k) local.push_back(hits_[k].triangle);
        std::sort(local.begin(), local.end());
        local.erase(std::unique(local.begin(), local.end()), local.end());
        for (id const t : local) named_.items.push_back(mesh[t]);
        named_.counts[r] = local.size();
      }
      answers_.counts[r] = h - before;
      first = end;
    }
    for (auto& a : answers_.items) a.triangle = mesh[a.triangle].number;
  }

  /// Adds what has come back to what was found. `first` is the number of the first sphere that was sent.
  void take(std::size_t first) {
    std::size_t at = 0, sphere = 0;
    for (std::size_t r = 0; r < answered_.counts.size(); ++r) {
      for (std::uint64_t k = 0; k < answered_.counts[r]; ++k) {
        answer const a = answered_.items[at++];
        found_.push_back({static_cast<id>(first + numbers_.items[sphere + a.place]), a.triangle});
      }
      sphere += static_cast<std::size_t>(numbers_.counts[r]);
    }
    triangles_.insert(triangles_.end(), learned_.items.begin(), learned_.items.end());
    learned_.items.clear();
  }

  void sort_triangles() {
    std::sort(triangles_.begin(), triangles_.end());
    auto const same = [](auto const& a, auto const& b) { return a.number == b.number; };
    triangles_.erase(std::unique(triangles_.begin(), triangles_.end(), same), triangles_.end());
  }

  std::vector<sent> packed_;
  buffer<sent> memory_;
  mail<sent> sent_, received_;
  mail<id> numbers_;  ///< of the spheres sent, in this round
  pairs local_;
  std::vector<pair> hits_;  ///< of the spheres received
  mail<answer> answers_, answered_;
  mail<numbered_triangle<S>> named_, learned_;
  std::vector<pair> found_;
  std::vector<numbered_triangle<S>> triangles_;
};

}  // namespace collide::detail
