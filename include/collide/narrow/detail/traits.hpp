/// \file
/// Properties of a narrow phase: discrete or continuous, and whether it computes contacts and impacts.
#pragma once

#include <type_traits>
#include <utility>

#include <collide/core/detail/detected.hpp>
#include <collide/core/moving_spheres.hpp>

namespace collide::detail {

/// True if the narrow phase has a static member intersects(triangle<S>, Sphere) that returns bool.
template <class NarrowPhase, class S, class Sphere, class = void>
struct has_intersects : std::false_type {};
template <class NarrowPhase, class S, class Sphere>
struct has_intersects<
    NarrowPhase, S, Sphere,
    std::enable_if_t<std::is_convertible<decltype(NarrowPhase::intersects(std::declval<triangle<S> const&>(),
                                                                          std::declval<Sphere const&>())),
                                         bool>::value>> : std::true_type {};

/// The view of spheres that a query with the narrow phase takes.
template <class NarrowPhase, class S>
using sphere_view_for =
    std::conditional_t<has_intersects<NarrowPhase, S, sphere<S>>::value, sphere_view<S>, moving_sphere_view<S>>;

/// True if the narrow phase is discrete: it takes spheres at one time. False if it is continuous: it takes moving
/// spheres.
template <class NarrowPhase, class S>
inline constexpr bool is_discrete = std::is_same<sphere_view_for<NarrowPhase, S>, sphere_view<S>>::value;

/// True if the narrow phase has a static member contact_of(triangle<S>, Sphere), Sphere as `sphere_view_for` has it.
template <class N, class S>
using contact_call =
    decltype(N::contact_of(std::declval<triangle<S> const&>(), std::declval<moving_sphere<S> const&>()));
template <class N, class S>
inline constexpr bool has_contact = is_valid<contact_call, N, S>;

/// True if the narrow phase has a static member impact_of(triangle<S>, moving_sphere<S>).
template <class N, class S>
using impact_call = decltype(N::impact_of(std::declval<triangle<S> const&>(), std::declval<moving_sphere<S> const&>()));
template <class N, class S>
inline constexpr bool has_impact = is_valid<impact_call, N, S>;

}  // namespace collide::detail
