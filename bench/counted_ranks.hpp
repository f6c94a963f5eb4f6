/// \file
/// Ranks that count what they send.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include <collide/ranks/ranks.hpp>

namespace bench {

/// The messages that a rank has sent to others.
struct traffic {
  std::uint64_t reductions = 0;       ///< how often all ranks have reduced numbers, or gathered some
  std::uint64_t reduced_bytes = 0;    ///< of this rank's numbers in them
  std::uint64_t exchanges = 0;        ///< how often all ranks have sent each other items, or how many there will be
  std::uint64_t messages = 0;         ///< in them, to other ranks
  std::uint64_t exchanged_bytes = 0;  ///< in them, to other ranks
  std::uint64_t first_bytes = 0;      ///< in the first exchange, if that is of items
  std::uint64_t last_bytes = 0;       ///< in the last exchange of items
};

/// Ranks that count what this one sends to others, and otherwise do as `Ranks`.
template <class Ranks>
class counted_ranks {
 public:
  /// Adds to `sent`, which must outlive it.
  counted_ranks(Ranks ranks, traffic& sent) : ranks_(std::move(ranks)), sent_{&sent} {}

  int rank() const { return ranks_.rank(); }
  int size() const { return ranks_.size(); }

  void all_gather(void const* mine, std::size_t bytes, void* all) const {
    ++sent_->reductions;
    sent_->reduced_bytes += bytes;
    ranks_.all_gather(mine, bytes, all);
  }
  void reduce(std::uint64_t const* mine, std::uint64_t* all, std::size_t n, collide::reduction how) const {
    ++sent_->reductions;
    sent_->reduced_bytes += n * sizeof *mine;
    ranks_.reduce(mine, all, n, how);
  }
  void exchange_counts(std::uint64_t const* to_each, std::uint64_t* of_each) const {
    auto const others = static_cast<std::uint64_t>(size() - 1);
    ++sent_->exchanges;
    sent_->messages += others;
    sent_->exchanged_bytes += others * sizeof *to_each;
    ranks_.exchange_counts(to_each, of_each);
  }
  void exchange(void const* from, std::uint64_t const* to_each, void* to, std::uint64_t const* of_each,
                std::size_t bytes) const {
    ++sent_->exchanges;
    sent_->last_bytes = 0;
    for (int r = 0; r < size(); ++r) {
      if (r == rank() || to_each[r] == 0) continue;
      ++sent_->messages;
      sent_->last_bytes += to_each[r] * bytes;
    }
    sent_->exchanged_bytes += sent_->last_bytes;
    if (sent_->exchanges == 1) sent_->first_bytes = sent_->last_bytes;
    ranks_.exchange(from, to_each, to, of_each, bytes);
  }

 private:
  Ranks ranks_;
  traffic* sent_;
};

}  // namespace bench
