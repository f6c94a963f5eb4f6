/// \file
/// Products of vectors whose components are exact numbers, as sums of products of components: what `exact_sum` sums.
///
/// Each function calls add(weight, factors...) for every product; `weight` and the further factors multiply all of it.
#pragma once

#include <collide/detail/numeric/exact_sum.hpp>

namespace collide::detail {

template <int Room>
using exact_vector = exact_number<Room>[3];

/// p.q
template <class Add, int P, int Q, class... Factors>
COLLIDE_HD void sum_dot(int weight, exact_number<P> const (&p)[3], exact_number<Q> const (&q)[3], Add const& add,
                        Factors const&... factors) {
  for (int k = 0; k < 3; ++k) add(weight, p[k], q[k], factors...);
}

/// Component k of p x q.
template <class Add, int P, int Q>
COLLIDE_HD void sum_cross(int k, int weight, exact_number<P> const (&p)[3], exact_number<Q> const (&q)[3],
                          Add const& add) {
  int const i = (k + 1) % 3, j = (k + 2) % 3;
  add(weight, p[i], q[j]);
  add(-weight, p[j], q[i]);
}

/// |p x q|^2
template <class Add, int P, int Q, class... Factors>
COLLIDE_HD void sum_cross_squared(int weight, exact_number<P> const (&p)[3], exact_number<Q> const (&q)[3],
                                  Add const& add, Factors const&... factors) {
  for (int k = 0; k < 3; ++k) {
    int const l = (k + 1) % 3;
    add(weight, p[k], p[k], q[l], q[l], factors...);
    add(weight, p[l], p[l], q[k], q[k], factors...);
    add(-2 * weight, p[k], p[l], q[k], q[l], factors...);
  }
}

/// (v x e).(p x q)
template <class Add, int V, int E, int P, int Q>
COLLIDE_HD void sum_cross_dot_cross(int weight, exact_number<V> const (&v)[3], exact_number<E> const (&e)[3],
                                    exact_number<P> const (&p)[3], exact_number<Q> const (&q)[3], Add const& add) {
  for (int k = 0; k < 3; ++k) {
    int const l = (k + 1) % 3;
    add(weight, v[k], e[l], p[k], q[l]);
    add(-weight, v[k], e[l], p[l], q[k]);
    add(-weight, v[l], e[k], p[k], q[l]);
    add(weight, v[l], e[k], p[l], q[k]);
  }
}

/// v . (p x q): six products, every other one negative.
template <class Add, int V, int P, int Q>
COLLIDE_HD void sum_determinant(int weight, exact_number<V> const (&v)[3], exact_number<P> const (&p)[3],
                                exact_number<Q> const (&q)[3], Add const& add) {
  for (int s = 0; s < 6; ++s) {
    int const i = s / 2, j = (i + 1 + s % 2) % 3, k = 3 - i - j;
    add(s % 2 == 0 ? weight : -weight, v[i], p[j], q[k]);
  }
}

/// (v . (p x q))^2
template <class Add, int V, int P, int Q>
COLLIDE_HD void sum_determinant_squared(int weight, exact_number<V> const (&v)[3], exact_number<P> const (&p)[3],
                                        exact_number<Q> const (&q)[3], Add const& add) {
  for (int s = 0; s < 6; ++s) {
    int const i = s / 2, j = (i + 1 + s % 2) % 3, k = 3 - i - j;
    for (int t = 0; t <= s; ++t) {
      int const l = t / 2, m = (l + 1 + t % 2) % 3, n = 3 - l - m;
      add(((s + t) % 2 == 0 ? weight : -weight) * (s == t ? 1 : 2), v[i], p[j], q[k], v[l], p[m], q[n]);
    }
  }
}

}  // namespace collide::detail
