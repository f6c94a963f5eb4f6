/// \file
/// Stress and other fields of grains: averages in a box, or coarse-grained on a grid.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <collide/simulation/energy.hpp>

namespace collide {

/// Fields of grains at a point, or their means in a box. Of a stress, entry [i][j] is the force along i through a
/// surface across j over its area; pressure is above 0.
struct grain_fields {
  double solid_fraction = 0;         ///< volume of spheres over volume
  double density = 0;                ///< mass over volume
  double coordination = 0;           ///< contacts of a sphere, those with the mesh too
  double velocity[3] = {};           ///< momentum over mass; 0 where there is no mass
  double contact_stress[3][3] = {};  ///< of forces of contact
  double kinetic_stress[3][3] = {};  ///< of velocities against the mean one

  /// A third of the trace of both stresses.
  double pressure() const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += (contact_stress[k][k] + kinetic_stress[k][k]) / 3;
    return sum;
  }
};

/// Points in the middle of equal cells of a box, for `stress`.
struct stress_grid {
  double lower[3];  ///< lower corner of the box
  double upper[3];  ///< upper corner
  int count[3];     ///< cells along each axis, above 0
  double reach;     ///< of the kernel, above 0: what is farther from a point does not count there; 2 to 4 diameters

  /// The number of points.
  std::size_t size() const { return std::size_t(count[0]) * std::size_t(count[1]) * std::size_t(count[2]); }
  /// The middle of a cell; x goes fastest.
  vec3<double> point(std::size_t cell) const {
    std::size_t const nx = std::size_t(count[0]), ny = std::size_t(count[1]);
    std::size_t const at[3] = {cell % nx, cell / nx % ny, cell / nx / ny};
    vec3<double> x;
    for (int k = 0; k < 3; ++k) x[k] = lower[k] + (upper[k] - lower[k]) * (static_cast<double>(at[k]) + 0.5) / count[k];
    return x;
  }
};

namespace detail {

/// A grain as laws see it, without a simulation.
template <class S>
struct lone_grain {
  S its_radius;
  vec3<S> x, v, w;
  std::uint8_t of_solid;
  std::size_t its_number;
  S of_clump = 1;  ///< `clump_mass`

  template <class C>
  static constexpr bool has = std::is_same<C, clump_mass>::value;
  COLLIDE_HD S radius() const { return its_radius; }
  COLLIDE_HD std::size_t number() const { return its_number; }
  COLLIDE_HD std::uint8_t operator[](material) const { return of_solid; }
  COLLIDE_HD S operator[](clump_mass) const { return of_clump; }
  COLLIDE_HD vec3<S> const& operator[](position) const { return x; }
  COLLIDE_HD vec3<S> const& operator[](velocity) const { return v; }
  COLLIDE_HD vec3<S> const& operator[](angular_velocity) const { return w; }
  COLLIDE_HD vec3<S>& operator[](velocity) { return v; }
  COLLIDE_HD vec3<S>& operator[](angular_velocity) { return w; }
};

/// Contacts of a grain with the mesh: how many, and the sums of force and of force times branch, over the grain's mass.
struct mesh_load {
  double contacts = 0, moment[3][3] = {}, force[3] = {};

  COLLIDE_HD_INLINE mesh_load& operator+=(mesh_load const& other) {
    add(other, 1, {0, 0, 0});
    return *this;
  }
  /// Adds a fraction of the load of a grain that is an arm away.
  COLLIDE_HD_INLINE void add(mesh_load const& other, double fraction, vec3<double> const& arm) {
    contacts += other.contacts;
    for (int i = 0; i < 3; ++i) {
      force[i] += fraction * other.force[i];
      for (int j = 0; j < 3; ++j) moment[i][j] += fraction * (other.moment[i][j] - other.force[i] * arm[j]);
    }
  }
};

/// For `sum_over_mesh_contacts`.
template <class Law>
struct load_of_mesh {
  Law law;

