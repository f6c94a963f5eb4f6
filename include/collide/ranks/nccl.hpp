/// \file
/// Ranks that are processes with a GPU each, whose messages NCCL moves. Needs CUDA's runtime and NCCL: with CMake, the
/// target `collide::nccl`.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <memory>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include <cuda_runtime.h>
#include <nccl.h>

#include <collide/ranks/ranks.hpp>

namespace collide {

namespace detail {

inline void nccl_cuda_check(cudaError_t status, char const* call) {
  if (status != cudaSuccess)
    throw error(std::string("collide: nccl_ranks: ") + call + ": " + cudaGetErrorString(status));
}
inline void nccl_check(ncclResult_t status, char const* call) {
  if (status != ncclSuccess && status != ncclInProgress)
    throw error(std::string("collide: nccl_ranks: ") + call + ": " + ncclGetErrorString(status));
}

/// A communicator, with memory of the device for what comes from the host, and memory of the host that the device reads
/// for a little of it.
class nccl_communicator {
 public:
  nccl_communicator(ncclUniqueId const& common, int rank, int size, double patience) : patience_{patience} {
    nccl_check(ncclCommInitRank(&comm_, size, common, rank), "ncclCommInitRank");
    nccl_cuda_check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "cudaStreamCreateWithFlags");
    nccl_cuda_check(cudaMallocHost(&little_, 2 * little), "cudaMallocHost");
  }
  nccl_communicator(nccl_communicator const&) = delete;
  nccl_communicator& operator=(nccl_communicator const&) = delete;
  /// Aborts if an exception is in flight: others may wait for messages that will not come.
  ~nccl_communicator() {
    if (comm_ != nullptr && std::uncaught_exceptions() > 0) abort();
    if (comm_ != nullptr) ncclCommDestroy(comm_);
    for (void* const at : {sent_.at, received_.at}) cudaFree(at);
    cudaFreeHost(little_);
    if (stream_ != nullptr) cudaStreamDestroy(stream_);
  }

  static constexpr std::size_t little = 4096;  ///< bytes
  /// Pinned memory of the host for a little that is sent, and for a little that is received.
  unsigned char* little_sent() const { return static_cast<unsigned char*>(little_); }
  unsigned char* little_received() const { return little_sent() + little; }

  ncclComm_t get() const {
    if (comm_ == nullptr) throw rank_error("collide: nccl_ranks: ended before, as a rank did not answer");
    return comm_;
  }
  cudaStream_t stream() const { return stream_; }

  unsigned char* sent(std::size_t bytes) { return reserved(sent_, bytes); }
  unsigned char* received(std::size_t bytes) { return reserved(received_, bytes); }

  /// Waits for a stream. If NCCL says that another rank is gone, or that takes too long, ends the communicator and
  /// throws.
  void wait(cudaStream_t stream) {
    auto const begun = std::chrono::steady_clock::now();
    for (cudaError_t status; (status = cudaStreamQuery(stream)) != cudaSuccess;) {
      if (status != cudaErrorNotReady) nccl_cuda_check(status, "cudaStreamQuery");
      ncclResult_t of_others = ncclSuccess;
      if (comm_ != nullptr) ncclCommGetAsyncError(comm_, &of_others);
      std::chrono::duration<double> const waited = std::chrono::steady_clock::now() - begun;
      bool const failed = of_others != ncclSuccess && of_others != ncclInProgress;
      if (failed || waited.count() > patience_) {
        abort();
        throw rank_error(failed ? std::string("collide: nccl_ranks: ") + ncclGetErrorString(of_others)
                                : "collide: nccl_ranks: a rank has not answered for " +
                                      std::to_string(static_cast<int>(patience_)) + " s");
      }
      if (waited.count() > 0.02) std::this_thread::sleep_for(std::chrono::microseconds(50));  // longer than a step
    }
  }

 private:
  struct memory {
    void* at = nullptr;
    std::size_t bytes = 0;
  };
  static unsigned char* reserved(memory& m, std::size_t bytes) {
    if (bytes > m.bytes) {
      cudaFree(m.at);
      m = {};
      nccl_cuda_check(cudaMalloc(&m.at, 2 * bytes), "cudaMalloc");
      m.bytes = 2 * bytes;
    }
    return static_cast<unsigned char*>(m.at);
  }
  void abort() {
    ncclCommAbort(comm_);
    comm_ = nullptr;
  }

