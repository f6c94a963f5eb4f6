/// \file
/// The memory of contacts, as ranks send it to each other: on the host, by numbers among the particles of all ranks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <collide/effects/detail/contact_memory.hpp>
#include <collide/ranks/detail/exchange_buffer.hpp>

namespace collide::detail {

/// A contact of a particle: with another, or with a body.
template <class S, std::size_t Width>
struct contact_row {
  id of, other;
  S values[Width];
};

/// The contacts of some particles: the particle at place i is number `numbers[i]`. Those of a particle follow each
/// other as they did.
template <class Row, class S>
std::vector<Row> rows_of(saved_contacts<S> const& saved, std::vector<id> const& numbers) {
  std::vector<Row> rows;
  std::size_t at = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::uint32_t k = 0; k < saved.counts[i]; ++k, ++at) {
      Row row{numbers[i], saved.others[at], {}};
      constexpr std::size_t width = sizeof row.values / sizeof(S);
      std::copy_n(saved.values.data() + width * at, width, row.values);
      rows.push_back(row);
    }
  }
  return rows;
}

/// The contacts that rows tell of, for particles at places: the opposite of `rows_of`. Rows of particles that are not
/// there are left out.
template <class S, std::size_t Width>
saved_contacts<S> contacts_of(std::vector<contact_row<S, Width>> const& rows, std::vector<id> const& numbers) {
  std::vector<std::pair<id, std::size_t>> places;
  for (std::size_t i = 0; i < numbers.size(); ++i) places.emplace_back(numbers[i], i);
  std::sort(places.begin(), places.end());
  std::vector<std::pair<std::size_t, std::size_t>> order;  // places, and rows
  for (std::size_t k = 0; k < rows.size(); ++k) {
    auto const found = std::lower_bound(places.begin(), places.end(), std::pair(rows[k].of, std::size_t{0}));
    if (found != places.end() && found->first == rows[k].of) order.emplace_back(found->second, k);
  }
  std::sort(order.begin(), order.end());
  saved_contacts<S> saved;
  saved.counts.assign(numbers.size(), 0);
  for (auto const& [place, k] : order) {
    ++saved.counts[place];
    saved.others.push_back(rows[k].other);
    saved.values.insert(saved.values.end(), rows[k].values, rows[k].values + Width);
  }
  return saved;
}

/// The numbers from 0 to n - 1.
inline std::vector<id> first_ids(std::size_t n) {
  std::vector<id> numbers(n);
  for (std::size_t i = 0; i < n; ++i) numbers[i] = static_cast<id>(i);
  return numbers;
}

/// Brings rows to the ranks on which their particles are to be: `rank_of(number)` is that of a particle. All ranks call
/// it.
template <class Ranks, class Row, class Rank>
void deliver_rows(Ranks const& ranks, std::vector<Row>& rows, Rank const& rank_of) {
  exchange_buffer<Row> out, in;
  together(ranks, [&] {
    fill_exchange_buffer(out, ranks.size(), [&](auto const& put) {
      for (Row const& row : rows) put(rank_of(row.of), row);
    });
  });
  deliver(ranks, out, in);
  rows = std::move(in.items);
}

}  // namespace collide::detail
