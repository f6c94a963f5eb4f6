/// \file
/// Sink: the triangles of each sphere, in compressed sparse rows.
#pragma once

#include <vector>

#include <collide/core/error.hpp>
#include <collide/core/memory.hpp>
#include <collide/sinks/detail/output.hpp>
#include <collide/spaces/detail/algorithms.hpp>
#if defined(__CUDACC__)
#include <cub/device/device_scan.cuh>

#include <collide/spaces/cuda_memory.cuh>
#endif

namespace collide {

namespace detail {

/// Temporary memory, in bytes, of `exclusive_sum` of n values on the stream of a device; 0 on the host.
template <class Space>
std::size_t exclusive_sum_bytes([[maybe_unused]] Space const& space, [[maybe_unused]] std::size_t n) {
  std::size_t bytes = 0;
#if defined(__CUDACC__)
  if constexpr (!Space::host_accessible) {
    std::uint64_t* const none = nullptr;
    cuda_check(cub::DeviceScan::ExclusiveSum(nullptr, bytes, none, none, n, space.stream()),
               "cub::DeviceScan::ExclusiveSum");
  }
#endif
  return bytes;
}

/// Makes of each of n values the sum of those before it. A space whose memory the host cannot access has a member
/// `stream()`, and needs nvcc: throws `error` without.
template <class Space>
void exclusive_sum(Space const& space, std::uint64_t* values, std::size_t n,
                   [[maybe_unused]] buffer<unsigned char>& temporary) {
  if constexpr (Space::host_accessible) {
    exclusive_scan(space, values, n);
  } else {
#if defined(__CUDACC__)
    std::size_t bytes = exclusive_sum_bytes(space, n);
    void* const memory = temporary.reserve(space.resource(), bytes);
    cuda_check(cub::DeviceScan::ExclusiveSum(memory, bytes, values, values, n, space.stream()),
               "cub::DeviceScan::ExclusiveSum");
#else
    throw error("collide: csr: offsets in memory of a device are summed where nvcc compiles the program");
#endif
  }
}

/// Kernel functor of `for_each` over pairs: how many each sphere has.
struct count_rows {
  pair const* pairs;
  std::uint64_t* counts;
  std::uint32_t* ranks;  ///< of each pair among those of its sphere; null if nobody asks
  COLLIDE_HD void operator()(std::size_t i) const {
    std::uint64_t const rank = fetch_add(counts + pairs[i].sphere, std::uint64_t{1});
    if (ranks != nullptr) ranks[i] = static_cast<std::uint32_t>(rank);
  }
};

/// Kernel functor of `for_each` over pairs: brings triangles to the rows of their spheres.
struct scatter_triangles {
  pair const* pairs;
  std::uint64_t const* offsets;
  std::uint32_t const* ranks;  ///< null if the pairs lie in the order of the rows
  id* triangles;
  std::uint64_t capacity;
  COLLIDE_HD void operator()(std::size_t i) const {
    pair const p = pairs[i];
    std::uint64_t const slot = ranks != nullptr ? offsets[p.sphere] + ranks[i] : std::uint64_t{i};
    if (slot < capacity) triangles[slot] = p.triangle;
  }
};

}  // namespace detail

/// The arrays of `csr`, on the host.
struct csr_arrays {
  std::vector<std::uint64_t> offsets;  ///< one more than there are spheres
  std::vector<id> triangles;           ///< row after row
};

/// All colliding pairs in compressed sparse rows (CSR), a row for each sphere: the triangles of sphere i are
/// `triangles()[offsets()[i]]` up to, and without, `triangles()[offsets()[i + 1]]`. In canonical order the triangles of
/// a row ascend; else their order is unspecified, which saves a sort. Offsets have 64 bits. `query` waits as for
/// `pairs`. Beyond what `pairs` takes it is O(spheres + pairs), with 8 bytes a sphere and 8 a pair.
class csr : public detail::kept_in_space<id> {
 public:
  static constexpr bool keeps_ids_alone = true;

