/// \file
/// Motion against the resistance of a medium: dv/dt = a - (linear + quadratic |v - flow|) (v - flow), in closed form.
/// Below, velocities are relative to the medium, and the step is the unit of time.
#pragma once

#include <collide/exact/detail/numeric/elementary.hpp>

namespace collide::detail {

struct medium {
  double linear = 0;     ///< per time
  double quadratic = 0;  ///< per length
  vec3<double> flow = {0, 0, 0};
};
struct medium_at_rest : medium {};

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

/// The part of a medium's resistance in a step that is the same for all particles.
struct resistance_in_step {
  double time = -1;                  ///< of the step
  double linear = 0, quadratic = 0;  ///< of the medium, times the step
  double left = 1, gained = 1;       ///< what is left of a velocity, and gained of a push, if it is linear
  double gentle = 0;                 ///< square of the push up to which `gentle_response` is meant

  resistance_in_step() = default;
  COLLIDE_HD_INLINE resistance_in_step(double by_time, double by_length, double step)
      : time{step}, linear{mul_rn(by_time, step)}, quadratic{mul_rn(by_length, step)} {
    decay const d = decay_after(linear);
    left = d.left;
    if (linear > 0) gained = div_rn(d.lost, linear);
    gentle = linear <= 0.6 ? div_rn(0.01, mul_rn(quadratic, quadratic)) : -1;
  }
  COLLIDE_HD_INLINE bool is_none() const { return linear == 0 && quadratic == 0; }
};

/// How much of its velocity a particle keeps in a step, and how much it gets of a push: that by which all else would
/// have changed its velocity.
struct response {
  double of_velocity, of_push;
  double margin = 0;  ///< negative if it is not right