  ncclComm_t comm_ = nullptr;
  cudaStream_t stream_ = nullptr;
  memory sent_, received_;
  void* little_ = nullptr;
  double patience_;
};

}  // namespace detail

/// Ranks: processes, or threads, each with a device of its own; NCCL moves all that they send, from device to device,
/// and what lies on the host by way of the device. What lies in memory of devices is sent in the order of a space's
/// stream, without waiting.
///
/// The device that is current when one is made must be current in every call; two ranks cannot have the same. A rank
/// that waits for another longer than its patience, or hears from NCCL that it is gone, throws `rank_error`; so none
/// hangs. Start processes under an `mpi_session`, and all end with the first.
class nccl_ranks {
 public:
  /// From other ranks, such as `mpi_ranks`, of which all make one: they hand out NCCL's id. `patience`, in seconds, is
  /// for how long a rank waits for others. Throws `error` if NCCL fails, or two ranks have the same GPU.
  template <class Ranks, class = std::enable_if_t<!std::is_same<std::decay_t<Ranks>, nccl_ranks>::value>>
  explicit nccl_ranks(Ranks const& by, double patience = 300)
      : nccl_ranks(handed_out(by), by.rank(), by.size(), patience) {}
  /// Number `rank` of `size`, with an id that one of them has made by `make_id` and given to all.
  nccl_ranks(ncclUniqueId const& common, int rank, int size, double patience = 300) : rank_{rank}, size_{size} {
    if (rank < 0 || rank >= size)
      throw error("collide: nccl_ranks: the number of a rank is from 0 to below their number");
    if (!(patience > 0)) throw error("collide: nccl_ranks: patience is above 0");
    comm_ = std::make_shared<detail::nccl_communicator>(common, rank, size, patience);
  }

  /// An id for ranks. With NCCL_COMM_ID=host:port in the environment, all ranks may call it instead of one.
  static ncclUniqueId make_id() {
    ncclUniqueId made;
    detail::nccl_check(ncclGetUniqueId(&made), "ncclGetUniqueId");
    return made;
  }

  /// The number of this rank, from 0.
  int rank() const { return rank_; }
  /// How many ranks there are.
  int size() const { return size_; }

  void all_gather(void const* mine, std::size_t bytes, void* all) const {
    by_way_of_device(mine, bytes, all, bytes * count(), [&](void* from, void* to) {
      detail::nccl_check(ncclAllGather(from, to, bytes, ncclUint8, comm_->get(), comm_->stream()), "ncclAllGather");
    });
  }

  void reduce(std::uint64_t const* mine, std::uint64_t* all, std::size_t n, reduction how) const {
    by_way_of_device(mine, n * sizeof *mine, all, n * sizeof *all, [&](void* from, void* to) {
      ncclRedOp_t const op = how == reduction::sum ? ncclSum : ncclMax;
      detail::nccl_check(ncclAllReduce(from, to, n, ncclUint64, op, comm_->get(), comm_->stream()), "ncclAllReduce");
    });
  }

  void exchange_counts(std::uint64_t const* to_each, std::uint64_t* of_each) const {
    std::vector<std::uint64_t> const one(count(), 1);
    exchange(to_each, one.data(), of_each, one.data(), sizeof *to_each);
  }

  void exchange(void const* from, std::uint64_t const* to_each, void* to, std::uint64_t const* of_each,
                std::size_t bytes) const {
    by_way_of_device(from, bytes * sum(to_each), to, bytes * sum(of_each), [&](void* sent, void* received) {
      send(comm_->stream(), sent, to_each, received, of_each, bytes);
    });
  }

  /// As `exchange`, of memory of devices, in the order of the space's stream. Does not wait.
  template <class Space>
  auto exchange_in_space(Space const& space, void const* from, std::uint64_t const* to_each, void* to,
                         std::uint64_t const* of_each, std::size_t bytes) const
      -> std::enable_if_t<std::is_convertible<decltype(space.stream()), cudaStream_t>::value> {
    send(space.stream(), from, to_each, to, of_each, bytes);
  }

