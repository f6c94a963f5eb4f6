/// \file
/// The part of the programs that show scenes which is compiled once.
#include "film.hpp"

#include <cstdio>
#include <filesystem>
#include <iostream>

#include <nlohmann/json.hpp>

#include "on_ranks.hpp"
#include "output.hpp"
#include "program.hpp"

namespace io {
namespace {

/// True if a file is in a folder, or a folder of that; either may not be there yet.
bool is_within(std::string const& file, std::string const& folder) {
  using std::filesystem::weakly_canonical;
  auto const way = weakly_canonical(file).lexically_relative(weakly_canonical(folder));
  return !way.empty() && *way.begin() != "..";
}

/// Makes the folder that the film is to be in, which may be there already, but empty: no film is lost.
void make_folder(std::string const& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  bool const empty = !error && std::filesystem::is_empty(path, error);
  if (error) throw data_error(path, error.message());
  if (!empty) throw data_error(path, "the folder is not empty");
  output_file::check(path + "/film.pvd");
}

/// Refuses files that --output would lose, and makes its folder.
void prepare_files(film const& wish) {
  check_outputs({{"--load", wish.load}}, {{"--report", wish.report}});
  check_outputs({{"--report", wish.report}}, {{"--save", wish.save}});  // may be --load's, too
  if (!wish.output.empty()) make_folder(wish.output);
}

/// Checks what CLI11 does not.
void check(film const& wish) {
  if (!(wish.seconds >= wish.dt && wish.seconds <= 1e6)) {
    throw usage_error("--seconds: must be at least a step, " + std::to_string(wish.dt) + ", and at most a million");
  }
  for (named_file const& file : {named_file{"--report", wish.report}, named_file{"--save", wish.save}}) {
    if (!file.path.empty() && !wish.output.empty() && is_within(file.path, wish.output)) {
      throw usage_error(file.name + ": " + file.path + " is in the folder of --output");
    }
  }
  if (wish.ranks.empty()) return;
  check_ranks(wish.ranks, wish.space);
  if (wish.space == "cuda") throw usage_error("--ranks: works with --space host or cuda_shared");
}

/// Adds the options of a film.
void add_options(CLI::App& app, film& wish) {
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
  app.add_option("--ranks", wish.ranks,
                 "threads:N, or under mpirun mpi, or nccl with a GPU each: so many simulate together")
      ->type_name("RANKS");
}

}  // namespace

void report(film const& of, film_cost const& cost) {
  std::cout << of.name << ": " << of.particles << " particles, " << cost.steps << " steps of " << of.dt << " s, "
            << cost.milliseconds_per_step << " ms a step, " << cost.bytes_per_particle
            << " bytes a particle in columns, " << (cost.ranks > 1 ? std::to_string(cost.ranks) + " ranks, " : "")
            << of.space << " (" << cost.device
            << (cost.threads > 1 ? ", " + std::to_string(cost.threads) + " threads" : "") << ")\n";
  if (of.report.empty()) return;
  output_file report(of.report);
  report << nlohmann::ordered_json{{"scene", of.name},
                                   {"particles", of.particles},
                                   {"triangles", of.stage.triangle_count()},
                                   {"steps", cost.steps},
                                   {"dt", of.dt},
                                   {"ms_per_step", cost.milliseconds_per_step},
                                   {"bytes_per_particle", cost.bytes_per_particle},
                                   {"space", of.space},
                                   {"threads", cost.threads},
                                   {"ranks", cost.ranks},
                                   {"device", cost.device},
                                   {"version", version()}}
                .dump(2)
         << "\n";
  report.commit();
}

void write_mesh(std::string const& path, std::vector<float> const& vertices,
                std::vector<std::uint32_t> const& corners) {
  output_file out(path);
  collide::write_vtp(out, vertices, {}, collide::vtk_cells::triangles, corners);
  out.commit();
}

std::vector<float> moved_vertices(film const& of, std::vector<collide::body_state> const& states) {
  auto const& stage = of.stage;
  std::vector<float> found(stage.vertices.begin(), stage.vertices.end());
  for (std::size_t k = 0; k < of.bodies.size(); ++k) {
    auto const& body = of.bodies[k];
    for (std::size_t c = 3 * body.first; c < 3 * (body.first + body.size); ++c) {
      point const p = vertex_of(stage, c);
      auto const at = states[k].at({p[0], p[1], p[2]});
      for (int i = 0; i < 3; ++i) found[3 * std::size_t{stage.corners[c]} + std::size_t(i)] = static_cast<float>(at[i]);
    }
  }
  return found;
}

collide::vtk_frame next_frame(film const& of, std::size_t i, double time) {
  char number[16];
  std::snprintf(number, sizeof number, "-%05zu.vtp", i);
  return {std::string("particles") + number, time, of.bodies.empty() ? "" : std::string("mesh") + number};
}

int run_film(int argc, char** argv, film wish, std::function<void(film const&, int)> const& take,
             std::function<void(film const&, any_ranks const*)> const& shoot) {
  CLI::App app(wish.about, wish.name);
  add_options(app, wish);
  rank_session session;
  return run_program(app, {argv + 1, argv + argc}, [&] {
    check(wish);
    if (wish.ranks.empty()) {
      take(wish, 0);
      prepare_files(wish);
      return shoot(wish, nullptr);
    }
    session.begin(wish.ranks, argc, argv);
    on_ranks(
        wish.ranks, [&](int rank) { take(wish, rank); },
        [&](any_ranks const& ranks) {
          collide::together(ranks, [&] {
            if (ranks.rank() + 1 == ranks.size()) prepare_files(wish);
          });
          shoot(wish, &ranks);
        });
  });
}

}  // namespace io
