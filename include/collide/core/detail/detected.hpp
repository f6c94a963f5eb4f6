/// \file
/// Detection of members: true where a type has one, and what it is; the first of some types.
#pragma once

#include <type_traits>

namespace collide::detail {

template <class Void, class Otherwise, template <class...> class Expression, class... T>
struct detection : std::false_type {
  using type = Otherwise;
};
template <class Otherwise, template <class...> class Expression, class... T>
struct detection<std::void_t<Expression<T...>>, Otherwise, Expression, T...> : std::true_type {
  using type = Expression<T...>;
};

/// True if Expression<T...> is a type.
template <template <class...> class Expression, class... T>
inline constexpr bool is_valid = detection<void, void, Expression, T...>::value;

/// Expression<T...> if it is a type, else `Otherwise`.
template <class Otherwise, template <class...> class Expression, class... T>
using detected_or = typename detection<void, Otherwise, Expression, T...>::type;

/// The first T of those `choice<Is, T>` with `Is`, or `Otherwise`.
template <bool Is, class T>
struct choice;
template <class Otherwise, class... Choice>
struct first_of {
  using type = Otherwise;
};
template <class Otherwise, bool Is, class T, class... More>
struct first_of<Otherwise, choice<Is, T>, More...>
    : std::conditional_t<Is, std::enable_if<true, T>, first_of<Otherwise, More...>> {};

/// Defines NAME<T>, of the type of OTHERWISE: the static MEMBER of T, or that if it has none.
#define COLLIDE_MEMBER_OR(NAME, MEMBER, OTHERWISE)       \
  template <class T, class = void>                       \
  inline constexpr decltype(OTHERWISE) NAME = OTHERWISE; \
  template <class T>                                     \
  inline constexpr decltype(OTHERWISE) NAME<T, std::void_t<decltype(T::MEMBER)>> = T::MEMBER;

}  // namespace collide::detail
