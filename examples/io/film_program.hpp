/// \file
/// The part of the programs that show scenes which depends on their simulation: the steps and the frames.
#pragma once

#include <chrono>
#include <cmath>
#include <numeric>
#include <type_traits>
#include <utility>

#include <collide/bucket.cuh>
#include <collide/effects/emit.hpp>
#include <collide/ranks/distributed_checkpoint.hpp>
#include <collide/simulation.cuh>
#include <collide/spaces/upload.hpp>

#include "device.hpp"
#include "film.hpp"
#include "output.hpp"
#include "progress.hpp"

namespace io {
namespace detail {

inline char const* name_of(collide::velocity) { return "velocity"; }
inline char const* name_of(collide::radius) { return "radius"; }
inline char const* name_of(collide::material) { return "material"; }
inline char const* name_of(collide::angular_velocity) { return "angular_velocity"; }
inline char const* name_of(collide::adhered) { return "stuck"; }
inline char const* name_of(collide::slow_steps) { return "slow_steps"; }
inline char const* name_of(collide::in_contact) { return "in_contact"; }
inline char const* name_of(collide::pair_acceleration) { return "pair_acceleration"; }
inline char const* name_of(collide::pair_angular_acceleration) { return "pair_angular_acceleration"; }

/// True if a list of columns has a column.
template <class Column, class... Listed>
constexpr bool has(collide::columns<Listed...>) {
  return (std::is_same<Column, Listed>::value || ...);
}

/// A column's values of the particles that are there, and how many each has.
template <class Column, class Simulation>
auto of_present(Simulation& simulation) {
  auto const present = simulation.template to_host<collide::alive>();
  auto values = simulation.template to_host<Column>();
  constexpr std::size_t width = sizeof(typename Column::template value<float>) / sizeof(values[0]);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (present[i / width] != 0) values[kept++] = values[i];
  }
  values.resize(kept);
  return std::pair(values, width);
}

/// Writes the particles that are there, with all that is known of them. With ranks, all call it, and the one that
/// `shows` has all particles and writes.
template <class Simulation, class... Column>
void write_particles(std::string const& path, Simulation& simulation, float radius, bool shows,
                     collide::columns<Column...>) {
  auto const points = of_present<collide::position>(simulation).first;
  std::size_t const n = points.size() / 3;
  std::vector<collide::vtk_array> known;
  if (!has<collide::radius>(typename Simulation::columns()))
    known.emplace_back("radius", std::vector<float>(n, radius));
  auto const add = [&](auto column) {
    using type = decltype(column);
    if constexpr (!std::is_same<type, collide::position>::value && !std::is_same<type, collide::alive>::value) {
      auto const [values, width] = of_present<type>(simulation);
      known.emplace_back(name_of(column), values, width);
    }
  };
  (add(Column{}), ...);
  if (!shows) return;
  std::vector<std::uint32_t> all(n);
  std::iota(all.begin(), all.end(), 0u);
  output_file out(path);
  collide::write_vtp(out, points, known, collide::vtk_cells::dots, all);
  out.commit();
}

/// The bodies of a simulation; on ranks all have them alike.
template <class Detector, class... Effect>
auto const& bodies_of(collide::simulation<Detector, Effect...> const& simulation) {
  return simulation.bodies();
}
template <class Detector, class... Effect, class Ranks>
auto const& bodies_of(collide::distributed<collide::simulation<Detector, Effect...>, Ranks> const& simulation) {
  return simulation.local().bodies();
}

/// Writes the particles that are there, and the mesh if it moves. With ranks, all call it, and the one that `shows`
/// writes.
template <class Simulation>
void write_frame(film const& wish, collide::vtk_frame const& frame, Simulation& simulation, float radius, bool shows) {
  write_particles(wish.output + "/" + frame.file, simulation, radius, shows, typename Simulation::columns());
  if constexpr (std::decay_t<decltype(bodies_of(simulation))>::exist) {
    if (!shows) return;
    auto const states = bodies_of(simulation).to_host(simulation.space());
    write_mesh(wish.output + "/" + frame.mesh, moved_vertices(wish, states), wish.stage.corners);
  }
}

/// Stops a source; other effects are none.
template <class Effect>
void stop(Effect&) {}
template <class Source>
void stop(collide::emit_from<Source>& source) {
  source.rate = 0;
}
template <class Detector, class... Effect>
void stop_sources(collide::simulation<Detector, Effect...>& simulation) {
  (stop(simulation.template effect<Effect>()), ...);
}
template <class Detector, class... Effect, class Ranks>
void stop_sources(collide::distributed<collide::simulation<Detector, Effect...>, Ranks>& simulation) {
  (stop(simulation.template effect<Effect>()), ...);
}

/// Spaces in which there are ranks. With more of them programs would take longer to compile.
template <class Space>
constexpr bool has_ranks = std::is_same<Space, collide::host>::value;
#if defined(__CUDACC__)
template <>
inline constexpr bool has_ranks<collide::cuda_shared> = true;
#endif

/// The simulation on ranks.
template <class Detector, class... Effect>
auto distributed_over(any_ranks const& ranks, collide::simulation<Detector, Effect...>&& one) {
  using simulation = collide::simulation<Detector, Effect...>;
  return collide::distributed<simulation, any_ranks>(ranks, one.space(), one.template effect<Effect>()...);
}

/// Puts the first particles into a simulation, those of the film into the rank that `shows`; the others come later.
template <class Simulation>
void set_first(film const& wish, Simulation& simulation, bool shows) {
  auto const radius = static_cast<float>(wish.stage.radius);
  if constexpr (has<collide::radius>(typename Simulation::columns())) {
    auto const first = wish.first != nullptr ? wish.first(wish) : std::vector<first_sphere>();
    std::vector<float> x, v, r;
    for (auto const& s : shows ? first : std::vector<first_sphere>()) {
      x.insert(x.end(), s.centre, s.centre + 3);
      v.insert(v.end(), s.velocity, s.velocity + 3);
      r.push_back(static_cast<float>(s.radius));
    }
    auto const spheres = collide::upload(simulation.space(), collide::spheres_xyz(x.data(), r.size(), r.data()));
    collide::buffer<float> moving;
    float* const to = moving.reserve(simulation.space().resource(), v.size());
    simulation.space().copy_from_host(to, v.data(), v.size());
    simulation.set(spheres.view(), to, wish.particles + first.size());
  } else {
    simulation.set(collide::spheres_xyz<float>(nullptr, 0, radius), nullptr, wish.particles);
  }
}

/// Runs the simulation and shows it. Of ranks, the last does: it has all that sources make.
template <class Ranks, class Simulation>
void shoot(film const& wish, Ranks const& ranks, Simulation simulation) {
  bool const shows = ranks.rank() + 1 == ranks.size();
  using device = device_of<typename Simulation::execution_space>;
  using clock = std::chrono::steady_clock;
  auto const& space = simulation.space();
  auto const& stage = wish.stage;
  std::vector<float> const vertices(stage.vertices.begin(), stage.vertices.end());
  auto const mesh = collide::upload(
      space, collide::indexed_mesh(vertices.data(), vertices.size() / 3, stage.corners.data(), stage.triangle_count()));
  auto const radius = static_cast<float>(stage.radius);
  set_first(wish, simulation, shows);
  simulation.set_mesh(mesh.view(), wish.bodies);
  if (!wish.load.empty()) collide::load(simulation, wish.load);

  auto const step = static_cast<float>(wish.dt);
  auto const begin = static_cast<std::size_t>(std::llround(simulation.time() / static_cast<double>(step)));
  std::size_t first = 0;  // the next picture
  for (std::size_t at = 0; (at = wish.picture(first, at)) <= begin;) ++first;
  std::size_t const steps = wish.steps();
  std::vector<collide::vtk_frame> frames;
  auto const goes_on = [&](std::size_t done) {
    return done < steps && (wish.until == 0 || first + frames.size() < wish.until);
  };
  if (!goes_on(begin)) throw data_error(wish.load, "the film is over there, or --until comes before it");
  if (!wish.output.empty() && shows) write_mesh(wish.output + "/mesh.vtp", vertices, stage.corners);
  double spent = 0;
  progress bar(wish.name, static_cast<double>(steps));
  std::size_t done = begin;
  while (goes_on(done)) {
    std::size_t const until = wish.picture(first + frames.size(), done);
    auto const start = clock::now();
    for (; done < until; ++done) {
      if (done == wish.pouring_steps()) stop_sources(simulation);
      simulation.step(step);
      if (shows && Simulation::execution_space::host_accessible) bar.update(static_cast<double>(done));
    }
    space.synchronize();
    spent += std::chrono::duration<double, std::milli>(clock::now() - start).count();
    if (shows) bar.update(static_cast<double>(done));
    frames.push_back(next_frame(wish, first + frames.size(), static_cast<double>(done) * wish.dt));
    if (!wish.output.empty()) write_frame(wish, frames.back(), simulation, radius, shows);
    if (!wish.save.empty()) collide::save(simulation, wish.save);
  }
  if (!shows) return;
  if (!wish.output.empty()) {
    output_file out(wish.output + "/film.pvd");
    collide::write_pvd(out, frames);
    out.commit();
  }

  report(wish, {done - begin, spent / static_cast<double>(done - begin), Simulation::bytes_per_particle,
                device::threads(space), ranks.size(), device::name()});
}

}  // namespace detail

/// The program of a film: `make(space, film)` gives the simulation.
template <class Make>
int film_program(int argc, char** argv, film const& wish, Make const& make) {
  return run_film(
      argc, argv, wish,
      [](film const& asked, int rank) {
        choose_space(asked.space, [rank](auto space) {
          using device = device_of<typename decltype(space)::type>;
          device::require();
          device::take(rank);
        });
      },
      [&](film const& asked, any_ranks const* ranks) {
        choose_space(asked.space, [&](auto space) {
          using space_type = typename decltype(space)::type;
          using device = device_of<space_type>;
          auto one = make(device::make(asked.threads, device::memory()), asked);
          if (ranks == nullptr) return detail::shoot(asked, collide::one_rank(), std::move(one));
          if constexpr (detail::has_ranks<space_type>) {
            detail::shoot(asked, *ranks, detail::distributed_over(*ranks, std::move(one)));
          }
        });
      });
}

}  // namespace io
