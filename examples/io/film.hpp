/// \file
/// What the programs that show scenes have in common: the command line, the steps, the frames, and what it all costs.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include <nlohmann/json.hpp>

#include <collide/bodies.hpp>
#include <collide/bucket.cuh>
#include <collide/distributed_checkpoint.hpp>
#include <collide/emit.hpp>
#include <collide/simulation.cuh>
#include <collide/thread_ranks.hpp>
#include <collide/upload.hpp>
#if defined(COLLIDE_PROGRAM_HAS_MPI)
#include <collide/mpi.hpp>
#endif

#include "device.hpp"
#include "output.hpp"
#include "program.hpp"
#include "progress.hpp"
#include "ranks.hpp"
#include "scenes.hpp"
#include "vtk.hpp"

namespace io {

/// A film: what it shows, and what the command line says of it.
struct film {
  char const* name;
  char const* about;
  scene stage;                          ///< the mesh, and the radius of the particles
  double dt;                            ///< a step
  std::size_t particles;                ///< how many there are at most
  double seconds;                       ///< of the scene's time
  double pouring = 1;                   ///< for which part of them there are new particles
  std::size_t frames = 100, until = 0;  ///< how many pictures there are, and after how many to stop; 0: after all
  std::string space = "host", output = "", report = "", save = "", load = "", ranks = "";
  int threads = 0;
  std::vector<collide::body> bodies =
      {};  ///< parts of the mesh that move; no triangle of one shares a vertex with others

  /// How many steps there are, and after how many of them nothing more comes.
  std::size_t steps() const { return static_cast<std::size_t>(std::ceil(seconds / dt)); }
  std::size_t pouring_steps() const { return static_cast<std::size_t>(std::ceil(pouring * seconds / dt)); }
  /// After how many steps picture number `i` is taken, if the one before was taken after `done`.
  std::size_t picture(std::size_t i, std::size_t done) const { return std::max(done + 1, steps() * (i + 1) / frames); }
  /// How many particles must come a second, for all to have come then.
  double rate() const {
    double const simulated = static_cast<double>(static_cast<float>(dt)) * static_cast<double>(pouring_steps());
    return (static_cast<double>(particles) + 0.5) / simulated;
  }
};

/// Makes a body of the triangles that the stage has got since the body before.
inline void add_body(film& of, collide::body_motion const& motion) {
  std::size_t const first = of.bodies.empty() ? 0 : of.bodies.back().first + of.bodies.back().size;
  of.bodies.push_back({first, of.stage.triangle_count() - first, motion});
}

/// A motion around an axis through a point.
inline collide::body_motion turning(point const& pivot, point const& axis, double rate) {
  collide::body_motion m;
  std::copy(pivot.begin(), pivot.end(), m.pivot);
  std::copy(axis.begin(), axis.end(), m.axis);
  m.rate = rate;
  return m;
}

/// Where particle number 0, 1, 2, ... of a source begins, in coordinates between -1 and 1. Those of `evenly` are spread
/// over the square such that numbers that follow each other are far apart, so that particles do not overlap when they
/// begin (M. Roberts' sequence R2); those of `anyhow` have no order.
struct spot {
  double evenly[2], anyhow[2];

  COLLIDE_HD explicit spot(std::uint64_t number) {
    double const i = static_cast<double>(number), slope[] = {0.7548776662466927, 0.5698402909980532};
    for (int k = 0; k < 2; ++k) {
      evenly[k] = 2 * fraction(slope[k] * i) - 1;
      anyhow[k] = 2 * fraction(fraction(slope[k] * i) * i) - 1;  // of large numbers, too, some fraction is left
    }
  }

