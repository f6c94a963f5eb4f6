/// \file
/// Finds every pair of a sphere (CSV) and a triangle (OBJ) that touch. What finds them is in detect/, and compiled once
/// for each scalar type, as CUDA where there is nvcc. Nothing here is for CUDA.

#include <algorithm>
#include <cmath>
#include <list>

#include <nlohmann/json.hpp>

#include "detect/detection.hpp"
#include "io/output.hpp"
#include "io/ply.hpp"
#include "io/program.hpp"
#include "io/tables.hpp"
#include "io/text.hpp"

namespace {

using detection::clock, detection::milliseconds;
using detection::findings, detection::options, detection::scene;

template <class S>
scene<S> read(options const& wish, std::string_view mesh, std::string_view spheres) {
  scene<S> from;
  from.mesh = io::read_obj<S>(wish.mesh, mesh, wish.strict);
  from.spheres = io::read_csv<S>(wish.spheres, spheres);
  from.tally = from.mesh.tally;
  from.tally += from.spheres.tally;
  if (!from.spheres.has_radii) {
    if (wish.radius.empty()) throw io::usage_error("--radius: is required, as " + wish.spheres + " has no column r");
    io::parse_number(wish.radius, from.radius, from.tally);
  }
  if (from.spheres.size() > 0) {
    auto const& radii = from.spheres.radii;
    S const smallest = radii.empty() ? from.radius : *std::min_element(radii.begin(), radii.end());
    from.coarse = io::coarse(from.tally.most, smallest);
  }
  return from;
}

/// Reads the files as the scalar type that the options name, or chooses one.
auto read(options& wish) {
  io::text_file const mesh(wish.mesh), spheres(wish.spheres);
  return io::read_as(wish.scalar,
                     [&](auto scalar) { return read<decltype(scalar)>(wish, mesh.view(), spheres.view()); });
}

nlohmann::ordered_json statistics(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  auto const middle = values.size() / 2;
  double const median = values.size() % 2 != 0 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
  return {{"min", values.front()}, {"median", median}, {"max", values.back()}};
}

template <class S>
void write(options const& wish, scene<S> const& from, findings<S>& found, nlohmann::ordered_json const& report) {
  if (found.pairs.empty()) {
    for (auto const& c : found.contacts) found.pairs.push_back({c.sphere, c.triangle});
  }
  std::list<io::output_file> files;  // they all appear together, when all of them are complete
  auto const to = [&](std::string const& path, auto const& fill) {
    if (path.empty()) return;
    fill(files.emplace_back(path));
    files.back().close();
  };
  to(wish.output, [&](auto& out) { io::write_pairs(out, found.pairs); });
  to(wish.contacts, [&](auto& out) { io::write_contacts(out, found.contacts); });
  to(wish.ply, [&](auto& out) { io::write_ply(out, from.mesh, from.spheres, from.radius, found.pairs); });
  to(wish.report, [&](auto& out) { out << report.dump(2) << "\n"; });
  for (auto& file : files) file.commit();
}

/// Says what may be a surprise, and how it went, unless standard output has something else to take.
template <class S>
void summarise(options const& wish, scene<S> const& from, findings<S> const& found,
               nlohmann::ordered_json const& report, std::string const& roundings) {
  for (auto const& remark : from.mesh.remarks) std::cerr << "detect: " << remark << "\n";
  for (auto const& path : {wish.output, wish.contacts, wish.ply, wish.report}) {
    if (path.empty() || !io::output_file::is_standard_output(path)) continue;
    if (from.tally.rounded > 0) std::cerr << "detect: " << roundings << "\n";
    return;
  }
  auto const median = [&](char const* what) { return report[what]["median"].template get<double>(); };
  std::cout << found.total << " colliding pairs of " << from.spheres.size() << " spheres and " << from.mesh.size()
            << " triangles\n"
            << wish.broad << " on " << wish.space << " (" << found.device << "), " << wish.precision << " precision";
  if (found.cell_width > 0) std::cout << ", cells of width " << found.cell_width;
  std::cout << "\nbuild " << median("build_ms") << " ms, query " << median("query_ms") << " ms, "
            << static_cast<double>(found.peak_bytes) / 1e6 << " MB\n"
            << roundings << "\n";
  if (from.spheres.has_radii && !wish.radius.empty()) {
    std::cout << "radii are those of column r of " << wish.spheres << ", not --radius\n";
  }
}

template <class S>
void run(options const& wish, scene<S> const& from, double read_ms, std::string const& roundings) {
  auto found = detection::detect(wish, from);
  nlohmann::ordered_json const report{
      {"pairs", found.total},
      {"build_ms", statistics(found.build_ms)},
      {"query_ms", statistics(found.query_ms)},
      {"total_ms", statistics(found.total_ms)},
      {"peak_bytes", found.peak_bytes},
      {"threads", found.threads},
      {"space", wish.space},
      {"broad", wish.broad},
      {"precision", wish.precision},
      {"scalar", wish.scalar},
      {"cell_width", found.cell_width},
      {"device", found.device},
      {"triangles", from.mesh.size()},
      {"spheres", from.spheres.size()},
      {"repeat", wish.repeat},
      {"read_ms", read_ms},
      {"version", io::version()},
  };
  write(wish, from, found, report);
  summarise(wish, from, found, report, roundings);
}

void run(options& wish) {
  auto const start = clock::now();
  auto const input = read(wish);
  double const read_ms = milliseconds(clock::now() - start);
  std::visit([&](auto const& from) { run(wish, from, read_ms, input.roundings); }, input.data);
}

/// Checks what CLI11 does not, before any work is done.
void check(options& wish) {
  if (!wish.radius.empty()) {
    double radius = 0;
    if (!io::parse_number(wish.radius, radius) || std::isnan(radius)) {
      throw io::usage_error("--radius: " + io::quoted(wish.radius) + " is not a number");
    }
    if (radius < 0) throw io::usage_error("--radius: " + io::quoted(wish.radius) + " is negative");
  }
  if (!(wish.cell_width >= 0) || std::isinf(wish.cell_width)) {
    throw io::usage_error("--cell-width: must be finite and not negative");
  }
  if (wish.scalar.empty() && wish.precision == "double") wish.scalar = "double";
  io::check_outputs(
      {{"MESH", wish.mesh}, {"SPHERES", wish.spheres}},
      {{"--output", wish.output}, {"--contacts", wish.contacts}, {"--ply", wish.ply}, {"--report", wish.report}});
  detection::require_space(wish.space);
}

}  // namespace

