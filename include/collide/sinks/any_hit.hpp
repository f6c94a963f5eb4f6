/// \file
/// Sink: one flag per sphere.
#pragma once

#include <collide/sinks/detail/array_in_space.hpp>

namespace collide {

/// A flag per sphere: 1 if it touches any triangle, else 0. `query` does not wait for the flags. Memory: one byte per
/// sphere.
class any_hit : public detail::array_per_sphere<std::uint8_t> {
 public:
  static constexpr bool keeps_ids_alone = true;

  /// The flags are kept in memory of the space.
  any_hit() = default;
  /// The flags are written to the caller's memory (of the space), one byte per sphere: 0 or 1, for all spheres of the
  /// query. It must have room for them, and stay valid as long as this object is used.
  explicit any_hit(std::uint8_t* flags) : array_per_sphere{flags} {}

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    std::uint8_t* const flags = memory_for(space, query.spheres.size());
    space.fill(flags, 0, size_);
    query(detail::output{{nullptr, nullptr}, nullptr, 0, flags});
  }
};

}  // namespace collide
