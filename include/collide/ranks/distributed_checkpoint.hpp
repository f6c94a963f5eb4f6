/// \file
/// Saves a simulation on many ranks to a file, and goes on from it on any number of ranks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include <collide/ranks/distributed_simulation.cuh>
#include <collide/simulation/checkpoint.hpp>

namespace collide {

namespace detail {

/// The checkpoints of a simulation on ranks are those of one rank.
template <class Detector, class... Effect, class Ranks>
class distributed_checkpoint<distributed<simulation<Detector, Effect...>, Ranks>> {
  using simulated = distributed<simulation<Detector, Effect...>, Ranks>;
  using S = typename simulated::scalar;
  using format = checkpoint<Detector, Effect...>;

 public:
  /// `stream` is of the first rank alone.
  static void write(simulated& from, std::ostream* stream, std::string const& name = "the stream") {
    Ranks const& ranks = from.ranks_;
    std::optional<checkpoint_writer> to;
    auto const on_first = [&](auto const& f) {
      together(ranks, [&] {
        if (ranks.rank() == 0) f();
      });
    };
    together(ranks, [&] {
      if (!from.part_.is_set()) throw error("collide: save: the simulation has no particles: call set before it");
    });
    birth_counts born;
    if constexpr (simulated::simulation_type::effects_type::makes) born = from.births();
    on_first([&] {
      to.emplace(*stream, name);
      auto numbers = from.part_.template saved_numbers_of_all<typename format::numbers_type>(from.reverse_order_);
      numbers.clock[clock_overlapping] = static_cast<double>(born.overlapping);
      numbers.clock[clock_not_born] = static_cast<double>(born.not_born);
      format::begin(*to, numbers, from.part_.effects());
    });
    for (saved_column const& column : saved_columns<S>(from.local().state(), typename simulated::columns())) {
      std::vector<unsigned char> values;
      from.bring_home(column.data, column.bytes(), values);
      bring_to_first(ranks, values);
      on_first([&] { to->block(column.name(), values.data(), values.size() / column.element, column.element); });
    }
    on_first([&] { format::end(*to, from.local()); });
    using part_type = typename simulated::part_type;
    if constexpr (part_type::remembers_pairs || part_type::remembers_surfaces) {
      typename part_type::contact_rows rows;
      together(ranks, [&] { rows = from.part_.contacts(); });
      auto const to_first = [](id) { return 0; };
      deliver_rows(ranks, rows.pairs, to_first);
      deliver_rows(ranks, rows.surfaces, to_first);
      on_first([&] {
        std::vector<id> const every = first_ids(from.size());
        format::write_contacts(*to, contacts_of(rows.pairs, every), contacts_of(rows.surfaces, every));
      });
    }
    on_first([&] { to->finish(); });
  }

  /// All ranks read the same.
  template <class Read>
  static void restore(simulated& to, Read const& read) {
    Ranks const& ranks = to.ranks_;
    auto const n = static_cast<std::uint64_t>(ranks.size());
    std::optional<format> found;
    std::vector<std::uint64_t> starts;
    auto const begin_of = [&](std::uint64_t number) {  // a clump stays whole
      if constexpr (contains<typename simulated::columns, in_clump>) {
        auto const* const clump = found->template column<in_clump>();
        auto const goes_on = [&] { return number > 0 && number < found->numbers().places && clump[number] != no_id; };
        while (goes_on() && clump[number] == clump[number - 1]) --number;
      }
      return number;
    };
    together(ranks, [&] {
      found.emplace(read([&](std::istream& from) { return format(to.part_.triangles(), to.local(), from); }));
      for (std::uint64_t r = 0; r <= n; ++r) starts.push_back(begin_of(found->numbers().placed * r / n));
    });
    to.is_sound_ = false;
    to.starts_ = std::move(starts);
    std::uint64_t const first = to.starts_[static_cast<std::size_t>(ranks.rank())],
                        end = to.starts_[static_cast<std::size_t>(ranks.rank()) + 1];
    global_counts all{first, found->numbers().placed, found->numbers().places, 0, 0};
    to.share_free(all, begin_of);
    to.reverse_order_ = found->numbers().reverse_order != 0;
    to.exchange_.clear();
    together(ranks, [&] { to.part_.restore(*found, static_cast<std::size_t>(end - first), all, ranks.rank() == 0); });
    to.is_sound_ = true;
  }
};

}  // namespace detail

/// Writes the checkpoint that `save` writes of the same simulation on one rank to a stream of the first rank: others'
/// are not touched. All ranks call it. Columns come to the first rank one after the other, which takes
/// memory of its host for one column of all. Throws what that `save` throws, on all ranks.
template <class Detector, class... Effect, class Ranks>
void save(distributed<simulation<Detector, Effect...>, Ranks>& from, std::ostream& to) {
  detail::distributed_checkpoint<distributed<simulation<Detector, Effect...>, Ranks>>::write(from, &to);
}

/// Writes a checkpoint to a file, which the first rank does; see `save` of checkpoint.hpp.
template <class Detector, class... Effect, class Ranks>
void save(distributed<simulation<Detector, Effect...>, Ranks>& from, std::string const& path) {
  std::optional<detail::checkpoint_file> file;
  together(from.ranks(), [&] {
    if (from.ranks().rank() == 0) file.emplace(path);
  });
  detail::distributed_checkpoint<distributed<simulation<Detector, Effect...>, Ranks>>::write(
      from, file ? &file->stream() : nullptr, path);
  together(from.ranks(), [&] {
    if (file) file->complete();
  });
}

/// Gives a simulation on ranks the state that `save` has written, of one rank or of any number of them: see `load` of
/// checkpoint.hpp. All ranks call it, and each reads a stream of its own with all of the checkpoint; then each has an
/// equal part of the particles, which `to_host` returns. Takes memory of each rank's host for a copy of all columns.
template <class Detector, class... Effect, class Ranks>
void load(distributed<simulation<Detector, Effect...>, Ranks>& into, std::istream& from) {
  detail::distributed_checkpoint<distributed<simulation<Detector, Effect...>, Ranks>>::restore(
      into, [&](auto const& read) { return read(from); });
}

/// Reads a checkpoint from a file that all ranks see, which has nothing else in it. Throws `error` if it cannot be
/// read, and what `load` of a stream throws; `rank_error` on the ranks that could.
template <class Detector, class... Effect, class Ranks>
void load(distributed<simulation<Detector, Effect...>, Ranks>& into, std::string const& path) {
  detail::distributed_checkpoint<distributed<simulation<Detector, Effect...>, Ranks>>::restore(
      into, [&](auto const& read) { return detail::read_checkpoint_file(path, read); });
}

}  // namespace collide
