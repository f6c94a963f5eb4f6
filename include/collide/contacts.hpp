/// \file
/// Sink: all colliding pairs with their contacts.
#pragma once

#include <vector>

#include <collide/detail/sink.hpp>

namespace collide {

namespace detail {

/// Kernel body of `for_each` over pairs.
template <class NarrowPhase, class S>
struct compute_contacts {
  pair const* pairs;
  contact<S>* to;
  mesh_view<S> mesh;
  sphere_view<S> spheres;
  COLLIDE_HD void operator()(std::size_t i) const { to[i] = hit<NarrowPhase, S>(pairs[i], mesh, spheres).contact(); }
};

}  // namespace detail

/// The contact of every colliding pair: closest point, normal, distance, depth and feature. The pairs are found first
/// and the contacts computed from them in a second pass over the pairs alone, so that a miss costs nothing.
template <class S = float>
class contacts {
 public:
  /// The contacts are kept in memory of the space, as many as there are.
  explicit contacts(order o = order::unspecified) : order_{o} {}
  /// The contacts are written to the caller's `buffer` (in memory of the space) as long as `capacity` lasts; `total`
  /// tells how many there are all the same. Which ones are stored if they do not fit is unspecified, unless the order
  /// is canonical: then they are the first ones.
  contacts(contact<S>* buffer, std::size_t capacity, order o = order::unspecified)
      : external_{buffer}, capacity_{capacity}, order_{o}, fixed_{true} {}

  /// How many pairs collide.
  std::uint64_t total() const { return collected_.total(); }
  /// How many contacts are stored.
  std::size_t size() const { return size_; }
  /// True if all of them are stored.
  bool complete() const { return size_ == total(); }

  /// The stored contacts, in memory of the space.
  contact<S> const* data() const { return data_; }
  contact<S> const* begin() const { return data_; }
  contact<S> const* end() const { return data_ + size_; }
  /// A copy of the stored contacts on the host.
  std::vector<contact<S>> to_host() const { return download_(data_, size_); }

  template <class Space, class Query>
  void run(Space& space, Query const& query) {
    static_assert(std::is_same<S, typename Query::scalar>::value,
                  "collide: contacts<S> must have the scalar type of the detector");
    download_ = detail::downloader<contact<S>>(space);
    collected_.fill(space, query);
    if (order_ == order::canonical) collected_.sort(space, query);
    size_ = collected_.size();
    if (fixed_ && size_ > capacity_) size_ = capacity_;
    if (!fixed_ && size_ > own_.capacity()) own_.reserve(space.resource(), size_ + size_ / 4);
    data_ = fixed_ ? external_ : own_.data();
    using narrow_phase = typename Query::narrow_phase;
    space.for_each(size_,
                   detail::compute_contacts<narrow_phase, S>{collected_.data(), data_, query.mesh, query.spheres});
  }

 private:
  contact<S>* external_ = nullptr;
  contact<S>* data_ = nullptr;
  std::size_t capacity_ = 0;
  std::size_t size_ = 0;
  order order_;
  bool fixed_ = false;
  detail::collector collected_;
  buffer<contact<S>> own_;
  detail::downloader<contact<S>> download_;
};

}  // namespace collide
