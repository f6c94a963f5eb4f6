/// \file
/// Writes a scene as an OBJ and a CSV file.

#include <map>
#include <optional>

#include "io/number.hpp"
#include "io/output.hpp"
#include "io/program.hpp"
#include "io/progress.hpp"
#include "io/scenes.hpp"
#include "io/scenes/order.hpp"

namespace {

struct options {
  std::string scene = "study";
  std::string mesh = "mesh.obj";
  std::string spheres_file = "spheres.csv";
  std::optional<std::size_t> spheres, triangles;
  std::uint64_t seed = 0;
  std::string offset = "0";
  std::optional<double> radius;
  std::string scalar = "float";
  std::string triangle_order = "made", vertex_order = "made", sphere_order = "made";
};

std::map<std::string, io::order> const orders{{"made", io::order::made},
                                              {"shuffled", io::order::shuffled},
                                              {"along_x", io::order::along_x},
                                              {"halves", io::order::halves}};

/// `x` as it is written: a number of the file's scalar type.
struct rounded {
  bool to_float;
  double x;
};

io::output_file& operator<<(io::output_file& out, rounded const& r) {
  return r.to_float ? out << static_cast<float>(r.x) : out << r.x;
}

void write_mesh(io::output_file& out, io::scene const& scene, bool to_float) {
  auto const& v = scene.vertices;
  auto const& c = scene.corners;
  io::progress bar("writing the mesh", static_cast<double>(v.size() + c.size()));
  for (std::size_t i = 0; i < v.size(); i += 3) {
    out << "v " << rounded{to_float, v[i]} << " " << rounded{to_float, v[i + 1]} << " " << rounded{to_float, v[i + 2]}
        << "\n";
    if (i % 4096 == 0) bar.update(static_cast<double>(i));
  }
  for (std::size_t i = 0; i < c.size(); i += 3) {
    out << "f " << c[i] + 1 << " " << c[i + 1] + 1 << " " << c[i + 2] + 1 << "\n";
    if (i % 4096 == 0) bar.update(static_cast<double>(v.size() + i));
  }
}

void write_spheres(io::output_file& out, io::scene const& scene, bool to_float) {
  auto const& p = scene.centres;
  io::progress bar("writing the spheres", static_cast<double>(p.size()));
  out << (scene.radii.empty() ? "x,y,z\n" : "x,y,z,r\n");
  for (std::size_t i = 0; i < p.size(); i += 3) {
    out << rounded{to_float, p[i]} << "," << rounded{to_float, p[i + 1]} << "," << rounded{to_float, p[i + 2]};
    if (!scene.radii.empty()) out << "," << rounded{to_float, scene.radii[i / 3]};
    out << "\n";
    if (i % 4096 == 0) bar.update(static_cast<double>(i));
  }
}

/// The offset: one number for all axes, or three.
io::point offset_of(options const& wish) {
  std::vector<double> numbers;
  for (std::string_view left = wish.offset; numbers.empty() || !left.empty();) {
    auto const text = left.substr(0, left.find(','));
    left.remove_prefix(std::min(text.size() + 1, left.size()));
    double x = 0;
    if (!io::parse_number(io::trimmed(text), x) || !std::isfinite(x)) {
      throw io::usage_error("--offset: " + io::quoted(text) + " is not a finite number");
    }
    numbers.push_back(x);
  }
  if (numbers.size() == 1) return {numbers[0], numbers[0], numbers[0]};
  if (numbers.size() != 3) throw io::usage_error("--offset: takes one number or three");
  return {numbers[0], numbers[1], numbers[2]};
}

/// Joins the three numbers of `--offset X Y Z` to X,Y,Z, so that they cannot be mistaken for the names of files.
std::vector<std::string> join_offset(int argc, char** argv) {
  std::vector<std::string> args(argv + 1, argv + argc);
  double x = 0;
  auto const number = [&](std::size_t i) { return i < args.size() && io::parse_number(args[i], x); };
  for (std::size_t i = 0; i < args.size(); ++i) {
    if (args[i] == "--offset" && number(i + 1) && number(i + 2) && number(i + 3)) {
      args[i + 1] += ',' + args[i + 2] + ',' + args[i + 3];
      args.erase(args.begin() + static_cast<std::ptrdiff_t>(i) + 2, args.begin() + static_cast<std::ptrdiff_t>(i) + 4);
    }
  }
  return args;
}

void generate(options const& wish) {
  auto const offset = offset_of(wish);
  auto const& kind = *io::find_scene(wish.scene);
  auto scene = kind.make(wish.spheres.value_or(kind.spheres), wish.triangles.value_or(kind.triangles), wish.seed);
  io::order_vertices(scene, orders.at(wish.vertex_order), wish.seed);
  io::order_triangles(scene, orders.at(wish.triangle_order), wish.seed);
  io::order_spheres(scene, orders.at(wish.sphere_order), wish.seed);
  io::shift(scene, offset);
  if (wish.radius) {
    scene.radii.clear();
    scene.radius = *wish.radius;
  }

  bool const to_float = wish.scalar == "float";
  io::output_file mesh(wish.mesh), spheres(wish.spheres_file);
  write_mesh(mesh, scene, to_float);
  write_spheres(spheres, scene, to_float);
  mesh.close();
  spheres.close();
  mesh.commit();
  spheres.commit();

  if (io::output_file::is_standard_output(wish.mesh) || io::output_file::is_standard_output(wish.spheres_file)) return;
  std::cout << wish.mesh << ": " << scene.triangle_count() << " triangles\n"
            << wish.spheres_file << ": " << scene.sphere_count() << " spheres, ";
  if (scene.radii.empty()) {
    std::cout << "for --radius " << scene.radius << "\n";
  } else {
    std::cout << "with radii\n";
  }
}

/// The line of the help for a kind of scene.
std::string line_of(io::scene_kind const& kind) {
  auto const name = std::string(kind.name), spheres = std::to_string(kind.spheres),
             triangles = std::to_string(kind.triangles);
  auto const gap = [](std::size_t width, std::string const& text) {
    return std::string(width - std::min(width, text.size()), ' ');
  };
  return "  " + name + gap(16, name) + gap(8, spheres) + spheres + gap(10, triangles) + triangles + "  " + kind.about +
         "\n";
}

}  // namespace

