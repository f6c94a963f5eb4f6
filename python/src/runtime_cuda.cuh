/// \file
/// Where a mesh of Python lives on a GPU: on the caller's current stream, with memory in the order of streams.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

#include <collide/cuda.cuh>

#include "runtime.hpp"

namespace collide_python {

/// Makes a device current for as long as it is there.
class on_device {
 public:
  explicit on_device(int device) {
    if (is_forked())
      throw collide::error(
          "collide: this process was forked from one that may have used CUDA, which does not work in a child: start it "
          "with multiprocessing's 'spawn' or 'forkserver', or use arrays of the host");
    cudaError_t const asked = cudaGetDevice(&before_);
    if (asked != cudaSuccess && collide::cuda_device_count() == 0)
      throw collide::error(
          "collide: the array is on a GPU, but CUDA finds no GPU here, or no driver for CUDA 13 (see nvidia-smi): "
          "arrays "
          "of the host work");
    collide::cuda_check(asked, "cudaGetDevice");
    device_ = device;
    if (before_ != device_) collide::cuda_check(cudaSetDevice(device_), "cudaSetDevice");
  }
  ~on_device() {
    if (before_ != device_) cudaSetDevice(before_);
  }
  on_device(on_device const&) = delete;
  on_device& operator=(on_device const&) = delete;

 private:
  int before_ = 0, device_ = 0;
};

/// Work that is put on `second` from now on begins after what is on `first` now. Nothing waits.
inline void order(cudaStream_t first, cudaStream_t second) {
  cudaEvent_t event;
  collide::cuda_check(cudaEventCreateWithFlags(&event, cudaEventDisableTiming), "cudaEventCreateWithFlags");
  cudaError_t const recorded = cudaEventRecord(event, first);
  cudaError_t const waits = recorded == cudaSuccess ? cudaStreamWaitEvent(second, event, 0) : recorded;
  cudaEventDestroy(event);  // when it has been recorded
  collide::cuda_check(waits, "cudaStreamWaitEvent");
}

/// What there is once for each device, made by `make(device)` when it is first asked for.
template <class Make>
auto one_each(int device, Make const& make) {
  static std::mutex mutex;
  static std::map<int, decltype(make(device))> made;
  std::lock_guard<std::mutex> const one_at_a_time(mutex);
  auto const found = made.find(device);
  return found != made.end() ? found->second : made[device] = make(device);
}

/// A stream of our own for each device, for libraries that have none that we could work on.
inline cudaStream_t own_stream(int device) {
  return one_each(device, [](int of) {
    on_device const here(of);
    cudaStream_t stream = nullptr;
    collide::cuda_check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "cudaStreamCreateWithFlags");
    return stream;
  });
}

/// Device memory in the order of streams, from a pool that keeps what is returned. It may be returned when another
/// stream is current: then the stream that it was taken on waits for that one first.
class pool_memory final : public std::pmr::memory_resource {
 public:
  explicit pool_memory(int device) : device_{device}, pool_{one_each(device, new_pool)} {}

  void use(cudaStream_t stream) {
    std::lock_guard<std::mutex> const one_at_a_time(mutex_);
    stream_ = stream;
  }

