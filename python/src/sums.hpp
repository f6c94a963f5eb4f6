/// \file
/// The memory of `reaction`, `mass_flow` and `wear`, which belongs to the simulation.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include <collide/effects/mass_flow.hpp>
#include <collide/effects/reaction.hpp>
#include <collide/effects/wear.hpp>

#include "simulation_base.hpp"

namespace collide_python {

template <class Sums>
struct sums_in_memory {
  std::optional<Sums> sums;
  template <class Space>
  void clear(Space const& space) {
    sums->clear(space);
  }
};

/// Appends rows of nothing else than doubles.
template <class Row>
void append(std::vector<double>& to, std::vector<Row> const& rows) {
  auto const* const first = reinterpret_cast<double const*>(rows.data());
  to.insert(to.end(), first, first + rows.size() * (sizeof(Row) / sizeof(double)));
}

template <>
struct sums_of<collide::reaction> : sums_in_memory<collide::reaction_sums> {
  /// For so many bodies and, where the effect wants them, triangles. Sums begin at 0.
  template <class Space>
  void make(Space const& space, collide::reaction& e, std::size_t bodies, std::size_t triangles) {
    sums = collide::reaction_sums(space, bodies, e.unit, e.triangles != 0 ? std::max<std::size_t>(triangles, 1) : 0);
    e = sums->effect(e.density);
  }
  /// Six numbers of each body, of what rests, and of each triangle; last how many contacts are in no sum.
  template <class Space>
  std::vector<double> read(Space const& space) const {
    std::vector<double> found;
    append(found, sums->read(space));
    append(found, sums->read_triangles(space));
    found.push_back(static_cast<double>(sums->refused(space)));
    return found;
  }
};

template <>
struct sums_of<collide::mass_flow<>> : sums_in_memory<collide::flow_sums> {
  template <class Space>
  void make(Space const& space, collide::mass_flow<>& e, std::size_t, std::size_t) {
    sums = collide::flow_sums(space, e.unit);
    e = sums->through(e.point, e.normal, e.made_of, e.disc);
  }
  /// How many particles, and their mass.
  template <class Space>
  std::vector<double> read(Space const& space) const {
    collide::flow_counts const found = sums->read(space);
    return {static_cast<double>(found.particles), found.mass};
  }
};

template <>
struct sums_of<collide::wear<>> : sums_in_memory<collide::wear_sums> {
  template <class Space>
  void make(Space const& space, collide::wear<>& e, std::size_t, std::size_t triangles) {
    sums = collide::wear_sums(space, triangles, e.unit_of_impulse, e.unit_of_work);
    e = sums->effect(e.made_of);
  }
  /// Two numbers of each triangle.
  template <class Space>
  std::vector<double> read(Space const& space) const {
    std::vector<double> found;
    append(found, sums->read(space));
    return found;
  }
};

}  // namespace collide_python
