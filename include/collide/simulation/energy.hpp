/// \file
/// The energy of a simulation's particles, and what their contacts are like.
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include <collide/effects/contact_work.hpp>
#include <collide/effects/granular_contact.hpp>
#include <collide/effects/gravity.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/simulation.cuh>
#include <collide/simulation/checkpoint.hpp>
#include <collide/simulation/detail/overlaps_on_host.hpp>

namespace collide {

/// The result of `energy`, in mass times length squared per time squared.
struct energy_sums {
  double kinetic = 0;     ///< of the motion of centres
  double rotational = 0;  ///< of solid spheres that turn; 0 in scenes in which none turns
  double elastic = 0;     ///< of the normal springs of `sphere_contact` and `granular_contact`, those at the mesh too
  double potential = 0;   ///< in `gravity`, 0 at the origin
  double tangential = 0;  ///< of the springs of `mindlin`, as spheres last met each other and the mesh
  double damping = 0;     ///< lost along normals since the springs were relaxed, what the step makes of springs too
  double sliding = 0;     ///< lost to sliding, and to the dashpots along the surface
  double rolling = 0;     ///< lost to rolling and torsion, and held by springs against them
  double given = 0;       ///< work that walls have done on particles

  double total() const { return kinetic + rotational + elastic + potential + tangential; }  ///< of energies
  double lost() const { return damping + sliding + rolling; }                               ///< all that is
  /// The sum that stays the same where only contacts, walls and `gravity` act on particles.
  double balance() const { return total() + lost() - given; }
};

/// The result of `contact_report` on the contacts between spheres.
struct contact_counts {
  std::size_t contacts = 0;    ///< pairs that overlap
  double coordination = 0;     ///< contacts of a particle, the mean of all that are alive
  std::size_t deep = 0;        ///< contacts whose overlap is above a fifth of the smaller radius: too soft
  double largest_overlap = 0;  ///< over the smaller radius

  /// Throws `error` if a contact is deep.
  void require_shallow() const {
    if (deep > 0)
      throw error("collide: contact_report: " + std::to_string(deep) +
                  " contacts overlap by more than a fifth of the smaller radius, the deepest by " +
                  std::to_string(largest_overlap) +
                  " of it: make the solids stiffer, or let fewer particles overlap to begin with");
  }
};

namespace detail {

template <class E>
inline constexpr bool is_granular = false;
template <class... Law>
inline constexpr bool is_granular<granular_contact<Law...>> = true;

/// The first of the effects that is `granular_contact`, or `none`.
template <class... E>
using granular_of = first_of<none, choice<is_granular<E>, E>...>;

/// Particles on the host, in double.
template <class Detector, class... Effect>
struct particles_on_host {
  using list = typename simulation<Detector, Effect...>::columns;
  using S = typename Detector::scalar;

  std::vector<S> x, v, w, r;
  std::vector<std::uint8_t> is_there, solid;
  std::vector<id> clump;                           ///< `in_clump`, by places
  std::vector<S> clump_masses;                     ///< `clump_mass`
  std::vector<std::pair<id, std::size_t>> places;  ///< by numbers among the particles of all ranks
  typename simulation<Detector, Effect...>::effects_type::space_type space;

  explicit particles_on_host(simulation<Detector, Effect...> const& of)
      : x{of.template to_host<position>()},
        v{of.template to_host<velocity>()},
        w(x.size()),
        r(of.size(), of.state().common_radius),
        is_there(of.size(), 1),
        solid(of.size(), 0),
        clump_masses(of.size(), S(1)),
        space(typename simulation<Detector, Effect...>::effects_type(of.template effect<Effect>()...).space()) {
    if constexpr (contains<list, radius>) r = of.template to_host<radius>();
    if constexpr (contains<list, angular_velocity>) w = of.template to_host<angular_velocity>();
    if constexpr (contains<list, alive>) is_there = of.template to_host<alive>();
    if constexpr (contains<list, material>) solid = of.template to_host<material>();
    if constexpr (contains<list, in_clump>) {
      clump = of.template to_host<in_clump>();
      clump_masses = of.template to_host<clump_mass>();
    }
    if constexpr (contains<list, global_number>) {
      for (id const number : of.template to_host<global_number>()) places.emplace_back(number, places.size());
      std::sort(places.begin(), places.end());
    }
    for (id& first : clump)
      if (first != no_id) first = static_cast<id>(place_of(first));
  }

