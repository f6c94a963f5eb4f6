/// \file
/// Packs of spheres: those that one thread works on.
#pragma once

#include <cstdint>

#include <collide/core/moving_spheres.hpp>
#include <collide/exact/detail/geometry/bounding_sphere.hpp>

namespace collide::detail {

/// `Items` consecutive spheres: in registers on CUDA, eight or sixteen to a vector register on a CPU. Spheres beyond
/// the end of the set are far from everything, and have a NaN radius.
template <class S, unsigned Items>
struct sphere_pack {
  static_assert(Items % 4 == 0, "packed centres are loaded four at a time");

  S x[Items], y[Items], z[Items], radius[Items];

  static COLLIDE_HD sphere<S> none() {
    constexpr S far = std::numeric_limits<S>::max();
    return {{far, far, far}, std::numeric_limits<S>::quiet_NaN()};
  }

  /// Loads the swept bounding spheres of moving spheres.
  COLLIDE_HD_INLINE void load(moving_sphere_view<S> const& spheres, std::size_t first) { load_each(spheres, first); }

  COLLIDE_HD_INLINE void load(sphere_view<S> const& spheres, std::size_t first) {
    if (first + Items <= spheres.size()) {
      load_centres(spheres, first);
      if (spheres.one_radius()) {
        for (unsigned k = 0; k < Items; ++k) radius[k] = spheres.common_radius();
      } else {
        for (unsigned k = 0; k < Items; ++k) radius[k] = spheres.radius(first + k);
      }
    } else {
      load_each(spheres, first);
    }
  }

  COLLIDE_HD_INLINE sphere<S> shape(unsigned k) const { return {{x[k], y[k], z[k]}, radius[k]}; }

  /// The packed centres if the device can load four at a time with 16-byte loads; else null.
  static COLLIDE_HD_INLINE S const* aligned_centres(sphere_view<S> const& spheres) {
#if defined(__CUDA_ARCH__)
    return spheres.centres().packed() ? aligned_or_null(spheres.centres().address(0)) : nullptr;
#else
    static_cast<void>(spheres);
    return nullptr;
#endif
  }

  /// Centres only, which are all there; `first` is a multiple of four, and `aligned` is aligned_centres(spheres), not
  /// null.
  COLLIDE_HD_INLINE void load_xyz4(S const* aligned, std::size_t first) { load_xyz4(aligned, first, x, y, z); }

  /// Loads `Items` packed vectors from vector `first` on, a multiple of four; `aligned` is aligned to 16 bytes.
  static COLLIDE_HD_INLINE void load_xyz4([[maybe_unused]] S const* aligned, [[maybe_unused]] std::size_t first,
                                          [[maybe_unused]] S (&x)[Items], [[maybe_unused]] S (&y)[Items],
                                          [[maybe_unused]] S (&z)[Items]) {
#if defined(__CUDA_ARCH__)
    if constexpr (sizeof(S) == 4) {  // four packed vectors are three 16-byte loads
      auto const* const from = reinterpret_cast<float4 const*>(aligned + 3 * first);
      for (unsigned k = 0; k < Items; k += 4) {
        float4 const read[3] = {from[3 * k / 4], from[3 * k / 4 + 1], from[3 * k / 4 + 2]};
        x[k] = read[0].x, y[k] = read[0].y, z[k] = read[0].z;
        x[k + 1] = read[0].w, y[k + 1] = read[1].x, z[k + 1] = read[1].y;
        x[k + 2] = read[1].z, y[k + 2] = read[1].w, z[k + 2] = read[2].x;
        x[k + 3] = read[2].y, y[k + 3] = read[2].z, z[k + 3] = read[2].w;
      }
    }
#endif
  }

  /// `packed`, if groups of four can be loaded from there at a time; else null.
  static COLLIDE_HD_INLINE S const* aligned_or_null(S const* packed) {
    return sizeof(S) == 4 && reinterpret_cast<std::uintptr_t>(packed) % 16 == 0 ? packed : nullptr;
  }

