/// \file
/// Parts of the built-in sinks; the members of a sink are in concepts.hpp.
#pragma once

#include <algorithm>
#include <new>
#include <type_traits>
#include <vector>

#include <collide/core/contact.hpp>
#include <collide/core/memory.hpp>
#include <collide/query/detail/candidate_pipeline.hpp>
#include <collide/sinks/detail/sort_pairs.hpp>
#include <collide/spaces/detail/atomic.hpp>

namespace collide::detail {

/// Remembers the space that an array lives in, whatever its type, to copy the array to the host later.
template <class T>
class host_copier {
 public:
  host_copier() = default;
  template <class Space>
  explicit host_copier(Space const& space) {
    static_assert(std::is_trivially_copyable<Space>::value && sizeof(Space) <= sizeof(space_),
                  "collide: an execution space is a small trivially copyable value");
    new (space_) Space(space);
    copy_ = [](void const* s, T* to, T const* from, std::size_t n) {
      static_cast<Space const*>(s)->copy_to_host(to, from, n);
    };
  }

  std::vector<T> operator()(T const* from, std::size_t n) const {
    std::vector<T> copy(n);
    if (n != 0) copy_(space_, copy.data(), from, n);
    return copy;
  }

 private:
  alignas(16) unsigned char space_[64] = {};
  void (*copy_)(void const*, T*, T const*, std::size_t) = nullptr;
};

/// Base of the sinks that keep an array of `T` in memory of the space. The type of a sink does not say which memory
/// that is, so a loop over a sink, or an index into it, does not compile in any space: the same code works in all of
/// them.
template <class T>
class kept_in_space {
 public:
  template <class U = T>
  U const* begin() const {
    return refuse<U>();
  }
  template <class U = T>
  U const* end() const {
    return refuse<U>();
  }
  template <class U = T>
  U const& operator[](std::size_t) const {
    return *refuse<U>();
  }

 private:
  template <class U>
  static U const* refuse() {
    static_assert(!std::is_same<U, T>::value,
                  "collide: results are in memory of the space, which the host may be unable to read: use to_host()");
    return nullptr;
  }
};

/// Numbers the hits of a pass. `sum` is 0 before and after it, so that nothing need set it to 0 first; `total` is how
/// many there were.
struct hit_counter {
  std::uint64_t* sum;
  std::uint64_t* total;
};

/// The output of a query for its hits, and all that it knows of a built-in sink: so a kernel is compiled once for all
/// of them. What a sink does not want is null, or no room.
struct output {
  static constexpr bool stores_ids = true;

  hit_counter count;       ///< of all hits, also of those that find no room
  pair* pairs;             ///< hits, one after the other
  std::uint64_t capacity;  ///< how many pairs there is room for
  std::uint8_t* flags;     ///< one per sphere, set to 1 where it touches anything

  COLLIDE_HD_INLINE std::uint64_t allocate(std::uint64_t n) const {
    return count.sum != nullptr ? fetch_add(count.sum, n) : 0;
  }
  COLLIDE_HD_INLINE void store(std::uint64_t slot, pair p) const {
    if (slot < capacity) pairs[slot] = p;
    if (flags != nullptr) store_relaxed(flags + p.sphere, std::uint8_t{1});
  }
  /// True if nothing but flags is wanted.
  COLLIDE_HD_INLINE bool wants_one_of_each() const { return flags != nullptr && count.sum == nullptr; }
  /// True if more hits of a sphere would change nothing: its flag is set, and nothing else is wanted.
  COLLIDE_HD_INLINE bool has_enough_of(id sphere) const {
    return wants_one_of_each() && load_relaxed(flags + sphere) != 0;
  }
  COLLIDE_HD_INLINE void end_pass() const {
    if (count.sum == nullptr) return;
    *count.total = fetch_add(count.sum, std::uint64_t{0});
    *count.sum = 0;
  }
};

/// Flags are complete as they are.
inline bool wants_end_pass(output const& o) { return o.count.sum != nullptr; }

class hit_counter_buffer {
 public:
  /// For a pass that is put on the space's stream next.
  template <class Space>
  hit_counter begin(Space& space) {
    bool const is_zero = numbers_.data() != nullptr && zero_in_ == space.resource();
    std::uint64_t* const numbers = numbers_.reserve(space.resource(), 2);
    if (!is_zero) space.fill(numbers, 0, 2 * sizeof *numbers);
    zero_in_ = nullptr;
    return {numbers, numbers + 1};
  }