  /// The place of the particle of a number by which neighbours meet; behind all if it is on another rank.
  std::size_t place_of(id number) const {
    if constexpr (!contains<list, global_number>) return number;
    auto const found = std::lower_bound(places.begin(), places.end(), std::pair(number, std::size_t{0}));
    return found != places.end() && found->first == number ? found->second : r.size();
  }

  /// True of a sphere that is not a grain by itself.
  bool is_of_clump(std::size_t i) const { return !clump.empty() && clump[i] != no_id; }

  static vec3<double> at(std::vector<S> const& all, std::size_t i) {
    return vec3<S>(all[3 * i], all[3 * i + 1], all[3 * i + 2]).template cast<double>();
  }
  double radius_of(std::size_t i) const { return static_cast<double>(r[i]); }

  /// As materials see a particle.
  struct made_of {
    std::uint8_t number;
    COLLIDE_HD std::uint8_t operator[](material) const { return number; }
  };
  made_of solid_of(std::size_t i) const { return {solid[i]}; }

  /// From the centre of one sphere to that of another.
  vec3<double> between(std::size_t i, std::size_t k) const {
    auto const in_space = [&](std::size_t n) { return vec3<S>(x[3 * n], x[3 * n + 1], x[3 * n + 2]); };
    return apart(space, in_space(i), in_space(k)).template cast<double>();
  }
  /// The overlap of two spheres; below 0 if they are apart.
  double overlap_of(std::size_t i, std::size_t k) const { return radius_of(i) + radius_of(k) - between(i, k).norm(); }
  /// Two spheres, as springs see them.
  granular_pair<double> pair_of(std::size_t i, std::size_t k, double overlap) const {
    granular_pair<double> p{};
    double const a = radius_of(i), b = radius_of(k);
    p.overlap = overlap;
    p.radius = a * b / (a + b);
    return p;
  }

