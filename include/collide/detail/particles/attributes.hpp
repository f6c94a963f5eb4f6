/// \file
/// Lists of columns: what they contain, their union, and how a column lies in memory.
#pragma once

#include <type_traits>

#include <collide/columns.hpp>

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

/// A value of a column is `width` numbers of type `element`, one after the other.
template <class V>
struct layout_of {
  static_assert(std::is_arithmetic<V>::value, "collide: a column holds vec3<S>, S or an integer");
  using element = V;
  static constexpr int width = 1;
  static COLLIDE_HD_INLINE V& at(V& v, int) { return v; }
  static COLLIDE_HD_INLINE V const& at(V const& v, int) { return v; }
};
template <class S>
struct layout_of<vec3<S>> {
  using element = S;
  static constexpr int width = 3;
  static COLLIDE_HD_INLINE S& at(vec3<S>& v, int k) { return v[k]; }
  static COLLIDE_HD_INLINE S const& at(vec3<S> const& v, int k) { return v[k]; }
};

template <class C, class S>
using column_value = typename C::template value<S>;
template <class C, class S>
using column_layout = layout_of<column_value<C, S>>;
template <class C, class S>
using column_element = typename column_layout<C, S>::element;

/// Bytes of a particle in a column.
template <class C, class S>
inline constexpr std::size_t column_bytes = sizeof(column_element<C, S>) * std::size_t(column_layout<C, S>::width);

/// The initial value of a column.
template <class C, class S, class = void>
struct initial_of {
  static COLLIDE_HD column_value<C, S> value() {
    if constexpr (column_layout<C, S>::width == 3) {
      return column_value<C, S>(S(0), S(0), S(0));
    } else {
      return column_value<C, S>(0);
    }
  }
};
template <class C, class S>
struct initial_of<C, S, std::void_t<decltype(C::template initial<S>)>> {
  static COLLIDE_HD column_value<C, S> value() {
    constexpr column_value<C, S> v = C::template initial<S>;
    return v;
  }
};

}  // namespace collide::detail
