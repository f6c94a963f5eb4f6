/// \file
/// Which spheres of a set touch each other. Includes the sinks and spaces to use it with: with nvcc the CUDA spaces
/// too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include <collide/detector.hpp>
#include <collide/detectors/detail/sphere_cells.hpp>
#include <collide/sinks/csr.hpp>

namespace collide {

namespace detail {

/// Kernel functor of `for_each` over spheres in the order of cells: gives the pairs that a sphere has to find to the
/// output, some at a time. `BothWays` if each of two has the other as a neighbour.
template <class S, bool BothWays>
struct find_sphere_pairs {
  sphere_cells<S> cells;
  output to;

  COLLIDE_AS_O3 COLLIDE_HD void operator()(std::size_t place) const {
    if (place >= cells.counts[1]) return;
    constexpr std::uint32_t capacity = 16;
    pair found[capacity];
    std::uint32_t size = 0;
    auto const i = static_cast<std::uint32_t>(place);
    id const own = cells.numbers[i];
    std::uint32_t const level = sphere_size(cells.spheres[i]).level();
    cells.for_each_touching(i, [&](std::uint32_t k) COLLIDE_HOT {
      id const other = cells.numbers[k];
      bool const is_found_by_other = sphere_size(cells.spheres[k]).level() == level;
      if (BothWays) {
        found[size++] = {own, other};
        if (!is_found_by_other) found[size++] = {other, own};
      } else if (own < other || !is_found_by_other) {
        found[size++] = own < other ? pair{own, other} : pair{other, own};
      }
      if (size + 2 <= capacity) return;
      store(found, size);
      size = 0;
    });
    if (size != 0) store(found, size);
  }

 private:
  COLLIDE_HD_INLINE void store(pair const* found, std::uint32_t size) const {
    std::uint64_t const slot = to.allocate(size);
    for (std::uint32_t n = 0; n < size; ++n) to.store(slot + n, found[n]);
  }
};

/// One pass over the pairs of spheres, as a sink sees it; see concepts.hpp.
template <class Space, class S, bool BothWays>
struct sphere_pass {
  using scalar = S;

  Space const& space;
  sphere_view<S> spheres;
  sphere_view<S> mesh;  ///< the others
  sphere_cells<S> cells;

  void operator()(output const& to) const {
    space.for_each(spheres.size(), find_sphere_pairs<S, BothWays>{cells, to});
    if (wants_end_pass(to)) space.for_each(1, end_pass_kernel<output>{to});
  }
};

}  // namespace detail

/// Finds all pairs of spheres of a set that touch or overlap: those whose centres are as far apart as the sum of their
/// radii, or nearer. That is decided exactly, as in real arithmetic on the coordinates as given. A sphere with a NaN or
/// infinite coordinate, or a NaN or negative radius, touches nothing; one of infinite radius touches all others.
/// Spheres of radius 0 touch where they have one centre.
///
/// Sinks are `count`, `pairs`, `csr` and `any_hit`; in a `pair`, and in a row of `csr`, the place of the triangle has
/// the number of the other sphere. Radii may be common or each, and differ much: there is a grid for each power of two.
///
/// \tparam ExecutionSpace  where it runs: `host`, `cuda` or `cuda_shared`, of which the last two do the same here
/// \tparam Scalar          type of the coordinates: float or double
///
/// Memory is taken from the space's resource and kept: at most 37 bytes a sphere, 53 with double, and 27 KiB. It can be
/// moved, but not copied. What detectors say of streams, threads, and of what is thrown, holds here too.
template <class ExecutionSpace = host, class Scalar = float>
class sphere_pairs {
  static_assert(std::is_same<Scalar, float>::value || std::is_same<Scalar, double>::value,
                "collide: the second parameter of sphere_pairs is the type of the coordinates, float or double");
  static_assert(detail::is_execution_space<ExecutionSpace>,
                "collide: the first parameter of sphere_pairs is an execution space: host, cuda or cuda_shared");
  static_assert(detail::check_space<ExecutionSpace>());

 public:
  /// Keeps a copy of the space, and allocates nothing; its stream and memory resource must outlive the object.
  explicit sphere_pairs(ExecutionSpace space = ExecutionSpace()) : space_(std::move(space)) {}

  /// Hands each pair of spheres that touch to the sink, once: the lower number first. Not for `any_hit`, which would
  /// miss the other one: see `neighbours`.
  ///
  /// \param spheres  in memory of the space: valid and unchanged until the work is done. There may be none.
  /// \param sink     `count`, `pairs` or `csr`
  /// \return the sink: by reference if it was given as an lvalue, else by value
  /// \complexity O(n + pairs) for spheres that do not crowd: each looks at those in 27 cells about as wide as it, and
  ///             in 27 of each larger power of two of which there are spheres.
  /// \sync As the sink says.
  template <class Sink>
  Sink query(sphere_view<Scalar> const& spheres, Sink&& sink) {
    static_assert(!std::is_same<std::decay_t<Sink>, any_hit>::value,
                  "collide: sphere_pairs: query gives each pair once, and any_hit would mark one of the two: use "
                  "neighbours");
    run<false>(spheres, sink);
    return std::forward<Sink>(sink);
  }

  /// Hands each sphere with each of those that it touches to the sink, so that each pair comes both ways: `csr` then
  /// has a list of all neighbours of each sphere, and `any_hit` marks spheres that touch another. Else as `query`.
  ///
  /// \param spheres  as for `query`
  /// \param sink     `count`, `pairs`, `csr` or `any_hit`
  /// \return the sink, as `query` does
  template <class Sink>
  Sink neighbours(sphere_view<Scalar> const& spheres, Sink&& sink) {
    run<true>(spheres, sink);
    return std::forward<Sink>(sink);
  }

  /// Makes room for queries ahead, which then allocate nothing.
  ///
  /// \param spheres  the largest number of spheres
  /// \param pairs    the largest number of pairs that a sink keeps
  /// \param sinks    those of later queries, kept by the caller
  template <class... Sink>
  void reserve(std::size_t spheres, [[maybe_unused]] std::size_t pairs, Sink&... sinks) {
    cells_.reserve(space_.resource(), spheres);
    (sinks.reserve(space_, spheres, pairs), ...);
  }

  /// The space, to wait for it, or to put work of your own on its stream.
  ExecutionSpace& space() { return space_; }

 private:
  template <bool BothWays, class Sink>
  void run(sphere_view<Scalar> const& spheres, Sink& sink) {
    using pass = detail::sphere_pass<ExecutionSpace, Scalar, BothWays>;
    static_assert(detail::sink_keeps_ids_alone<Sink>,
                  "collide: sphere_pairs gives ids alone: its sinks are count, pairs, csr and any_hit");
    sink.run(space_, pass{space_, spheres, spheres, cells_.build(space_, spheres)});
  }

  ExecutionSpace space_;
  detail::sphere_cell_lists<Scalar> cells_;
};

}  // namespace collide
