/// \file
/// A quick test of several particles that rest whether they may touch a body: in the coordinates' own precision, with a
/// bound on how far the place that it finds in a body's frame is from the one that contacts are computed with.
/// The bound: docs/development/numerics.md ("Spheres beside a body").
#pragma once

#include <cstdint>
#include <limits>

#include <collide/broad/detail/grid/occupancy.hpp>
#include <collide/simulation/detail/bodies/moving_mesh.hpp>

namespace collide::detail {

template <class S>
inline constexpr S float_frame_error = 16 * ieee_traits<S>::unit_roundoff + S(128 * 0x1p-53);

/// How much larger than the particles' the radius is that the grid of a mesh with bodies is made for. `extent` is the
/// largest distance of what a body has from the origin of its frame.
template <class S>
S float_frame_margin(double extent) {
  return static_cast<S>(16 * static_cast<double>(float_frame_error<S>) * extent);
}

/// A body's frame at the end of a step.
template <class S>
struct alignas(16) float_frame {
  S centre[3], reach;  ///< no particle of radius r whose distance is above 1 + 2e-5 times reach + r touches the body
  S turn[3][3];
  S shift[3];  ///< where `centre` is in the frame
  S slack;  ///< how far places may be off, beside `float_frame_error` times the radius, of particles that are not far

  /// The frame of what rests: all places are exact, and none is far.
  static float_frame at_rest() {
    return {{0, 0, 0}, std::numeric_limits<S>::infinity(), {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}, 0};
  }

  /// The frame of a discrete step, in which `f` has the bounding sphere as it is at the end.
  static COLLIDE_HD_INLINE float_frame of(body_frame<S> const& f) {
    float_frame q;
    double const w = f.now.w, a[3] = {f.now.axis.x(), f.now.axis.y(), f.now.axis.z()};
    double const twist[3][3] = {{0, a[2], -a[1]}, {-a[2], 0, a[0]}, {a[1], -a[0], 0}};
    vec3<double> const local = f.now.to_local(f.centre.template cast<double>());
    for (int i = 0; i < 3; ++i) {
      int const j = (i + 1) % 3, k = (i + 2) % 3;
      q.turn[i][i] = static_cast<S>(1 - 2 * (mul_rn(a[j], a[j]) + mul_rn(a[k], a[k])));
      q.turn[i][j] = static_cast<S>(2 * (mul_rn(a[i], a[j]) + mul_rn(w, twist[i][j])));
      q.turn[i][k] = static_cast<S>(2 * (mul_rn(a[i], a[k]) + mul_rn(w, twist[i][k])));
      q.centre[i] = f.centre[i];
      q.shift[i] = static_cast<S>(local[i]);
    }
    q.reach = f.reach;
    // where squares vanish a particle may seem not to be far
    constexpr S smallest = std::numeric_limits<S>::min(), largest = std::numeric_limits<S>::max();
    double const tiny = 4 * sqrt_rn(static_cast<double>(smallest)), far = sqrt_rn(dot(local, local));
    double const slack = mul_rn(static_cast<double>(float_frame_error<S>), static_cast<double>(f.reach) + far + tiny);
    bool const has_squares = static_cast<double>(f.reach) + far < sqrt_rn(static_cast<double>(largest)) / 4;
    q.slack =
        has_squares ? static_cast<S>(slack + 32 * static_cast<double>(smallest)) : std::numeric_limits<S>::infinity();
    return q;
  }

  /// Which of some particles of one radius are not far, and how many. Without branches, for the CPU's vector unit.
  template <unsigned N>
  COLLIDE_HD_INLINE std::uint32_t find_close(S const (&x)[N], S const (&y)[N], S const (&z)[N], S radius,
                                             std::uint32_t (&close)[N]) const {
    S const at_least = mul_rn(reach + radius, S(1 + 2e-5)), limit = mul_rn(at_least, at_least);
    std::uint32_t count = 0;
    for (unsigned k = 0; k < N; ++k) {
      S const dx = x[k] - centre[0], dy = y[k] - centre[1], dz = z[k] - centre[2];
      close[k] = mul_add(dx, dx, mul_add(dy, dy, mul_rn(dz, dz))) > limit ? 0u : 1u;
      count += close[k];
    }
    return count;
  }

