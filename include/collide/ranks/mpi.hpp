/// \file
/// Ranks that are processes of MPI. Needs an MPI library: with CMake, the target `collide::mpi`.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <iostream>
#include <memory>
#include <type_traits>
#include <vector>

#include <mpi.h>
#if __has_include(<mpi-ext.h>)
#include <mpi-ext.h>
#endif

#include <collide/ranks/ranks.hpp>

namespace collide {

/// MPI for as long as a program runs: a variable of `main`. Where an exception leaves the scope on one rank, it ends
/// all of them, for the others may wait for it.
class mpi_session {
 public:
  /// Initialises MPI, unless somebody has.
  mpi_session(int& argc, char**& argv) : exceptions_{std::uncaught_exceptions()} {
    int is_initialised = 0, provided = 0;
    MPI_Initialized(&is_initialised);
    is_ours_ = is_initialised == 0;
    if (is_ours_) MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  }
  mpi_session(mpi_session const&) = delete;
  mpi_session& operator=(mpi_session const&) = delete;

  ~mpi_session() {
    if (std::uncaught_exceptions() > exceptions_) {
      int rank = 0;
      MPI_Comm_rank(MPI_COMM_WORLD, &rank);
      std::cerr << "collide: rank " << rank << " failed, and ends all ranks" << std::endl;
      MPI_Abort(MPI_COMM_WORLD, 1);
    }
    if (is_ours_) MPI_Finalize();
  }

 private:
  int exceptions_;
  bool is_ours_;
};

/// Ranks: the processes of an MPI communicator. Messages go in pieces, so there is no limit of 2^31 bytes. An MPI
/// library that fails, or a process that dies, ends all processes, with a line that says which: that is MPI's own
/// default. What is in memory of devices is sent from there if MPI says at run time that it can; if not, by way of
/// pinned memory of the host.
class mpi_ranks {
 public:
  /// Takes a communicator of its own, made from `comm`: all processes of `comm` call it. No message is longer than
  /// `piece` bytes. Throws `error` if MPI is not initialised, or `piece` is below 8, or 2^31 or more.
  explicit mpi_ranks(MPI_Comm comm = MPI_COMM_WORLD, std::size_t piece = std::size_t{1} << 30) : piece_{piece} {
    int is_initialised = 0;
    MPI_Initialized(&is_initialised);
    if (is_initialised == 0) throw error("collide: mpi_ranks: MPI is not initialised: make an mpi_session before");
    if (piece < 8 || piece >= std::size_t{1} << 31) throw error("collide: mpi_ranks: a piece has 8 to 2^31 - 1 bytes");
    comm_ = std::shared_ptr<communicator>(new communicator(comm));
    MPI_Comm_rank(comm_->comm, &rank_);
    MPI_Comm_size(comm_->comm, &size_);
    requests_ = std::make_shared<std::vector<MPI_Request>>();
  }

  /// The number of this rank, from 0: that of the process in the communicator.
  int rank() const { return rank_; }
  /// How many ranks there are.
  int size() const { return size_; }

  void all_gather(void const* mine, std::size_t bytes, void* all) const {
    auto* const to = static_cast<unsigned char*>(all);
    if (bytes <= piece_) {
      int const n = static_cast<int>(bytes);
      MPI_Allgather(mine, n, MPI_BYTE, to, n, MPI_BYTE, comm_->comm);
      return;
    }
    auto const* const from = static_cast<unsigned char const*>(mine);
    begin_transfer(
        [&](int) {
          return message<unsigned char const>{from, bytes};
        },
        [&](int r) {
          return message<unsigned char>{to + static_cast<std::size_t>(r) * bytes, bytes};
        },
        [](void* at, void const* own, std::size_t n) { std::memcpy(at, own, n); });
    end_exchange();
  }

  void reduce(std::uint64_t const* mine, std::uint64_t* all, std::size_t n, reduction how) const {
    MPI_Op const op = how == reduction::sum ? MPI_SUM : MPI_MAX;
    std::size_t const max_count = piece_ / sizeof *mine;
    for (std::size_t i = 0; i < n; i += max_count) {
      MPI_Allreduce(mine + i, all + i, static_cast<int>(std::min(max_count, n - i)), MPI_UINT64_T, op, comm_->comm);
    }
  }

  void exchange_counts(std::uint64_t const* to_each, std::uint64_t* of_each) const {
    MPI_Alltoall(to_each, 1, MPI_UINT64_T, of_each, 1, MPI_UINT64_T, comm_->comm);
  }

  void exchange(void const* from, std::uint64_t const* to_each, void* to, std::uint64_t const* of_each,
                std::size_t bytes) const {
    begin_exchange(from, to_each, to, of_each, bytes);
    end_exchange();
  }