  COLLIDE_HD_INLINE vec3<double> operator()(vec3<double> const& v, vec3<double> const& push) const {
    return scaled(v, of_velocity) + scaled(push, of_push);
  }
};

/// 1 / sqrt(x) to within 4 units in the last place, of normal numbers; NaN of an infinite one. A loop of it has no
/// branch and no call, and is vectorised.
COLLIDE_HD_INLINE double reciprocal_root(double x) {
  double r = from_bits<double>(0x5fe6eb50c7b537a9u - (to_bits(x) >> 1));
  for (int i = 0; i < 4; ++i) r = mul_rn(r, 1.5 - mul_rn(mul_rn(x / 2, r), r));  // Newton: from 3 % to 1e-21
  return r;
}

/// The result of `resisted_strongly`, where a step changes little: without a branch, in sums, products and one
/// quotient.
///
/// Along v the motion has the closed form v' = (v + (a - h v) T) / (1 + (h + q |v|) T) with T = tanh(r) / r, h = half
/// of linear, r^2 = h^2 + q a (negative: tan). T is a quotient of polynomials in r^2, the seventh of its continued
/// fraction, right to rounding for |r^2| < 0.2. Of a push across v the mean of what is left of a velocity at the
/// beginning and at the end remains. It is wrong where the particle turns around, or gets faster than the terminal
/// velocity.
///
/// \param vv, va, aa  the scalar products of velocity and push
COLLIDE_HD_INLINE response gentle_response(double vv, double va, double aa, resistance_in_step const& r) {
  double const h = r.linear / 2, q = r.quadratic;
  bool const moves = vv > 1e-200;  // else it goes along the push
  double const xx = select(moves, vv, aa) + 1e-200, inverse = reciprocal_root(xx), length = mul_rn(xx, inverse);
  double const along = mul_rn(select(moves, va, aa), inverse), share = mul_rn(along, inverse);
  double const y = mul_rn(h, h) + mul_rn(q, along);
  double const top = 135135 + mul_rn(y, 17325 + mul_rn(y, 378 + y));  // T = top / bottom
  double const bottom = 135135 + mul_rn(y, 62370 + mul_rn(y, 3150 + mul_rn(28, y)));
  double const kept = bottom - mul_rn(h, top), speed = select(moves, length, 0.0);
  double const scale = div_rn(1, bottom + mul_rn(h + mul_rn(q, speed), top));
  double const left = mul_rn(kept, scale), gained = mul_rn(top, scale), across = select(moves, 0.5 + left / 2, gained);
  double const of_v = left + mul_rn(share, gained - across);
  double const ss =
      mul_rn(mul_rn(of_v, of_v), vv) + mul_rn(across, mul_rn(2 * of_v, va) + mul_rn(across, aa));  // speed afterwards
  double const limit = mul_rn(mul_rn(ss, inverse) + length, 0.5);                                  // is not above this
  double const force =
      mul_rn(r.linear, r.linear) + mul_rn(q, mul_rn(2 * r.linear, limit) + mul_rn(q, ss));  // square, by speed
  constexpr double rounding = 1 + 8e-15;
  int const bounded = int{ss <= mul_rn(vv, rounding)} | int{mul_rn(ss, force) <= mul_rn(aa, rounding)};
  bool const right = (int{aa <= r.gentle} & int{kept + mul_rn(share, top) >= 0} & bounded) != 0;
  return {of_v, across, select(right, 0.0, -1.0)};
}

/// The velocity after a step against any resistance: exact where velocity and push are parallel. Else of second order;
/// never faster than both at first and in the end.
COLLIDE_HD_RARE vec3<double> resisted_strongly(vec3<double> const& v, vec3<double> const& push, double linear,
                                               double quadratic) {
  double const a = length_of(push), speed = length_of(v);
  vec3<double> const along = a > 0 ? scaled(push, div_rn(1, a)) : scaled(v, speed > 0 ? div_rn(1, speed) : 0);
  double const along_it = dot(v, along);
  if (length_of<double>(v - scaled(along, along_it)) <= 1e-15 * speed) {
    return scaled(along, velocity_along(along_it, a, linear, quadratic));
  }
  vec3<double> const ahead = v + push;
  double const gain = dot(push, ahead), to = length_of(ahead);  // how fast the speed grows is gain / to
  double const middle = gain >= 0 && to > 0
                            ? speed_after(speed, div_rn(gain, to), linear, quadratic, 0.5)
                            : speed_after(length_of<double>(v + scaled(push, 0.5)), 0, linear, quadratic, 0.5);
  double const rate = linear + mul_rn(quadratic, middle);
  decay const d = decay_after(rate);
  vec3<double> const after = response{d.left, rate > 0 ? div_rn(d.lost, rate) : 1}(v, push);
  double const terminal = div_rn(2 * a, linear + sqrt_rn(mul_rn(linear, linear) + mul_rn(4 * quadratic, a)));
  double const found = length_of(after), limit = max(speed, terminal);
  return found > limit ? scaled(after, div_rn(limit, found)) : after;
}

/// The velocity after a step against any resistance: `resisted_strongly`, but exact if it is linear, and fast if the
/// step changes little.
COLLIDE_HD_INLINE vec3<double> resisted(vec3<double> const& v, vec3<double> const& push, resistance_in_step const& r) {
  response by{r.left, r.gained};
  if (r.quadratic != 0) by = gentle_response(dot(v, v), dot(v, push), dot(push, push), r);
  return by.margin >= 0 ? by(v, push) : resisted_strongly(v, push, r.linear, r.quadratic);
}

/// The velocity after a step in a medium. `before`: at its beginning; `pushed`: after what else accelerates.
template <class S>
COLLIDE_HD_INLINE vec3<S> velocity_in(resistance_in_step const& r, vec3<double> const& flow, vec3<S> const& before,
                                      vec3<S> const& pushed) {
  if (r.is_none()) return pushed;
  vec3<double> const from = before.template cast<double>();
  return rounded_to<S>(flow + resisted(from - flow, pushed.template cast<double>() - from, r));
}

/// Velocities of `N` particles after a step, for the vector unit of a CPU; `Flows`: the medium does not rest.
template <class S, unsigned N, bool Flows>
class velocities_in {
 public:
  // number by number: what has been written in fours is not read in eights, which takes as long as all of the rest
  COLLIDE_HD_INLINE void set_before(unsigned k, [[maybe_unused]] vec3<double> const& flow, vec3<S> const& velocity) {
    for (int d = 0; d < 3; ++d) {
      if constexpr (Flows) flow_[d][k] = flow[d];
      before_[d][k] = velocity[d];
    }
  }
  COLLIDE_HD_INLINE void set_pushed(unsigned k, vec3<S> const& velocity) {
    for (int d = 0; d < 3; ++d) pushed_[d][k] = velocity[d];
  }
  COLLIDE_HD_INLINE void find(resistance_in_step const& r) {
    resistance_in_step const in = r;
    for (unsigned k = 0; k < N; ++k) {
      double v[3], push[3];
      for (int d = 0; d < 3; ++d) {
        double const from = static_cast<double>(before_[d][k]);
        v[d] = from - flow(d, k);
        push[d] = static_cast<double>(pushed_[d][k]) - from;
      }
      response const by = gentle_response(product(v, v), product(v, push), product(push, push), in);
      for (int d = 0; d < 3; ++d) {
        after_[d][k] = static_cast<S>(flow(d, k) + (mul_rn(v[d], by.of_velocity) + mul_rn(push[d], by.of_push)));
      }
      margin_[k] = by.margin;
    }
  }
  COLLIDE_HD_INLINE void ease(resistance_in_step const& r) {
    double const left = r.left, gained = r.gained;
    for (int d = 0; d < 3; ++d) {
      for (unsigned k = 0; k < N; ++k) {
        double const from = static_cast<double>(before_[d][k]), v = from - flow(d, k);
        double const push = static_cast<double>(pushed_[d][k]) - from;
        after_[d][k] = static_cast<S>(flow(d, k) + (mul_rn(v, left) + mul_rn(push, gained)));
      }
    }
    for (unsigned k = 0; k < N; ++k) margin_[k] = 0;
  }
  COLLIDE_HD_INLINE void get(unsigned k, vec3<S>& velocity, resistance_in_step const& r) const {
    if (margin_[k] >= 0) {
      for (int d = 0; d < 3; ++d) velocity[d] = after_[d][k];
    } else {
      velocity = alone(k, r);
    }
  }
  /// To be called after `find` and `ease`: keeps a compiler from leaving out the rounding; see `rounded_to`.
  COLLIDE_HD_INLINE void keep() {
#if defined(__GNUC__) && !defined(__CUDA_ARCH__)
    __asm__("" : "+m"(after_));
#endif
  }

