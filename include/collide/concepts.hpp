/// \file
/// What the parts of a detector must have; docs/extending.md shows each with an example.
///
/// A sink is a class with a member `template <class Space, class Query> void run(Space& space, Query const& query)`. It
/// calls `query(handle)` as often as it needs to; each call puts one pass over the scene on the space's stream. The
/// handle is trivially copyable, goes to the device, and has
///   - `std::uint64_t reserve(std::uint64_t n) const`: called once per batch of n hits; returns the slot of the first;
///   - `void store(std::uint64_t slot, Hit const& hit) const`: called once per hit (see hit.hpp);
///   - `void finish() const`, if it wants to: called once per pass, when all hits are stored.
/// `query.mesh` and `query.spheres` are the views, `Query::narrow_phase` and `Query::scalar` are types.
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include <collide/hit.hpp>
#include <collide/karabassi.hpp>
#include <collide/mesh.hpp>
#include <collide/spheres.hpp>

namespace collide::detail {

/// A broad phase B for a space E and coordinates of type S.
template <class B, class E, class S, class = void>
struct is_broad_phase : std::false_type {};
template <class B, class E, class S>
struct is_broad_phase<
    B, E, S,
    std::void_t<decltype(std::declval<typename B::template index<S>&>().build(
                    std::declval<E&>(), std::declval<B const&>(), std::declval<mesh_view<S>>())),
                decltype(std::declval<typename B::template index<S>&>().prepare(
                    std::declval<E&>(), std::declval<B const&>(), std::declval<S>())),
                decltype(std::declval<typename B::template index<S>&>().prepare(
                    std::declval<E&>(), std::declval<B const&>(), std::declval<sphere_view<S> const&>()))>>
    : std::true_type {};

template <class E, class = void>
struct is_execution_space : std::false_type {};
template <class E>
struct is_execution_space<
    E, std::void_t<decltype(std::declval<E const&>().resource()),
                   decltype(std::declval<E const&>().saturating_blocks()), decltype(E::host_accessible)>>
    : std::true_type {};

template <class D, class = void>
struct is_detector : std::false_type {};
template <class D>
struct is_detector<
    D, std::void_t<typename D::broad_phase, typename D::narrow_phase, typename D::execution_space, typename D::scalar>>
    : std::true_type {};

/// What a sink passes to a query.
template <class H, class = void>
struct is_handle : std::false_type {};
template <class H>
struct is_handle<H, std::void_t<decltype(std::declval<H const&>().reserve(std::uint64_t{})),
                                decltype(&H::template store<hit<karabassi<>, float>>)>> : std::true_type {};

template <class Sink, class Space, class Query, class = void>
struct is_sink : std::false_type {};
template <class Sink, class Space, class Query>
struct is_sink<Sink, Space, Query,
               std::void_t<decltype(std::declval<Sink&>().run(std::declval<Space&>(), std::declval<Query const&>()))>>
    : std::true_type {};

}  // namespace collide::detail