  template <class Seen, class S, class Values>
  COLLIDE_HD_INLINE mesh_load operator()(Seen const& self, mesh_overlap<S> const& wall, Values& values) const {
    lone_grain<S> grain{self.the_radius, self[position{}], self[velocity{}], {S(0), S(0), S(0)}, 0, 0};
    if constexpr (contains<typename Seen::list, angular_velocity>) grain.w = self[angular_velocity{}];
    if constexpr (contains<typename Seen::list, material>) grain.of_solid = self[material{}];
    if constexpr (contains<typename Seen::list, clump_mass>) grain.of_clump = self[clump_mass{}];
    lone_grain<S> pushed = grain;
    bool touches = wall.overlap > 0;
    if constexpr (Law::is_memoryless) {
      law.on_mesh_overlap(pushed, grain, wall, S(1));
    } else {
      using memory_type = contact_access<typename Law::remembers::list, Values, S>;
      touches = law.on_mesh_overlap(pushed, grain, wall, memory_type(values, S(0)), S(1));
    }
    mesh_load found;
    found.contacts = touches ? 1 : 0;
    double const arm = static_cast<double>(self.the_radius - wall.overlap);
    for (int i = 0; i < 3; ++i) {
      found.force[i] = static_cast<double>(pushed.v[i] - grain.v[i]);
      for (int j = 0; j < 3; ++j) found.moment[i][j] = found.force[i] * static_cast<double>(wall.normal[j]) * arm;
    }
    return found;
  }
};

/// f(i, k, from k to i, force on i) for each two grains of a simulation that touch: the law's forces where grains are.
template <class Detector, class... Effect, class F>
void for_each_force(simulation<Detector, Effect...> const& of, particles_on_host<Detector, Effect...> const& all,
                    F const& f) {
  using law_type = typename granular_of<Effect...>::type;
  static_assert(is_granular<law_type>, "collide: stress is that of granular_contact: name it in the scene");
  law_type const& law = of.template effect<law_type>();
  auto const grain_of = [&](std::size_t i) {
    return lone_grain<double>{all.radius_of(i),
                              all.at(all.x, i),
                              all.at(all.v, i),
                              all.at(all.w, i),
                              all.solid[i],
                              i,
                              static_cast<double>(all.clump_masses[i])};
  };
  for_each_contact_of<law_type>(of, all, [&](std::size_t i, std::size_t k, [[maybe_unused]] auto const& memory) {
    lone_grain<double> const own = grain_of(i);
    lone_grain<double> other = grain_of(k);
    vec3<double> const branch = -all.between(i, k);
    other.x = own.x - branch;
    lone_grain<double> pushed = own;
    if constexpr (law_type::is_memoryless) {
      law.on_pair_contact(pushed, own, other, 1.0);
    } else {
      law.on_pair_contact(pushed, own, other, memory, 1.0);
    }
    double const mass = sphere_mass(law.made_of.template density_of<double>(own), own.its_radius);
    f(i, k, branch, vec3<double>((pushed.v - own.v) * mass));
  });
}

/// Sums of fields, of which kernels say how much of a grain, and of a line between two, counts at a point.
struct field_sums {
  double volume = 0, mass = 0, grains = 0, contacts = 0, momentum[3] = {}, moments[3][3] = {}, flux[3][3] = {};

  void add_grain(double weight, double of_volume, double of_mass, mesh_load const& load, vec3<double> const& v) {
    volume += weight * of_volume, mass += weight * of_mass, grains += weight, contacts += weight * load.contacts;
    for (int i = 0; i < 3; ++i) {
      momentum[i] += weight * of_mass * v[i];
      for (int j = 0; j < 3; ++j) {
        flux[i][j] += weight * of_mass * v[i] * v[j];
        moments[i][j] += weight * of_mass * load.moment[i][j];
      }
    }
  }
  void add_force(double weight, vec3<double> const& force, vec3<double> const& branch) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) moments[i][j] += weight * force[i] * branch[j];
  }
  grain_fields fields() const {
    grain_fields f;
    f.solid_fraction = volume;
    f.density = mass;
    f.coordination = grains > 0 ? contacts / grains : 0;
    for (int i = 0; i < 3; ++i) f.velocity[i] = mass > 0 ? momentum[i] / mass : 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        f.contact_stress[i][j] = moments[i][j];
        f.kinetic_stress[i][j] = flux[i][j] - momentum[i] * f.velocity[j];
      }
    return f;
  }
};

/// The grain of each sphere: itself, or a clump.
template <class Detector, class... Effect>
struct grains_of_spheres {
  using particles = particles_on_host<Detector, Effect...>;
  particles const& all;
  std::vector<std::size_t> first;           ///< sphere of the grain
  std::vector<vec3<double>> arms;           ///< from the grain's centre
  std::vector<typename particles::S> x, v;  ///< of the grain, at its first sphere

