/// The interface of the CUDA spaces.
#include "api.hpp"

int cuda_devices() { return collide::cuda_device_count(); }

namespace {

/// Takes its time, and then sets the heights of a triangle and of spheres.
__global__ void set_heights_late(float* vertices, float* centres, std::size_t n, float triangle, float spheres) {
  for (int k = 0; k < 20; ++k) __nanosleep(1000);
  std::size_t const i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i < 3) vertices[3 * i + 2] = triangle;
  if (i < n) centres[3 * i + 2] = spheres;
}

/// Counts in memory of the device, and waits for nothing.
struct count_there {
  collide::detail::hit_counter numbers;

  template <class Space, class Query>
  void run(Space&, Query const& query) {
    query(collide::detail::output{numbers, nullptr, 0, nullptr});
  }
};

/// Between kernels of the caller that write what it reads: those come first that were put on the stream first.
template <class BroadPhase, class Space>
void check_turns(cudaStream_t stream) {
  constexpr std::size_t n = 100000;
  constexpr int rounds = 12;
  Space space(stream);
  std::vector<float> corners{-10, -10, 0, 10, -10, 0, 0, 10, 0}, centres;
  for (std::size_t i = 0; i < n; ++i) {
    float const x = static_cast<float>(i % 100) / 100, y = static_cast<float>(i / 100 % 100) / 100;
    centres.insert(centres.end(), {x, y, 5});
  }
  auto const copy_of = [&](collide::buffer<float>& to, std::vector<float> const& from) {
    float* const there = to.reserve(space.resource(), from.size());
    space.copy_from_host(there, from.data(), from.size());
    return there;
  };
  collide::buffer<float> vertex_memory, centre_memory;
  collide::buffer<std::uint64_t> totals;
  float* const vertices = copy_of(vertex_memory, corners);
  float* const places = copy_of(centre_memory, centres);
  std::uint64_t* const counts = totals.reserve(space.resource(), rounds + 1);
  space.fill(counts + rounds, 0, sizeof *counts);
  auto const mesh = collide::triangle_soup(static_cast<float const*>(vertices), 1);
  auto const spheres = collide::spheres_xyz(static_cast<float const*>(places), n, 0.5f);
  collide::detector<BroadPhase, collide::karabassi<>, Space> detector(space);
  auto const set = [&](float triangle, float height) {
    set_heights_late<<<(n + 255) / 256, 256, 0, stream>>>(vertices, places, n, triangle, height);
    collide::cuda_check(cudaGetLastError(), "set_heights_late");
  };
  for (int round = 0; round < rounds; ++round) {
    float const height = static_cast<float>(round);
    set(height, round % 3 == 0 ? height + 50 : height);
    detector.build(mesh, 0.5f);
    count_there sink{{counts + rounds, counts + round}};
    detector.query(spheres, sink);
    set(-100, 100);
  }
  std::vector<std::uint64_t> found(rounds);
  space.copy_to_host(found.data(), counts, rounds);
  for (int round = 0; round < rounds; ++round) {
    CAPTURE(round);
    CHECK(found[static_cast<std::size_t>(round)] == (round % 3 == 0 ? 0 : n));
  }
}

/// Kernel functor of `for_each`: counts the calls of each item.
struct count_calls {
  unsigned char* calls;
  __device__ void operator()(std::size_t i) const { ++calls[i]; }
};

/// Where the radii of spheres are.
float const* radii_of(collide::sphere_view<float> spheres) {
  float const* last = nullptr;
  spheres.for_each_array([&](float const* from, std::size_t) { last = from; });
  return last;
}

/// Calls f, which must throw an `error` that says which memory it cannot read.
template <class F>
void check_refused(std::string const& memory, F const& f) {
  std::string what;
  try {
    f();
  } catch (collide::error const& e) {
    what = e.what();
  }
  CAPTURE(what);
  CHECK(what.find("in " + memory + ", which the space") != std::string::npos);
}

}  // namespace

TEST_CASE("api: sinks on the device") {
  tests::check_sink_interface<collide::all_pairs>(collide::cuda());
  tests::check_sink_interface<collide::bucket>(collide::cuda_shared());
}

TEST_CASE("api: the baseline precision on the device") {
  tests::check_baseline<collide::all_pairs>(collide::cuda_shared());
  tests::check_baseline<collide::bucket>(collide::cuda());
}