  /// f(a, b, overlap) for each two that overlap, `swept_point`s: a sweep along x. O(n log n) and the pairs that are
  /// near along x.
  template <class F>
  void for_each_overlap(F const& f) const {
    std::vector<S> there = x;
    for (std::size_t i = 0; i < r.size(); ++i)
      if (is_there[i] == 0) there[3 * i] = std::numeric_limits<S>::quiet_NaN();
    detail::for_each_overlap(there, r, space, [&](swept_point const& a, swept_point const& b, double overlap) {
      if (!is_of_clump(a.number) || clump[a.number] != clump[b.number]) f(a, b, overlap);
    });
  }
  /// f(i, k, overlap) for each two that overlap.
  template <class F>
  void for_each_contact(F const& f) const {
    for_each_overlap(
        [&](swept_point const& a, swept_point const& b, double overlap) { f(a.number, b.number, overlap); });
  }
};

/// The energy of a law's normal spring, without cohesion: 2/5 force overlap of `hertz`, 1/2 of `linear`.
template <class Law, class S>
COLLIDE_HD_INLINE S elastic_energy(normal_force<S> const& force, granular_pair<S> const& p) {
  return S(decltype(Law::normal)::is_hertzian ? 0.4 : 0.5) * force.elastic * p.overlap;
}

/// The force of the normal spring of two spheres, without damping and cohesion.
template <class Law, class Particles>
double elastic_force(Law const& law, Particles const& all, std::size_t i, std::size_t k, double overlap) {
  return law.normal.force(all.pair_of(i, k, overlap), law.made_of.between(all.solid_of(i), all.solid_of(k))).elastic;
}

/// The energy of the normal spring of two spheres.
template <class Law, class Particles>
double elastic_energy(Law const& law, Particles const& all, std::size_t i, std::size_t k, double overlap) {
  granular_pair<double> const p = all.pair_of(i, k, overlap);
  return elastic_energy<Law>(law.normal.force(p, law.made_of.between(all.solid_of(i), all.solid_of(k))), p);
}

template <class Law, class P, class N, class Memory>
using spring_energy_call =
    decltype(std::declval<Law const&>().energy(std::declval<P const&>(), std::declval<contact_material const&>(),
                                               std::declval<N const&>(), std::declval<Memory const&>()));

/// f(i, k, what the contact remembers) for each two that touch, of a law. Of a law that remembers nothing 0.
template <class Law, class Detector, class... Effect, class F>
void for_each_contact_of(simulation<Detector, Effect...> const& of, particles_on_host<Detector, Effect...> const& all,
                         F const& f) {
  if constexpr (Law::is_memoryless) {
    all.for_each_contact([&](std::size_t i, std::size_t k, double) { f(i, k, 0); });
  } else {
    using remembered = typename simulation<Detector, Effect...>::effects_type::remembered;
    using record_type = contact_record<double, remembered>;
    using values_type = contact_values<double, remembered>;
    auto const saved = checkpoint<Detector, Effect...>::contacts_between_particles(of.internals());
    std::size_t at = 0;
    for (std::size_t i = 0; i < saved.counts.size(); ++i) {
      for (std::uint32_t n = 0; n < saved.counts[i]; ++n, ++at) {
        std::size_t const k = all.place_of(saved.others[at]);
        if (k == all.r.size() || k < i || all.is_there[i] == 0 || all.is_there[k] == 0) continue;
        record_type record;
        for (std::size_t w = 0; w < std::size_t(values_type::width); ++w)
          record.numbers[w] = static_cast<double>(saved.values[at * std::size_t(values_type::width) + w]);
        values_type values = record.values();
        f(i, k, contact_access<typename Law::remembers::list, values_type, double>(values, 0));
      }
    }
  }
}

/// The energy of the tangential springs between spheres, of which both of a pair know. 0 if the law has none.
template <class Law, class Detector, class... Effect>
double tangential_energy(Law const& law, simulation<Detector, Effect...> const& of,
                         particles_on_host<Detector, Effect...> const& all) {
  using values_type = contact_values<double, typename simulation<Detector, Effect...>::effects_type::remembered>;
  using memory_type = contact_access<typename Law::remembers::list, values_type, double>;
  double sum = 0;
  if constexpr (is_valid<spring_energy_call, decltype(law.tangential), granular_pair<double>, normal_force<double>,
                         memory_type>) {
    for_each_contact_of<Law>(of, all, [&](std::size_t i, std::size_t k, auto const& memory) {
      granular_pair<double> const p = all.pair_of(i, k, all.overlap_of(i, k));
      auto const& m = law.made_of.between(all.solid_of(i), all.solid_of(k));
      normal_force<double> force = law.normal.force(p, m);
      law.cohesion.pull(force, p, m, memory);
      sum += law.tangential.energy(p, m, force, memory);
    });
  }
  return sum;
}

/// The energy of springs.
struct spring_energies {
  double elastic = 0, tangential = 0;

  COLLIDE_HD_INLINE spring_energies& operator+=(spring_energies const& other) {
    elastic += other.elastic;
    tangential += other.tangential;
    return *this;
  }
};

/// The energy of a law's springs between a particle and the mesh: for `sum_over_mesh_contacts`.
template <class Law>
struct springs_at_mesh {
  Law law;

  template <class Seen, class S, class Values>
  COLLIDE_HD_INLINE spring_energies operator()(Seen const& self, mesh_overlap<S> const& wall, Values& values) const {
    spring_energies const found = at(self, wall, wall.overlap, values);
    if (!wall.has_saddle()) return found;
    spring_energies const at_saddle = at(self, wall, wall.saddle_overlap, values);
    return {found.elastic - at_saddle.elastic, found.tangential - at_saddle.tangential};
  }

