/// \file
/// Finds every pair of a sphere (CSV) and a triangle (OBJ, STL, PLY, OFF or glTF) that touch. What finds them is in
/// detect/, and compiled once for each scalar type, as CUDA where there is nvcc. Nothing here is for CUDA.

#include <algorithm>
#include <cmath>
#include <limits>
#include <list>
#include <optional>

#include <nlohmann/json.hpp>

#include <collide/checks/self_intersections.hpp>
#include <collide/checks/validate_closed.hpp>

#include "detect/detection.hpp"
#include "io/mesh.hpp"
#include "io/on_ranks.hpp"
#include "io/output.hpp"
#include "io/ply.hpp"
#include "io/program.hpp"
#include "io/ranks.hpp"
#include "io/tables.hpp"
#include "io/text.hpp"

namespace {

using detection::clock, detection::milliseconds;
using detection::findings, detection::options, detection::scene;

/// Each rank reads the mesh, and its part of the spheres.
template <class S, class Ranks>
scene<S> read(Ranks const& ranks, options const& wish, std::string_view mesh, std::string_view spheres) {
  scene<S> from;
  double smallest = std::numeric_limits<double>::infinity();
  io::read_together(ranks, [&] {
    from.mesh = io::read_mesh<S>(wish.mesh, mesh, wish.strict);
    from.spheres = io::read_csv<S>(wish.spheres, spheres, ranks.rank(), ranks.size());
    from.tally = from.mesh.tally;
    if (!from.spheres.has_radii) {
      if (wish.radius.empty() && !wish.asks_points()) {
        throw io::usage_error("--radius: is required, as " + wish.spheres + " has no column r");
      }
      if (!wish.radius.empty()) {
        io::parse_number(wish.radius, from.radius, from.tally);
        smallest = from.radius;
      }
    }
    auto const& radii = from.spheres.radii;
    if (!radii.empty()) smallest = *std::min_element(radii.begin(), radii.end());
  });
  from.tally += io::sum(ranks, from.spheres.tally);
  from.first_sphere = static_cast<std::size_t>(collide::count_before(ranks, from.spheres.size()));
  from.all_spheres = static_cast<std::size_t>(io::sum(ranks, from.spheres.size()));
  if (from.all_spheres > 0) from.coarse = io::coarse(from.tally.most, io::smallest(ranks, smallest));
  return from;
}

/// Reads the files as the scalar type that the options name, or chooses one.
template <class Ranks>
auto read(Ranks const& ranks, options& wish) {
  std::optional<io::text_file> mesh, spheres;
  io::read_together(ranks, [&] {
    mesh.emplace(wish.mesh);
    spheres.emplace(wish.spheres);
  });
  return io::read_as(wish.scalar,
                     [&](auto scalar) { return read<decltype(scalar)>(ranks, wish, mesh->view(), spheres->view()); });
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
  to(wish.output, [&](auto& out) {
    if (wish.inside) return io::write_inside(out, found.inside);
    if (wish.asks_points()) return io::write_nearest(out, found.nearest);
    io::write_pairs(out, found.pairs);
  });
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
  if (wish.asks_for_sides()) {
    auto const mesh = collide::indexed_mesh<S>(from.mesh.vertices.data(), from.mesh.vertices.size() / 3,
                                               from.mesh.corners.data(), from.mesh.size());
    auto const seams = collide::validate_closed(mesh);
    if (!seams.closed())
      std::cerr << "detect: the mesh is not closed, so sides mean little: " << seams.message() << "\n";
    auto const pairs = collide::self_intersections(mesh);
    if (!pairs.empty())
      std::cerr << "detect: the mesh cuts or touches itself, and what is inside twice counts as outside: "
                << pairs.size() << " pair(s) of triangles, the first are number " << pairs[0].first << " and "
                << pairs[0].second << "\n";
  }
  for (auto const& path : {wish.output, wish.contacts, wish.ply, wish.report}) {
    if (path.empty() || !io::output_file::is_standard_output(path)) continue;
    if (from.tally.rounded > 0) std::cerr << "detect: " << roundings << "\n";
    return;
  }
  auto const median = [&](char const* what) { return report[what]["median"].template get<double>(); };
  std::cout << found.total
            << (wish.inside          ? " points inside, of "
                : wish.asks_points() ? " points with a nearest triangle, of "
                                     : " colliding pairs of ")
            << from.all_spheres << (wish.asks_points() ? " points and " : " spheres and ") << from.mesh.size()
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

/// Brings what all ranks have found to the first.
template <class S, class Ranks>
void gather(Ranks const& ranks, options const& wish, scene<S>& from, findings<S>& found) {
  auto const first = static_cast<collide::id>(from.first_sphere);
  for (auto& p : found.pairs) p.sphere += first;
  for (auto& c : found.contacts) c.sphere += first;
  io::gather_to_first(ranks, found.pairs);
  io::gather_to_first(ranks, found.contacts);
  io::gather_to_first(ranks, found.nearest);
  io::gather_to_first(ranks, found.inside);
  found.total = io::sum(ranks, found.total);
  if (wish.ply.empty()) return;
  io::gather_to_first(ranks, from.spheres.xyz);
  io::gather_to_first(ranks, from.spheres.radii);
}

template <class S, class Ranks>
void run(Ranks const& ranks, options const& wish, scene<S>& from, double read_ms, std::string const& roundings) {
  if (from.all_spheres >= collide::no_id) throw io::data_error(wish.spheres, "more than 2^32 - 2 spheres");
  findings<S> found;
  collide::together(ranks, [&] { found = detection::detect(wish, from); });
  gather(ranks, wish, from, found);
  collide::together(ranks, [&] {
    if (ranks.rank() != 0) return;
    nlohmann::ordered_json report{
        {wish.inside          ? "inside"
         : wish.asks_points() ? "nearest"
                              : "pairs",
         found.total},
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
        {"spheres", from.all_spheres},
        {"repeat", wish.repeat},
        {"read_ms", read_ms},
        {"version", io::version()},
    };
    if (!wish.ranks.empty()) report["ranks"] = ranks.size();
    write(wish, from, found, report);
    summarise(wish, from, found, report, roundings);
  });
}

/// As `read`, but the rank with a bad file says to all what is wrong.
template <class Ranks>
auto read_or_agree(Ranks const& ranks, options& wish) {
  try {
    return read(ranks, wish);
  } catch (io::error_elsewhere const&) {
    collide::agree(ranks);
    throw;
  } catch (io::data_error const&) {
    collide::agree(ranks, std::current_exception());
    throw;
  }
}

template <class Ranks>
void run(Ranks const& ranks, options wish) {
  auto const start = clock::now();
  auto input = read_or_agree(ranks, wish);
  double const read_ms = milliseconds(clock::now() - start);
  std::visit([&](auto& from) { run(ranks, wish, from, read_ms, input.roundings); }, input.data);
}

/// Ranks that are threads share the cores and the devices.
void run(options const& wish) {
  if (wish.ranks.empty()) return run(collide::one_rank(), wish);
  io::on_ranks(
      wish.ranks, [&](int rank) { detection::take_device(wish.space, rank); },
      [&](io::any_ranks const& ranks) { run(ranks, wish); });
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
  if (wish.triangles_per_pass != 0 && wish.space != "host") {
    throw io::usage_error("--triangles-per-pass: is for --space host");
  }
  if (!wish.ranks.empty()) io::check_ranks(wish.ranks, wish.space);
  if (wish.asks_points()) {
    std::string const asked = wish.nearest ? "--nearest" : wish.signed_distance ? "--signed-distance" : "--inside";
    if (wish.nearest + wish.signed_distance + wish.inside > 1)
      throw io::usage_error(asked + ": points are asked one thing at a time");
    if (wish.broad == "bucket")
      throw io::usage_error("--broad: bucket cannot find what is far away: " + asked + " takes bvh or all_pairs");
    if (wish.triangles_per_pass != 0) throw io::usage_error("--triangles-per-pass: is not for " + asked);
    if (!wish.contacts.empty()) throw io::usage_error("--contacts: is not for " + asked);
    if (!wish.ply.empty()) throw io::usage_error("--ply: is not for " + asked);
  }
  if (wish.broad.empty()) wish.broad = wish.asks_points() ? "bvh" : "bucket";
  // of points near a surface all digits count
  if (wish.scalar.empty() && (wish.precision == "double" || wish.asks_points())) wish.scalar = "double";
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
  file("mesh", wish.mesh, "the triangles: an OBJ, STL, PLY or OFF file, or with Assimp glTF")->required();
  file("spheres", wish.spheres, "the spheres, a CSV file with columns x, y, z and perhaps r")->required();
  app.add_option("--radius,radius", wish.radius, "radius of all spheres; a column r has precedence")->type_name("R");
  file("--output,output", wish.output, "colliding pairs (CSV), by sphere and then by triangle, ids from 0");
  file("--contacts", wish.contacts, "contacts (CSV): point, normal, depth and feature touched");
  file("--ply", wish.ply, "picture of the hits (PLY) for ParaView or MeshLab");
  file("--report", wish.report, "measurements (JSON)");
  app.add_flag("--nearest", wish.nearest,
               "the nearest triangle of each point instead (CSV: point, triangle, x, y, z, distance); a radius counts");
  app.add_flag("--signed-distance", wish.signed_distance,
               "the same of a closed mesh, with distances that are negative inside; a radius does not count");
  app.add_flag("--inside", wish.inside, "which points are inside a closed mesh instead (CSV: point, inside)");
  io::add_choice(app, "--broad", wish.broad, {"all_pairs", "bucket", "bvh"},
                 "broad phase; if not given bucket, of points bvh");
  io::add_choice(app, "--space", wish.space, {"host", "cuda", "cuda_shared"}, "execution space");
  io::add_choice(app, "--precision", wish.precision, {"exact", "single", "double"}, "how sure verdicts are");
  io::add_choice(app, "--scalar", wish.scalar, {"float", "double"},
                 "type of the coordinates; double if not given with --precision double, for points, or where float is "
                 "too coarse; else float");
  app.add_flag("--strict", wish.strict,
               "refuse a mesh with faces that would be left out, or lines that may be a mistake");
  app.add_option("--threads", wish.threads, "threads of the host; 0 for all")
      ->check(CLI::Range(0, 1024))
      ->type_name("N");
  app.add_option("--cell-width", wish.cell_width, "width of the buckets; 0 for the best")->type_name("W");
  app.add_option("--triangles-per-pass", wish.triangles_per_pass,
                 "how many triangles to build at a time, for large meshes, on the host; all if not given")
      ->check(CLI::Range(std::size_t{1}, std::size_t{4294967294}))
      ->type_name("N");
  app.add_option(
         "--ranks", wish.ranks,
         "parts that each take some spheres: threads:N of this process, or the processes of mpirun: mpi, or nccl with "
         "a GPU each")
      ->type_name("RANKS");
  app.add_option("--repeat", wish.repeat, "how often to measure")->check(CLI::Range(1, 1'000'000))->type_name("N");
  app.footer("`detect MESH SPHERES RADIUS OUTPUT` is the short form.");
  io::rank_session session;  // until all has been said
  return io::run_program(app, {argv + 1, argv + argc}, [&] {
    check(wish);
    session.begin(wish.ranks, argc, argv);
    run(wish);
  });
}
