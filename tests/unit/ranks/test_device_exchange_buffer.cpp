/// Mail of a space, from one's memory to another's or by way of the host, as the ranks say at run time.
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

#include <doctest/doctest.h>

#include <collide/ranks/detail/device_exchange_buffer.hpp>
#include <collide/ranks/thread_ranks.hpp>

namespace {

/// A space that the host does not see: it counts what is copied between the two, and fails if it is told to.
struct far_space {
  static constexpr bool host_accessible = false;

  int* copies;
  bool fails = false;

  std::pmr::memory_resource* resource() const { return std::pmr::new_delete_resource(); }
  void synchronize() const {}
  std::shared_ptr<void> mark() const { return nullptr; }
  void after(std::shared_ptr<void> const&) const {}
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

/// Work that a thread does later, in order.
class work_queue {
 public:
  explicit work_queue(int most_copies = 1000000) : most_copies_{most_copies}, worker_([this] { work(); }) {}
  ~work_queue() {
    put([this] { ends_ = true; });
    worker_.join();
  }

  void put(std::function<void()> work) {
    std::lock_guard<std::mutex> const lock(mutex_);
    all_.push_back(std::move(work));
    changed_.notify_one();
  }
  /// Throws after so many.
  void count_copy() {
    if (copies_++ == most_copies_) throw collide::error("on purpose");
  }

 private:
  void work() {
    while (!ends_) {
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait(lock, [&] { return !all_.empty(); });
      auto const next = std::move(all_.front());
      all_.pop_front();
      lock.unlock();
      next();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> all_;
  bool ends_ = false;
  int copies_ = 0, most_copies_;
  std::thread worker_;
};

/// A space whose work is done later, for which nobody may wait.
struct late_space {
  work_queue* queue;
  void synchronize() const { throw collide::error("waits"); }
  std::shared_ptr<void> mark() const {
    auto const passed = std::make_shared<std::atomic<bool>>(false);
    queue->put([passed] { passed->store(true); });
    return passed;
  }
  void after(std::shared_ptr<void> const& mark) const {
    queue->put([passed = std::static_pointer_cast<std::atomic<bool>>(mark)] {
      while (!passed->load()) std::this_thread::yield();
    });
  }
  void copy_from_any_device(void* to, void const* from, std::size_t bytes) const {
    queue->count_copy();
    queue->put([=] { std::memcpy(to, from, bytes); });
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

TEST_CASE("space mail: threads send in the order of their spaces' work, for which they do not wait") {
  constexpr int rounds = 50, size = 3;
  std::vector<int> wrong(size, 0);
  collide::thread_ranks::run(size, [&](collide::thread_ranks const& ranks) {
    int const rank = ranks.rank();
    std::vector<std::uint64_t> to_each(size), of_each(size);
    for (int q = 0; q < size; ++q) {
      to_each[std::size_t(q)] = std::uint64_t(rank == 2 && q == 0 ? 0 : 100 * (rank + 1));
      of_each[std::size_t(q)] = std::uint64_t(q == 2 && rank == 0 ? 0 : 100 * (q + 1));
    }
    std::vector<int> from(900), to(600);
    work_queue queue;
    late_space const space{&queue};
    for (int round = 0; round < rounds; ++round) {
      queue.put([&, round] {
        if ((rank + round) % size == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
        std::fill(from.begin(), from.end(), 10 * round + rank);
      });
      ranks.exchange_in_space(space, from.data(), to_each.data(), to.data(), of_each.data(), sizeof(int));
      queue.put([&, round] {
        int const* at = to.data();
        for (int q = 0; q < size; ++q) {
          for (std::uint64_t i = 0; i < of_each[std::size_t(q)]; ++i)
            wrong[std::size_t(rank)] += *at++ != 10 * round + q;
        }
      });
    }
  });
  CHECK(wrong == std::vector<int>(size, 0));
}

TEST_CASE("space mail: a copy that cannot be begun is thrown on its rank, and what others sent stays") {
  std::vector<int> thrown(3, 0), read(3, 0);
  std::vector<std::vector<int>> to(3, std::vector<int>(6, 0));
  collide::thread_ranks::run(3, [&](collide::thread_ranks const& ranks) {
    auto const r = std::size_t(ranks.rank());
    std::vector<std::uint64_t> const each(3, 2);
    std::vector<int> from(6, 1);
    work_queue queue(r == 0 ? 1 : 100);
    late_space const space{&queue};
    queue.put([r] { std::this_thread::sleep_for(std::chrono::milliseconds(r == 0 ? 20 : 0)); });
    try {
      ranks.exchange_in_space(space, from.data(), each.data(), to[r].data(), each.data(), sizeof(int));
    } catch (collide::error const&) {
      thrown[r] = 1;
    }
    queue.put([&] { std::fill(from.begin(), from.end(), 2); });
    queue.put([&, r] { read[r] = int(std::count(to[r].begin(), to[r].end(), 1)); });
  });
  CHECK(thrown == std::vector<int>{1, 0, 0});
  CHECK(read == std::vector<int>{2, 6, 6});
}
