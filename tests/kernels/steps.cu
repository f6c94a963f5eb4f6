/// Steps of simulations, and kernels written by hand that do the same: compare.py compiles this and compares them.
#include <collide/bucket.cuh>
#include <collide/drag.hpp>
#include <collide/gravity.hpp>
#include <collide/simulation.cuh>

namespace {

struct quadruple {
  float4 a, b, c;
};

__device__ __forceinline__ quadruple load(float const* from, std::size_t i) {
  auto const* const p = reinterpret_cast<float4 const*>(from) + 3 * i;
  return {p[0], p[1], p[2]};
}
__device__ __forceinline__ void store(float* to, std::size_t i, quadruple const& q) {
  auto* const p = reinterpret_cast<float4*>(to) + 3 * i;
  p[0] = q.a, p[1] = q.b, p[2] = q.c;
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
__device__ __forceinline__ void slowed(float& x, float& y, float& z, float linear, float quadratic, float dt) {
  float const factor = 1 / (1 + (linear + quadratic * sqrtf(x * x + y * y + z * z)) * dt);
  x *= factor, y *= factor, z *= factor;
}

/// Particles that move in straight lines.
__global__ void __launch_bounds__(256) by_hand_none(float* x, float const* v, std::size_t n, float dt) {
  std::size_t const i = std::size_t{blockIdx.x} * 256 + threadIdx.x;
  if (4 * i >= n) return;
  store(x, i, moved(load(x, i), load(v, i), dt));
}

__global__ void __launch_bounds__(256) by_hand_gravity(float* x, float* v, std::size_t n, float dt, double3 g) {
  std::size_t const i = std::size_t{blockIdx.x} * 256 + threadIdx.x;
  if (4 * i >= n) return;
  quadruple speed = load(v, i);
  accelerated(speed, {float(g.x), float(g.y), float(g.z)}, dt);
  store(x, i, moved(load(x, i), speed, dt));
  store(v, i, speed);
}

__global__ void __launch_bounds__(256)
    by_hand_gravity_drag(float* x, float* v, std::size_t n, float dt, double3 g, double linear, double quadratic) {
  std::size_t const i = std::size_t{blockIdx.x} * 256 + threadIdx.x;
  if (4 * i >= n) return;
  quadruple u = load(v, i);
  accelerated(u, {float(g.x), float(g.y), float(g.z)}, dt);
  float const a = float(linear), b = float(quadratic);
  slowed(u.a.x, u.a.y, u.a.z, a, b, dt);
  slowed(u.a.w, u.b.x, u.b.y, a, b, dt);
  slowed(u.b.z, u.b.w, u.c.x, a, b, dt);
  slowed(u.c.y, u.c.z, u.c.w, a, b, dt);
  store(x, i, moved(load(x, i), u, dt));
  store(v, i, u);
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
  by_hand_gravity_drag<<<1, 1>>>(nullptr, nullptr, 0, 0, {}, 0, 0);
  step<>();
  step<collide::gravity>();
  step<collide::gravity, collide::drag>();
}
