/// \file
/// Triangles in the order of a curve through space, as devices sort them: alike in every run.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <collide/detail/execution/launch.hpp>
#include <collide/detail/grid/mesh_statistics.hpp>
#include <collide/memory.hpp>
#if defined(__CUDACC__)
#include <collide/detail/tree/sort_ids_cuda.cuh>
#endif

namespace collide::detail {

/// The position of a place on Hilbert's curve through a cube, from coordinates of `Bits` bits (J. Skilling,
/// "Programming the Hilbert curve", 2004).
template <int Bits>
COLLIDE_HD_INLINE std::uint64_t place_on_curve(std::uint32_t (&x)[3]) {
  constexpr std::uint32_t top = 1u << (Bits - 1);
  for (std::uint32_t q = top; q > 1; q >>= 1) {
    for (auto& c : x) {
      std::uint32_t const t = (x[0] ^ c) & (q - 1);
      if ((c & q) != 0) {
        x[0] ^= q - 1;
      } else {
        x[0] ^= t;
        c ^= t;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t turned = 0;
  for (std::uint32_t q = top; q > 1; q >>= 1) turned ^= (x[2] & q) != 0 ? q - 1 : 0;
  std::uint64_t place = 0;
  for (int b = Bits - 1; b >= 0; --b) {
    for (auto const c : x) place = place << 1 | ((c ^ turned) >> b & 1);
  }
  return place;
}

/// Kernel functor of `for_each` over triangles: where each is on the curve, and its number.
template <class S>
struct find_places {
  static constexpr int bits = 16;                            ///< of a coordinate
  static constexpr std::uint64_t none = 1ull << (3 * bits);  ///< of what is not finite

  mesh_view<S> mesh;
  mesh_statistics<S> const* summary;
  std::uint64_t* places;
  id* ids;

  COLLIDE_HD void operator()(std::size_t i) const {
    aabb<S> const box = aabb_of(mesh[i]);
    ids[i] = static_cast<id>(i);
    places[i] = none;
    if (box.is_empty()) return;
    S extent = 0;
    for (int k = 0; k < 3; ++k) extent = max(extent, summary->upper_of(k) / 2 - summary->lower_of(k) / 2);
    std::uint32_t x[3];
    for (int k = 0; k < 3; ++k) {
      S const part = div_rn((box.lower[k] / 2 + box.upper[k] / 2 - summary->lower_of(k)) / 2, extent);
      x[k] = static_cast<std::uint32_t>(static_cast<std::int32_t>(saturate(part) * S((1 << bits) - 1)));
    }
    places[i] = place_on_curve<bits>(x);
  }
};

/// Sorts triangles along the curve.
template <class S>
class curve_order {
 public:
  /// Puts triangles in order, of equal places the lowest number first, and makes `summary`. O(triangles).
  template <class Space>
  void sort(Space& space, mesh_view<S> const& mesh) {
    std::size_t const n = mesh.size();
    auto* const summary = summary_.reserve(space.resource(), 1);
    mesh_statistics<S>::clear(space, summary);
    compute_mesh_statistics<S> const seen{mesh, summary, nullptr};
    space.launch(grid_size<Space>(n, seen), seen);
    std::uint64_t* const places = places_.reserve(space.resource(), 2 * n);
    id* const ids = ids_.reserve(space.resource(), 2 * n);
    space.for_each(n, find_places<S>{mesh, summary, places, ids});
    places_in_order_ = places + n;
    ids_in_order_ = ids + n;
    sort(space, n);
  }

  /// The numbers of the triangles in order,
  id const* ids() const { return ids_in_order_; }
  /// their places, which rise,
  std::uint64_t const* places() const { return places_in_order_; }
  /// and statistics of the mesh, in memory of the space.
  mesh_statistics<S> const* summary() const { return summary_.data(); }

 private:
  template <class Space>
  void sort([[maybe_unused]] Space& space, std::size_t n) {
    if constexpr (Space::host_accessible) {
      std::uint64_t const* const places = places_.data();
      std::copy(ids_.data(), ids_.data() + n, ids_in_order_);
      std::stable_sort(ids_in_order_, ids_in_order_ + n, [&](id a, id b) { return places[a] < places[b]; });
      std::transform(ids_in_order_, ids_in_order_ + n, places_in_order_, [&](id t) { return places[t]; });
    } else {
#if defined(__CUDACC__)
      sort_ids_on_device(space.stream(), space.resource(), places_.data(), places_in_order_, ids_.data(), ids_in_order_,
                         n, 3 * find_places<S>::bits + 1, scratch_);
#else
      throw error("collide: bvh: triangles in memory of a device are sorted where nvcc compiles the program");
#endif
    }
  }

  std::uint64_t* places_in_order_ = nullptr;
  id* ids_in_order_ = nullptr;
  buffer<mesh_statistics<S>> summary_;
  buffer<std::uint64_t> places_;
  buffer<id> ids_;
  buffer<unsigned char> scratch_;
};

}  // namespace collide::detail
