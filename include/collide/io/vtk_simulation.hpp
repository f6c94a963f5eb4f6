/// \file
/// The particles of a simulation, and where they touch each other, as VTK's XML files (.vtp) for ParaView.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <collide/effects/columns.hpp>
#include <collide/effects/sphere_contact.hpp>
#include <collide/io/vtk.hpp>
#include <collide/simulation.cuh>
#include <collide/simulation/energy.hpp>

namespace collide {
namespace detail {

/// The name of a column in a file; null if files do not show it.
template <class Column>
constexpr char const* vtk_name(Column) {
  return nullptr;
}
constexpr char const* vtk_name(velocity) { return "velocity"; }
constexpr char const* vtk_name(angular_velocity) { return "angular_velocity"; }
constexpr char const* vtk_name(adhered) { return "adhered"; }
constexpr char const* vtk_name(slow_steps) { return "slow_steps"; }

/// The particles that are there, as files show them.
template <class S>
struct vtk_particles {
  std::vector<S> points, radii;
  std::vector<vtk_array> known;

  template <class Simulation, class... Column>
  vtk_particles(Simulation const& of, S common_radius, columns<Column...> all) {
    std::vector<std::uint8_t> present(of.size(), 1);
    if constexpr (contains<decltype(all), alive>) present = of.template to_host<alive>();
    auto const kept = [&](auto column) {
      auto values = of.template to_host<decltype(column)>();
      std::size_t const width = present.empty() ? 1 : values.size() / present.size();
      std::size_t n = 0;
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (present[i / width] != 0) values[n++] = values[i];
      }
      values.resize(n);
      return std::pair(std::move(values), width);
    };
    points = kept(position{}).first;
    radii.assign(points.size() / 3, common_radius);
    if constexpr (contains<decltype(all), radius>) radii = kept(radius{}).first;
    known.emplace_back("radius", radii);
    auto const add = [&](auto column) {
      if constexpr (vtk_name(decltype(column){}) != nullptr) {
        auto const [values, width] = kept(column);
        known.emplace_back(vtk_name(column), values, width);
      }
    };
    (add(Column{}), ...);
  }
};

/// The force of the normal spring of two spheres that overlap, if the scene has such: of `granular_contact`, else of
/// `sphere_contact`.
template <class Detector, class... Effect>
double spring_force(simulation<Detector, Effect...> const& of, particles_on_host<Detector, Effect...> const& all,
                    std::size_t i, std::size_t k, double overlap) {
  using law_type = typename granular_of<Effect...>::type;
  if constexpr (is_granular<law_type>) {
    return elastic_force(of.template effect<law_type>(), all, i, k, overlap);
  } else {
    return of.template effect<sphere_contact>().stiffness * overlap;
  }
}

}  // namespace detail

/// Writes the particles that are there as the file `path` (.vtp), as points with `radius`, `velocity`, and
/// `angular_velocity`, `adhered` and `slow_steps` where the scene has them. ParaView's filter Glyph, scaled by radius,
/// shows spheres. Waits; O(particles). Throws `error` if the file cannot be written.
template <class Detector, class... Effect>
void write_vtk_particles(std::string const& path, simulation<Detector, Effect...> const& of) {
  using list = typename simulation<Detector, Effect...>::columns;
  detail::vtk_particles<typename Detector::scalar> const shown(of, of.state().common_radius, list{});
  detail::write_file(path, [&](std::ofstream& out) {
    write_vtp(out, shown.points, shown.known, vtk_cells::dots, detail::first_numbers(shown.radii.size()));
  });
}

/// Writes a line between the centres of each two particles that overlap, as the file `path` (.vtp), with their
/// `overlap`, and `force`, that of the normal spring of `granular_contact` or `sphere_contact`, where the scene has it:
/// the force chains. Across a side of `periodic_box` it goes out of the box. ParaView's filter Tube, its radius by
/// force, shows them. Waits; O(n log n), and pairs near each other along x. Throws `error` if the file cannot be
/// written.
template <class Detector, class... Effect>
void write_vtk_contacts(std::string const& path, simulation<Detector, Effect...> const& of) {
  using S = typename Detector::scalar;
  constexpr bool has_springs = ((std::is_same<Effect, sphere_contact>::value || detail::is_granular<Effect>) || ...);
  detail::particles_on_host<Detector, Effect...> const all(of);
  std::vector<S> points, overlaps, forces;
  all.for_each_overlap([&](auto const& a, auto const& b, double overlap) {
    S force = 0;
    if constexpr (has_springs) force = static_cast<S>(detail::spring_force(of, all, a.number, b.number, overlap));
    for (auto const* p : {&a, &b}) {
      for (int k = 0; k < 3; ++k) points.push_back(static_cast<S>(p->centre[k]));
      overlaps.push_back(static_cast<S>(overlap));
      forces.push_back(force);
    }
  });
  std::vector<vtk_array> known{{"overlap", overlaps}};
  if (has_springs) known.emplace_back("force", forces);
  detail::write_file(path, [&](std::ofstream& out) {
    write_vtp(out, points, known, vtk_cells::lines, detail::first_numbers(overlaps.size()));
  });
}

}  // namespace collide
