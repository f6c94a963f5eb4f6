/// \file
/// Ranks: parts of a program that work together, each with spheres of its own; see docs/ranks.md. Here are the concept
/// and its simplest model; `thread_ranks` are in thread_ranks.hpp, `mpi_ranks` in mpi.hpp.
///
/// A model of ranks is a value that is cheap to copy, with const members that all ranks call in the same order. Memory
/// is the host's, and is not allocated by them:
///   - `int rank()`, `int size()`: the number of this rank, from 0, and how many there are;
///   - `all_gather(mine, bytes, all)`: `bytes` from each rank, in the order of their numbers;
///   - `reduce(mine, all, n, reduction)`: the sums or maxima of n numbers of 64 bits; `all` is not `mine`;
///   - `exchange_counts(to_each, of_each)`: one number of 64 bits from each rank to each;
///   - `exchange(from, to_each, to, of_each, bytes)`: items of so many `bytes`, `to_each[r]` of them to rank r, and
///     `of_each[r]` from it, each time in the order of the ranks and without gaps;
///   - `exchange_in_space(space, from, to_each, to, of_each, bytes)`, if they can: the same of memory of devices, at
///     once or in the order of the spaces' work. All ranks come out of it, also where one of them throws;
///   - `wait_for(space)`, if they can: waits for a space's work, but throws where messages in it do not come; messages
///     that are under way go on;
///   - `begin_exchange`, with the parameters of `exchange`, and `end_exchange()`, if they can: what is sent may travel
///     until the second, and only `reduce` and `wait_for` are called in between;
///   - `bool takes_device_memory()`, if that is known at run time alone: whether `exchange_in_space` can be called.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <string>
#include <type_traits>
#include <vector>

#include <collide/core/detail/detected.hpp>
#include <collide/core/error.hpp>

namespace collide {

/// The result of `reduce` for the numbers of all ranks.
enum class reduction {
  sum,  ///< their sum
  max   ///< the largest
};

/// The exception of a rank when another one has failed, or has left: the message says which, and why.
class rank_error : public error {
 public:
  using error::error;
};

/// Ranks: a single one. Nothing is sent, and nothing remains of it in compiled code.
class one_rank {
 public:
  /// The number of this rank.
  static constexpr int rank() { return 0; }
  /// How many ranks there are.
  static constexpr int size() { return 1; }
  void all_gather(void const* mine, std::size_t bytes, void* all) const { copy(mine, bytes, all); }
  void reduce(std::uint64_t const* mine, std::uint64_t* all, std::size_t n, reduction) const {
    copy(mine, n * sizeof *mine, all);
  }
  void exchange_counts(std::uint64_t const* to_each, std::uint64_t* of_each) const { *of_each = *to_each; }
  void exchange(void const* from, std::uint64_t const* to_each, void* to, std::uint64_t const* /*of_each*/,
                std::size_t bytes) const {
    copy(from, static_cast<std::size_t>(*to_each) * bytes, to);
  }

