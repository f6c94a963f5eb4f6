/// \file
/// The base of sinks that keep one triangle per sphere: that of the smallest number, and of these the first.
#pragma once

#include <collide/exact/detail/numeric/float_bits.hpp>
#include <collide/query/hit.hpp>
#include <collide/sinks/detail/array_in_space.hpp>

namespace collide::detail {

/// Kernel functor of `for_each` over spheres: nothing is there yet. Memory of all ones has `no_id` for the triangle
/// already.
template <class Entry, class Key>
struct reset_best {
  Entry* to;
  COLLIDE_HD void operator()(std::size_t i) const {
    auto& number = Key::key_of(to[i]);
    number = std::numeric_limits<std::decay_t<decltype(number)>>::infinity();
  }
};

/// Kernel functor of `for_each` over pairs: the number of each, which takes a contact or an impact to tell, and the
/// smallest of each sphere. Numbers are not negative, so they sort like their bits. `Mesh` is a `mesh_view`, or what
/// else `hit_of` takes.
template <class NarrowPhase, class S, class Entry, class Key, class Mesh>
struct reduce_key {
  pair const* pairs;
  uint_for<S>* numbers;
  Entry* to;
  Mesh mesh;
  sphere_view_for<NarrowPhase, S> spheres;
  COLLIDE_HD void operator()(std::size_t i) const {
    pair const p = pairs[i];
    uint_for<S> const number = to_bits(Key::of(hit_of<NarrowPhase, S>(p, mesh, spheres)));
    numbers[i] = number;
    fetch_min(reinterpret_cast<uint_for<S>*>(&Key::key_of(to[p.sphere])), number);
  }
};

/// Kernel functor of `for_each` over pairs: the smallest id among the triangles with that number.
template <class S, class Entry, class Key>
struct find_best {
  pair const* pairs;
  uint_for<S> const* numbers;
  Entry* to;
  COLLIDE_HD void operator()(std::size_t i) const {
    pair const p = pairs[i];
    Entry& best = to[p.sphere];
    if (numbers[i] == to_bits(Key::key_of(best))) fetch_min(&best.triangle, p.triangle);
  }
};

/// Kernel functor of `for_each` over spheres: the contact or impact with the best triangle. Memory is all ones, so NaN.
template <class NarrowPhase, class S, class Entry, class Key, class Record, class Mesh>
struct record_best {
  Entry const* best;
  Record* to;
  Mesh mesh;
  sphere_view_for<NarrowPhase, S> spheres;
  COLLIDE_HD void operator()(std::size_t i) const {
    pair const p{static_cast<id>(i), best[i].triangle};
    Key::key_of(to[i]) = Key::key_of(best[i]);
    if (p.triangle != no_id) to[i] = record_of<Record>(hit_of<NarrowPhase, S>(p, mesh, spheres));
  }
};

/// One entry per sphere, or in its place a `Record`: a contact or an impact. `Key::of(hit)` is the number of a pair,
/// `Key::key_of(entry)` that of an entry.
template <class Entry, class S, class Key, class Record = Entry>
class per_sphere_min : public array_in_space<Record> {
  using base = array_in_space<Record>;
  using base::data_, base::size_, base::download_;

 public:
  /// How many pairs collide.
  std::uint64_t total() const { return collected_.total(); }

  /// Makes room in memory of `space` for queries of up to so many spheres and pairs: they then allocate nothing.
  template <class Space>
  void reserve(Space const& space, std::size_t spheres, std::size_t pairs) {
    collected_.reserve(space, spheres, pairs);
    own_.reserve(space.resource(), spheres);
    if (with_records) records_.reserve(space.resource(), spheres);
    numbers_.reserve(space.resource(), pairs);
  }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    static_assert(std::is_same<S, typename Query::scalar>::value,
                  "collide: closest<S> and earliest<S> must have the scalar type of the detector");
    using narrow_phase = typename Query::narrow_phase;
    using reduce = reduce_key<narrow_phase, S, Entry, Key, decltype(query.mesh)>;
    download_ = host_copier<Record>(space);
    size_ = query.spheres.size();
    collected_.fill(space, query);
    auto* const to = own_.reserve(space.resource(), size_);
    space.fill(to, 0xff, size_ * sizeof *to);
    space.for_each(size_, reset_best<Entry, Key>{to});
    std::size_t const pairs = collected_.size();
    std::size_t const reserved = numbers_.capacity();
    numbers_.reserve(space.resource(), pairs > reserved ? pairs + pairs / 4 : reserved);
    pair const* const from = collected_.data();
    space.for_each(pairs, reduce{from, numbers_.data(), to, query.mesh, query.spheres});
    space.for_each(pairs, find_best<S, Entry, Key>{from, numbers_.data(), to});
    if constexpr (with_records) {
      using record = record_best<narrow_phase, S, Entry, Key, Record, decltype(query.mesh)>;
      data_ = records_.reserve(space.resource(), size_);
      space.fill(data_, 0xff, size_ * sizeof *data_);
      space.for_each(size_, record{to, data_, query.mesh, query.spheres});
    } else {
      data_ = to;
    }
  }

 private:
  static constexpr bool with_records = !std::is_same<Record, Entry>::value;

  pair_collector collected_;
  buffer<uint_for<S>> numbers_;  ///< of the pairs
  buffer<Entry> own_;
  buffer<Record> records_;
};

}  // namespace collide::detail