int main(int argc, char** argv) {
  options wish;
  std::vector<std::string> names;
  std::string footer = "Scenes, with how many spheres and triangles they have if nothing else is said:\n";
  io::for_each_scene([&](io::scene_kind const& kind) {
    names.emplace_back(kind.name);
    footer += line_of(kind);
  });
  footer += "\nThe same options write the same files everywhere.";

  CLI::App app("Writes a mesh (OBJ) and spheres (CSV) to detect collisions between.", "generate");
  app.option_defaults()->always_capture_default();
  app.add_option("mesh,--mesh", wish.mesh, "the mesh's file")->type_name("MESH.obj");
  app.add_option("spheres_file,--spheres-file,--csv", wish.spheres_file, "the spheres' file")->type_name("SPHERES.csv");
  app.add_option("--scene", wish.scene, "which scene, see below")->check(CLI::IsMember(names))->type_name("NAME");
  app.add_option("-n,--spheres", wish.spheres, "how many spheres; the scene's own number if not given")->type_name("N");
  app.add_option("--triangles", wish.triangles, "about how many triangles; the scene's own number if not given")
      ->type_name("N");
  app.add_option("--offset", wish.offset, "moves everything: by one number along each axis, or by three")
      ->type_name("X [Y Z]");
  app.add_option("--seed", wish.seed, "seed of the random numbers")->type_name("N");
  app.add_option("--radius", wish.radius, "one radius for all spheres; the scene's own if not given")->type_name("R");
  app.add_option("--scalar", wish.scalar, "numbers are rounded to float, or to double")
      ->check(CLI::IsMember({"float", "double"}))
      ->type_name("float|double");
  auto const add_order = [&](char const* option, std::string& order, std::string const& of) {
    app.add_option(option, order, "the order of the " + of)
        ->check(CLI::IsMember({"made", "shuffled", "along_x", "halves"}))
        ->type_name("made|shuffled|along_x|halves");
  };
  add_order("--triangle-order", wish.triangle_order, "triangles; halves: first those of even numbers");
  add_order("--vertex-order", wish.vertex_order, "vertices: triangles stay where they are, with other numbers");
  add_order("--sphere-order", wish.sphere_order, "spheres");
  app.footer(footer);
  return io::run_program(app, join_offset(argc, argv), [&] {
    constexpr std::size_t most = 4'000'000'000;
    if (wish.radius && !(*wish.radius >= 0)) throw io::usage_error("--radius: must not be negative");
    if (wish.spheres.value_or(0) > most) throw io::usage_error("--spheres: at most 4000000000");
    if (wish.triangles.value_or(0) > most) throw io::usage_error("--triangles: at most 4000000000");
    generate(wish);
  });
}
