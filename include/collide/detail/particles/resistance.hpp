/// \file
/// Motion against the resistance of a medium: dv/dt = a - (linear + quadratic |v - flow|) (v - flow), in closed form.
/// Below, velocities are relative to the medium, and the step is the unit of time.
#pragma once

#include <collide/detail/numeric/decay.hpp>

namespace collide::detail {

/// How a medium resists.
struct medium {
  double linear = 0;     ///< per time
  double quadratic = 0;  ///< per length
  vec3<double> flow = {0, 0, 0};
};

COLLIDE_HD_INLINE double length_of(vec3<double> const& x) { return sqrt_rn(dot(x, x)); }

/// The speed after a time of what a push, not negative, makes faster all the time. All terms are positive: it is right
/// to rounding.
COLLIDE_HD_INLINE double speed_after(double speed, double push, double linear, double quadratic, double time) {
  double const h = linear / 2, rate = sqrt_rn(mul_rn(h, h) + mul_rn(push, quadratic));
  decay const d = decay_after(mul_rn(2 * rate, time));
  double const grown = rate > 0 ? div_rn(d.lost, rate) : 2 * time, share = rate > 0 ? div_rn(h, rate) : 0;
  double const other = rate > 0 ? div_rn(mul_rn(push, quadratic), mul_rn(rate, rate + h)) : 1;  // 1 - share
  double const up = mul_rn(speed, other + mul_rn(d.left, 1 + share)) + mul_rn(push, grown);
  return div_rn(up, 1 + d.left + mul_rn(mul_rn(quadratic, speed) + h, grown));
}

/// The time t at which tanh(r t) / r is x, where r^2 = `square`, which may be negative: tan is meant then.
COLLIDE_HD_INLINE double time_of_tangent(double x, double square) {
  for (int i = 0; i < 10; ++i) x = div_rn(x, 1 + sqrt_rn(max(1 - mul_rn(square, mul_rn(x, x)), 0.0)));  // half the time
  double const y = mul_rn(square, mul_rn(x, x));
  double sum = 0;
  for (double const f : {1.0 / 11, 1.0 / 9, 1.0 / 7, 1.0 / 5, 1.0 / 3, 1.0}) sum = f + mul_rn(y, sum);
  return 1024 * mul_rn(x, sum);
}
/// Its inverse at the time 1; r is imaginary and above -pi / 2, or real.
COLLIDE_HD_INLINE double tangent_of_one(double square) {
  if (square > 1e-3) {
    double const r = sqrt_rn(square);
    decay const d = decay_after(2 * r);
    return div_rn(d.lost, mul_rn(r, 1 + d.left));
  }
  double const y = square / 1048576;  // at a time of 1 / 1024
  double x = (1 - mul_rn(y, 1.0 / 3 - mul_rn(y, 2.0 / 15))) / 1024;
  for (int i = 0; i < 10; ++i) x = div_rn(2 * x, 1 + mul_rn(square, mul_rn(x, x)));
  return x;
}

/// The velocity along a push after a step: against it first, until it stops, if it is negative.
COLLIDE_HD_INLINE double velocity_along(double v, double push, double linear, double quadratic) {
  if (v >= 0) return speed_after(v, push, linear, quadratic, 1);
  double const h = linear / 2, square = mul_rn(h, h) - mul_rn(push, quadratic), slowing = push - mul_rn(h, v);
  double const stop = time_of_tangent(div_rn(-v, slowing), square);
  if (stop < 1) return speed_after(0, push, linear, quadratic, 1 - stop);
  double const x = tangent_of_one(square);
  return div_rn(v + mul_rn(slowing, x), 1 + mul_rn(h - mul_rn(quadratic, v), x));
}

/// The velocity after a step against a linear resistance. `push`: by which a push alone would have changed it.
COLLIDE_HD_INLINE vec3<double> eased(vec3<double> const& v, vec3<double> const& push, double rate) {
  decay const d = decay_after(rate);
  return scaled(v, d.left) + scaled(push, rate > 0 ? div_rn(d.lost, rate) : 1);
}

/// The velocity after a step against any resistance: exact if it is linear, or velocity and push are parallel. Else of
/// second order; never faster than both at first and in the end.
COLLIDE_HD_INLINE vec3<double> resisted(vec3<double> const& v, vec3<double> const& push, double linear,
                                        double quadratic) {
  if (quadratic == 0) return eased(v, push, linear);
  double const a = length_of(push), speed = length_of(v);
  vec3<double> const along = a > 0 ? scaled(push, div_rn(1, a)) : scaled(v, speed > 0 ? div_rn(1, speed) : 0);
  double const part = dot(v, along);
  if (length_of(v - scaled(along, part)) <= 1e-15 * speed) {
    return scaled(along, velocity_along(part, a, linear, quadratic));
  }
  vec3<double> const ahead = v + push;
  double const gain = dot(push, ahead), to = length_of(ahead);  // how fast the speed grows is gain / to
  double const middle = gain >= 0 && to > 0 ? speed_after(speed, div_rn(gain, to), linear, quadratic, 0.5)
                                            : speed_after(length_of(v + scaled(push, 0.5)), 0, linear, quadratic, 0.5);
  vec3<double> const after = eased(v, push, linear + mul_rn(quadratic, middle));
  double const terminal = div_rn(2 * a, linear + sqrt_rn(mul_rn(linear, linear) + mul_rn(4 * quadratic, a)));
  double const found = length_of(after), most = max(speed, terminal);
  return found > most ? scaled(after, div_rn(most, found)) : after;
}

/// The velocity after the time `dt` in a medium. `before`: at its beginning; `pushed`: after what else accelerates.
template <class S>
COLLIDE_HD_INLINE vec3<S> velocity_in(medium const& m, vec3<S> const& before, vec3<S> const& pushed, S dt) {
  if (m.linear == 0 && m.quadratic == 0) return pushed;
  double const time = static_cast<double>(dt);
  vec3<double> const from = before.template cast<double>(), push = pushed.template cast<double>() - from;
  return rounded_to<S>(m.flow + resisted(from - m.flow, push, mul_rn(m.linear, time), mul_rn(m.quadratic, time)));
}

/// One medium in place of several: it resists a velocity as they do together.
class media {
 public:
  COLLIDE_HD_INLINE explicit media(vec3<double> const& velocity) : velocity_{velocity} {}

  COLLIDE_HD_INLINE void add(medium const& m) {
    vec3<double> const v = velocity_ - m.flow;
    resisting_ += scaled(v, m.linear + mul_rn(m.quadratic, length_of(v)));
    sum_.linear += m.linear;
    sum_.quadratic += m.quadratic;
    sum_.flow = m.flow;
    ++count_;
  }
  COLLIDE_HD_INLINE medium sum() const {
    if (count_ == 1) return sum_;
    double const force = length_of(resisting_),
                 root = mul_rn(sum_.linear, sum_.linear) + mul_rn(4 * sum_.quadratic, force);
    double const speed_by_force = force > 0 ? div_rn(2, sum_.linear + sqrt_rn(root)) : 0;
    return {sum_.linear, sum_.quadratic, velocity_ - scaled(resisting_, speed_by_force)};
  }

 private:
  vec3<double> velocity_, resisting_ = {0, 0, 0};
  medium sum_;
  int count_ = 0;
};

}  // namespace collide::detail