  /// The places of some particles in the frame.
  template <unsigned N>
  COLLIDE_HD_INLINE void to_local(S const (&x)[N], S const (&y)[N], S const (&z)[N], S (&at)[3][N]) const {
    for (unsigned k = 0; k < N; ++k) {
      S const dx = x[k] - centre[0], dy = y[k] - centre[1], dz = z[k] - centre[2];
      at[0][k] = place(0, dx, dy, dz), at[1][k] = place(1, dx, dy, dz), at[2][k] = place(2, dx, dy, dz);
    }
  }

 private:
  COLLIDE_HD_INLINE S place(int i, S dx, S dy, S dz) const {
    return mul_add(turn[i][0], dx, mul_add(turn[i][1], dy, mul_add(turn[i][2], dz, shift[i])));
  }
};

/// The frames of a mesh with bodies, for spheres at rest.
template <class S>
struct float_frames {
  float_frame<S> const* frames;
  S margin;  ///< how much larger than the particles' the radius is that the grid has to serve

  /// True if a particle's place may be off by no more than there is room for, except for how far bodies are.
  COLLIDE_HD_INLINE bool serve(S radius) const {
    return mul_rn(float_frame_error<S>, radius) <= margin && is_finite(mul_rn(4 * radius, radius));
  }

  /// Sets near[k] for those of some particles that may touch a triangle of the frames from `first` to before `end`:
  /// those in cells with triangles (`occupancy`). False if that is not known, as a place may be too far off.
  template <unsigned N>
  COLLIDE_HD_INLINE bool test_occupied(occupancy_view<S> const& occupancy, int first, int end, S const (&x)[N],
                                       S const (&y)[N], S const (&z)[N], S radius, bool (&near)[N]) const {
    S const largest = margin - mul_rn(float_frame_error<S>, radius);
    for (unsigned k = 0; k < N; ++k) near[k] = false;
    COLLIDE_NO_UNROLL
    for (int i = first; i < end; ++i) {
      float_frame<S> const& f = frames[i];
      if (!(f.slack <= largest)) return false;
      std::uint32_t close[N];
      std::uint32_t const count = f.find_close(x, y, z, radius, close);
      if (count == 0) continue;
      if constexpr (N >= 64) {
        if (count <= N / 4) {
          test_few<N / 4>(f, occupancy, x, y, z, close, near);
          continue;
        }
      }
      S at[3][N];
      f.to_local(x, y, z, at);
      auto const places = occupancy.places_of(at[0], at[1], at[2]);
      for (unsigned k = 0; k < N; ++k) close[k] &= places.inside[k];
      for (unsigned k = 0; k < N; ++k) {
        if (close[k] != 0 && occupancy.is_occupied(places.cells[k])) near[k] = true;
      }
    }
    return true;
  }

 private:
  /// Marks those that are close, of which there are at most `M`: they are gathered first.
  template <unsigned M, unsigned N>
  COLLIDE_HD_INLINE static void test_few(float_frame<S> const& f, occupancy_view<S> const& occupancy, S const (&x)[N],
                                         S const (&y)[N], S const (&z)[N], std::uint32_t const (&close)[N],
                                         bool (&near)[N]) {
    unsigned numbers[M + 1], n = 0;  // one more: each is written, and kept if it is close
    for (unsigned k = 0; k < N; ++k) {
      numbers[n] = k;
      n += close[k];
    }
    S few[3][M], at[3][M];
    for (unsigned j = 0; j < M; ++j) {
      unsigned const k = numbers[j < n ? j : 0];
      few[0][j] = x[k], few[1][j] = y[k], few[2][j] = z[k];
    }
    f.to_local(few[0], few[1], few[2], at);
    auto const places = occupancy.places_of(at[0], at[1], at[2]);
    for (unsigned j = 0; j < n; ++j) {
      if (places.inside[j] != 0 && occupancy.is_occupied(places.cells[j])) near[numbers[j]] = true;
    }
  }
};

}  // namespace collide::detail
