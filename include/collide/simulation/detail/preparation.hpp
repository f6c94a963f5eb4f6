/// \file
/// How a simulation is prepared for its steps, when particles or the mesh have changed.
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include <collide/simulation/detail/step_phases.hpp>
#include <collide/spaces/detail/tuning.hpp>

namespace collide::detail {

template <class S, class Columns>
sphere_view<S> spheres_of(particle_state<S, Columns> const& particles) {
  S const* const xyz = particles.at(position{});
  if constexpr (contains<Columns, radius>)
    return spheres_xyz(xyz, particles.size, static_cast<S const*>(particles.at(radius{})));
  return spheres_xyz(xyz, particles.size, particles.common_radius);
}

/// Nothing goes on in silence without what contacts should remember.
template <class State>
void check_contacts([[maybe_unused]] State const& s) {
  using effects_type = typename State::effects_type;
  if constexpr (effects_type::any_pair_contact && effects_type::remembered::size != 0 &&
                !State::execution_space::host_accessible) {
    if (s.is_set && s.neighbours.has_forgotten(s.space))
      throw error(
          "collide: simulation: contacts have found no room for what they remember, as many particles have "
          "more than 16 neighbours: call reserve with several times as many particles before set, and begin "
          "anew");
  }
  if constexpr (effects_type::overlaps && !State::execution_space::host_accessible) {
    if (s.is_set && s.space.read(s.pressing_counts.data() + 2) != 0)
      throw error(
          "collide: simulation: particles that overlap more than 16 triangles each have found no room for all of "
          "them: call reserve with several times as many particles before set, and begin anew");
  }
}

/// Bytes of memory of a space, on the host. Waits.
template <class Space>
std::vector<unsigned char> bytes_on_host(Space const& space, void const* from, std::size_t n) {
  std::vector<unsigned char> copy(n);
  space.copy_to_host(copy.data(), static_cast<unsigned char const*>(from), n);
  return copy;
}

/// A column of a simulation's particles on the host. Waits.
template <class Column, class State>
std::vector<column_element<Column, typename State::S>> column_on_host(State const& s) {
  using layout = column_layout<Column, typename State::S>;
  check_contacts(s);
  std::vector<column_element<Column, typename State::S>> copy(s.particles.size * std::size_t(layout::width));
  s.space.copy_to_host(copy.data(), s.particles.at(Column{}), copy.size());
  return copy;
}

/// A view of a simulation's data, which it changes.
template <class Detector, class... Effect>
class preparation {
 public:
  using state_type = simulation_state<Detector, Effect...>;
  using execution_space = typename state_type::execution_space;
  using S = typename state_type::S;
  using effects_type = typename state_type::effects_type;
  using columns = typename state_type::columns;

  preparation(state_type& all) : s_(all) {}

  /// Finds out by which radii effects limit steps: of each material too, where no effect changes materials. A source's
  /// particles are of material 0. May wait.
  COLLIDE_COLD void know_smallest() {
    constexpr bool changes_materials = (contains<writes_of<Effect>, material> || ...);
    smallest_radii& found = s_.smallest;
    found = smallest_radii(static_cast<double>(s_.radii.smallest));
    if constexpr (contains<columns, material> && !changes_materials) {
      for (double& r : found.of_material) r = std::numeric_limits<double>::infinity();
      std::vector<S> radii;
      if constexpr (contains<columns, radius>) radii = column_on_host<radius>(s_);
      auto const numbers = column_on_host<material>(s_);
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        auto const own = radii.empty() ? found.of_all : static_cast<double>(radii[i]);
        found.largest_material = std::max<int>(found.largest_material, numbers[i]);
        double& of_number = found.of_material[std::min<int>(numbers[i], smallest_radii::numbers - 1)];
        if (own >= 0) of_number = std::min(of_number, own);
      }
    }
    if (double const own = static_cast<double>(s_.effects.source_radius()); own > 0)
      s_.smallest.of_material[0] = min(s_.smallest.of_material[0], own);
  }