  /// Begins an `exchange`: until `end_exchange`, nothing but `reduce` may be called, and all stays where it is.
  void begin_exchange(void const* from, std::uint64_t const* to_each, void* to, std::uint64_t const* of_each,
                      std::size_t bytes) const {
    begin_by([](void* at, void const* own, std::size_t n) { std::memcpy(at, own, n); }, from, to_each, to, of_each,
             bytes);
  }
  /// Waits until all is there.
  void end_exchange() const {
    MPI_Waitall(static_cast<int>(requests_->size()), requests_->data(), MPI_STATUSES_IGNORE);
    requests_->clear();
  }
  /// Waits for the work of a space. Messages go on meanwhile: MPI moves them only while it is called.
  template <class Space>
  auto wait_for(Space const& space) const -> decltype(space.is_done(), void()) {
    int all = 0;
    while (!requests_->empty() && !space.is_done())
      MPI_Testall(static_cast<int>(requests_->size()), requests_->data(), &all, MPI_STATUSES_IGNORE);
  }

  /// True if MPI takes pointers to memory of CUDA devices: what MPIX_Query_cuda_support() says. False where MPI does
  /// not define MPIX_CUDA_AWARE_SUPPORT, as Open MPI does.
  bool takes_device_memory() const {
#if defined(MPIX_CUDA_AWARE_SUPPORT)
    return MPIX_Query_cuda_support() == 1;
#else
    return false;
#endif
  }

  /// As `exchange`, of memory of devices, which MPI must accept. If the space of a rank fails, that rank throws.
  template <class Space>
  auto exchange_in_space(Space const& space, void const* from, std::uint64_t const* to_each, void* to,
                         std::uint64_t const* of_each, std::size_t bytes) const
      -> decltype(space.copy_from_any_device(to, from, bytes)) {
    detail::first_failure failure;
    failure.attempt([&] { space.synchronize(); });
    begin_by([&](void* at, void const* own,
                 std::size_t n) { failure.attempt([&] { space.copy_from_any_device(at, own, n); }); },
             from, to_each, to, of_each, bytes);
    end_exchange();
    if (to_each[rank_] != 0) failure.attempt([&] { space.synchronize(); });
    failure.rethrow();
  }

 private:
  template <class Byte>
  struct message {
    Byte* at;
    std::size_t bytes;
  };

  struct communicator {
    explicit communicator(MPI_Comm of) { MPI_Comm_dup(of, &comm); }
    ~communicator() {
      int is_finalised = 0;
      MPI_Finalized(&is_finalised);
      if (is_finalised == 0) MPI_Comm_free(&comm);
    }
    communicator(communicator const&) = delete;
    communicator& operator=(communicator const&) = delete;
    MPI_Comm comm = MPI_COMM_NULL;
  };

  /// Begins to send items to each rank and to receive some from each; copy(to, from, bytes) copies those to this rank
  /// itself.
  template <class Copy>
  void begin_by(Copy const& copy, void const* from, std::uint64_t const* to_each, void* to,
                std::uint64_t const* of_each, std::size_t bytes) const {
    auto const* sent = static_cast<unsigned char const*>(from);
    auto* received = static_cast<unsigned char*>(to);
    auto const next = [bytes](auto*& at, std::uint64_t items) {
      message<std::remove_reference_t<decltype(*at)>> const m{at, static_cast<std::size_t>(items) * bytes};
      if (m.bytes != 0) at += m.bytes;
      return m;
    };
    begin_transfer([&](int r) { return next(sent, to_each[r]); }, [&](int r) { return next(received, of_each[r]); },
                   copy);
  }

  /// Begins to send to each rank and to receive from each, in pieces; the two functions give the messages, rank after
  /// rank. A message to this rank itself is copied. Others wait for it already, so without memory for requests the
  /// program ends.
  template <class Outgoing, class Incoming, class Copy>
  void begin_transfer(Outgoing const& outgoing, Incoming const& incoming, Copy const& copy) const noexcept {
    auto& requests = *requests_;
    requests.clear();
    message<unsigned char> self{nullptr, 0};
    for (int r = 0; r < size_; ++r) {
      message<unsigned char> const m = incoming(r);
      if (r == rank_) self = m;
      for (std::size_t i = 0; r != rank_ && i < m.bytes; i += piece_) {
        MPI_Irecv(m.at + i, length(m.bytes - i), MPI_BYTE, r, 0, comm_->comm, &requests.emplace_back());
      }
    }
    for (int r = 0; r < size_; ++r) {
      message<unsigned char const> const m = outgoing(r);
      if (r == rank_ && m.bytes != 0) copy(self.at, m.at, m.bytes);
      for (std::size_t i = 0; r != rank_ && i < m.bytes; i += piece_) {
        MPI_Isend(m.at + i, length(m.bytes - i), MPI_BYTE, r, 0, comm_->comm, &requests.emplace_back());
      }
    }
  }

  int length(std::size_t bytes) const { return static_cast<int>(std::min(bytes, piece_)); }

  std::shared_ptr<communicator> comm_;
  std::shared_ptr<std::vector<MPI_Request>> requests_;
  std::size_t piece_;
  int rank_ = 0, size_ = 1;
};

}  // namespace collide
