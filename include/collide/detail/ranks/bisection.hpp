/// \file
/// Space divided among ranks: a brick each, in which they have about as many particles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <collide/detail/geometry/aabb.hpp>
#include <collide/detail/numeric/float_bits.hpp>
#include <collide/ranks.hpp>

namespace collide::detail {

/// Bricks that cover all of space. A brick of several ranks is cut across its longest side, as often as there are ranks
/// in it (M. J. Berger and S. H. Bokhari, "A partitioning strategy for nonuniform problems on multiprocessors", IEEE
/// Transactions on Computers C-36(5), 1987). What is counted are integers, so all ranks make the same cuts.
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

  /// The rank in whose brick a point is.
  template <class S>
  int rank_at(S const* x) const {
    std::size_t i = 0;
    while (nodes_[i].ranks > 1) i = nodes_[i].child + (is_below(x, nodes_[i]) ? 0 : 1);
    return nodes_[i].first;
  }

  /// Calls f(rank) for all ranks whose bricks a cube around the point meets, from the point up to `reach`.
  template <class S, class F>
  void for_each_rank(S const* x, double reach, F const& f) const {
    visit(0, x, reach, f);
  }

 private:
  static constexpr std::size_t bins = 512;

  /// A brick of some ranks. If there are several, those below the cut are in node `child`, the others in the next.
  struct node {
    int first, ranks, axis;
    std::size_t child;
    double cut;
  };

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

  template <class S>
  static bool is_below(S const* x, node const& n) {
    return static_cast<double>(x[n.axis]) < n.cut;
  }

  template <class S, class F>
  void visit(std::size_t i, S const* x, double reach, F const& f) const {
    node const& n = nodes_[i];
    if (n.ranks == 1) return f(n.first);
    double const at = static_cast<double>(x[n.axis]);
    if (at - reach <= n.cut) visit(n.child, x, reach, f);
    if (at + reach >= n.cut) visit(n.child + 1, x, reach, f);
  }

  /// Finds where the nodes of a level are cut.
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
        std::uint64_t* const most = mine.data() + 6 * (at[i] - first);
        for (std::size_t k = 0; k < 3; ++k) {
          double const x = static_cast<double>(centres[3 * i + k]);
          most[k] = larger(most[k], to_ordered_bits(-x));
          most[3 + k] = larger(most[3 + k], to_ordered_bits(x));
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
      node& one = nodes_[i];
      ruler const& along = rulers[i - first];
      one.axis = along.axis;
      one.cut = along.edge(middle_of(all.data() + bins * (i - first), one.ranks));
    }
  }

  static ruler ruler_of(std::uint64_t const* most) {
    ruler longest;
    for (int k = 0; k < 3; ++k) {
      double const lower = -from_ordered_bits<double>(most[k]), upper = from_ordered_bits<double>(most[3 + k]);
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
      node const whole = nodes_[i];
      nodes_[i].child = nodes_.size();
      for (int const upper : {0, 1}) {
        int const below = whole.ranks / 2, ranks = upper == 0 ? below : whole.ranks - below;
        if (ranks > 1) next.push_back(nodes_.size());
        nodes_.push_back({whole.first + upper * below, ranks, 0, 0, 0});
      }
    }
    for (std::size_t i = 0; i < at.size(); ++i) {
      node const& n = nodes_[at[i]];
      if (n.child == 0) continue;
      at[i] = static_cast<std::uint32_t>(n.child + (is_below(centres.data() + 3 * i, n) ? 0 : 1));
    }
    return next;
  }

  std::vector<node> nodes_;
};

}  // namespace collide::detail
