/// \file
/// The members of the parts of a detector; docs/development/extending.md shows each with an example.
///
/// A sink is a class with a member `template <class Space, class Query> void run(Space& space, Query const& query)`. It
/// calls `query(output)` as often as it needs to; each call puts one pass over the scene on the space's stream. The
/// output is trivially copyable, goes to the device, and has
///   - `std::uint64_t allocate(std::uint64_t n) const`: called once per batch of n hits; returns the slot of the first;
///   - `void store(std::uint64_t slot, Hit const& hit) const`: called once per hit (see hit.hpp);
///   - `void end_pass() const`, if it wants to: called once per pass, when all hits are stored.
///
/// `query.spheres` is the view, `Query::narrow_phase` and `Query::scalar` are types. `query.mesh` has `size()` and
/// `operator[]`: it is the view, but where a mesh is divided among ranks, or goes to a device in passes, only triangles
/// that were hit can be read.
///
/// A sink may have a member, for `detector::reserve`, which takes the memory that such a query needs:
/// `template <class Space> void reserve(Space const& space, std::size_t spheres, std::size_t pairs)`.
/// A sink that asks hits for nothing but ids may have a member `static constexpr bool keeps_ids_alone = true`:
/// `distributed` and `in_passes` then send no triangles, and none can be read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include <collide/core/detail/detected.hpp>
#include <collide/mesh.hpp>
#include <collide/narrow/detail/traits.hpp>
#include <collide/spheres.hpp>

