/// \file
/// Finds every pair of a sphere (CSV) and a triangle (OBJ) that touch.

#include <chrono>
#include <list>
#include <optional>

#include <nlohmann/json.hpp>

#include <collide/all_pairs.cuh>
#include <collide/bucket.cuh>
#include <collide/upload.hpp>

#include "io/counting.hpp"
#include "io/csv.hpp"
#include "io/device.hpp"
#include "io/obj.hpp"
#include "io/output.hpp"
#include "io/ply.hpp"
#include "io/program.hpp"
#include "io/progress.hpp"
#include "io/tables.hpp"

namespace {

using clock = std::chrono::steady_clock;

struct options {
  std::string mesh, spheres, radius;
  std::string broad = "bucket", space = "host", precision = "exact", scalar;
  std::string output, contacts, ply, report;
  double cell_width = 0;
  int threads = 0;
  int repeat = 1;
};

/// What a detection gives: the pairs or the contacts, if somebody wants them, and what it cost.
template <class S>
struct findings {
  std::uint64_t total = 0;
  std::vector<collide::pair> pairs;
  std::vector<collide::contact<S>> contacts;
  std::vector<double> build_ms, query_ms, total_ms;
  std::size_t peak_bytes = 0;
  int threads = 1;
  double cell_width = 0;
  std::string device;
};

/// The files' contents.
template <class S>
struct scene {
  io::mesh_data<S> mesh;
  io::sphere_data<S> spheres;
  S radius = 0;  ///< of all spheres, if the file has none
};

double milliseconds(clock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); }

// ---- detection

/// The input in memory of the space: where it is for the host, a copy for CUDA.
template <class Space, class S>
class input {
 public:
  input(Space const& space, scene<S> const& from) : radius_{from.radius}, size_{from.spheres.size()} {
    auto const& mesh = from.mesh;
    auto const local = [&](auto& buffer, auto const& values) {
      if constexpr (Space::host_memory) {
        return values.data();
      } else {
        auto* const to = buffer.reserve(space.resource(), values.size());
        space.copy_from_host(to, values.data(), values.size());
        return to;
      }
    };
    mesh_ = collide::indexed_mesh<S>(local(vertices_, mesh.vertices), mesh.vertices.size() / 3,
                                     local(corners_, mesh.corners), mesh.size());
    xyz_ = local(centres_, from.spheres.xyz);
    if (!from.spheres.radii.empty()) radii_ = local(own_radii_, from.spheres.radii);
  }

  collide::mesh_view<S> mesh() const { return mesh_; }
  std::size_t size() const { return size_; }
  bool one_radius() const { return radii_ == nullptr; }

  /// `count` spheres from number `first` on.
  collide::sphere_view<S> spheres(std::size_t first, std::size_t count) const {
    if (one_radius()) return collide::spheres_xyz(xyz_ + 3 * first, count, radius_);
    return collide::spheres_xyz(xyz_ + 3 * first, count, radii_ + first);
  }

 private:
  collide::buffer<S> vertices_, centres_, own_radii_;
  collide::buffer<collide::id> corners_;
  collide::mesh_view<S> mesh_;
  S const* xyz_ = nullptr;
  S const* radii_ = nullptr;
  S radius_;
  std::size_t size_;
};

/// Appends what a query of the spheres from `first` on has found.
template <class Sink, class Found>
void append(Sink const& sink, std::size_t first, std::vector<Found>& to) {
  auto part = sink.to_host();
  for (auto& found : part) found.sphere += static_cast<collide::id>(first);
  if (to.empty()) {
    to = std::move(part);
  } else {
    to.insert(to.end(), part.begin(), part.end());
  }
}

/// Builds and queries as often as wanted, and calls keep(sink, first) with what the first run finds.
///
/// If someone watches and it takes longer than a person has patience for, the spheres are queried in parts of about a
/// fifth of that time, for the progress bar; otherwise all at once.
template <class Detector, class Input, class Sink, class S, class Keep>
void measure(options const& wish, Detector& detector, Input const& in, Sink& sink, findings<S>& out, Keep const& keep) {
  std::size_t const n = in.size();
  std::size_t step = n;
  io::progress bar("detecting", static_cast<double>(n) * wish.repeat);
  auto const timed = [&](auto const& work) {
    auto const start = clock::now();
    work();
    detector.space().synchronize();
    return milliseconds(clock::now() - start);
  };
  auto const query = [&](std::size_t first, std::size_t count) {
    return timed([&] { detector.query(in.spheres(first, count), sink); });
  };
  for (int run = 0; run < wish.repeat; ++run) {
    double const build = timed([&] {
      if (in.one_radius()) {
        detector.build(in.mesh(), in.spheres(0, 0).common_radius());
      } else {
        detector.build(in.mesh());
      }
    });
    constexpr std::size_t probe = 1024;
    if (run == 0 && io::progress::watched() && n > probe) {
      double const once = query(0, probe);
      double const patience = 1000 * io::progress::patience();
      if (once * static_cast<double>(n / probe) > patience) {
        step = std::max<std::size_t>(1, static_cast<std::size_t>(probe * std::min(patience / 5 / once, 1e6)));
      }
    }
    double spent = 0;
    std::size_t first = 0;
    do {
      spent += query(first, std::min(step, n - first));
      if (run == 0) keep(sink, first);
      first += step;
      bar.update(static_cast<double>(n) * run + static_cast<double>(std::min(first, n)));
    } while (first < n);
    out.build_ms.push_back(build);
    out.query_ms.push_back(spent);
    out.total_ms.push_back(build + spent);
  }
}