  /// The arrays are kept in memory of the space.
  explicit csr(order o = order::unspecified) : order_{o} {}
  /// The arrays are written to the caller's memory (of the space): one more offset than there are spheres, and
  /// triangles as long as `capacity` lasts. The offsets are those of all pairs also where the triangles do not fit:
  /// then the first `capacity` are stored, and a row ends where they end.
  csr(std::uint64_t* offsets, id* triangles, std::size_t capacity, order o = order::unspecified)
      : external_offsets_{offsets}, external_triangles_{triangles}, capacity_{capacity}, order_{o}, fixed_{true} {}

  /// How many pairs collide: the last offset.
  std::uint64_t total() const { return collected_.total(); }
  /// How many triangles are stored.
  std::size_t size() const { return size_; }
  /// True if all of them are stored.
  bool complete() const { return size() == total(); }
  /// Number of spheres of the last query.
  std::size_t rows() const { return rows_; }

  /// The begin of each sphere's row, and behind the last row the number of pairs: `rows() + 1` numbers, in memory
  /// of the space. Null before the first query.
  std::uint64_t const* offsets() const { return offsets_; }
  /// The stored triangles, row after row, `size()` of them, in memory of the space. Valid until the next query.
  id const* triangles() const { return triangles_; }
  /// A copy of both arrays on the host. Waits.
  csr_arrays to_host() const {
    return {download_offsets_(offsets_, offsets_ == nullptr ? 0 : rows_ + 1), download_(triangles_, size_)};
  }

  /// Makes room in memory of `space` for queries of up to so many spheres and pairs: they then allocate nothing.
  template <class Space>
  void reserve(Space const& space, std::size_t spheres, std::size_t pairs) {
    collected_.reserve(space, spheres, pairs);
    if (order_ == order::canonical) {
      collected_.reserve_sort(space);
    } else {
      ranks_.reserve(space.resource(), collected_.capacity());
    }
    sum_memory_.reserve(space.resource(), detail::exclusive_sum_bytes(space, spheres + 1));
    if (fixed_) return;
    own_offsets_.reserve(space.resource(), spheres + 1);
    own_triangles_.reserve(space.resource(), collected_.capacity());
  }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    download_offsets_ = detail::host_copier<std::uint64_t>(space);
    download_ = detail::host_copier<id>(space);
    rows_ = query.spheres.size();
    collected_.fill(space, query);
    // room as for all pairs, so that a few more than last time are no reason to allocate
    std::size_t const hits = collected_.size(), reserved = collected_.capacity();
    bool const is_sorted = order_ == order::canonical;
    if (is_sorted) collected_.sort(space, query);
    std::uint64_t* const offsets = fixed_ ? external_offsets_ : own_offsets_.reserve(space.resource(), rows_ + 1);
    id* const triangles = fixed_ ? external_triangles_ : own_triangles_.reserve(space.resource(), reserved);
    std::uint32_t* const ranks = is_sorted ? nullptr : ranks_.reserve(space.resource(), reserved);
    space.fill(offsets, 0, (rows_ + 1) * sizeof *offsets);
    space.for_each(hits, detail::count_rows{collected_.data(), offsets, ranks});
    detail::exclusive_sum(space, offsets, rows_ + 1, sum_memory_);
    std::size_t const capacity = fixed_ ? capacity_ : reserved;
    space.for_each(hits, detail::scatter_triangles{collected_.data(), offsets, ranks, triangles, capacity});
    size_ = hits < capacity ? hits : capacity;
    offsets_ = offsets;
    triangles_ = triangles;
  }

 private:
  std::uint64_t* external_offsets_ = nullptr;
  id* external_triangles_ = nullptr;
  std::uint64_t const* offsets_ = nullptr;
  id const* triangles_ = nullptr;
  std::size_t capacity_ = 0, size_ = 0, rows_ = 0;
  order order_;
  bool fixed_ = false;
  detail::pair_collector collected_;
  buffer<std::uint64_t> own_offsets_;
  buffer<id> own_triangles_;
  buffer<std::uint32_t> ranks_;
  buffer<unsigned char> sum_memory_;
  detail::host_copier<std::uint64_t> download_offsets_;
  detail::host_copier<id> download_;
};

}  // namespace collide