TEST_CASE("api: each item has one call, in small blocks and in large ones") {
  collide::cuda const space;
  int processors = 0;
  collide::cuda_check(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, 0), "cudaDeviceGetAttribute");
  std::size_t const full = std::size_t{2048} * static_cast<std::size_t>(processors);
  collide::buffer<unsigned char> memory;
  for (std::size_t const n : {std::size_t{1}, std::size_t{65}, full, full + 1, 4 * full + 255}) {
    unsigned char* const calls = memory.reserve(space.resource(), n + 256);
    space.fill(calls, 0, n + 256);
    space.for_each(n, count_calls{calls});
    std::vector<unsigned char> found(n + 256), expected(n + 256);
    std::fill_n(expected.begin(), n, static_cast<unsigned char>(1));
    space.copy_to_host(found.data(), calls, found.size());
    CHECK(found == expected);
  }
}

TEST_CASE("api: uploads to the device") { tests::check_uploads(collide::cuda_shared()); }

TEST_CASE("api: validate on the device") { tests::check_validate(collide::cuda()); }

TEST_CASE("api: memory that a space cannot read is refused where the host would crash, or a kernel fail") {
  tests::small_scene const scene;
  collide::cuda const device;
  auto const mesh = collide::upload(device, scene.mesh());
  auto const spheres = collide::upload(device, scene.spheres());
  float const* const radii_there = radii_of(spheres.view());
  collide::mesh_view<float> const mixed_mesh(scene.mesh().vertices(), mesh.view().indices(), 2);
  auto const mixed_spheres = collide::spheres_xyz(scene.xyz.data(), 4, radii_there);
  check_refused("device memory", [&] { collide::validate(mesh.view()); });
  check_refused("device memory", [&] { collide::validate(mixed_mesh); });
  check_refused("device memory", [&] { collide::validate(spheres.view()); });
  check_refused("device memory", [&] { collide::validate(mixed_spheres, collide::host(1)); });
  check_refused("device memory", [&] { collide::upload(device, mesh.view()); });
  check_refused("device memory", [&] { collide::upload(device, mixed_spheres); });

  int reads_all = 0;
  collide::cuda_check(cudaDeviceGetAttribute(&reads_all, cudaDevAttrPageableMemoryAccess, 0), "cudaDeviceGetAttribute");
  if (reads_all == 0) {
    check_refused("host memory", [&] { collide::validate(scene.mesh(), device); });
    check_refused("host memory", [&] { collide::validate(mixed_mesh, device); });
    check_refused("host memory", [&] { collide::validate(scene.spheres(), collide::cuda_shared()); });
  }

  float* managed = nullptr;  // what both can read is refused by neither
  collide::cuda_check(cudaMallocManaged(&managed, 12 * sizeof(float)), "cudaMallocManaged");
  std::copy(scene.xyz.begin(), scene.xyz.end(), managed);
  std::pmr::vector<float> const pinned(scene.xyz.begin(), scene.xyz.end(), collide::cuda_pinned_memory::get());
  for (float const* xyz : {static_cast<float const*>(managed), pinned.data()}) {
    CHECK(collide::validate(collide::spheres_xyz(xyz, 4, 1)).ok());
    CHECK(collide::validate(collide::spheres_xyz(xyz, 4, 1), device).ok());
  }
  collide::cuda_check(cudaFree(managed), "cudaFree");
  CHECK(collide::validate(collide::mesh_view<float>()).ok());
  CHECK(collide::validate(collide::sphere_view<float>(), device).ok());
  CHECK(collide::validate(mesh.view(), device).ok());  // the device is as it was
}

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

TEST_CASE("api: kernels of the caller, before and after, have their turn") {
  cudaStream_t stream;
  collide::cuda_check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "cudaStreamCreateWithFlags");
  check_turns<collide::bucket, collide::cuda_shared>(stream);
  check_turns<collide::bucket, collide::cuda>(stream);
  check_turns<collide::all_pairs, collide::cuda_shared>(stream);
  CHECK(cudaStreamSynchronize(stream) == cudaSuccess);
  cudaStreamDestroy(stream);
}

TEST_CASE("api: more spheres near the mesh than the device has room for at a time") {
  constexpr std::size_t n = 3000001;
  tests::check_crowd<collide::karabassi<>, collide::cuda_shared>(n, 1);
  tests::check_crowd<collide::karabassi<collide::single_precision>, collide::cuda_shared>(n, 1);
  tests::check_crowd<collide::karabassi<>, collide::cuda>(n, 1);
  tests::check_crowd<collide::karabassi_swept<>, collide::cuda_shared>(n, 1);
}

TEST_CASE("api: more spheres, few of them near the mesh, than the device places at a time") {
  constexpr std::size_t n = 16000001;
  tests::check_crowd<collide::karabassi<>, collide::cuda_shared>(n, 61);
  tests::check_crowd<collide::karabassi_swept<>, collide::cuda_shared>(n, 61);
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