  /// Waits for the work of a space, as long as all others answer.
  template <class Space>
  auto wait_for(Space const& space) const
      -> std::enable_if_t<std::is_convertible<decltype(space.stream()), cudaStream_t>::value> {
    comm_->wait(space.stream());
  }

 private:
  /// NCCL's id, of the first rank, and the GPU of each.
  struct greeting {
    ncclUniqueId common;
    cudaUUID_t device;
  };

  /// The id of the first rank. Throws on all if one has no device, or two have the same.
  template <class Ranks>
  static ncclUniqueId handed_out(Ranks const& by) {
    greeting mine{};
    std::vector<greeting> all;
    together(by, [&] {
      int device = 0;
      cudaDeviceProp about{};
      detail::nccl_cuda_check(cudaGetDevice(&device), "cudaGetDevice");
      detail::nccl_cuda_check(cudaGetDeviceProperties(&about, device), "cudaGetDeviceProperties");
      mine.device = about.uuid;
      if (by.rank() == 0) mine.common = make_id();
      all.resize(static_cast<std::size_t>(by.size()));
    });
    by.all_gather(&mine, sizeof mine, all.data());
    for (std::size_t r = 0; r < all.size(); ++r) {
      for (std::size_t q = 0; q < r; ++q) {
        if (std::memcmp(&all[q].device, &all[r].device, sizeof mine.device) != 0) continue;
        throw error("collide: nccl_ranks: ranks " + std::to_string(q) + " and " + std::to_string(r) +
                    " have the same GPU: call cudaSetDevice before, or start no more ranks than there are GPUs");
      }
    }
    return all.front().common;
  }

  std::size_t count() const { return static_cast<std::size_t>(size_); }
  std::size_t sum(std::uint64_t const* of) const {
    std::size_t all = 0;
    for (std::size_t r = 0; r < count(); ++r) all += static_cast<std::size_t>(of[r]);
    return all;
  }

  /// Sends items to each rank and receives some from each, all at once.
  void send(cudaStream_t stream, void const* from, std::uint64_t const* to_each, void* to, std::uint64_t const* of_each,
            std::size_t bytes) const {
    auto const* sent = static_cast<unsigned char const*>(from);
    auto* received = static_cast<unsigned char*>(to);
    detail::nccl_check(ncclGroupStart(), "ncclGroupStart");
    for (int r = 0; r < size_; ++r) {
      std::size_t const out = bytes * static_cast<std::size_t>(to_each[r]),
                        in = bytes * static_cast<std::size_t>(of_each[r]);
      if (out != 0) detail::nccl_check(ncclSend(sent, out, ncclUint8, r, comm_->get(), stream), "ncclSend");
      if (in != 0) detail::nccl_check(ncclRecv(received, in, ncclUint8, r, comm_->get(), stream), "ncclRecv");
      if (out != 0) sent += out;
      if (in != 0) received += in;
    }
    detail::nccl_check(ncclGroupEnd(), "ncclGroupEnd");
  }

  /// Calls work(sent, received) with memory of the device, of which the first is `from` and the second becomes `to`.
  /// Waits once for a little, and twice for more, of which no copy may begin that others could hold up.
  template <class Work>
  void by_way_of_device(void const* from, std::size_t out, void* to, std::size_t in, Work const& work) const {
    cudaStream_t const stream = comm_->stream();
    unsigned char *const sent = comm_->sent(out), *const received = comm_->received(in);
    bool const is_little = out <= comm_->little && in <= comm_->little;
    if (is_little && out != 0) from = std::memcpy(comm_->little_sent(), from, out);
    if (out != 0)
      detail::nccl_cuda_check(cudaMemcpyAsync(sent, from, out, cudaMemcpyHostToDevice, stream), "cudaMemcpyAsync");
    work(sent, received);
    if (!is_little) comm_->wait(stream);
    if (in != 0) {
      void* const at = is_little ? comm_->little_received() : to;
      detail::nccl_cuda_check(cudaMemcpyAsync(at, received, in, cudaMemcpyDeviceToHost, stream), "cudaMemcpyAsync");
    }
    comm_->wait(stream);
    if (is_little && in != 0) std::memcpy(to, comm_->little_received(), in);
  }

  std::shared_ptr<detail::nccl_communicator> comm_;
  int rank_, size_;
};

}  // namespace collide