  /// Takes the memory. What is in it is not known then.
  template <class Space>
  void reserve(Space const& space) {
    numbers_.reserve(space.resource(), 2);
    zero_in_ = nullptr;
  }

  /// How many hits it had. Waits.
  template <class Space>
  std::uint64_t end(Space& space) {
    std::uint64_t const total = space.read(numbers_.data() + 1);
    zero_in_ = space.resource();
    return total;
  }

 private:
  buffer<std::uint64_t> numbers_;
  std::pmr::memory_resource* zero_in_ = nullptr;  ///< in whose memory the sum is 0 for sure
};

/// About how many hits a query has, rather too many; 0 if it cannot tell.
template <class Query>
auto expected_hits(Query const& query, int) -> decltype(query.expected_hits()) {
  return query.expected_hits();
}
template <class Query>
std::uint64_t expected_hits(Query const&, long) {
  return 0;
}

/// Collects all colliding pairs, in an array of its own that grows until they fit or in the caller's of fixed size.
class pair_collector {
 public:
  /// Runs the query into `to[0 .. capacity)`.
  template <class Space, class Query>
  void fill(Space& space, Query const& query, pair* to, std::uint64_t capacity) {
    query(output{total_of_.begin(space), to, capacity, nullptr});
    data_ = to;
    total_ = total_of_.end(space);
    size_ = static_cast<std::size_t>(total_ < capacity ? total_ : capacity);
  }

  /// Runs the query until everything fits: once if the array of the last time is large enough, or if there is none and
  /// the query can tell how large it must be.
  template <class Space, class Query>
  void fill(Space& space, Query const& query) {
    std::size_t const spheres = query.spheres.size();
    std::size_t expected = 0;
    if (own_.capacity() == 0) {
      expected = static_cast<std::size_t>(expected_hits(query, 0));
      // what is never written is not there, on a host
      if (Space::host_accessible && expected < spheres) expected = spheres;
    }
    pair* const to = reserve_own(space, spheres, expected);
    fill(space, query, to, own_.capacity());
    if (total_ > own_.capacity()) {
      std::size_t const reserved = total_ + total_ / 4;  // so that a few more next time fit too
      fill(space, query, own_.reserve(space.resource(), reserved), reserved);
    }
  }

  /// Sorts what was stored into canonical order.
  template <class Space, class Query>
  void sort(Space& space, Query const& query) {
    // room as for the whole array, so that a few pairs more than last time are no reason to allocate
    std::size_t const reserved = data_ == own_.data() ? own_.capacity() : size_;
    sort_pairs(space, data_, size_, reserved, query.spheres.size(), query.mesh.size(), sort_memory_);
  }

  /// Makes room for the pairs of a query in the array of its own.
  template <class Space>
  void reserve(Space const& space, std::size_t spheres, std::size_t pairs) {
    total_of_.reserve(space);
    reserve_own(space, spheres, pairs);
  }
  /// Takes what `fill` into the caller's array needs.
  template <class Space>
  void reserve(Space const& space) {
    total_of_.reserve(space);
  }
  /// Takes what it needs to sort as many as there is room for.
  template <class Space>
  void reserve_sort(Space const& space) {
    reserve_sort_memory(space, own_.capacity(), sort_memory_);
  }

  pair* data() const { return data_; }
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return own_.capacity(); }
  std::uint64_t total() const { return total_; }

 private:
  /// Its own array, with room for `pairs`, and as many as one may expect of so many spheres.
  template <class Space>
  pair* reserve_own(Space const& space, std::size_t spheres, std::size_t pairs) {
    std::size_t const guess = spheres / 32 + 64;
    return own_.reserve(space.resource(), std::max({own_.capacity(), guess, pairs}));
  }

  hit_counter_buffer total_of_;
  buffer<pair> own_;
  sort_memory sort_memory_;
  pair* data_ = nullptr;
  std::size_t size_ = 0;
  std::uint64_t total_ = 0;
};

}  // namespace collide::detail
