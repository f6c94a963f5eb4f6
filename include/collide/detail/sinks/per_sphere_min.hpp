/// \file
/// What sinks share that keep one triangle per sphere: that of the smallest number, and of these the first.
#pragma once

#include <vector>

#include <collide/detail/numeric/float_bits.hpp>
#include <collide/detail/sinks/output.hpp>
#include <collide/hit.hpp>

namespace collide::detail {

/// True if an entry keeps all that is to know of a hit; else it is a triangle and a number.
template <class Entry, class S>
inline constexpr bool is_record = std::is_same<Entry, contact<S>>::value || std::is_same<Entry, impact<S>>::value;

/// The entry of a sphere that touches nothing.
template <class Entry, class S>
COLLIDE_HD Entry empty_entry([[maybe_unused]] id sphere) {
  constexpr S infinity = std::numeric_limits<S>::infinity();
  if constexpr (std::is_same<Entry, contact<S>>::value) {
    constexpr S nan = std::numeric_limits<S>::quiet_NaN();
    return {sphere, no_id, {nan, nan, nan}, {nan, nan, nan}, infinity, -infinity, feature::face, 0};
  } else if constexpr (is_record<Entry, S>) {
    return {empty_entry<contact<S>, S>(sphere), infinity};
  } else {
    return {no_id, infinity};
  }
}

template <class Entry>
COLLIDE_HD id& triangle_of(Entry& entry) {
  return entry.triangle;
}
template <class S>
COLLIDE_HD id& triangle_of(impact<S>& entry) {
  return entry.contact.triangle;
}

/// Kernel body of `for_each` over spheres: nothing is there yet.
template <class Entry, class S>
struct reset_best {
  Entry* to;
  COLLIDE_HD void operator()(std::size_t i) const { to[i] = empty_entry<Entry, S>(static_cast<id>(i)); }
};

/// Kernel body of `for_each` over pairs: the number of each, which takes a contact or an impact to tell, and the
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

/// Kernel body of `for_each` over pairs: the smallest id among the triangles with that number.
template <class S, class Entry, class Key>
struct find_best {
  pair const* pairs;
  uint_for<S> const* numbers;
  Entry* to;
  COLLIDE_HD void operator()(std::size_t i) const {
    pair const p = pairs[i];
    Entry& best = to[p.sphere];
    if (numbers[i] == to_bits(Key::key_of(best))) fetch_min(&triangle_of(best), p.triangle);
  }
};

/// Kernel body of `for_each` over spheres: the contact or impact with the triangle that was found.
template <class NarrowPhase, class S, class Entry, class Mesh>
struct record_best {
  Entry* to;
  Mesh mesh;
  sphere_view_for<NarrowPhase, S> spheres;
  COLLIDE_HD void operator()(std::size_t i) const {
    pair const p{static_cast<id>(i), triangle_of(to[i])};
    if (p.triangle != no_id) to[i] = record_of<Entry>(hit_of<NarrowPhase, S>(p, mesh, spheres));
  }
};

/// One entry per sphere. `Key::of(hit)` is the number of a pair, `Key::key_of(entry)` that of an entry.
template <class Entry, class S, class Key>
class per_sphere_min : public kept_in_space<Entry> {
 public:
  /// One entry per sphere, in memory of the space; complete when the work on the stream is done. Valid until the next
  /// query. Null before the first.
  Entry const* data() const { return own_.data(); }
  /// Number of spheres of the last query.
  std::size_t size() const { return size_; }
  /// How many pairs collide.
  std::uint64_t total() const { return collected_.total(); }
  /// A copy of the entries on the host. Waits for them.
  std::vector<Entry> to_host() const { return download_(data(), size_); }

  /// Makes room in memory of `space` for queries of up to so many spheres and pairs: they then allocate nothing.
  template <class Space>
  void reserve(Space const& space, std::size_t spheres, std::size_t pairs) {
    collected_.reserve(space, spheres, pairs);
    own_.reserve(space.resource(), spheres);
    numbers_.reserve(space.resource(), pairs);
  }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    static_assert(std::is_same<S, typename Query::scalar>::value,
                  "collide: closest<S> and earliest<S> must have the scalar type of the detector");
    using narrow_phase = typename Query::narrow_phase;
    using reduce = reduce_key<narrow_phase, S, Entry, Key, decltype(query.mesh)>;
    download_ = host_copier<Entry>(space);
    size_ = query.spheres.size();
    collected_.fill(space, query);
    auto* const to = own_.reserve(space.resource(), size_);
    space.for_each(size_, reset_best<Entry, S>{to});
    std::size_t const pairs = collected_.size();
    std::size_t const room = numbers_.capacity();
    numbers_.reserve(space.resource(), pairs > room ? pairs + pairs / 4 : room);
    pair const* const from = collected_.data();
    space.for_each(pairs, reduce{from, numbers_.data(), to, query.mesh, query.spheres});
    space.for_each(pairs, find_best<S, Entry, Key>{from, numbers_.data(), to});
    if constexpr (is_record<Entry, S>) {
      using record = record_best<narrow_phase, S, Entry, decltype(query.mesh)>;
      if (pairs != 0) space.for_each(size_, record{to, query.mesh, query.spheres});
    }
  }

 private:
  std::size_t size_ = 0;
  pair_collector collected_;
  buffer<uint_for<S>> numbers_;  ///< of the pairs
  buffer<Entry> own_;
  host_copier<Entry> download_;
};

}  // namespace collide::detail