 private:
  template <class Seen, class S, class Values>
  COLLIDE_HD_INLINE spring_energies at(Seen const& self, mesh_overlap<S> const& wall, S overlap, Values& values) const {
    granular_pair<S> p{};
    p.overlap = detail::max(overlap, S(0));
    p.radius = self.the_radius;
    p.is_wall = true;
    auto const& m = law.made_of.with_wall(self, wall.triangle, wall.body);
    normal_force<S> force = law.normal.force(p, m);
    spring_energies found;
    found.elastic = static_cast<double>(elastic_energy<Law>(force, p));
    using memory_type = contact_access<typename Law::remembers::list, Values, S>;
    if constexpr (is_valid<spring_energy_call, decltype(law.tangential), granular_pair<S>, normal_force<S>,
                           memory_type>) {
      memory_type const memory(values, S(0));
      law.cohesion.pull(force, p, m, memory);
      found.tangential = static_cast<double>(law.tangential.energy(p, m, force, memory));
    }
    return found;
  }
};

/// The sums of f(particle, overlap, what it remembers) over the contacts of each particle with the mesh. Waits.
template <class Sum, class Detector, class... Effect, class F>
std::vector<Sum> sums_over_mesh_contacts(simulation<Detector, Effect...> const& of, F const& f) {
  using S = typename Detector::scalar;
  auto const& s = of.internals();
  auto const triangles = mesh_ref<true>(s, S(0));
  auto const memory = s.surfaces.ref(s.particles.size);
  std::vector<Sum> found(s.particles.size);
  if (s.mesh.size() == 0 || found.empty()) return found;
  buffer<Sum> sums;
  sums.reserve(s.space.resource(), found.size());
  using kernel = sum_over_mesh_contacts<S, typename simulation<Detector, Effect...>::effects_type,
                                        std::decay_t<decltype(triangles)>, std::decay_t<decltype(memory)>, F, Sum>;
  s.space.fill(s.pressing_counts.data() + 1, 0, sizeof(std::uint32_t));  // the pool is empty
  s.space.for_each(
      found.size(),
      kernel{
          {s.particles, s.effects, triangles, memory, {}, overlap_pool_of(s), S(0), meeting::of_all}, f, sums.data()});
  s.space.copy_to_host(found.data(), sums.data(), found.size());
  return found;
}

/// Adds the energies of the motion of clumps, and in a field; density(i) is that of sphere i.
template <class Detector, class... Effect, class Density>
void add_clumps(energy_sums& to, simulation<Detector, Effect...> const& of,
                particles_on_host<Detector, Effect...> const& all, vec3<double> const& field, Density const& density) {
  auto const x = of.template to_host<clump_centre>(), v = of.template to_host<clump_velocity>(),
             l = of.template to_host<clump_momentum>(), inertia = of.template to_host<clump_inertia>();
  for (std::size_t i = 0; i < all.clump.size(); ++i) {
    if (all.clump[i] != i || all.is_there[i] == 0) continue;
    double const m = sphere_mass(density(i), static_cast<double>(inertia[4 * i + 3]));
    to.kinetic += 0.5 * m * all.at(v, i).squaredNorm();
    to.rotational += 0.5 * m * all.at(l, i).dot(all.at(all.w, i));
    to.potential -= m * field.dot(all.at(x, i));
  }
}

}  // namespace detail

/// The energy of all particles that are alive, those that sleep included; NaN if one is nowhere. With
/// `semi_implicit_euler` velocities are those of half a step before the positions, and the sum goes up and down with
/// them. `density` is the mass per volume, 0 that of `granular_contact`'s materials or of `sphere_contact`; `error` if
/// there is none, or it is not above 0 and finite. What springs against rolling and cohesion hold is not in it. In a
/// scene with `contact_work` the work is there too, that was lost and given. Of `local()` of ranks it is that of the
/// rank's own particles, without springs to those of others. Waits, and copies columns to the host. O(n log n), and the
/// pairs that are near along x.
template <class Detector, class... Effect>
energy_sums energy(simulation<Detector, Effect...> const& of, double density = 0) {
  using law_type = typename detail::granular_of<Effect...>::type;
  constexpr bool is_granular = detail::is_granular<law_type>;
  gravity field{0, 0, 0};
  sphere_contact springs{0, 0, 0, 0, density};
  if constexpr ((std::is_same<Effect, gravity>::value || ...)) field = of.template effect<gravity>();
  if constexpr ((std::is_same<Effect, sphere_contact>::value || ...)) springs = of.template effect<sphere_contact>();
  bool const is_of_material = is_granular && density == 0;
  if (density == 0) density = springs.density;
  detail::check_parameter(is_of_material || detail::is_positive(density),
                          "energy: density is above 0: give it, or name sphere_contact");
  detail::particles_on_host<Detector, Effect...> const all(of);
  energy_sums sum;
  vec3<double> const pull(field.x, field.y, field.z);
  auto const density_of = [&](std::size_t i) {
    if constexpr (is_granular) {
      if (is_of_material) return of.template effect<law_type>().made_of.template density_of<double>(all.solid_of(i));
    }
    return density;
  };
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (all.is_there[i] == 0 || all.is_of_clump(i)) continue;
    double const r = all.radius_of(i), m = detail::sphere_mass(density_of(i), r);
    sum.kinetic += 0.5 * m * all.at(all.v, i).squaredNorm();
    sum.rotational += 0.2 * m * r * r * all.at(all.w, i).squaredNorm();
    sum.potential -= m * pull.dot(all.at(all.x, i));
  }
  if constexpr (detail::contains<typename simulation<Detector, Effect...>::columns, in_clump>)
    add_clumps(sum, of, all, pull, density_of);
  if (is_granular || springs.stiffness > 0)
    all.for_each_contact([&](std::size_t i, std::size_t k, double overlap) {
      sum.elastic += 0.5 * springs.stiffness * overlap * overlap;
      if constexpr (is_granular) sum.elastic += elastic_energy(of.template effect<law_type>(), all, i, k, overlap);
    });
  if constexpr (is_granular) {
    law_type const& law = of.template effect<law_type>();
    sum.tangential = tangential_energy(law, of, all);
    auto const at_mesh =
        detail::sums_over_mesh_contacts<detail::spring_energies>(of, detail::springs_at_mesh<law_type>{law});
    for (std::size_t i = 0; i < at_mesh.size(); ++i) {
      if (all.is_there[i] == 0) continue;
      sum.elastic += at_mesh[i].elastic;
      sum.tangential += at_mesh[i].tangential;
    }
  }
  if constexpr (detail::contains<typename simulation<Detector, Effect...>::columns, normal_work>) {
    auto const sum_of = [&](auto column) {
      std::vector<double> const work = of.template to_host<decltype(column)>();
      double found = 0;
      for (std::size_t i = 0; i < work.size(); ++i) found += all.is_there[i] != 0 ? work[i] : 0;
      return found;
    };
    sum.damping = sum_of(normal_work{}) - sum.elastic;
    sum.sliding = sum_of(sliding_work{}) - sum.tangential;
    sum.rolling = sum_of(rolling_work{});
    sum.given = sum_of(wall_work{});
  }
  return sum;
}

/// Reports how many contacts there are between spheres, and how deep: look at it when a scene is new. Waits, and copies
/// columns to the host. O(n log n), and the pairs that are near along x.
template <class Detector, class... Effect>
contact_counts contact_report(simulation<Detector, Effect...> const& of) {
  detail::particles_on_host<Detector, Effect...> const all(of);
  contact_counts found;
  all.for_each_contact([&](std::size_t i, std::size_t k, double overlap) {
    double const ratio = overlap / std::min(all.radius_of(i), all.radius_of(k));
    ++found.contacts;
    found.deep += ratio > 0.2;
    found.largest_overlap = std::max(found.largest_overlap, ratio);
  });
  auto const living = std::count_if(all.is_there.begin(), all.is_there.end(), [](auto there) { return there != 0; });
  if (living > 0) found.coordination = 2 * static_cast<double>(found.contacts) / static_cast<double>(living);
  return found;
}

}  // namespace collide