  grains_of_spheres(simulation<Detector, Effect...> const& of, particles const& on_host)
      : all{on_host}, first(of.size()), arms(of.size(), vec3<double>(0, 0, 0)), x{all.x}, v{all.v} {
    for (std::size_t i = 0; i < of.size(); ++i) first[i] = all.is_of_clump(i) ? all.clump[i] : i;
    if constexpr (contains<typename simulation<Detector, Effect...>::columns, in_clump>) {
      auto const q = of.template to_host<clump_rotation>(), offset = of.template to_host<clump_offset>(),
                 at = of.template to_host<clump_centre>(), moves = of.template to_host<clump_velocity>();
      for (std::size_t i = 0; i < of.size(); ++i) {
        if (!all.is_of_clump(i)) continue;
        several<double, 4> turn;
        for (std::size_t k = 0; k < 4; ++k) turn.of[k] = static_cast<double>(q[4 * first[i] + k]);
        arms[i] = turned_axes<double>(turn).to_space(all.at(offset, i));
        for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) x[k] = at[k], v[k] = moves[k];
      }
    }
  }
  vec3<double> centre(std::size_t i) const { return all.at(x, first[i]); }
  vec3<double> velocity(std::size_t i) const { return all.at(v, first[i]); }
};

/// Gives all grains and all lines between those that touch to a sink: grain(x, volume, mass, contacts, v) and
/// line(from, branch, force), of grains with the mesh line(centre, 0, ...) by its moments.
template <class Detector, class... Effect, class Sink>
void for_each_load(simulation<Detector, Effect...> const& of, Sink& sink) {
  using law_type = typename granular_of<Effect...>::type;
  law_type const& law = of.template effect<law_type>();
  particles_on_host<Detector, Effect...> const all(of);
  grains_of_spheres<Detector, Effect...> const grains(of, all);
  auto const on_spheres = sums_over_mesh_contacts<mesh_load>(of, load_of_mesh<law_type>{law});
  std::vector<mesh_load> loads(of.size());
  for (std::size_t i = 0; i < of.size(); ++i)
    loads[grains.first[i]].add(on_spheres[i], 1 / static_cast<double>(all.clump_masses[i]), grains.arms[i]);
  for_each_force(of, all, [&](std::size_t i, std::size_t k, vec3<double> const& branch, vec3<double> const& force) {
    ++loads[grains.first[i]].contacts, ++loads[grains.first[k]].contacts;
    sink.line(grains.centre(i), branch - grains.arms[i] + grains.arms[k], force);
  });
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (all.is_there[i] == 0 || grains.first[i] != i) continue;
    double const volume = sphere_mass(1.0, all.radius_of(i)) * static_cast<double>(all.clump_masses[i]);
    double const mass = volume * law.made_of.template density_of<double>(all.solid_of(i));
    sink.grain(grains.centre(i), volume, mass, loads[i], grains.velocity(i));
  }
}

/// All in a box counts the same; of a line the part that is in it.
struct box_sink {
  vec3<double> lower, upper;
  field_sums sums{};

  double density() const { return 1 / ((upper - lower).prod()); }
  void grain(vec3<double> const& x, double volume, double mass, mesh_load const& load, vec3<double> const& v) {
    for (int k = 0; k < 3; ++k)
      if (!(x[k] >= lower[k] && x[k] < upper[k])) return;
    sums.add_grain(density(), volume, mass, load, v);
  }
  void line(vec3<double> const& from, vec3<double> const& branch, vec3<double> const& force) {
    double begin = 0, end = 1;
    for (int k = 0; k < 3; ++k) {
      double const to = -branch[k];
      if (to == 0) {
        if (!(from[k] >= lower[k] && from[k] < upper[k])) return;
        continue;
      }
      double const a = (lower[k] - from[k]) / to, b = (upper[k] - from[k]) / to;
      begin = std::max(begin, std::min(a, b)), end = std::min(end, std::max(a, b));
    }
    if (end > begin) sums.add_force((end - begin) * density(), force, branch);
  }
};

/// Lucy's kernel at the points of a grid; a line by Gauss' rule of four points.
struct grid_sink {
  stress_grid grid;
  std::vector<field_sums> sums = std::vector<field_sums>(grid.size());