 private:
  static COLLIDE_HD double fraction(double x) { return x - static_cast<double>(static_cast<std::uint64_t>(x)); }
};

namespace detail {

inline char const* name_of(collide::velocity) { return "velocity"; }
inline char const* name_of(collide::angular_velocity) { return "angular_velocity"; }
inline char const* name_of(collide::adhered) { return "stuck"; }
inline char const* name_of(collide::slow_steps) { return "slow_steps"; }

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
  std::vector<vtk_array> known{{"radius", std::vector<float>(n, radius)}};
  auto const add = [&](auto column) {
    using type = decltype(column);
    if constexpr (!std::is_same<type, collide::position>::value && !std::is_same<type, collide::alive>::value) {
      auto const [values, width] = of_present<type>(simulation);
      known.emplace_back(name_of(column), values, width);
    }
  };
  (add(Column{}), ...);
  if (!shows) return;
  std::vector<std::uint32_t> all(n), ends;
  for (std::size_t i = 0; i < n; ++i) all[i] = static_cast<std::uint32_t>(i);
  if (n != 0) ends.push_back(static_cast<std::uint32_t>(n));
  output_file out(path);
  write_vtp(out, points, known, "Verts", all, ends);
  out.commit();
}

inline void write_mesh(std::string const& path, std::vector<float> const& vertices,
                       std::vector<std::uint32_t> const& corners) {
  std::vector<std::uint32_t> ends(corners.size() / 3);
  for (std::size_t i = 0; i < ends.size(); ++i) ends[i] = static_cast<std::uint32_t>(3 * i + 3);
  output_file out(path);
  write_vtp(out, vertices, {}, "Polys", corners, ends);
  out.commit();
}

/// The vertices of a stage, where its bodies have been taken.
inline std::vector<float> moved_vertices(film const& wish, std::vector<collide::body_state> const& states) {
  auto const& stage = wish.stage;
  std::vector<float> found(stage.vertices.begin(), stage.vertices.end());
  for (std::size_t k = 0; k < wish.bodies.size(); ++k) {
    auto const& body = wish.bodies[k];
    for (std::size_t c = 3 * body.first; c < 3 * (body.first + body.size); ++c) {
      point const p = vertex_of(stage, c);
      auto const at = states[k].at({p[0], p[1], p[2]});
      for (int i = 0; i < 3; ++i) found[3 * std::size_t{stage.corners[c]} + std::size_t(i)] = static_cast<float>(at[i]);
    }
  }
  return found;
}

/// The files of picture number `i`.
inline vtk_frame next_frame(film const& wish, std::size_t i, double time) {
  char number[16];
  std::snprintf(number, sizeof number, "-%05zu.vtp", i);
  return {std::string("particles") + number, time, wish.bodies.empty() ? "" : std::string("mesh") + number};
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
void write_frame(film const& wish, vtk_frame const& frame, Simulation& simulation, float radius, bool shows) {
  write_particles(wish.output + "/" + frame.file, simulation, radius, shows, typename Simulation::columns());
  if constexpr (std::decay_t<decltype(bodies_of(simulation))>::exist) {
    if (!shows) return;
    auto const states = bodies_of(simulation).to_host(simulation.space());
    write_mesh(wish.output + "/" + frame.mesh, moved_vertices(wish, states), wish.stage.corners);
  }
}

/// True if a file is in a folder, or a folder of that; either may not be there yet.
inline bool is_within(std::string const& file, std::string const& folder) {
  using std::filesystem::weakly_canonical;
  auto const way = weakly_canonical(file).lexically_relative(weakly_canonical(folder));
  return !way.empty() && *way.begin() != "..";
}

/// Makes the folder that the film is to be in, which may be there already, but empty: no film is lost.
inline void make_folder(std::string const& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  bool const empty = !error && std::filesystem::is_empty(path, error);
  if (error) throw data_error(path, error.message());
  if (!empty) throw data_error(path, "the folder is not empty");
  output_file::check(path + "/film.pvd");
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

/// The simulation on ranks, if there are several.
template <class Detector, class... Effect, class Ranks>
auto distributed_over(Ranks const& ranks, collide::simulation<Detector, Effect...>&& one) {
  using simulation = collide::simulation<Detector, Effect...>;
  if constexpr (std::is_same<Ranks, collide::one_rank>::value) {
    return std::move(one);
  } else {
    return collide::distributed<simulation, Ranks>(ranks, one.space(), one.template effect<Effect>()...);
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
  simulation.set(collide::spheres_xyz<float>(nullptr, 0, radius), nullptr, wish.particles);
  simulation.set_mesh(mesh.view(), wish.bodies);
  if (!wish.load.empty()) collide::load(simulation, wish.load);

  auto const step = static_cast<float>(wish.dt);
  auto const begin = static_cast<std::size_t>(std::llround(simulation.time() / static_cast<double>(step)));
  std::size_t first = 0;  // the next picture
  for (std::size_t at = 0; (at = wish.picture(first, at)) <= begin;) ++first;
  std::size_t const steps = wish.steps();
  std::vector<vtk_frame> frames;
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
    write_pvd(out, frames);
    out.commit();
  }

  double const each = spent / static_cast<double>(done - begin);
  int const threads = device::threads(space);
  std::cout << wish.name << ": " << wish.particles << " particles, " << done - begin << " steps of " << wish.dt
            << " s, " << each << " ms a step, " << Simulation::bytes_per_particle << " bytes a particle, "
            << (ranks.size() > 1 ? std::to_string(ranks.size()) + " ranks, " : "") << wish.space << " ("
            << device::name() << (threads > 1 ? ", " + std::to_string(threads) + " threads" : "") << ")\n";
  if (wish.report.empty()) return;
  output_file report(wish.report);
  report << nlohmann::ordered_json{{"scene", wish.name},
                                   {"particles", wish.particles},
                                   {"triangles", stage.triangle_count()},
                                   {"steps", done - begin},
                                   {"dt", wish.dt},
                                   {"ms_per_step", each},
                                   {"bytes_per_particle", Simulation::bytes_per_particle},
                                   {"space", wish.space},
                                   {"threads", threads},
                                   {"ranks", ranks.size()},
                                   {"device", device::name()},
                                   {"version", version()}}
                .dump(2)
         << "\n";
  report.commit();
}

/// Calls f(ranks, film), on so many ranks as are wished for.
template <class NamedSpace, class F>
void on_ranks(film const& wish, F const& f) {
  if (wish.ranks.empty()) return f(collide::one_rank(), wish);
  if constexpr (std::is_same<typename NamedSpace::type, collide::host>::value) {
    if (int const n = threads_of(wish.ranks)) {
      film of_rank = wish;
      if (wish.threads == 0) of_rank.threads = threads_for_each(n);
      return collide::thread_ranks::run(n, [&](collide::thread_ranks const& ranks) { f(ranks, of_rank); });
    }
    if (wish.ranks != "mpi") {
      throw usage_error("--ranks: " + io::quoted(wish.ranks) + " is neither mpi nor threads:N, N from 1 to 1024");
    }
#if defined(COLLIDE_PROGRAM_HAS_MPI)
    f(collide::mpi_ranks(), wish);
#else
    throw usage_error("--ranks: this program was built without MPI");
#endif
  } else {
    throw usage_error("--ranks: works with --space host alone");
  }
}

}  // namespace detail

/// The program of a film: `make(space, film)` gives the simulation.
template <class Make>
int film_program(int argc, char** argv, film wish, Make const& make) {
  CLI::App app(wish.about, wish.name);
  app.option_defaults()->always_capture_default();
  app.add_option("--particles", wish.particles, "how many particles")
      ->check(CLI::Range(1, 1'000'000'000))
      ->type_name("N");
  app.add_option("--seconds", wish.seconds, "how long the scene lasts")->type_name("S");
  app.add_option("--frames", wish.frames, "how many pictures of it")->check(CLI::Range(1, 99'999))->type_name("N");
  app.add_option("--output", wish.output, "folder for film.pvd and mesh.vtp, which ParaView opens; none if not given")
      ->type_name("FOLDER");
  app.add_option("--report", wish.report, "measurements (JSON)")->type_name("FILE");
  app.add_option("--until", wish.until, "after how many pictures to stop; 0 for all")
      ->check(CLI::Range(0, 99'999))
      ->type_name("N");
  app.add_option("--save", wish.save, "checkpoint for --load, after each picture")->type_name("FILE");
  app.add_option("--load", wish.load, "checkpoint to go on from; the other options are as they were")
      ->type_name("FILE");
  add_choice(app, "--space", wish.space, {"host", "cuda", "cuda_shared"}, "execution space");
  app.add_option("--threads", wish.threads, "threads of the host; 0 for all")
      ->check(CLI::Range(0, 1024))
      ->type_name("N");
  app.add_option("--ranks", wish.ranks, "threads:N, or mpi under mpirun: so many simulate together, on the host")
      ->type_name("RANKS");
#if defined(COLLIDE_PROGRAM_HAS_MPI)
  std::optional<collide::mpi_session> session;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "mpi" || std::string(argv[i]) == "--ranks=mpi") session.emplace(argc, argv);
  }
#endif
  return run_program(app, {argv + 1, argv + argc}, [&] {
    if (!(wish.seconds >= wish.dt && wish.seconds <= 1e6)) {
      throw usage_error("--seconds: must be at least a step, " + std::to_string(wish.dt) + ", and at most a million");
    }
    choose_space(wish.space, [&](auto space) {
      using device = device_of<typename decltype(space)::type>;
      device::require();
      for (named_file const& file : {named_file{"--report", wish.report}, named_file{"--save", wish.save}}) {
        if (!file.path.empty() && !wish.output.empty() && detail::is_within(file.path, wish.output)) {
          throw usage_error(file.name + ": " + file.path + " is in the folder of --output");
        }
      }
      detail::on_ranks<decltype(space)>(wish, [&](auto const& ranks, film const& of_rank) {
        collide::together(ranks, [&] {
          if (ranks.rank() + 1 != ranks.size()) return;
          check_outputs({{"--load", wish.load}}, {{"--report", wish.report}});
          check_outputs({{"--report", wish.report}}, {{"--save", wish.save}});  // may be --load's, too
          if (!wish.output.empty()) detail::make_folder(wish.output);
        });
        auto one = make(device::make(of_rank.threads, device::memory()), of_rank);
        detail::shoot(of_rank, ranks, detail::distributed_over(ranks, std::move(one)));
      });
    });
  });
}

}  // namespace io
