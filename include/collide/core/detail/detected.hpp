/// \file
/// Detection of members: true where a type has one, and what it is.
#pragma once

#include <type_traits>
#include <utility>

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

}  // namespace collide::detail