  double kernel(double square) const {
    double const q = std::sqrt(square) / grid.reach;
    return q < 1
               ? 2.0889967811348634 / (grid.reach * grid.reach * grid.reach) * (1 + 3 * q) * (1 - q) * (1 - q) * (1 - q)
               : 0;
  }
  /// f(cell, its point) for the cells whose points are within the reach of a place, and `more`.
  template <class F>
  void near(vec3<double> const& x, double more, F const& f) const {
    int first[3], last[3];
    for (int k = 0; k < 3; ++k) {
      double const cell = (grid.upper[k] - grid.lower[k]) / grid.count[k], at = (x[k] - grid.lower[k]) / cell - 0.5;
      first[k] = static_cast<int>(std::max(std::ceil(at - (grid.reach + more) / cell), 0.0));
      last[k] = static_cast<int>(std::min(std::floor(at + (grid.reach + more) / cell), grid.count[k] - 1.0));
    }
    for (int c = first[2]; c <= last[2]; ++c)
      for (int b = first[1]; b <= last[1]; ++b)
        for (int a = first[0]; a <= last[0]; ++a) {
          std::size_t const cell = std::size_t(a) + std::size_t(grid.count[0]) *
                                                        (std::size_t(b) + std::size_t(grid.count[1]) * std::size_t(c));
          f(cell, grid.point(cell));
        }
  }
  void grain(vec3<double> const& x, double volume, double mass, mesh_load const& load, vec3<double> const& v) {
    near(x, 0, [&](std::size_t cell, vec3<double> const& at) {
      double const weight = kernel((at - x).squaredNorm());
      if (weight > 0) sums[cell].add_grain(weight, volume, mass, load, v);
    });
  }
  void line(vec3<double> const& from, vec3<double> const& branch, vec3<double> const& force) {
    constexpr double places[] = {0.0694318442029737, 0.330009478207572, 0.669990521792428, 0.930568155797026};
    constexpr double weights[] = {0.173927422568727, 0.326072577431273, 0.326072577431273, 0.173927422568727};
    near(from, branch.norm(), [&](std::size_t cell, vec3<double> const& at) {
      double weight = 0;
      for (int k = 0; k < 4; ++k) weight += weights[k] * kernel((from - branch * places[k] - at).squaredNorm());
      if (weight > 0) sums[cell].add_force(weight, force, branch);
    });
  }
};

}  // namespace detail

/// The force along the normal of each contact between grains, of a scene with `granular_contact`, below 0 where it
/// pulls: over their mean they have the distribution of forces. Forces are those where grains are, with velocities as
/// they are. Waits, and copies columns to the host. O(n log n).
template <class Detector, class... Effect>
std::vector<double> normal_forces(simulation<Detector, Effect...> const& of) {
  std::vector<double> found;
  detail::for_each_force(of, detail::particles_on_host<Detector, Effect...>(of),
                         [&](std::size_t, std::size_t, vec3<double> const& branch, vec3<double> const& force) {
                           found.push_back(force.dot(branch.normalized()));
                         });
  return found;
}

/// The means of fields in a box, of a scene with `granular_contact`: grains count where their centres are, those of
/// clumps their centres of mass, forces by the part of the line between centres that is in the box, those of the mesh
/// where the grain's centre is. Forces are those where grains are, with velocities as they are. In a periodic box a
/// line counts where its first grain is. Of `local()` of ranks it is that of the rank's own grains. Waits, and copies
/// columns to the host. O(n log n).
template <class Detector, class... Effect>
grain_fields stress(simulation<Detector, Effect...> const& of, double const (&lower)[3], double const (&upper)[3]) {
  for (int k = 0; k < 3; ++k) detail::check_parameter(lower[k] < upper[k], "stress: each side of the box is above 0");
  detail::box_sink sink{{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
  detail::for_each_load(of, sink);
  return sink.sums.fields();
}

/// Fields at the points of a grid, x fastest: I. Goldhirsch, "Stress, stress asymmetry and couple stress: from discrete
/// particles to continuous fields", Granular Matter 12, 2010, with Lucy's kernel. Else as in a box.
template <class Detector, class... Effect>
std::vector<grain_fields> stress(simulation<Detector, Effect...> const& of, stress_grid const& grid) {
  for (int k = 0; k < 3; ++k)
    detail::check_parameter(grid.lower[k] < grid.upper[k] && grid.count[k] > 0,
                            "stress: each side of the grid, and each number of cells, is above 0");
  detail::check_parameter(detail::is_positive(grid.reach), "stress: reach is above 0, and finite");
  detail::grid_sink sink{grid};
  detail::for_each_load(of, sink);
  std::vector<grain_fields> found;
  for (auto const& sums : sink.sums) found.push_back(sums.fields());
  return found;
}

}  // namespace collide