int main(int argc, char** argv) {
  options wish;
  CLI::App app("Finds every pair of a sphere and a triangle that touch.", "detect");
  auto const file = [&](char const* name, std::string& path, char const* about) {
    return app.add_option(name, path, about)->type_name("FILE");
  };
  file("mesh", wish.mesh, "the triangles, an OBJ file")->required();
  file("spheres", wish.spheres, "the spheres, a CSV file with columns x, y, z and perhaps r")->required();
  app.add_option("--radius,radius", wish.radius, "radius of all spheres; a column r has precedence")->type_name("R");
  file("--output,output", wish.output, "colliding pairs (CSV), by sphere and then by triangle, ids from 0");
  file("--contacts", wish.contacts, "contacts (CSV): point, normal, depth and feature touched");
  file("--ply", wish.ply, "picture of the hits (PLY) for ParaView or MeshLab");
  file("--report", wish.report, "measurements (JSON)");
  io::add_choice(app, "--broad", wish.broad, {"all_pairs", "bucket"}, "broad phase");
  io::add_choice(app, "--space", wish.space, {"host", "cuda", "cuda_shared"}, "execution space");
  io::add_choice(app, "--precision", wish.precision, {"exact", "single", "double"}, "how sure verdicts are");
  io::add_choice(
      app, "--scalar", wish.scalar, {"float", "double"},
      "type of the coordinates; double if not given with --precision double or where float is too coarse, else float");
  app.add_flag("--strict", wish.strict,
               "refuse a mesh with faces that would be left out, or lines that may be a mistake");
  app.add_option("--threads", wish.threads, "threads of the host; 0 for all")
      ->check(CLI::Range(0, 1024))
      ->type_name("N");
  app.add_option("--cell-width", wish.cell_width, "width of the buckets; 0 for the best")->type_name("W");
  app.add_option("--repeat", wish.repeat, "how often to measure")->check(CLI::Range(1, 1'000'000))->type_name("N");
  app.footer("`detect MESH SPHERES RADIUS OUTPUT` is the short form.");
  return io::run_program(app, {argv + 1, argv + argc}, [&] {
    check(wish);
    run(wish);
  });
}