 private:
  /// Loads those that exist of a pack, which may be the last; the others are `none()`.
  template <class Spheres>
  COLLIDE_HD_INLINE void load_each(Spheres const& spheres, std::size_t first) {
    for (unsigned k = 0; k < Items; ++k) {
      std::size_t const i = first + k;
      bool const there = i < spheres.size();
      sphere<S> const s = there ? swept_bounding_sphere(spheres[i]) : none();
      x[k] = s.centre.x();
      y[k] = s.centre.y();
      z[k] = s.centre.z();
      radius[k] = s.radius;
    }
  }

  COLLIDE_HD_INLINE void load_centres(sphere_view<S> const& spheres, std::size_t first) {
    if (S const* const aligned = aligned_centres(spheres)) {
      load_xyz4(aligned, first);
    } else if (spheres.centres().packed()) {  // a stride that the compiler knows
      S const* const from = spheres.centres().address(first);
      for (unsigned k = 0; k < Items; ++k) {
        x[k] = from[3 * k];
        y[k] = from[3 * k + 1];
        z[k] = from[3 * k + 2];
      }
    } else {
      for (unsigned k = 0; k < Items; ++k) {
        std::size_t const i = first + k;
        vec3<S> const c = spheres.centre(i);
        x[k] = c.x(), y[k] = c.y(), z[k] = c.z();
      }
    }
  }
};

/// `Items` consecutive moving spheres; those beyond the end of the set have a NaN radius.
template <class S, unsigned Items>
struct moving_pack {
  S x[Items], y[Items], z[Items], dx[Items], dy[Items], dz[Items], radius[Items];

  COLLIDE_HD_INLINE void load(moving_sphere_view<S> const& spheres, std::size_t first) {
    if (first + Items <= spheres.size() && spheres.centres().packed() && spheres.displacements().packed() &&
        spheres.one_radius()) {
      load_packed(spheres, first);
      for (unsigned k = 0; k < Items; ++k) radius[k] = spheres.common_radius();
      return;
    }
    for (unsigned k = 0; k < Items; ++k) {
      std::size_t const i = first + k;
      bool const there = i < spheres.size();
      moving_sphere<S> const s =
          there ? spheres[i] : moving_sphere<S>{{{0, 0, 0}, std::numeric_limits<S>::quiet_NaN()}, {0, 0, 0}};
      x[k] = s.centre.x(), y[k] = s.centre.y(), z[k] = s.centre.z();
      dx[k] = s.displacement.x(), dy[k] = s.displacement.y(), dz[k] = s.displacement.z();
      radius[k] = s.radius;
    }
  }

  COLLIDE_HD_INLINE vec3<S> centre(unsigned k) const { return {x[k], y[k], z[k]}; }
  COLLIDE_HD_INLINE vec3<S> displacement(unsigned k) const { return {dx[k], dy[k], dz[k]}; }
  COLLIDE_HD_INLINE moving_sphere<S> shape(unsigned k) const { return {{centre(k), radius[k]}, displacement(k)}; }

 private:
  COLLIDE_HD_INLINE void load_packed(moving_sphere_view<S> const& spheres, std::size_t first) {
#if defined(__CUDA_ARCH__)
    using still = sphere_pack<S, Items>;
    S const *const centres = still::aligned_or_null(spheres.centres().address(0)), *const ways = still::aligned_or_null(
                                                                                       spheres.displacements().address(
                                                                                           0));
    if (centres != nullptr && ways != nullptr) {
      still::load_xyz4(centres, first, x, y, z);
      still::load_xyz4(ways, first, dx, dy, dz);
      return;
    }
#endif
    S const *const from = spheres.centres().address(first), *const along = spheres.displacements().address(first);
    for (unsigned k = 0; k < Items; ++k) {  // strides that the compiler knows
      x[k] = from[3 * k], y[k] = from[3 * k + 1], z[k] = from[3 * k + 2];
      dx[k] = along[3 * k], dy[k] = along[3 * k + 1], dz[k] = along[3 * k + 2];
    }
  }
};

}  // namespace collide::detail
