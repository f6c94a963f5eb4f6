/// \file
/// The bases of sinks that keep one array.
#pragma once

#include <cstddef>
#include <vector>

#include <collide/sinks/detail/output.hpp>

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

/// An array with a row of entries for each sphere or point, in memory of its own or of the caller.
template <class T>
class array_per_sphere : public array_in_space<T> {
 public:
  /// Makes room in memory of `space` for queries of up to so many spheres or points, whatever they touch: they then
  /// allocate nothing. Number of pairs: of no account.
  template <class Space>
  void reserve(Space const& space, std::size_t spheres, std::size_t /*pairs*/ = 0) {
    if (external_ == nullptr) own_.reserve(space.resource(), spheres * row_);
  }

 protected:
  /// Entries are kept at `external`, or in memory of the space if that is null.
  explicit array_per_sphere(T* external = nullptr, std::size_t row = 1) : external_{external}, row_{row} {}

  /// The entries of a query of so many spheres, not yet written.
  template <class Space>
  T* room_for(Space const& space, std::size_t spheres) {
    this->size_ = spheres * row_;
    this->data_ = external_ != nullptr ? external_ : own_.reserve(space.resource(), this->size_);
    this->download_ = host_copier<T>(space);
    return this->data_;
  }

 private:
  T* external_;
  std::size_t row_;
  buffer<T> own_;
};

}  // namespace collide::detail
