/// \file
/// Space divided among ranks: a subdomain each, in which they have about as many particles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/exact/detail/numeric/repeating_box.hpp>
#include <collide/ranks/ranks.hpp>
#include <collide/spaces/detail/host_array.hpp>

namespace collide::detail {

/// A subdomain of some ranks. If there are several, it is cut: what is below the cut is in subdomain `child`, the rest
/// in the next.
struct subdomain {
  int first, ranks, axis;
  std::uint32_t child;
  double cut;

  template <class S>
  COLLIDE_HD_INLINE bool is_below(S const* x) const {
    return static_cast<double>(x[axis]) < cut;
  }
};

/// A `bisection` as a plain value that a kernel takes: it reads the subdomains in memory of its space.
struct subdomain_lookup {
  subdomain const* subdomains;

  template <class S>
  COLLIDE_HD int rank_at(S const* x) const {
    std::size_t i = 0;
    while (subdomains[i].ranks > 1) i = subdomains[i].child + (subdomains[i].is_below(x) ? 0 : 1);
    return subdomains[i].first;
  }

  /// Calls f(rank) for all ranks whose subdomains a cube around the point meets, from the point up to `reach`, in
  /// rising order.
  template <class S, class F>
  COLLIDE_HD void for_each_rank(S const* x, double reach, F const& f) const {
    std::uint32_t waiting[32] = {};  // one for each cut, at most
    for (int n = 1; n > 0;) {
      subdomain const& b = subdomains[waiting[--n]];
      if (b.ranks == 1) {
        f(b.first);
        continue;
      }
      double const at = static_cast<double>(x[b.axis]);
      if (at + reach >= b.cut) waiting[n++] = b.child + 1;
      if (at - reach <= b.cut) waiting[n++] = b.child;
    }
  }
};

/// Calls f(rank) for all ranks whose subdomains a cube around the point meets, in rising order; once each, if space
/// repeats.
template <class S, class F>
COLLIDE_HD void for_each_rank_near(subdomain_lookup const& to, open_space, S const* x, double reach, F const& f) {
  to.for_each_rank(x, reach, f);
}
template <class S, class F>
COLLIDE_HD void for_each_rank_near(subdomain_lookup const& to, repeating_box<S> const& space, S const* x, double reach,
                                   F const& f) {
  vec3<S> const at = space.inside(vec3<S>(x[0], x[1], x[2]));
  // for each axis, three bits say for which lengths, 0, 1 or -1, a cube so far away meets what the cuts have left
  struct node {
    std::uint32_t number, lengths[3];
  } waiting[32] = {{0, {7, 7, 7}}};
  for (int n = 1; n > 0;) {
    node const of = waiting[--n];
    subdomain const& b = to.subdomains[of.number];
    if (b.ranks == 1) {
      f(b.first);
      continue;
    }
    std::uint32_t above = 0, below = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      double const there = static_cast<double>(at[b.axis]) + (k == 2 ? -1.0 : double(k)) * space.length(b.axis);
      if ((of.lengths[b.axis] >> k & 1) == 0) continue;
      if (there + reach >= b.cut) above |= 1u << k;
      if (there - reach <= b.cut) below |= 1u << k;
    }
    for (int side = 0; side < 2; ++side) {
      if ((side == 0 ? above : below) == 0) continue;
      node& next = waiting[n++] = of;
      next.number = b.child + (side == 0 ? 1 : 0);
      next.lengths[b.axis] = side == 0 ? above : below;
    }
  }
}

/// Subdomains that cover all of space. A subdomain of several ranks is cut across its longest side, as often as there
/// are ranks in it (M. J. Berger and S. H. Bokhari, "A partitioning strategy for nonuniform problems on
/// multiprocessors", IEEE Transactions on Computers C-36(5), 1987). What is counted are integers, so all ranks make the
/// same cuts.
class bisection {
 public:
  /// All ranks call it, each with the centres of its particles, which are finite: three coordinates each.
  /// O(particles log ranks).
  template <class Ranks, class S>
  void build(Ranks const& ranks, std::vector<S> const& centres) {
    std::vector<std::uint32_t> at;  // the node of each particle
    std::vector<std::size_t> level;
    together(ranks, [&] {
      nodes_.assign(1, {0, ranks.size(), 0, 0, 0});
      at.assign(centres.size() / 3, 0);
      if (ranks.size() > 1) level.assign(1, 0);
    });
    while (!level.empty()) {
      cut(ranks, level, at, centres);
      together(ranks, [&] { level = split(level, at, centres); });
    }
  }

  subdomain_lookup lookup() const { return {nodes_.data()}; }
  /// For kernels of a space, valid until the subdomains are built again; `memory` has them, where the space cannot read
  /// the host's.
  template <class Space>
  subdomain_lookup lookup(Space const& space, buffer<subdomain>& memory) const {
    subdomain const* const subdomains = in_space(space, nodes_, memory);
    return {subdomains};
  }

