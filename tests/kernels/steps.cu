/// Steps of simulations, and kernels written by hand that do the same: compare.py compiles this and compares them.
#include <collide/bucket.cuh>
#include <collide/effects/drag.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/simulation.cuh>

namespace {

struct quadruple {
  float4 a, b, c;
};

/// Four particles a lane; a warp reads and writes what lies side by side, and its lanes exchange it.
__device__ __forceinline__ quadruple load(float const* from, unsigned i, unsigned n) {
  unsigned const own = threadIdx.x % 32, first = 3 * (i - own) + own;
  auto const* const p = reinterpret_cast<float4 const*>(from);
  quadruple side;
  if (first < 3 * n) side.a = p[first];
  if (first + 32 < 3 * n) side.b = p[first + 32];
  if (first + 64 < 3 * n) side.c = p[first + 64];
  return side;
}
__device__ __forceinline__ quadruple exchanged(quadruple const& side) {
  __shared__ float4 lines[256 / 32][96];
  float4* const line = lines[threadIdx.x / 32];
  unsigned const own = threadIdx.x % 32;
  line[own] = side.a, line[own + 32] = side.b, line[own + 64] = side.c;
  __syncwarp();
  quadruple const q{line[3 * own], line[3 * own + 1], line[3 * own + 2]};
  __syncwarp();
  return q;
}
__device__ __forceinline__ void store(float* to, unsigned i, unsigned n, quadruple const& q) {
  __shared__ float4 lines[256 / 32][96];
  float4* const line = lines[threadIdx.x / 32];
  unsigned const own = threadIdx.x % 32, first = 3 * (i - own) + own;
  auto* const p = reinterpret_cast<float4*>(to);
  line[3 * own] = q.a, line[3 * own + 1] = q.b, line[3 * own + 2] = q.c;
  __syncwarp();
  for (unsigned k = 0; k < 96; k += 32) {
    if (first + k < 3 * n) p[first + k] = line[own + k];
  }
  __syncwarp();
}
__device__ __forceinline__ float4 moved(float4 x, float4 v, float dt) {
  return {x.x + v.x * dt, x.y + v.y * dt, x.z + v.z * dt, x.w + v.w * dt};
}
__device__ __forceinline__ quadruple moved(quadruple const& x, quadruple const& v, float dt) {
  return {moved(x.a, v.a, dt), moved(x.b, v.b, dt), moved(x.c, v.c, dt)};
}
__device__ __forceinline__ void accelerated(quadruple& v, float3 g, float dt) {
  v.a.x += g.x * dt, v.a.y += g.y * dt, v.a.z += g.z * dt;
  v.a.w += g.x * dt, v.b.x += g.y * dt, v.b.y += g.z * dt;
  v.b.z += g.x * dt, v.b.w += g.y * dt, v.c.x += g.z * dt;
  v.c.y += g.x * dt, v.c.z += g.y * dt, v.c.w += g.z * dt;
}
__device__ __noinline__ void fallen(float& x, float& y, float& z, float3 g,
                                    collide::detail::resistance_in_step const& medium, float dt) {
  collide::vec3<float> const before(x, y, z), pushed(x + g.x * dt, y + g.y * dt, z + g.z * dt);
  collide::vec3<float> const after = collide::detail::velocity_in(medium, {0, 0, 0}, before, pushed);
  x = after.x(), y = after.y(), z = after.z();
}

/// Particles that move in straight lines. `n` are groups of four.
__global__ void __launch_bounds__(256) by_hand_none(float* x, float const* v, unsigned n, float dt) {
  unsigned const i = blockIdx.x * 256 + threadIdx.x;
  if (i - threadIdx.x % 32 >= n) return;
  quadruple const place = load(x, i, n), speed = load(v, i, n);
  store(x, i, n, moved(exchanged(place), exchanged(speed), dt));
}

__global__ void __launch_bounds__(256) by_hand_gravity(float* x, float* v, unsigned n, float dt, double3 g) {
  unsigned const i = blockIdx.x * 256 + threadIdx.x;
  if (i - threadIdx.x % 32 >= n) return;
  quadruple place = load(x, i, n), speed = load(v, i, n);
  place = exchanged(place), speed = exchanged(speed);
  accelerated(speed, {float(g.x), float(g.y), float(g.z)}, dt);
  store(x, i, n, moved(place, speed, dt));
  store(v, i, n, speed);
}

__global__ void __launch_bounds__(256) by_hand_gravity_drag(float* x, float* v, unsigned n, float dt, double3 g,
                                                            collide::detail::resistance_in_step medium) {
  unsigned const i = blockIdx.x * 256 + threadIdx.x;
  if (i - threadIdx.x % 32 >= n) return;
  quadruple place = load(x, i, n), u = load(v, i, n);
  place = exchanged(place), u = exchanged(u);
  float3 const by{float(g.x), float(g.y), float(g.z)};
  fallen(u.a.x, u.a.y, u.a.z, by, medium, dt);
  fallen(u.a.w, u.b.x, u.b.y, by, medium, dt);
  fallen(u.b.z, u.b.w, u.c.x, by, medium, dt);
  fallen(u.c.y, u.c.z, u.c.w, by, medium, dt);
  store(x, i, n, moved(place, u, dt));
  store(v, i, n, u);
}

using detector = collide::detector<collide::bucket, collide::karabassi<>, collide::cuda_shared>;

template <class... Effect>
void step() {
  collide::simulation<detector, Effect...> simulation;
  simulation.step(0.5f);
}

}  // namespace

int main() {
  by_hand_none<<<1, 1>>>(nullptr, nullptr, 0, 0);
  by_hand_gravity<<<1, 1>>>(nullptr, nullptr, 0, 0, {});
  by_hand_gravity_drag<<<1, 1>>>(nullptr, nullptr, 0, 0, {}, {});
  step<>();
  step<collide::gravity>();
  step<collide::gravity, collide::drag>();
}