 private:
  static void copy(void const* from, std::size_t bytes, void* to) {
    if (bytes != 0) std::memcpy(to, from, bytes);
  }
};

namespace detail {

/// The members of ranks.
template <class R>
using ranks_rank = std::enable_if_t<std::is_convertible<decltype(std::declval<R const&>().rank()), int>::value>;
template <class R>
using ranks_size = std::enable_if_t<std::is_convertible<decltype(std::declval<R const&>().size()), int>::value>;
template <class R>
using ranks_all_gather = decltype(std::declval<R const&>().all_gather(static_cast<void const*>(nullptr), std::size_t{},
                                                                      static_cast<void*>(nullptr)));
template <class R>
using ranks_reduce = decltype(std::declval<R const&>().reduce(
    static_cast<std::uint64_t const*>(nullptr), static_cast<std::uint64_t*>(nullptr), std::size_t{}, reduction::sum));
template <class R>
using ranks_exchange_counts = decltype(std::declval<R const&>().exchange_counts(
    static_cast<std::uint64_t const*>(nullptr), static_cast<std::uint64_t*>(nullptr)));
template <class R>
using ranks_exchange = decltype(std::declval<R const&>().exchange(
    static_cast<void const*>(nullptr), static_cast<std::uint64_t const*>(nullptr), static_cast<void*>(nullptr),
    static_cast<std::uint64_t const*>(nullptr), std::size_t{}));

template <class R>
constexpr bool check_ranks() {
  static_assert(is_valid<ranks_rank, R> && is_valid<ranks_size, R>,
                "collide: ranks have const members rank() and size(), such as one_rank, thread_ranks and mpi_ranks");
  static_assert(is_valid<ranks_all_gather, R>, "collide: ranks have a const member all_gather(mine, bytes, all)");
  static_assert(is_valid<ranks_reduce, R>, "collide: ranks have a const member reduce(mine, all, n, reduction)");
  static_assert(is_valid<ranks_exchange_counts, R>,
                "collide: ranks have a const member exchange_counts(to_each, of_each)");
  static_assert(is_valid<ranks_exchange, R>,
                "collide: ranks have a const member exchange(from, to_each, to, of_each, bytes)");
  return true;
}

/// The message of an exception.
inline std::string message_of(std::exception_ptr const& failure) {
  try {
    std::rethrow_exception(failure);
  } catch (std::exception const& e) {
    return e.what();
  } catch (...) {
    return "an exception that is no std::exception";
  }
}

/// Keeps the first exception of work that must continue, as other ranks wait for it.
class first_failure {
 public:
  /// Calls f(), and keeps what it throws.
  template <class F>
  void attempt(F const& f) noexcept {
    try {
      f();
    } catch (...) {
      if (!failure_) failure_ = std::current_exception();
    }
  }
  /// The first exception; null if there was none.
  std::exception_ptr const& get() const { return failure_; }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::exception_ptr failure_;
};

}  // namespace detail

/// Makes an exception of one rank one of all: all ranks call it, with what each has caught, or null. A rank that has
/// caught something throws that again; if it has not, but another has, it throws `rank_error` with the number and the
/// message of the first such rank. It allocates nothing if all is well.
template <class Ranks>
void agree(Ranks const& ranks, std::exception_ptr const& failure = nullptr) {
  auto const size = static_cast<std::uint64_t>(ranks.size());
  std::uint64_t const mine = failure ? size - static_cast<std::uint64_t>(ranks.rank()) : 0;
  std::uint64_t first = 0;
  ranks.reduce(&mine, &first, 1, reduction::max);
  if (first == 0) return;
  constexpr std::size_t longest = 512;
  std::uint64_t text[longest / 8] = {}, heard[longest / 8] = {};
  if (mine == first) {
    std::string const message = detail::message_of(failure);
    std::memcpy(text, message.data(), message.size() < longest ? message.size() : longest - 1);
  }
  ranks.reduce(text, heard, longest / 8, reduction::max);  // all others have zeros
  if (failure) std::rethrow_exception(failure);
  throw rank_error("collide: rank " + std::to_string(size - first) + " of " + std::to_string(size) +
                   " failed: " + reinterpret_cast<char const*>(heard));
}

/// Calls f() on each rank, and throws on all of them if it throws on one; see `agree`. What f does is of its own rank
/// alone: it calls no members of ranks.
template <class Ranks, class F>
void together(Ranks const& ranks, F const& f) {
  if constexpr (std::is_same<Ranks, one_rank>::value) {
    f();
  } else {
    std::exception_ptr failure;
    try {
      f();
    } catch (...) {
      failure = std::current_exception();
    }
    agree(ranks, failure);
  }
}

/// How many the ranks before this one have, if it has `mine`. All ranks call it.
template <class Ranks>
std::uint64_t count_before([[maybe_unused]] Ranks const& ranks, [[maybe_unused]] std::uint64_t mine) {
  std::uint64_t sum = 0;
  if constexpr (!std::is_same<Ranks, one_rank>::value) {
    std::vector<std::uint64_t> all;
    together(ranks, [&] { all.resize(static_cast<std::size_t>(ranks.size())); });
    ranks.all_gather(&mine, sizeof mine, all.data());
    for (int r = 0; r < ranks.rank(); ++r) sum += all[static_cast<std::size_t>(r)];
  }
  return sum;
}

}  // namespace collide
