/// \file
/// The base of sinks that keep a record of every colliding pair.
#pragma once

#include <collide/sinks/detail/array_in_space.hpp>

namespace collide::detail {

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
