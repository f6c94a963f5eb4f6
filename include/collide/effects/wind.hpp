/// \file
/// Effect: the resistance of a medium that moves.
#pragma once

#include <type_traits>

#include <collide/effects/detail/resistance.hpp>
#include <collide/effects/effect.hpp>

namespace collide {

/// A velocity field that is uniform: (x, y, z) everywhere, in units of length per time.
struct uniform_field {
  double x = 0;  ///< length per time
  double y = 0;  ///< length per time
  double z = 0;  ///< length per time

  void check_parameters() const {
    detail::check_parameter(detail::is_finite(x) && detail::is_finite(y) && detail::is_finite(z),
                            "wind: the velocity of uniform_field is finite");
  }

  /// The velocity, whatever the position.
  template <class S>
  COLLIDE_HD_INLINE vec3<S> operator()(vec3<S> const&) const {
    return {S(x), S(y), S(z)};
  }
};

/// Wind: drag (drag.hpp) relative to a medium with a velocity of its own. `Field` is a copyable function object: given
/// a position, a COLLIDE_HD operator() const returns the velocity of the medium there.
template <class Field = uniform_field>
struct wind {
  using reads = columns<position>;
  using writes = columns<velocity>;
  static constexpr bool saves_parameters = detail::saves_parameters<Field>;

  double linear = 0;      ///< per time, not negative
  double quadratic = 0;   ///< per length, not negative
  Field field = Field();  ///< gives the velocity of the medium, in length per time

  template <class F>
  void for_each_part(F const& f) {
    f(linear);
    f(quadratic);
    detail::for_each_part_of(field, f);
  }
  void check_parameters() const {
    detail::check_parameter(detail::is_amount(linear) && detail::is_amount(quadratic),
                            "wind: linear and quadratic are not negative, and finite");
    detail::check_part(field);
  }

  template <class Particle>
  COLLIDE_HD_INLINE detail::medium resistance(Particle const& p) const {
    using S = typename Particle::scalar;
    static_assert(std::is_invocable_r<vec3<S>, Field const&, vec3<S> const&>::value,
                  "collide: a field of wind is called as field(position) const, and returns a velocity");
    vec3<S> const flow = field(p[position{}]);
    return {linear, quadratic, flow.template cast<double>()};
  }
};

}  // namespace collide
