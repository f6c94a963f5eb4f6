/// Spheres in chunks, on the GPU.
#include "streaming/streamed.hpp"

TEST_CASE("streamed: chunks find what a query of all spheres finds, on the device") {
  tests::check_streamed<collide::bucket, float>(collide::cuda_shared(), collide::cuda_pinned_memory::get());
  tests::check_streamed<collide::bucket, float>(collide::cuda_shared(), std::pmr::new_delete_resource());
  tests::check_streamed<collide::all_pairs, double>(collide::cuda(), collide::cuda_pinned_memory::get());
}

TEST_CASE("streamed: on a stream of one's own, with memory in its order") {
  cudaStream_t stream;
  collide::cuda_check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "cudaStreamCreateWithFlags");
  {
    collide::cuda_async_memory memory(stream);
    collide::cuda_shared const space(stream, &memory);
    tests::check_streamed<collide::bucket, float>(space, collide::cuda_pinned_memory::get());
    tests::check_streamed_edges(space, collide::cuda_pinned_memory::get());
  }
  CHECK(cudaStreamSynchronize(stream) == cudaSuccess);
  cudaStreamDestroy(stream);
}

TEST_CASE("streamed: spheres that move, on the device") {
  tests::check_streamed_swept<collide::bucket, float>(collide::cuda_shared(), collide::cuda_pinned_memory::get());
}

TEST_CASE("streamed: no spheres, no chunk, exceptions on the way, on the device") {
  tests::check_streamed_edges(collide::cuda_shared(), collide::cuda_pinned_memory::get());
  tests::check_streamed_edges(collide::cuda_shared(), std::pmr::new_delete_resource());
}

TEST_CASE("streamed: memory for three chunks, and for no more spheres than there are") {
  tests::counting_resource counting(collide::cuda_memory::get());
  tests::check_streamed_memory(collide::cuda_shared(nullptr, &counting), counting);
}

TEST_CASE("streamed: pinned memory is memory of the host that the device knows") {
  auto* const memory = collide::cuda_pinned_memory::get();
  auto* const p = static_cast<int*>(memory->allocate(100 * sizeof(int)));
  for (int i = 0; i < 100; ++i) p[i] = i;
  cudaPointerAttributes about;
  collide::cuda_check(cudaPointerGetAttributes(&about, p), "cudaPointerGetAttributes");
  CHECK(about.type == cudaMemoryTypeHost);
  memory->deallocate(p, 100 * sizeof(int));
  CHECK_THROWS_AS(static_cast<void>(memory->allocate(std::size_t{1} << 60)), collide::cuda_error);
  CHECK(cudaGetLastError() == cudaSuccess);
}
