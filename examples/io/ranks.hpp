/// \file
/// Files of programs on several ranks: each reads a part of a table, and the first writes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <collide/ranks/ranks.hpp>

#include "error.hpp"
#include "rounding.hpp"

struct CUstream_st;  // what CUDA's streams point to

namespace io {

/// The part of a space of a device that ranks use to send from its memory.
class any_device {
 public:
  /// Refers to a space, which must outlive it.
  template <class Space>
  explicit any_device(Space const& space)
      : space_{&space},
        stream_{space.stream()},
        synchronize_{[](void const* of) { static_cast<Space const*>(of)->synchronize(); }},
        is_done_{[](void const* of) { return static_cast<Space const*>(of)->is_done(); }},
        copy_{[](void const* of, void* to, void const* from, std::size_t bytes) {
          static_cast<Space const*>(of)->copy_from_any_device(to, from, bytes);
        }},
        mark_{[](void const* of) { return static_cast<Space const*>(of)->mark(); }},
        after_{[](void const* of, std::shared_ptr<void> const& mark) { static_cast<Space const*>(of)->after(mark); }} {}

  CUstream_st* stream() const { return stream_; }
  void synchronize() const { synchronize_(space_); }
  bool is_done() const { return is_done_(space_); }
  void copy_from_any_device(void* to, void const* from, std::size_t bytes) const { copy_(space_, to, from, bytes); }
  std::shared_ptr<void> mark() const { return mark_(space_); }
  void after(std::shared_ptr<void> const& mark) const { after_(space_, mark); }

 private:
  void const* space_;
  CUstream_st* stream_;
  void (*synchronize_)(void const*);
  bool (*is_done_)(void const*);
  void (*copy_)(void const*, void*, void const*, std::size_t);
  std::shared_ptr<void> (*mark_)(void const*);
  void (*after_)(void const*, std::shared_ptr<void> const&);
};

/// Says if ranks can wait for a device, send while something else is done, or from memory of devices, and if they know
/// that at run time alone.
template <class Ranks, class = void>
inline constexpr bool waits_for_devices = false;
template <class Ranks>
inline constexpr bool waits_for_devices<
    Ranks, std::void_t<decltype(std::declval<Ranks const&>().wait_for(std::declval<any_device const&>()))>> = true;
template <class Ranks, class = void>
inline constexpr bool sends_meanwhile = false;
template <class Ranks>
inline constexpr bool sends_meanwhile<Ranks, std::void_t<decltype(std::declval<Ranks const&>().end_exchange())>> = true;
template <class Ranks, class = void>
inline constexpr bool sends_from_devices = false;
template <class Ranks>
inline constexpr bool sends_from_devices<
    Ranks, std::void_t<decltype(std::declval<Ranks const&>().exchange_in_space(
               std::declval<any_device const&>(), nullptr, nullptr, nullptr, nullptr, std::size_t{}))>> = true;
template <class Ranks, class = void>
inline constexpr bool knows_at_run_time = false;
template <class Ranks>
inline constexpr bool
    knows_at_run_time<Ranks, std::void_t<decltype(std::declval<Ranks const&>().takes_device_memory())>> = true;

/// Ranks of any kind, so that a program is compiled once for all of them. It has a copy of what it is made from.
class any_ranks {
 public:
  template <class Ranks>
  explicit any_ranks(Ranks const& ranks) : ranks_{std::make_shared<model<Ranks>>(ranks)} {}

  int rank() const { return ranks_->rank(); }
  int size() const { return ranks_->size(); }
  void all_gather(void const* mine, std::size_t bytes, void* all) const { ranks_->all_gather(mine, bytes, all); }
  void reduce(std::uint64_t const* mine, std::uint64_t* all, std::size_t n, collide::reduction how) const {
    ranks_->reduce(mine, all, n, how);
  }
  void exchange_counts(std::uint64_t const* to_each, std::uint64_t* of_each) const {
    ranks_->exchange_counts(to_each, of_each);
  }
  void exchange(void const* from, std::uint64_t const* to_each, void* to, std::uint64_t const* of_each,
                std::size_t bytes) const {
    ranks_->exchange(from, to_each, to, of_each, bytes);
  }
  void begin_exchange(void const* from, std::uint64_t const* to_each, void* to, std::uint64_t const* of_each,
                      std::size_t bytes) const {
    ranks_->begin_exchange(from, to_each, to, of_each, bytes);
  }
  void end_exchange() const { ranks_->end_exchange(); }
  bool takes_device_memory() const { return ranks_->takes_device_memory(); }
  template <class Space>
  auto exchange_in_space(Space const& space, void const* from, std::uint64_t const* to_each, void* to,
                         std::uint64_t const* of_each, std::size_t bytes) const
      -> std::enable_if_t<std::is_convertible<decltype(space.stream()), CUstream_st*>::value> {
    ranks_->exchange_in_space(any_device(space), from, to_each, to, of_each, bytes);
  }
  template <class Space>
  auto wait_for(Space const& space) const
      -> std::enable_if_t<std::is_convertible<decltype(space.stream()), CUstream_st*>::value> {
    ranks_->wait_for(any_device(space));
  }

