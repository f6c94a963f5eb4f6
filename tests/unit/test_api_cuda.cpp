/// The interface of the CUDA spaces.
#include "api.hpp"

int cuda_devices() { return collide::cuda_device_count(); }

TEST_CASE("api: sinks on the device") {
  tests::check_sink_interface<collide::all_pairs>(collide::cuda());
  tests::check_sink_interface<collide::bucket>(collide::cuda_shared());
}

TEST_CASE("api: the baseline precision on the device") {
  tests::check_baseline<collide::all_pairs>(collide::cuda_shared());
  tests::check_baseline<collide::bucket>(collide::cuda());
}

TEST_CASE("api: uploads to the device") { tests::check_uploads(collide::cuda_shared()); }

TEST_CASE("api: validate on the device") { tests::check_validate(collide::cuda()); }

TEST_CASE("api: memory of the device") {
  auto const make = [](std::pmr::memory_resource* from) { return collide::cuda_shared(nullptr, from); };
  tests::check_memory<collide::cuda_shared>(make, collide::cuda_memory::get());
}

TEST_CASE("api: work is put on the caller's stream, memory is taken in its order") {
  cudaStream_t stream;
  collide::cuda_check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "cudaStreamCreateWithFlags");
  {
    collide::cuda_async_memory memory(stream);
    tests::check_sink_interface<collide::bucket>(collide::cuda(stream, &memory));
    tests::check_sink_interface<collide::all_pairs>(collide::cuda_shared(stream, &memory));
  }
  CHECK(cudaStreamSynchronize(stream) == cudaSuccess);
  cudaStreamDestroy(stream);
}

TEST_CASE("api: a failed CUDA call says which and where") {
  std::string what;
  try {
    collide::cuda_check(cudaErrorMemoryAllocation, "cudaMalloc", "there.cuh", 42);
  } catch (collide::error const& e) {
    what = e.what();
  }
  for (char const* part : {"cudaMalloc", "cudaErrorMemoryAllocation", "there.cuh:42"})
    CHECK(what.find(part) != std::string::npos);
  CHECK_THROWS_AS(static_cast<void>(collide::cuda_memory::get()->allocate(std::size_t{1} << 60)), collide::cuda_error);
  CHECK(cudaGetLastError() == cudaSuccess);  // the failure is not reported a second time
}