 private:
  static constexpr std::size_t bins = 512;

  /// How the particles of a node are counted: in bins along its longest side.
  struct ruler {
    int axis = 0;
    double lower = 0, half = 0;  ///< half the length
    std::size_t bin_of(double x) const {
      double const bin = half > 0 ? (x / 2 - lower / 2) / half * static_cast<double>(bins) : 0;
      return bin < static_cast<double>(bins - 1) ? (bin > 0 ? static_cast<std::size_t>(bin) : 0) : bins - 1;
    }
    double edge(std::size_t bin) const { return lower + 2 * (half * (static_cast<double>(bin) / bins)); }
  };

  template <class Ranks, class S>
  void cut(Ranks const& ranks, std::vector<std::size_t> const& level, std::vector<std::uint32_t> const& at,
           std::vector<S> const& centres) {
    std::size_t const first = level.front(), n = nodes_.size() - first;  // not all are cut
    std::vector<std::uint64_t> mine, all;
    together(ranks, [&] {
      mine.assign(6 * n, to_ordered_bits(-std::numeric_limits<double>::infinity()));
      all.resize(6 * n);
      for (std::size_t i = 0; i < at.size(); ++i) {
        if (at[i] < first) continue;
        std::uint64_t* const largest = mine.data() + 6 * (at[i] - first);
        for (std::size_t k = 0; k < 3; ++k) {
          double const x = static_cast<double>(centres[3 * i + k]);
          largest[k] = max(largest[k], to_ordered_bits(-x));
          largest[3 + k] = max(largest[3 + k], to_ordered_bits(x));
        }
      }
    });
    ranks.reduce(mine.data(), all.data(), all.size(), reduction::max);
    std::vector<ruler> rulers;
    together(ranks, [&] {
      for (std::size_t k = 0; k < n; ++k) rulers.push_back(ruler_of(all.data() + 6 * k));
      mine.assign(bins * n, 0);
      all.resize(bins * n);
      for (std::size_t i = 0; i < at.size(); ++i) {
        if (at[i] < first) continue;
        ruler const& along = rulers[at[i] - first];
        double const x = static_cast<double>(centres[3 * i + static_cast<std::size_t>(along.axis)]);
        ++mine[bins * (at[i] - first) + along.bin_of(x)];
      }
    });
    ranks.reduce(mine.data(), all.data(), all.size(), reduction::sum);
    for (std::size_t const i : level) {
      subdomain& one = nodes_[i];
      ruler const& along = rulers[i - first];
      one.axis = along.axis;
      one.cut = along.edge(middle_of(all.data() + bins * (i - first), one.ranks));
    }
  }

  static ruler ruler_of(std::uint64_t const* largest) {
    ruler longest;
    for (int k = 0; k < 3; ++k) {
      double const lower = -from_ordered_bits<double>(largest[k]), upper = from_ordered_bits<double>(largest[3 + k]);
      double const half = upper / 2 - lower / 2;
      if (half > longest.half) longest = {k, lower, half};
    }
    return longest;
  }

  /// The bin before which the first half of so many ranks have their part, as nearly as that can be.
  static std::size_t middle_of(std::uint64_t const* counts, int ranks) {
    std::uint64_t sum = 0;
    for (std::size_t b = 0; b < bins; ++b) sum += counts[b];
    double const wanted = static_cast<double>(sum) * (ranks / 2) / ranks;
    double below = 0;
    std::size_t bin = 0;
    while (bin < bins && below + static_cast<double>(counts[bin]) / 2 < wanted) {
      below += static_cast<double>(counts[bin++]);
    }
    return bin;
  }

  /// Makes the next level, and says which of its nodes are to be cut.
  template <class S>
  std::vector<std::size_t> split(std::vector<std::size_t> const& level, std::vector<std::uint32_t>& at,
                                 std::vector<S> const& centres) {
    std::vector<std::size_t> next;
    for (std::size_t const i : level) {
      subdomain const whole = nodes_[i];
      nodes_[i].child = static_cast<std::uint32_t>(nodes_.size());
      for (int const upper : {0, 1}) {
        int const below = whole.ranks / 2, ranks = upper == 0 ? below : whole.ranks - below;
        if (ranks > 1) next.push_back(nodes_.size());
        nodes_.push_back({whole.first + upper * below, ranks, 0, 0, 0});
      }
    }
    for (std::size_t i = 0; i < at.size(); ++i) {
      subdomain const& b = nodes_[at[i]];
      if (b.child == 0) continue;
      at[i] = b.child + (b.is_below(centres.data() + 3 * i) ? 0 : 1);
    }
    return next;
  }

  std::vector<subdomain> nodes_;
};

}  // namespace collide::detail
