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

  /// Entries of later queries are written to the caller's memory (of the space), which must have room for them and stay
  /// valid as long as this object is used; null: to memory of its own.
  void write_to(T* entries) { external_ = entries; }

 protected:
  /// Entries are kept at `external`, or in memory of the space if that is null.
  explicit array_per_sphere(T* external = nullptr, std::size_t row = 1) : external_{external}, row_{row} {}

  /// The entries of a query of so many spheres, not yet written.
  template <class Space>
  T* memory_for(Space const& space, std::size_t spheres) {
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

/// Kernel functor of `for_each` over pairs. `Mesh` is a `mesh_view`, or what else `hit_of` takes.
template <class NarrowPhase, class S, class Record, class Mesh>
struct compute_records {
  pair const* pairs;
  Record* to;
  Mesh mesh;
  sphere_view_for<NarrowPhase, S> spheres;
  COLLIDE_HD void operator()(std::size_t i) const {
    to[i] = record_of<Record>(hit_of<NarrowPhase, S>(pairs[i], mesh, spheres));
  }
};

/// Contacts or impacts. The pairs are found first and the records computed from them in a second pass over the pairs
/// alone, so that a miss costs nothing.
template <class Record, class S>
class records : public array_in_space<Record> {
  using base = array_in_space<Record>;
  using base::data_, base::size_, base::download_;

 public:
  /// The records are kept in memory of the space, as many as there are, in the order `o`.
  explicit records(order o = order::unspecified) : order_{o} {}
  /// The records are written to the caller's `buffer` (in memory of the space) as long as `capacity` lasts; `total`
  /// tells how many there are all the same. Which ones are stored if they do not fit is unspecified, unless the order
  /// is canonical: then they are the first ones.
  records(Record* buffer, std::size_t capacity, order o = order::unspecified)
      : external_{buffer}, capacity_{capacity}, order_{o}, fixed_{true} {}

  /// How many pairs collide.
  std::uint64_t total() const { return collected_.total(); }
  /// True if all of them are stored.
  bool complete() const { return size_ == total(); }

  /// Makes room in memory of `space` for queries of up to so many spheres and pairs: they then allocate nothing.
  template <class Space>
  void reserve(Space const& space, std::size_t spheres, std::size_t pairs) {
    collected_.reserve(space, spheres, pairs);
    if (order_ == order::canonical) collected_.reserve_sort(space);
    if (!fixed_) own_.reserve(space.resource(), collected_.capacity());
  }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    static_assert(std::is_same<S, typename Query::scalar>::value,
                  "collide: contacts<S> and impacts<S> must have the scalar type of the detector");
    download_ = host_copier<Record>(space);
    collected_.fill(space, query);
    if (order_ == order::canonical) collected_.sort(space, query);
    size_ = collected_.size();
    if (fixed_ && size_ > capacity_) size_ = capacity_;
    if (!fixed_) own_.reserve(space.resource(), size_ > own_.capacity() ? size_ + size_ / 4 : own_.capacity());
    data_ = fixed_ ? external_ : own_.data();
    using compute = compute_records<typename Query::narrow_phase, S, Record, decltype(query.mesh)>;
    space.for_each(size_, compute{collected_.data(), data_, query.mesh, query.spheres});
  }

 private:
  Record* external_ = nullptr;
  std::size_t capacity_ = 0;
  order order_;
  bool fixed_ = false;
  pair_collector collected_;
  buffer<Record> own_;
};

}  // namespace collide::detail
