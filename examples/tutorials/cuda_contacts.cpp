/// \file
/// Tutorial 1: a CUDA simulation with its own particles, kernels and stream asks collide for contacts in every step.
/// Needs CUDA.

#include <cmath>
#include <cstdio>
#include <vector>

#include <collide/bucket.cuh>
#include <collide/spaces/atomic_add.hpp>

namespace {

constexpr float dt = 1e-3f, largest_radius = 0.1f;

/// One step of the simulation as it was before: weight, positions. x, y, z and radius of a particle are a float4.
__global__ void advance(float4* particles, float3* velocities, unsigned n) {
  unsigned const i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= n) return;
  velocities[i].z -= 9.81f * dt;
  particles[i].x += velocities[i].x * dt;
  particles[i].y += velocities[i].y * dt;
  particles[i].z += velocities[i].z * dt;
}

/// Called for every contact, from many threads at once: a spring and a dashpot, per unit of mass.
struct push_back {
  float3* velocities;

  template <class Hit>
  __device__ void operator()(Hit const& hit) const {
    auto const c = hit.contact();
    float3& v = velocities[hit.sphere];
    float const along = v.x * c.normal.x() + v.y * c.normal.y() + v.z * c.normal.z();
    float const push = fmaxf(4e4f * c.depth - 100 * along, 0.0f) * dt;
    collide::atomic_add(&v.x, push * c.normal.x());
    collide::atomic_add(&v.y, push * c.normal.y());
    collide::atomic_add(&v.z, push * c.normal.z());
  }
};

/// A kernel that reads contacts: the deepest, in units of 1e-9.
__global__ void find_deepest(collide::contact<float> const* contacts, std::uint64_t n, unsigned* deepest) {
  std::uint64_t const i = blockIdx.x * std::uint64_t{blockDim.x} + threadIdx.x;
  if (i < n) atomicMax(deepest, static_cast<unsigned>(1e9f * contacts[i].depth));
}

template <class T>
T* on_device(std::vector<T> const& values) {
  T* to = nullptr;
  collide::cuda_check(cudaMalloc(&to, values.size() * sizeof(T)), "cudaMalloc");
  collide::cuda_check(cudaMemcpy(to, values.data(), values.size() * sizeof(T), cudaMemcpyHostToDevice), "cudaMemcpy");
  return to;
}

}  // namespace

int main() {
  if (collide::cuda_device_count() == 0) return 77;  // CTest: skipped
  std::vector<float4> start;
  for (int i = 0; i < 1000; ++i)
    start.push_back({0.4f * static_cast<float>(i % 10) - 1.8f, 0.4f * static_cast<float>(i / 10 % 10) - 1.7f,
                     0.5f + 0.1f * static_cast<float>(i / 100), i % 2 == 0 ? 0.05f : largest_radius});
  unsigned const n = static_cast<unsigned>(start.size()), blocks = (n + 255) / 256;
  float4* const particles = on_device(start);
  float3* const velocities = on_device(std::vector<float3>(n, float3{0, 0, 0}));
  float const* const vertices = on_device(std::vector<float>{-2, -2, 0, 2, -2, 0, 2, 2, 0, -2, 2, 0});
  int const* const triangles = on_device(std::vector<int>{0, 1, 2, 0, 2, 3});

  cudaStream_t stream = nullptr;
  collide::cuda_check(cudaStreamCreate(&stream), "cudaStreamCreate");
  collide::detector<collide::bucket, collide::karabassi<>, collide::cuda_shared> detector{collide::cuda_shared(stream)};
  detector.build(collide::indexed_mesh(vertices, 4, triangles, 2), largest_radius);  // once: the mesh rests
  auto const spheres = collide::spheres_xyzr(reinterpret_cast<float const*>(particles), n);

  // A step waits for nothing, so a graph can hold it. The first, outside of the graph, takes all memory.
  collide::visit response(push_back{velocities});
  auto const step = [&] {
    advance<<<blocks, 256, 0, stream>>>(particles, velocities, n);
    detector.query(spheres, response);
  };
  step();
  cudaGraph_t captured = nullptr;
  cudaGraphExec_t graph = nullptr;
  collide::cuda_check(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal), "cudaStreamBeginCapture");
  step();
  collide::cuda_check(cudaStreamEndCapture(stream, &captured), "cudaStreamEndCapture");
  collide::cuda_check(cudaGraphInstantiate(&graph, captured, 0), "cudaGraphInstantiate");
  for (int i = 0; i < 2000; ++i) collide::cuda_check(cudaGraphLaunch(graph, stream), "cudaGraphLaunch");

  // Contacts in an array of fixed size, for a kernel. This waits, for their number.
  std::size_t const capacity = 4000;
  auto* const room = on_device(std::vector<collide::contact<float>>(capacity));
  unsigned* const deepest = on_device(std::vector<unsigned>{0});
  collide::contacts<float> contacts(room, capacity);
  detector.query(spheres, contacts);
  if (!contacts.complete()) return std::printf("room for %zu contacts is needed\n", std::size_t{contacts.total()}), 1;
  unsigned const found = static_cast<unsigned>(contacts.size());
  if (found > 0) find_deepest<<<(found + 255) / 256, 256, 0, stream>>>(contacts.data(), found, deepest);

  unsigned depth = 0;
  std::vector<float4> end(n);
  collide::cuda_check(cudaStreamSynchronize(stream), "cudaStreamSynchronize");
  collide::cuda_check(cudaMemcpy(&depth, deepest, sizeof depth, cudaMemcpyDeviceToHost), "cudaMemcpy");
  collide::cuda_check(cudaMemcpy(end.data(), particles, n * sizeof(float4), cudaMemcpyDeviceToHost), "cudaMemcpy");
  int resting = 0;
  for (float4 const& p : end) resting += std::fabs(p.z - p.w) < 1e-3f ? 1 : 0;
  std::printf("%d of %u particles rest on the floor\n", resting, n);
  std::printf("no deeper than 1e-3: %s\n", depth < 1000000 ? "yes" : "no");

  collide::cuda_check(cudaGraphExecDestroy(graph), "cudaGraphExecDestroy");
  collide::cuda_check(cudaGraphDestroy(captured), "cudaGraphDestroy");
  for (void const* p :
       {static_cast<void const*>(particles), static_cast<void const*>(velocities), static_cast<void const*>(vertices),
        static_cast<void const*>(triangles), static_cast<void const*>(room), static_cast<void const*>(deepest)})
    collide::cuda_check(cudaFree(const_cast<void*>(p)), "cudaFree");
}
