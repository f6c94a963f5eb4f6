/// hunt (float|double) SEED SECONDS: random cases that some stage gets wrong, as rows for the files next to this one. Is
/// compiled with a mutated library; the verdicts are the oracle's. See mutate.py.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <xmmintrin.h>

#include "../oracle/exact.hpp"
#include "stages.hpp"

namespace {

using real = long double;
using vec = Eigen::Matrix<real, 3, 1>;

std::mt19937_64 engine;

real uniform(real low, real high) { return std::uniform_real_distribution<double>(double(low), double(high))(engine); }
int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine); }
vec in_cube(real half) {
  real const x = uniform(-half, half), y = uniform(-half, half), z = uniform(-half, half);
  return {x, y, z};
}

/// Roughly: rounding is left out of account.
real distance(vec const& a, vec const& b, vec const& c) {
  real best = std::min({a.norm(), b.norm(), c.norm()});
  vec const v[3] = {a, b, c};
  vec const n = (b - a).cross(c - a);
  bool inside = n.squaredNorm() > 0;
  for (int i = 0; i < 3; ++i) {
    vec const e = v[(i + 1) % 3] - v[i];
    real const along = -v[i].dot(e);
    if (along > 0 && along < e.squaredNorm()) best = std::min(best, v[i].cross(e).norm() / e.norm());
    inside = inside && v[i].cross(e).dot(n) > 0;
  }
  return inside ? std::min(best, std::abs(a.dot(n)) / n.norm()) : best;
}

template <class S>
struct example {
  collide::triangle<S> t;
  collide::sphere<S> s;

  S* values[13] = {&t.a[0], &t.a[1], &t.a[2],      &t.b[0],      &t.b[1],      &t.b[2],  &t.c[0],
                   &t.c[1], &t.c[2], &s.centre[0], &s.centre[1], &s.centre[2], &s.radius};

  oracle::point point(int i) const { return {double(*values[i]), double(*values[i + 1]), double(*values[i + 2])}; }
  bool truth() const { return oracle::hit({point(0), point(3), point(6)}, {point(9), double(s.radius)}); }
  void print(bool hit) const {
    std::printf("%d", hit);
    for (S const* v : values) std::printf(",%a", double(*v));
    std::puts("");
  }
};

template <class S>
void invent(example<S>& e) {
  constexpr bool wide = sizeof(S) == 8;
  if (integer(0, 3) == 0) {  // small integers: ties, and degenerate triangles
    int const end = integer(1, 6);
    for (S* v : e.values) *v = S(integer(-end, end)) / S(integer(0, 3) == 0 ? 2 : 1);
    e.s.radius = integer(0, 3) == 0 ? S(0) : std::abs(e.s.radius);
    if (integer(0, 1)) e.s.radius = std::sqrt(S(integer(0, 9)));
    if (integer(0, 3) == 0) e.t.c = e.t.b;
    if (integer(0, 3) == 0) e.t.c = e.t.a + S(integer(-2, 3)) * (e.t.b - e.t.a);
    return;
  }
  auto const tiny = [&](int most) { return std::exp2(-uniform(1, most)); };
  vec a = in_cube(1), b = in_cube(1), c = in_cube(1);
  int const kind = integer(0, 5);
  if (kind == 1) c = a + uniform(-1, 2) * (b - a) + tiny(wide ? 60 : 30) * in_cube(1);
  if (kind == 2) c = b + tiny(wide ? 60 : 30) * in_cube(1);
  if (kind == 3) {
    real const size = tiny(wide ? 290 : 45);
    b = a + size * in_cube(1), c = a + size * in_cube(1);
  }
  if (kind == 4) {  // tiny, and facing the centre, so that its coordinates need not be rounded
    real const size = tiny(wide ? 290 : 45);
    a = size * in_cube(1), b = size * in_cube(1), c = size * in_cube(1);
    a.x() = b.x() = c.x() = integer(0, 1) ? 1 : uniform(1, 2);
  }
  if (kind == 5) c = integer(0, 1) ? b : a;
  vec p = {0, 0, 0};
  if (kind != 4) {
    real const v = uniform(-1, 2), w = integer(0, 2) == 0 ? 0 : uniform(-1, 2);
    vec const n = (b - a).cross(c - a);
    vec const way = integer(0, 1) && n.norm() > 0 ? vec(n / n.norm()) : in_cube(1);
    p = a + v * (b - a) + w * (c - a) + (integer(0, 5) == 0 ? 0 : tiny(40)) * way;
    if (integer(0, 1)) a -= p, b -= p, c -= p, p = {0, 0, 0};
    if (integer(0, 3) == 0) {
      vec const offset = in_cube(std::exp2(uniform(0, 20)));
      a += offset, b += offset, c += offset, p += offset;
    }
  }
  real const scale = std::exp2(real(integer(0, 2) != 0 ? 0 : (wide ? integer(-1070, 1000) : integer(-148, 120))));
  vec const corners[4] = {a, b, c, p};
  for (int i = 0; i < 12; ++i) *e.values[i] = S(corners[i / 3][i % 3] * scale);
  auto const seen = [&](collide::vec3<S> const& v) { return vec((v.template cast<real>() - e.s.centre.template cast<real>())); };
  real const d = distance(seen(e.t.a), seen(e.t.b), seen(e.t.c));
  int const how = integer(0, 5);
  real const factor = how < 2 ? 1 : 1 + (integer(0, 1) ? 1 : -1) * tiny(wide ? 56 : 27);
  e.s.radius = how == 5 ? S(tiny(50) * scale) : S(d * factor);
  if (integer(0, 9) == 0) e.s.radius = 0;
}

template <class S>
void hunt(double seconds) {
  auto const start = std::chrono::steady_clock::now();
  example<S> e;
  long tried = 0, found = 0;
  for (; std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < seconds && found < 20; ++tried) {
    invent(e);
    bool const finite = [&] {
      for (S const* v : e.values)
        if (!std::isfinite(*v)) return false;
      return true;
    }();
    if (!finite) continue;
    bool const hit = e.truth();
    bool wrong = tests::some_stage_is_wrong(e.t, e.s, hit);
    auto const mode = _mm_getcsr();
    _mm_setcsr(mode | 0x8040);  // subnormal numbers are flushed to zero
    wrong = tests::some_stage_is_wrong(e.t, e.s, hit) || wrong;
    _mm_setcsr(mode);
    if (wrong) e.print(hit), ++found;
  }
  std::fprintf(stderr, "%ld tried, %ld found\n", tried, found);
}

}  // namespace

int main(int, char** argv) {
  engine.seed(std::strtoul(argv[2], nullptr, 10));
  std::strcmp(argv[1], "float") == 0 ? hunt<float>(std::atof(argv[3])) : hunt<double>(std::atof(argv[3]));
}
