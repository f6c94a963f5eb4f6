/// \file
/// Keys of a particle's contacts with the mesh, which say which comes first.
#pragma once

#include <cstdint>

#include <collide/core/contact.hpp>
#include <collide/exact/detail/numeric/float_bits.hpp>

namespace collide::detail {

/// Keys of contacts: the smaller comes first. That is the earlier contact, and of those at the beginning of the motion
/// the deeper one. Ties go to the face, then to the edge, so that on a plane which is divided into triangles the normal
/// is that of the face below the centre; then to the lower triangle number.
inline constexpr std::uint64_t no_contact = ~std::uint64_t{0};
/// Bits for the time or the depth in a key; one more tells which of them it is.
inline constexpr int key_bits = 29;

/// The next time at or below a time from 0 to 1 that keys tell from others: a multiple of 2^-29 below 1.
template <class S>
COLLIDE_HD_INLINE S key_time(S time) {
  constexpr auto ticks = std::uint32_t{1} << key_bits, last = ticks - (sizeof(S) == sizeof(float) ? 32 : 1);
  return S(min(static_cast<std::uint32_t>(time * S(ticks)), last)) * (S(1) / S(ticks));
}

/// `time` is a `key_time`.
template <class S>
COLLIDE_HD_INLINE std::uint64_t contact_key(S time, contact<S> const& c) {
  constexpr auto ticks = std::uint32_t{1} << key_bits;
  std::uint32_t const first = time > 0 ? static_cast<std::uint32_t>(time * S(ticks)) | ticks
                                       : ~to_ordered_bits(static_cast<float>(c.depth)) >> (32 - key_bits);
  return std::uint64_t{first} << 34 | std::uint64_t{static_cast<std::uint32_t>(c.feature)} << 32 | c.triangle;
}

/// The time of a contact, from its key.
template <class S>
COLLIDE_HD_INLINE S time_of_key(std::uint64_t key) {
  constexpr auto ticks = std::uint32_t{1} << key_bits;
  auto const first = static_cast<std::uint32_t>(key >> 34);
  return (first & ticks) != 0 ? S(first & (ticks - 1)) * (S(1) / S(ticks)) : S(0);
}

}  // namespace collide::detail
