/// \file
/// The arguments of a simulation.
#pragma once

#include <tuple>
#include <type_traits>

namespace collide::detail {

/// True if `E` are the parameters of all effects, of which there are some.
template <class Effects, class... E>
inline constexpr bool are_all_of = sizeof...(E) > 0 && std::is_same<std::tuple<E...>, Effects>::value;

/// True if `Rest` is nothing, or the parameters of all effects.
template <class Effects, class... Rest>
inline constexpr bool are_parameters = sizeof...(Rest) == 0 || std::is_same<std::tuple<Rest...>, Effects>::value;

/// True if the arguments after the space are the options of the broad phase, and then the parameters of all effects or
/// nothing.
template <class Options, class Effects, class... Argument>
inline constexpr bool starts_with_options = false;
template <class Options, class Effects, class First, class... Rest>
inline constexpr bool starts_with_options<Options, Effects, First, Rest...> =
    std::is_convertible<First, Options>::value&& are_parameters<Effects, std::decay_t<Rest>...>;

/// True for the arguments of a constructor of a simulation with such a space, options of the broad phase and effects.
template <class Space, class Options, class Effects, class First, class... Argument>
inline constexpr bool makes_simulation = std::is_convertible<First, Space>::value &&
                                         (are_parameters<Effects, std::decay_t<Argument>...> ||
                                          starts_with_options<Options, Effects, Argument...>);

/// Refuses another scalar type than the simulation's.
template <class T>
constexpr void reject_scalar() {
  static_assert(sizeof(T) == 0,
                "collide: particles, their velocities and the mesh must have the scalar type of the simulation's "
                "detector, its fourth parameter: nothing is narrowed silently");
}

}  // namespace collide::detail
