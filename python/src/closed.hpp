/// \file
/// A quick look whether a mesh is closed: for a warning, where `validate_closed` would take as long as an index.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include <collide/exact/detail/geometry/aabb.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/mesh.hpp>

namespace collide_python {

/// All bits depend on all bits: the finaliser of splitmix64, G. L. Steele et al., 2014.
inline std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

template <class S>
std::uint64_t number_of(collide::vec3<S> const& v) {
  std::uint64_t number = 0;
  for (int k = 0; k < 3; ++k)
    number = mixed(number + 0x9e3779b97f4a7c15u + collide::detail::to_bits(v[k] == 0 ? S(0) : v[k]));
  return number;
}

/// Whether each edge has an even number of triangles: the numbers of all edges, exclusive-ored, are 0. Where one has
/// not, they are 0 by a chance of 2^-64. Triangles that `validate_closed` leaves out are left out. O(triangles).
template <class S, class Space>
bool seems_closed(collide::mesh_view<S> const& mesh, Space const& space) {
  constexpr std::size_t share = 4096;
  std::atomic<std::uint64_t> all{0};
  space.for_each((mesh.size() + share - 1) / share, [&](std::size_t part) {
    std::uint64_t odd = 0;
    for (std::size_t i = share * part; i < std::min(mesh.size(), share * (part + 1)); ++i) {
      auto const t = mesh[i];
      if (!collide::detail::is_finite(t) || t.a == t.b || t.b == t.c || t.c == t.a) continue;
      std::uint64_t const a = number_of(t.a), b = number_of(t.b), c = number_of(t.c);
      odd ^= mixed(a + b) ^ mixed(b + c) ^ mixed(c + a);
    }
    all ^= odd;
  });
  return all == 0;
}

}  // namespace collide_python