template <class Broad, class Precision, class Space, class S>
findings<S> detect(options const& wish, scene<S> const& from, Broad const& broad) {
  using device = io::device_of<Space>;
  io::counting_resource memory(device::memory());
  findings<S> out;
  {
    collide::detector<Broad, collide::karabassi<Precision>, Space, S> detector(device::make(wish.threads, &memory),
                                                                               broad);
    input<Space, S> const in(detector.space(), from);
    if (Space::host_memory) {
      memory.add((from.mesh.vertices.size() + from.spheres.xyz.size() + from.spheres.radii.size()) * sizeof(S) +
                 from.mesh.corners.size() * sizeof(collide::id));
    }
    auto const run = [&](auto sink, auto const& keep) { measure(wish, detector, in, sink, out, keep); };
    if (!wish.contacts.empty()) {
      run(collide::contacts<S>(collide::order::canonical),
          [&](auto const& sink, std::size_t first) { append(sink, first, out.contacts); });
      out.total = out.contacts.size();
    } else if (!wish.output.empty() || !wish.ply.empty()) {
      run(collide::pairs(collide::order::canonical),
          [&](auto const& sink, std::size_t first) { append(sink, first, out.pairs); });
      out.total = out.pairs.size();
    } else {
      run(collide::count(), [&](auto const& sink, std::size_t) { out.total += sink.total(); });
    }
    out.cell_width = detector.cell_width();
    out.threads = device::threads(detector.space());
  }
  out.peak_bytes = memory.peak();
  out.device = device::name();
  return out;
}

// ---- input and output

template <class S>
scene<S> read(options const& wish) {
  scene<S> from{io::read_obj<S>(wish.mesh), io::read_csv<S>(wish.spheres), {}};
  if (!from.spheres.has_radii) {
    if (wish.radius.empty()) throw io::usage_error("--radius: is required, as " + wish.spheres + " has no column r");
    io::parse_number(wish.radius, from.radius);
  }
  return from;
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

template <class S>
void summarise(options const& wish, scene<S> const& from, findings<S> const& found,
               nlohmann::ordered_json const& report) {
  for (auto const& path : {wish.output, wish.contacts, wish.ply, wish.report}) {
    if (!path.empty() && io::output_file::is_standard_output(path)) return;
  }
  auto const median = [&](char const* what) { return report[what]["median"].template get<double>(); };
  std::cout << found.total << " colliding pairs of " << from.spheres.size() << " spheres and " << from.mesh.size()
            << " triangles\n"
            << wish.broad << " on " << wish.space << " (" << found.device << "), " << wish.precision << " precision";
  if (found.cell_width > 0) std::cout << ", cells of width " << found.cell_width;
  std::cout << "\nbuild " << median("build_ms") << " ms, query " << median("query_ms") << " ms, "
            << static_cast<double>(found.peak_bytes) / 1e6 << " MB\n";
  if (from.spheres.has_radii && !wish.radius.empty()) {
    std::cout << "radii are those of column r of " << wish.spheres << ", not --radius\n";
  }
}

template <class Broad, class Precision, class Space, class S>
void run(options const& wish, Broad const& broad) {
  io::device_of<Space>::require();
  auto start = clock::now();
  auto const from = read<S>(wish);
  double const read_ms = milliseconds(clock::now() - start);
  auto found = detect<Broad, Precision, Space, S>(wish, from, broad);

  nlohmann::ordered_json report{
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
  summarise(wish, from, found, report);
}

template <class Broad>
Broad broad_phase(options const& wish) {
  if constexpr (std::is_same<Broad, collide::bucket>::value) {
    return collide::bucket{wish.cell_width};
  } else {
    return Broad{};
  }
}

/// Runs the composition that the options name.
void run(options const& wish) {
  using io::choose, io::named;
  choose(
      wish.scalar,
      [&](auto scalar) {
        choose(
            wish.precision,
            [&](auto precision) {
              choose(
                  wish.broad,
                  [&](auto broad) {
                    using broad_type = typename decltype(broad)::type;
                    io::choose_space(wish.space, [&](auto space) {
                      run<broad_type, typename decltype(precision)::type, typename decltype(space)::type,
                          typename decltype(scalar)::type>(wish, broad_phase<broad_type>(wish));
                    });
                  },
                  named<collide::all_pairs>{"all_pairs"}, named<collide::bucket>{"bucket"});
            },
            named<collide::exact>{"exact"}, named<collide::single_precision>{"single"},
            named<collide::double_precision>{"double"});
      },
      named<float>{"float"}, named<double>{"double"});
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
  if (wish.scalar.empty()) wish.scalar = wish.precision == "double" ? "double" : "float";
  io::check_outputs(
      {{"MESH", wish.mesh}, {"SPHERES", wish.spheres}},
      {{"--output", wish.output}, {"--contacts", wish.contacts}, {"--ply", wish.ply}, {"--report", wish.report}});
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
  io::add_choice(app, "--scalar", wish.scalar, {"float", "double"},
                 "type of the coordinates; double with --precision double, else float");
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