namespace collide::detail {

template <template <class> class View, class T>
inline constexpr bool is_made_of = false;
template <template <class> class View, class S>
inline constexpr bool is_made_of<View, View<S>> = true;

/// For overloads that take what is neither a `View` of any scalar nor can become `Wanted`, to say so.
template <template <class> class View, class T, class Wanted>
using if_not_made_of = std::enable_if_t<!is_made_of<View, T> && !std::is_convertible<T const&, Wanted const&>::value>;

/// In place of a function, a kernel functor and an output, where only signatures are asked for.
struct any_function {
  void operator()(std::size_t) const {}
};
struct any_kernel {
  static constexpr int items = 1;
  template <class Block>
  struct scratch {};
  template <class Block>
  void operator()(Block&, scratch<Block>&) const {}
};
struct any_output {};

/// The members of an execution space E.
template <class E>
struct space_member {
  template <class T>
  using resource = decltype(std::declval<T const&>().resource());
  template <class T>
  using name = decltype(T::name());
  template <class T>
  using host_accessible = std::enable_if_t<std::is_same<decltype(T::host_accessible), bool const>::value>;
  template <class T>
  using block = typename T::template block<any_kernel>;
  template <class T>
  using launch = decltype(std::declval<T const&>().launch(std::size_t{}, any_kernel()));
  template <class T>
  using for_each = decltype(std::declval<T const&>().for_each(std::size_t{}, any_function()));
  template <class T>
  using fill = decltype(std::declval<T const&>().fill(static_cast<void*>(nullptr), static_cast<unsigned char>(0),
                                                      std::size_t{}));
  template <class T>
  using read = decltype(std::declval<T const&>().read(static_cast<int const*>(nullptr)));
  template <class T>
  using copy_to_host = decltype(std::declval<T const&>().copy_to_host(static_cast<int*>(nullptr),
                                                                      static_cast<int const*>(nullptr), std::size_t{}));
  template <class T>
  using copy_from_host = decltype(std::declval<T const&>().copy_from_host(
      static_cast<int*>(nullptr), static_cast<int const*>(nullptr), std::size_t{}));
  template <class T>
  using saturating_blocks = decltype(std::declval<T const&>().saturating_blocks());
  template <class T>
  using max_resident_blocks = decltype(std::declval<T const&>().template max_resident_blocks<any_kernel>());
  template <class T>
  using synchronize = decltype(std::declval<T const&>().synchronize());
};

/// True if E looks like an execution space at all: then `check_space` says what it lacks.
template <class E>
inline constexpr bool is_execution_space =
    is_valid<space_member<E>::template host_accessible, E> || is_valid<space_member<E>::template resource, E>;

template <class E>
constexpr bool check_space() {
  using m = space_member<E>;
  static_assert(is_valid<m::template resource, E>,
                "collide: an execution space has a const member resource(), a std::pmr::memory_resource*");
  static_assert(is_valid<m::template host_accessible, E>,
                "collide: an execution space has a static constexpr bool host_accessible");
  static_assert(is_valid<m::template name, E>, "collide: an execution space has a static member name()");
  static_assert(is_valid<m::template block, E>, "collide: an execution space has a member template block<Kernel>");
  static_assert(is_valid<m::template launch, E>,
                "collide: an execution space has a const member launch(blocks, kernel)");
  static_assert(is_valid<m::template for_each, E>, "collide: an execution space has a const member for_each(n, f)");
  static_assert(is_valid<m::template fill, E>, "collide: an execution space has a const member fill(to, byte, bytes)");
  static_assert(is_valid<m::template read, E>, "collide: an execution space has a const member read(from)");
  static_assert(is_valid<m::template copy_to_host, E>,
                "collide: an execution space has a const member copy_to_host(to, from, n)");
  static_assert(is_valid<m::template copy_from_host, E>,
                "collide: an execution space has a const member copy_from_host(to, from, n)");
  static_assert(is_valid<m::template saturating_blocks, E>,
                "collide: an execution space has a const member saturating_blocks()");
  static_assert(is_valid<m::template max_resident_blocks, E>,
                "collide: an execution space has a const member template max_resident_blocks<Kernel>()");
  static_assert(is_valid<m::template synchronize, E>, "collide: an execution space has a const member synchronize()");
  return true;
}

/// The members of the index of a broad phase B for a narrow phase N, a space E and coordinates of type S.
template <class B, class N, class E, class S>
struct broad_phase_member {
  template <class T>
  using index = typename T::template index<S>;
  template <class T>
  using build = decltype(std::declval<index<T>&>().build(std::declval<E&>(), std::declval<T const&>(),
                                                         std::declval<mesh_view<S>>()));
  template <class T>
  using prepare_radius =
      decltype(std::declval<index<T>&>().prepare(std::declval<E&>(), std::declval<T const&>(), std::declval<S>()));
  template <class T>
  using prepare_spheres = decltype(std::declval<index<T>&>().prepare(std::declval<E&>(), std::declval<T const&>(),
                                                                     std::declval<sphere_view<S> const&>()));
  template <class T>
  using query = decltype(std::declval<index<T>&>().template query<N>(
      std::declval<E&>(), std::declval<sphere_view_for<N, S> const&>(), std::declval<any_output const&>()));
  template <class T>
  using cell_width = decltype(std::declval<index<T> const&>().cell_width(std::declval<E const&>()));
};

template <class B, class S>
inline constexpr bool is_broad_phase = is_valid<broad_phase_member<B, int, int, S>::template index, B>;

template <class B, class N, class E, class S>
constexpr bool check_broad_phase() {
  using m = broad_phase_member<B, N, E, S>;
  static_assert(is_valid<m::template build, B>,
                "collide: the index of a broad phase has a member build(space, options, mesh)");
  static_assert(is_valid<m::template prepare_radius, B>,
                "collide: the index of a broad phase has a member prepare(space, options, radius)");
  static_assert(is_valid<m::template prepare_spheres, B>,
                "collide: the index of a broad phase has a member prepare(space, options, spheres)");
  static_assert(is_valid<m::template query, B>,
                "collide: the index of a broad phase has a member template query<NarrowPhase>(space, spheres, output)");
  static_assert(is_valid<m::template cell_width, B>,
                "collide: the index of a broad phase has a const member cell_width(space)");
  return true;
}

/// An optional member of an index: makes room for queries of up to so many spheres.
template <class Index, class Space>
using index_reserve = decltype(std::declval<Index&>().reserve(std::declval<Space&>(), std::size_t{}));

/// An optional member of an index: follows a mesh whose triangles have moved.
template <class Index, class Space, class Options, class S>
using index_refit = decltype(std::declval<Index&>().refit(std::declval<Space&>(), std::declval<Options const&>(),
                                                          std::declval<mesh_view<S>>()));

template <class D>
using detector_types =
    std::void_t<typename D::broad_phase, typename D::narrow_phase, typename D::execution_space, typename D::scalar>;
template <class D>
inline constexpr bool is_detector = is_valid<detector_types, D>;

/// The members of what a sink passes to a query.
template <class H>
using output_allocate = std::enable_if_t<
    std::is_convertible<decltype(std::declval<H const&>().allocate(std::uint64_t{})), std::uint64_t>::value>;
template <class H, class Hit>
using output_store = decltype(std::declval<H const&>().store(std::uint64_t{}, std::declval<Hit const&>()));

/// True if what a sink passes to a query can be handed to the device.
template <class H>
inline constexpr bool is_plain = std::is_trivially_destructible<H>::value;

/// The member that each sink has: runs a query.
template <class Sink, class Space, class Query>
using sink_run = decltype(std::declval<Sink&>().run(std::declval<Space&>(), std::declval<Query const&>()));
/// An optional member of a sink: makes room for queries of so many spheres and pairs.
template <class Sink, class Space>
using sink_reserve =
    decltype(std::declval<Sink&>().reserve(std::declval<Space const&>(), std::size_t{}, std::size_t{}));

/// True if a sink says that it keeps ids alone.
COLLIDE_MEMBER_OR(sink_keeps_ids_alone, keeps_ids_alone, false)

/// True if a sink searches the parts of a mesh one after the other, and joins what it finds.
COLLIDE_MEMBER_OR(sink_joins_parts, joins_parts, false)

}  // namespace collide::detail
