/// \file
/// The base of sinks that keep one array.
#pragma once

#include <vector>

#include <collide/detail/sinks/output.hpp>

namespace collide::detail {

/// An array of `T` in memory of a space.
template <class T>
class array_in_space : public kept_in_space<T> {
 public:
  /// The result of the last query, in memory of the space: `size()` elements, complete when the work on the stream is
  /// done. Valid until the next query. Null before the first.
  T const* data() const { return data_; }
  /// How many elements there are: of sinks with one for each sphere, the number of spheres; else how many are stored.
  std::size_t size() const { return size_; }
  /// A copy of the elements on the host. Waits for them.
  std::vector<T> to_host() const { return download_(data_, size_); }

 protected:
  T* data_ = nullptr;
  std::size_t size_ = 0;
  host_copier<T> download_;
};

}  // namespace collide::detail
