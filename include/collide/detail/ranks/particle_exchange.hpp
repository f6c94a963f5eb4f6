/// \file
/// How particles go from rank to rank, and what ranks tell each other of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <collide/detail/execution/host_array.hpp>
#include <collide/detail/ranks/bisection.hpp>
#include <collide/detail/ranks/mail.hpp>
#include <collide/detail/ranks/part_of_simulation.hpp>

namespace collide::detail {

/// Each rank has the particles of its brick, and copies of those outside that may meet them, until one has moved too
/// far. All ranks call all members.
template <class Part>
class particle_exchange {
  using S = typename Part::S;
  using all_columns = typename Part::all_columns;
  using seen_columns = typename Part::seen_columns;
  template <class List>
  using row = particle_row<S, List>;

 public:
  /// Forgets the bricks: there are other particles.
  void clear() { is_divided_ = false; }

  /// Brings particles to the ranks in whose bricks they are, and finds out which copies go where.
  template <class Ranks>
  void exchange(Ranks const& ranks, Part& part) {
    divide(ranks, part);
    mail<std::uint32_t> leaving;
    mail<row<all_columns>> going, coming;
    together(ranks, [&] {
      fill_mail(leaving, ranks.size(), [&](auto const& put) {
        for_each_particle(ranks, part.all_size(), [&](std::size_t i, int to) {
          if (to != ranks.rank()) put(to, static_cast<std::uint32_t>(i));
        });
      });
      part.template pack<all_columns>(leaving.items, going.items);
      going.counts = leaving.counts;
    });
    deliver(ranks, going, coming);
    together(ranks, [&] {
      std::sort(leaving.items.begin(), leaving.items.end());
      part.replace(leaving.items, coming.items);
      look_at(part);
      fill_mail(copies_, ranks.size(), [&](auto const& put) {
        for (std::size_t i = 0; i < centres_.size() / 3; ++i) {
          if (!is_somewhere(i)) continue;
          bricks_.for_each_rank(centres_.data() + 3 * i, part.reach(), [&](int rank) {
            if (rank != ranks.rank()) put(rank, static_cast<std::uint32_t>(i));
          });
        }
      });
      to_receive_.assign(copies_.counts.size(), 0);
    });
    ranks.exchange_counts(copies_.counts.data(), to_receive_.data());
    together(ranks, [&] {
      std::uint64_t n = 0;
      for (std::uint64_t const each : to_receive_) n += each;
      received_.resize(part.space(), static_cast<std::size_t>(n));
      part.expect_copies(received_.size());
      places_ = in_space(part.space(), copies_.items, place_memory_);
      pack(part);
    });
  }

  /// Makes ready what others must know in this step.
  void pack(Part& part) { part.pack_seen(places_, copies_.items.size(), sent_); }

  /// Sends it.
  template <class Ranks>
  void send(Ranks const& ranks) {
    ranks.exchange(sent_.data(), copies_.counts.data(), received_.data(), to_receive_.data(),
                   sizeof(row<seen_columns>));
  }

  /// Takes over what the others have sent.
  void unpack(Part& part) { part.unpack_seen(received_); }

 private:
  /// Cuts bricks if there are none, or one has many more particles than it should.
  template <class Ranks>
  void divide(Ranks const& ranks, Part& part) {
    std::uint64_t mine = 0, most = 0, sum = 0;
    std::vector<S> there;
    together(ranks, [&] {
      look_at(part);
      for (std::size_t i = 0; i < centres_.size() / 3; ++i) {
        if (is_somewhere(i))
          there.insert(there.end(), centres_.begin() + std::ptrdiff_t(3 * i),
                       centres_.begin() + std::ptrdiff_t(3 * i + 3));
      }
    });
    mine = there.size() / 3;
    ranks.reduce(&mine, &most, 1, reduction::max);
    ranks.reduce(&mine, &sum, 1, reduction::sum);
    std::uint64_t const fair = sum / static_cast<std::uint64_t>(ranks.size());
    if (is_divided_ && most <= fair + fair / 4 + 16) return;
    bricks_.build(ranks, there);
    is_divided_ = true;
  }

  /// Copies to the host where particles are.
  void look_at(Part& part) {
    centres_ = part.template on_host<position>();
    if constexpr (Part::has_absent) {
      there_ = part.template on_host<alive>();
      numbers_ = part.template on_host<global_number>();
    }
  }

  bool is_there([[maybe_unused]] std::size_t i) const {
    if constexpr (Part::has_absent) {
      return there_[i] != 0;
    } else {
      return true;
    }
  }
  bool is_somewhere(std::size_t i) const {
    S const* const x = centres_.data() + 3 * i;
    return is_there(i) && is_finite(x[0]) && is_finite(x[1]) && is_finite(x[2]);
  }

  /// Calls f(i, rank) with the rank that each particle is to be on. Free places are on all ranks alike; what is nowhere
  /// stays.
  template <class Ranks, class F>
  void for_each_particle(Ranks const& ranks, [[maybe_unused]] std::size_t all, F const& f) const {
    for (std::size_t i = 0; i < centres_.size() / 3; ++i) {
      if (is_somewhere(i)) {
        f(i, bricks_.rank_at(centres_.data() + 3 * i));
      } else if (is_there(i)) {
        f(i, ranks.rank());
      } else {
        f(i, static_cast<int>(std::uint64_t{numbers_[i]} * static_cast<std::uint64_t>(ranks.size()) / all));
      }
    }
  }

  bisection bricks_;
  bool is_divided_ = false;
  std::vector<S> centres_;
  std::vector<std::uint8_t> there_;
  std::vector<id> numbers_;
  mail<std::uint32_t> copies_;  ///< places of this rank's particles of which others have copies
  std::uint32_t const* places_ = nullptr;
  buffer<std::uint32_t> place_memory_;
  std::vector<std::uint64_t> to_receive_;  ///< copies of each other rank's particles
  host_array<row<seen_columns>> sent_, received_;
};

}  // namespace collide::detail