 private:
  static COLLIDE_HD_INLINE double product(double const (&a)[3], double const (&b)[3]) {
    return mul_rn(a[0], b[0]) + mul_rn(a[1], b[1]) + mul_rn(a[2], b[2]);
  }
  COLLIDE_HD_INLINE double flow([[maybe_unused]] int d, [[maybe_unused]] unsigned k) const {
    if constexpr (Flows) return flow_[d][k];
    return 0;
  }
  COLLIDE_HD_NOINLINE vec3<S> alone(unsigned k, resistance_in_step const& r) const {
    return velocity_in(r, vec3<double>(flow(0, k), flow(1, k), flow(2, k)), of(before_, k), of(pushed_, k));
  }
  static COLLIDE_HD_INLINE vec3<S> of(S const (&a)[3][N], unsigned k) { return {a[0][k], a[1][k], a[2][k]}; }

  S before_[3][N], pushed_[3][N], after_[3][N];
  double flow_[3][Flows ? N : 1], margin_[N];
};

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
  /// The velocity of the one medium that resists as all of them do together.
  COLLIDE_HD_INLINE vec3<double> flow() const {
    if (count_ == 1) return sum_.flow;
    double const force = length_of(resisting_),
                 root = mul_rn(sum_.linear, sum_.linear) + mul_rn(4 * sum_.quadratic, force);
    double const speed_by_force = force > 0 ? div_rn(2, sum_.linear + sqrt_rn(root)) : 0;
    return velocity_ - scaled(resisting_, speed_by_force);
  }

 private:
  vec3<double> velocity_, resisting_ = {0, 0, 0};
  medium sum_;
  int count_ = 0;
};

}  // namespace collide::detail
