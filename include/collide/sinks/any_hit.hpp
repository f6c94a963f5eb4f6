/// \file
/// Sink: one flag per sphere.
#pragma once

#include <collide/detail/sinks/array_in_space.hpp>

namespace collide {

/// A flag per sphere: 1 if it touches any triangle, else 0. `query` does not wait for the flags. Memory: one byte per
/// sphere.
class any_hit : public detail::array_in_space<std::uint8_t> {
 public:
  static constexpr bool keeps_ids_alone = true;

  /// The flags are kept in memory of the space.
  any_hit() = default;
  /// The flags are written to the caller's memory (of the space), one byte per sphere: 0 or 1, for all spheres of the
  /// query. It must have room for them, and stay valid as long as this object is used.
  explicit any_hit(std::uint8_t* flags) : external_{flags} {}

  /// Makes room in memory of `space` for queries of up to so many spheres, whatever they touch: they then allocate
  /// nothing. Number of pairs: of no account.
  template <class Space>
  void reserve(Space const& space, std::size_t spheres, std::size_t /*pairs*/ = 0) {
    if (external_ == nullptr) own_.reserve(space.resource(), spheres);
  }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    size_ = query.spheres.size();
    data_ = external_ != nullptr ? external_ : own_.reserve(space.resource(), size_);
    download_ = detail::host_copier<std::uint8_t>(space);
    space.fill(data_, 0, size_);
    query(detail::output{{nullptr, nullptr}, nullptr, 0, data_});
  }

 private:
  std::uint8_t* external_ = nullptr;
  buffer<std::uint8_t> own_;
};

}  // namespace collide