  /// Makes room for particles, of which there are none then.
  COLLIDE_COLD void reserve(std::size_t particles) {
    check_places(particles);
    s_.particles = {};
    s_.is_set = false;
    auto* const resource = s_.space.resource();
    s_.memory.reserve(resource, padded_size(particles));
    if constexpr (state_type::has_begin_step) s_.device_time.reserve(resource, clock_size);
    if constexpr (state_type::may_be_made) s_.was_there.reserve(resource, particles);
    if constexpr (effects_type::any_mesh_contact) {
      using mesh_type = decltype(mesh_ref<true>(s_, S{}));
      using kernel_type = typename state_type::template step_kernel_type<mesh_type>;
      if constexpr (kernel_type::template has_many_tiles<typename execution_space::template block<kernel_type>>) {
        s_.overflow.reserve(resource, padded_size(particles));
      }
    }
    if constexpr (effects_type::any_pair_contact)
      s_.neighbours.reserve(s_.space, particles, particles * state_type::widest_moved);
    if constexpr (state_type::has_cell_order) s_.order.names.reserve(resource, particles);
    if constexpr (effects_type::overlaps) {
      constexpr bool on_host = execution_space::host_accessible;
      s_.surfaces.reserve(resource, particles, on_host);
      s_.is_pressing_known = false;
      s_.pressing.reserve(resource, on_host ? few_at_walls(particles) : particles);
      s_.pressing_counts.reserve(resource, 3);
      s_.space.fill(s_.pressing_counts.data(), 0, 3 * sizeof(std::uint32_t));
      if constexpr (!execution_space::host_accessible)
        s_.overlaps.reserve(resource, max(particles, overlap_pool::min_items));
    }
  }

  /// Puts particles into new columns, with places for more.
  COLLIDE_COLD void place(sphere_view<S> const& particles, S const* velocities, std::size_t places) {
    reserve(places);
    s_.particles = s_.memory.state(places, particles.size(), particles.common_radius());
    if constexpr (state_type::has_begin_step) {
      s_.particles.time = s_.device_time.data();
      s_.space.fill(s_.particles.time, 0, clock_size * sizeof(double));
    }
    s_.time = 0;
    s_.next_meeting = effects_type::ends_after_meeting ? meeting::of_all : meeting::in_step;
    s_.space.for_each(padded_size(places), initial(s_.particles, particles, velocities, s_.effects));
    s_.is_set = true;
  }

  /// The radii that particles have of their own; the largest is infinite if one is not finite. Waits.
  radius_range<S> radii_of_particles() const {
    radius_range<S> found{std::numeric_limits<S>::infinity(), S(0)};
    if constexpr (contains<columns, radius>) {
      auto const radii = column_on_host<radius>(s_);
      for (std::size_t i = 0; i < radii.size(); ++i) {
        S const r = radii[i];
        found.largest = !is_finite(r) ? std::numeric_limits<S>::infinity() : i == 0 ? r : max(found.largest, r);
        if (r >= 0) found.smallest = min(found.smallest, r);
        if (!is_finite(r)) break;
      }
      for (S const r : radii) {
        bool const is_small = r <= 2 * found.smallest;
        if (is_small) found.small = max(found.small, r);
        found.larger += !is_small;
      }
    }
    return found;
  }
  /// Throws `error` if radii make no sense, in the name of a member of `simulation`.
  COLLIDE_COLD void check_radii(char const* member) const {
    if (state_type::asks_mesh && s_.particles.placed != 0 && s_.radii.smallest == 0)
      throw error(std::string("collide: simulation: ") + member + ": radii of particles that touch a mesh are above 0");
    if (contains<columns, radius> && s_.particles.placed != 0 && !is_finite(s_.radii.largest))
      throw error(std::string("collide: simulation: ") + member + ": radii are finite");
  }

  /// Places bodies where they are now, and prepares the index for the radii.
  COLLIDE_COLD void bodies_and_index() {
    step_phases(s_).advance_bodies(0, true);
    index();
  }
  COLLIDE_COLD void index() {
    if constexpr (state_type::asks_mesh) {
      constexpr bool is_part = contains<columns, global_number>;  // others come from other ranks
      std::size_t const n = max(s_.particles.size, std::size_t{is_part});
      if (s_.mesh.size() == 0 || n == 0 || !s_.is_set) return;
      lookup_space<execution_space> there{s_.space};
      S const margin = state_type::sweeps || contains<columns, radius> ? S(0) : S(s_.bodies.margin());
      S const reached = reach_of<effects_type>(max(s_.radii.largest, s_.min_radius)) + margin + margin_near_mesh(s_);
      bool const wider = is_part || (s_.radii.largest >= 0 && s_.radii.largest < reached);
      detail::prepare_index(s_.index, there, s_.options,
                            wider ? spheres_xyz(s_.particles.at(position{}), n, reached) : spheres_of(s_.particles));
    }
  }

  /// Gives the spheres of clumps what has been assigned to these.
  template <class Column>
  void assign_clumps() {
    static_assert(!contains<collide::columns<position, velocity, angular_velocity, radius>, Column>,
                  "collide: assign: in a scene with clumps set_clumps says where spheres are, and how they move");
    if constexpr (contains<union_of<typename clumps::writes, collide::columns<material>>, Column>)
      s_.space.for_each(s_.particles.size, place_clumps<S, effects_type>{s_.particles, s_.effects.space()});
    if constexpr (std::is_same<Column, in_clump>::value) {
      if (s_.is_set) s_.neighbours.fit(s_.space, s_.particles.size, s_.radii);
    }
  }

 private:
  state_type& s_;
};

}  // namespace collide::detail
