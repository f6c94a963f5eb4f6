/// \file
/// Lists of columns: what they contain, and their union.
#pragma once

#include <type_traits>

#include <collide/effects/columns.hpp>

namespace collide::detail {

template <class List, class C>
inline constexpr bool contains = false;
template <class... D, class C>
inline constexpr bool contains<columns<D...>, C> = (std::is_same<D, C>::value || ...);

/// The columns of all lists, each once, in order of appearance.
template <class... List>
struct joined;
template <>
struct joined<> {
  using type = columns<>;
};
template <class List>
struct joined<List> {
  using type = List;
};
template <class... C, class D, class... E, class... More>
struct joined<columns<C...>, columns<D, E...>, More...> {
  using with = std::conditional_t<contains<columns<C...>, D>, columns<C...>, columns<C..., D>>;
  using type = typename joined<with, columns<E...>, More...>::type;
};
template <class... C, class... More>
struct joined<columns<C...>, columns<>, More...> : joined<columns<C...>, More...> {};
template <class... List>
using union_of = typename joined<List...>::type;

/// The columns that are in both.
template <class A, class B>
struct common;
template <class... C, class B>
struct common<columns<C...>, B> {
  using type = union_of<std::conditional_t<contains<B, C>, columns<C>, columns<>>...>;
};
template <class B>
struct common<columns<>, B> {
  using type = columns<>;
};
template <class A, class B>
using intersection_of = typename common<A, B>::type;

/// The columns of A that are not in B.
template <class A, class B>
struct remaining;
template <class... C, class B>
struct remaining<columns<C...>, B> {
  using type = union_of<columns<>, std::conditional_t<contains<B, C>, columns<>, columns<C>>...>;
};
template <class A, class B>
using difference_of = typename remaining<A, B>::type;

}  // namespace collide::detail
