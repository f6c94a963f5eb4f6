/// Mail of a space, from one's memory to another's or by way of the host, as the ranks say at run time.
#include <doctest/doctest.h>

#include <collide/detail/ranks/device_exchange_buffer.hpp>
#include <collide/ranks/thread_ranks.hpp>

namespace {

/// A space that the host does not see: it counts what is copied between the two, and fails if it is told to.
struct far_space {
  static constexpr bool host_accessible = false;

  int* copies;
  bool fails = false;

  std::pmr::memory_resource* resource() const { return std::pmr::new_delete_resource(); }
  void synchronize() const {}
  void copy_from_any_device(void* to, void const* from, std::size_t bytes) const {
    if (fails) throw collide::error("on purpose");
    std::memcpy(to, from, bytes);
  }
  template <class T>
  void copy_to_host(T* to, T const* from, std::size_t n) const {
    if (fails) throw collide::error("on purpose");
    ++*copies;
    std::copy_n(from, n, to);
  }
  template <class T>
  void copy_from_host(T* to, T const* from, std::size_t n) const {
    copy_to_host(to, from, n);
  }
};

/// A space whose copies go on until it waits, and fail after so many.
struct slow_space {
  int* under_way;
  int left;
  void synchronize() const { *under_way = 0; }
  void copy_from_any_device(void* to, void const* from, std::size_t bytes) const {
    if (*under_way == left) throw collide::error("on purpose");
    std::memcpy(to, from, bytes);
    ++*under_way;
  }
};

/// Ranks that find out at run time whether they send from memory of devices.
struct asking_ranks : collide::thread_ranks {
  bool can;
  asking_ranks(collide::thread_ranks const& ranks, bool direct) : collide::thread_ranks(ranks), can{direct} {}
  bool takes_device_memory() const { return can; }
};

/// Rank r sends r + 2 q numbers to rank q, which tell from whom they come.
template <class Ranks>
bool delivers(Ranks const& ranks, far_space const& space) {
  collide::detail::device_exchange_buffer<int> out, in;
  out.clear(ranks.size());
  for (int q = 0; q < ranks.size(); ++q) out.counts[std::size_t(q)] = std::uint64_t(ranks.rank() + 2 * q);
  int* const to = out.resize(space);
  for (std::size_t i = 0; i < out.size(); ++i) to[i] = 100 * ranks.rank() + int(i);
  collide::detail::deliver(ranks, space, out, in);
  std::size_t at = 0;
  bool right = true;
  for (int r = 0; r < ranks.size(); ++r) {
    int const n = r + 2 * ranks.rank();
    int first = 0;  // of what rank r has laid out for this one
    for (int q = 0; q < ranks.rank(); ++q) first += r + 2 * q;
    right = right && in.counts[std::size_t(r)] == std::uint64_t(n);
    for (int i = 0; right && i < n; ++i, ++at) right = in.data()[at] == 100 * r + first + i;
  }
  return right && at == in.size();
}

}  // namespace

TEST_CASE("space mail: goes from device to device if the ranks say so at run time, else by way of the host") {
  for (int const size : {1, 3}) {
    for (bool const direct : {false, true}) {
      std::vector<int> right(std::size_t(size), 0), copies(std::size_t(size), 0);
      collide::thread_ranks::run(size, [&](collide::thread_ranks const& ranks) {
        auto const r = std::size_t(ranks.rank());
        right[r] = delivers(asking_ranks(ranks, direct), {&copies[r]}) ? 1 : 0;
      });
      for (std::size_t r = 0; r < right.size(); ++r) {
        CHECK(right[r] == 1);
        CHECK((copies[r] == 0) == direct);
      }
    }
  }
}

TEST_CASE("space mail: a copy that fails on one rank makes all throw, on either way") {
  for (bool const direct : {false, true}) {
    std::vector<int> thrown(3, 0);
    collide::thread_ranks::run(3, [&](collide::thread_ranks const& ranks) {
      auto const r = std::size_t(ranks.rank());
      int copies = 0;
      far_space const space{&copies, ranks.rank() == 1};
      try {
        delivers(asking_ranks(ranks, direct), space);
      } catch (collide::rank_error const&) {
        thrown[r] = 2;
      } catch (collide::error const&) {
        thrown[r] = 1;
      }
    });
    CHECK(thrown == std::vector<int>{2, 1, 2});
  }
}

TEST_CASE("space mail: copies that are under way are waited for, also where a later one fails") {
  std::vector<int> under_way(3, 0), thrown(3, 0);
  collide::thread_ranks::run(3, [&](collide::thread_ranks const& ranks) {
    auto const r = std::size_t(ranks.rank());
    slow_space const space{&under_way[r], r == 0 ? 1 : 100};
    std::vector<std::uint64_t> const each(3, 2);
    std::vector<int> const from(6, 1);
    std::vector<int> to(6);
    try {
      ranks.exchange_in_space(space, from.data(), each.data(), to.data(), each.data(), sizeof(int));
    } catch (collide::error const&) {
      thrown[r] = 1;
    }
  });
  CHECK(thrown == std::vector<int>{1, 0, 0});
  CHECK(under_way == std::vector<int>(3, 0));
}