 private:
  struct interface {
    virtual ~interface() = default;
    virtual int rank() const = 0;
    virtual int size() const = 0;
    virtual void all_gather(void const*, std::size_t, void*) const = 0;
    virtual void reduce(std::uint64_t const*, std::uint64_t*, std::size_t, collide::reduction) const = 0;
    virtual void exchange_counts(std::uint64_t const*, std::uint64_t*) const = 0;
    virtual void exchange(void const*, std::uint64_t const*, void*, std::uint64_t const*, std::size_t) const = 0;
    virtual void begin_exchange(void const*, std::uint64_t const*, void*, std::uint64_t const*, std::size_t) const = 0;
    virtual void end_exchange() const = 0;
    virtual bool takes_device_memory() const = 0;
    virtual void exchange_in_space(any_device const&, void const*, std::uint64_t const*, void*, std::uint64_t const*,
                                   std::size_t) const = 0;
    virtual void wait_for(any_device const&) const = 0;
  };
  template <class Ranks>
  struct model final : interface {
    explicit model(Ranks const& r) : ranks{r} {}
    int rank() const override { return ranks.rank(); }
    int size() const override { return ranks.size(); }
    void all_gather(void const* mine, std::size_t bytes, void* all) const override {
      ranks.all_gather(mine, bytes, all);
    }
    void reduce(std::uint64_t const* mine, std::uint64_t* all, std::size_t n, collide::reduction how) const override {
      ranks.reduce(mine, all, n, how);
    }
    void exchange_counts(std::uint64_t const* to_each, std::uint64_t* of_each) const override {
      ranks.exchange_counts(to_each, of_each);
    }
    void exchange(void const* from, std::uint64_t const* to_each, void* to, std::uint64_t const* of_each,
                  std::size_t bytes) const override {
      ranks.exchange(from, to_each, to, of_each, bytes);
    }
    void begin_exchange(void const* from, std::uint64_t const* to_each, void* to, std::uint64_t const* of_each,
                        std::size_t bytes) const override {
      if constexpr (sends_meanwhile<Ranks>) {
        ranks.begin_exchange(from, to_each, to, of_each, bytes);
      } else {
        ranks.exchange(from, to_each, to, of_each, bytes);
      }
    }
    void end_exchange() const override {
      if constexpr (sends_meanwhile<Ranks>) ranks.end_exchange();
    }
    bool takes_device_memory() const override {
      if constexpr (knows_at_run_time<Ranks>) {
        return ranks.takes_device_memory();
      } else {
        return sends_from_devices<Ranks>;
      }
    }
    void exchange_in_space(any_device const& device, void const* from, std::uint64_t const* to_each, void* to,
                           std::uint64_t const* of_each, std::size_t bytes) const override {
      if constexpr (sends_from_devices<Ranks>) ranks.exchange_in_space(device, from, to_each, to, of_each, bytes);
    }
    void wait_for(any_device const& device) const override {
      if constexpr (waits_for_devices<Ranks>) ranks.wait_for(device);
    }
    Ranks ranks;
  };

  std::shared_ptr<interface const> ranks_;
};

/// Thrown where a file's fault is in the part of another rank.
class error_elsewhere : public data_error {
 public:
  error_elsewhere() : data_error("a file", "another rank cannot read its part") {}
};

/// Calls f(), which reads files, on each rank. If there is a `data_error` on one, there is on all.
template <class Ranks, class F>
void read_together(Ranks const& ranks, F const& f) {
  std::exception_ptr mine;
  collide::together(ranks, [&] {
    try {
      f();
    } catch (data_error const&) {
      mine = std::current_exception();
    }
  });
  std::uint64_t const is_wrong = mine ? 1 : 0;
  std::uint64_t somewhere = 0;
  ranks.reduce(&is_wrong, &somewhere, 1, collide::reduction::max);
  if (mine) std::rethrow_exception(mine);
  if (somewhere != 0) throw error_elsewhere();
}

/// The largest of numbers that are not negative, of which each rank has one. They sort like their bits.
template <class Ranks>
double largest(Ranks const& ranks, double mine) {
  std::uint64_t bits = 0, all = 0;
  std::memcpy(&bits, &mine, sizeof bits);
  ranks.reduce(&bits, &all, 1, collide::reduction::max);
  std::memcpy(&mine, &all, sizeof mine);
  return mine;
}

/// The smallest of numbers that are not negative.
template <class Ranks>
double smallest(Ranks const& ranks, double mine) {
  std::uint64_t bits = 0, all = 0;
  std::memcpy(&bits, &mine, sizeof bits);
  bits = ~bits;
  ranks.reduce(&bits, &all, 1, collide::reduction::max);
  all = ~all;
  std::memcpy(&mine, &all, sizeof mine);
  return mine;
}

/// The sum of numbers of which each rank has one.
template <class Ranks>
std::uint64_t sum(Ranks const& ranks, std::uint64_t mine) {
  std::uint64_t all = 0;
  ranks.reduce(&mine, &all, 1, collide::reduction::sum);
  return all;
}

/// Of the numbers of all ranks.
template <class Ranks>
rounding sum(Ranks const& ranks, rounding const& mine) {
  return {static_cast<std::size_t>(sum(ranks, mine.numbers)), static_cast<std::size_t>(sum(ranks, mine.rounded)),
          largest(ranks, mine.most)};
}

/// Brings the values of all ranks, in the order of the ranks, to the first.
template <class T, class Ranks>
void gather_to_first(Ranks const& ranks, std::vector<T>& values) {
  if (ranks.size() == 1) return;
  std::vector<std::uint64_t> to_each, of_each;
  collide::together(ranks, [&] {
    to_each.assign(static_cast<std::size_t>(ranks.size()), 0);
    of_each = to_each;
    to_each[0] = values.size();
  });
  ranks.exchange_counts(to_each.data(), of_each.data());
  std::vector<T> all;
  collide::together(ranks, [&] {
    std::uint64_t n = 0;
    for (auto const each : of_each) n += each;
    all.resize(static_cast<std::size_t>(n));
  });
  ranks.exchange(values.data(), to_each.data(), all.data(), of_each.data(), sizeof(T));
  values = std::move(all);
}

}  // namespace io