 private:
  static cudaMemPool_t new_pool(int device) {
    cudaMemPoolProps properties{};
    properties.allocType = cudaMemAllocationTypePinned;
    properties.location.type = cudaMemLocationTypeDevice;
    properties.location.id = device;
    cudaMemPool_t pool = nullptr;
    collide::cuda_check(cudaMemPoolCreate(&pool, &properties), "cudaMemPoolCreate");
    std::uint64_t keep = std::uint64_t{1} << 30;  // what is idle beyond a gigabyte goes back to the device
    collide::cuda_check(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &keep),
                        "cudaMemPoolSetAttribute");
    return pool;
  }

  void* do_allocate(std::size_t n, std::size_t) override {
    void* p = nullptr;
    cudaError_t const code = cudaMallocFromPoolAsync(&p, n, pool_, stream_);
    if (code == cudaErrorMemoryAllocation) {
      cudaGetLastError();
      throw std::bad_alloc();
    }
    collide::cuda_check(code, "cudaMallocFromPoolAsync");
    std::lock_guard<std::mutex> const one_at_a_time(mutex_);
    taken_on_[p] = stream_;
    return p;
  }

  void do_deallocate(void* p, std::size_t, std::size_t) override {
    if (is_forked()) return;
    std::lock_guard<std::mutex> const one_at_a_time(mutex_);
    auto const found = taken_on_.find(p);
    cudaStream_t const stream = found != taken_on_.end() ? found->second : stream_;
    if (found != taken_on_.end()) taken_on_.erase(found);
    try {
      on_device const here(device_);
      if (stream != stream_) order(stream_, stream);
      if (cudaFreeAsync(p, stream) == cudaSuccess) return;
      cudaGetLastError();  // the stream is gone
      cudaFree(p);
    } catch (collide::error const&) {  // the stream, or the driver, is gone
      cudaGetLastError();
    }
  }

  bool do_is_equal(std::pmr::memory_resource const& other) const noexcept override { return this == &other; }

  int device_;
  cudaMemPool_t pool_;
  cudaStream_t stream_ = nullptr;
  std::mutex mutex_;
  std::unordered_map<void*, cudaStream_t> taken_on_;
};

template <>
class runtime<collide::cuda_shared> {
 public:
  static constexpr bool is_cuda = true;

  runtime(int /*threads*/, int device)
      : at_{nb::device::cuda::value, device, -1}, memory_{(on_device(device), std::make_shared<pool_memory>(device))} {
    on_device const here(device);
    space_ = std::make_unique<collide::cuda_shared>(nullptr, memory_.get());
  }

  place at() const { return at_; }
  collide::cuda_shared const& space() const { return *space_; }
  whereabouts where() const { return {0, space_->stream(), memory_.get()}; }
  std::shared_ptr<void> memory() const { return memory_; }

  /// Later work begins after what is on the stream of another one by now.
  void follow(runtime const& other) {
    if (other.space_->stream() != space_->stream()) order(other.space_->stream(), space_->stream());
  }
  /// Waits for the work on the stream.
  void settle() {
    if (!is_forked()) cudaStreamSynchronize(space_->stream());
  }

  /// Keeps an array of the caller until the work of the call is done, where its library does not order that by the
  /// stream that we work on.
  array const& keep(array const& a) {
    if (at_.given != -1) lent_.push_back(a);
    return a;
  }

  struct scope : on_device {
    scope(runtime& r, stream_of_call const& s) : on_device(r.at_.device), of(r) { r.use_stream(s); }
    ~scope() { of.end_call(); }
    runtime& of;
  };

 private:
  /// Work of later calls goes to `stream`, after what earlier calls have put on another one. `given` is what DLPack's
  /// exporters are told.
  void use_stream(stream_of_call const& s) {
    auto* const next = reinterpret_cast<cudaStream_t>(s.first);
    at_.given = s.second;
    if (next == space_->stream()) return;
    cudaStreamCaptureStatus capturing = cudaStreamCaptureStatusNone;
    collide::cuda_check(cudaStreamIsCapturing(next, &capturing), "cudaStreamIsCapturing");
    if (capturing == cudaStreamCaptureStatusNone) order(space_->stream(), next);  // a graph knows no other streams
    memory_->use(next);
    space_ = std::make_unique<collide::cuda_shared>(next, memory_.get());
  }

  /// Arrays that were lent for this call go back when the work is done, which the calls after it look for.
  void end_call() {
    while (!kept_.empty() && cudaEventQuery(kept_.front().first) != cudaErrorNotReady) {
      cudaEventDestroy(kept_.front().first);
      kept_.pop_front();
    }
    if (lent_.empty()) return;
    cudaEvent_t done = nullptr;
    if (cudaEventCreateWithFlags(&done, cudaEventDisableTiming) != cudaSuccess) return;
    cudaEventRecord(done, space_->stream());
    kept_.emplace_back(done, std::move(lent_));
    lent_.clear();
  }

  place at_;
  std::vector<array> lent_;
  std::deque<std::pair<cudaEvent_t, std::vector<array>>> kept_;
  std::shared_ptr<pool_memory> memory_;
  std::unique_ptr<collide::cuda_shared> space_;
};

}  // namespace collide_python
