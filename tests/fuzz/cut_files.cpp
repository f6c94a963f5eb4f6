/// cut_files FOLDER COUNT SEED: COUNT files, each a cube that is cut, has a byte changed, or lacks or repeats some
/// bytes. A file is read with all triangles that it says it has, or refused in one line that names it, within five
/// seconds. The process that reads may die: the next one goes on. Files that fail are left in FOLDER.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <collide/core/error.hpp>
#include <collide/io/assimp.hpp>

namespace {

constexpr int corners[12][3] = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                                {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};

/// Coordinate k of vertex v: one of 0.25 and 10 (0x0a is a line feed).
float coordinate(int v, int k) { return (v >> (2 - k)) % 2 != 0 ? 10.0F : 0.25F; }

/// The bytes of a number in this order.
template <class T>
std::string bytes(T number, bool big_endian = false) {
  std::string of(sizeof(T), '\0');
  std::memcpy(of.data(), &number, sizeof(T));
  if (big_endian) std::reverse(of.begin(), of.end());
  return of;
}

std::string line(std::string const& begin, int v, int n = 3) {
  std::ostringstream out;
  out << begin;
  for (int k = 0; k < n; ++k) out << ' ' << coordinate(v, k);
  return out.str() + '\n';
}

std::string ascii_stl() {
  std::string file = "solid cube\n";
  for (auto const& t : corners) {
    file += "  facet normal 0 0 0\n    outer loop\n";
    for (int const v : t) file += line("      vertex", v);
    file += "    endloop\n  endfacet\n";
  }
  return file + "endsolid cube\n";
}

std::string binary_stl() {
  std::string file = std::string(80, ' ') + bytes(std::uint32_t{12});
  for (auto const& t : corners) {
    file += std::string(12, '\0');
    for (int const v : t) {
      for (int k = 0; k < 3; ++k) file += bytes(coordinate(v, k));
    }
    file += std::string(2, '\0');
  }
  return file;
}

std::string ply(std::string const& format) {
  std::string file = "ply\nformat " + format +
                     " 1.0\ncomment of a cube\nelement vertex 8\nproperty float x\nproperty float y\nproperty float "
                     "z\nelement face 12\nproperty list uchar int vertex_indices\nend_header\n";
  bool const big = format == "binary_big_endian";
  for (int v = 0; v < 8; ++v) {
    if (format == "ascii") file += line("", v).substr(1);
    for (int k = 0; k < 3 && format != "ascii"; ++k) file += bytes(coordinate(v, k), big);
  }
  for (auto const& t : corners) {
    file += format == "ascii" ? '3' : '\3';
    for (int const v : t) file += format == "ascii" ? ' ' + std::to_string(v) : bytes(v, big);
    if (format == "ascii") file += '\n';
  }
  return file;
}

std::string off() {
  std::string file = "OFF\n8 12 18\n";
  for (int v = 0; v < 8; ++v) file += line("", v).substr(1);
  for (auto const& t : corners) {
    file += '3';
    for (int const v : t) file += ' ' + std::to_string(v);
    file += '\n';
  }
  return file;
}

std::string obj() {
  std::string file = "# a cube\no cube\n";
  for (int v = 0; v < 8; ++v) file += line("v", v);
  for (auto const& t : corners) {
    file += 'f';
    for (int const v : t) file += ' ' + std::to_string(v + 1);
    file += '\n';
  }
  return file;
}

std::string base64(std::string const& data) {
  char const* const digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i + 2 < data.size(); i += 3) {
    unsigned three = 0;
    for (std::size_t k = 0; k < 3; ++k) three = three << 8 | static_cast<unsigned char>(data[i + k]);
    for (int shift = 18; shift >= 0; shift -= 6) text += digits[three >> shift & 63];
  }
  return text;
}

/// The text of a scene of one node; its buffer is in the text, or in what follows it.
std::string gltf(bool binary) {
  std::string data;
  for (auto const& t : corners) {
    for (int const v : t) data += bytes(static_cast<std::uint16_t>(v));
  }
  for (int v = 0; v < 8; ++v) {
    for (int k = 0; k < 3; ++k) data += bytes(coordinate(v, k));
  }
  std::string text =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":1},"indices":0}]}],"buffers":[{"byteLength":168)" +
      (binary ? "" : R"(,"uri":"data:application/octet-stream;base64,)" + base64(data) + '"') +
      R"(}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":72},{"buffer":0,"byteOffset":72,"byteLength":96}],)"
      R"("accessors":[{"bufferView":0,"componentType":5123,"count":36,"type":"SCALAR"},{"bufferView":1,)"
      R"("componentType":5126,"count":8,"type":"VEC3","min":[0.25,0.25,0.25],"max":[10,10,10]}]})";
  if (!binary) return text;
  text.resize((text.size() + 3) / 4 * 4, ' ');
  auto const number = [](std::size_t n) { return bytes(static_cast<std::uint32_t>(n)); };
  return "glTF" + number(2) + number(28 + text.size() + data.size()) + number(text.size()) + "JSON" + text +
         number(data.size()) + std::string("BIN\0", 4) + data;
}

/// How many triangles the faces of an OBJ file have, a line each.
std::size_t triangles_of_obj(std::string const& file) {
  std::size_t n = 0;
  std::istringstream lines(file);
  for (std::string text; std::getline(lines, text);) {
    std::istringstream words(text.substr(0, text.find('#')));
    std::string word;
    if (!(words >> word) || word != "f") continue;
    std::size_t corners_of_face = 0;
    while (words >> word) ++corners_of_face;
    if (corners_of_face > 2) n += corners_of_face - 2;
  }
  return n;
}

/// How many triangles the scene of a glTF file has, by its JSON.
std::size_t triangles_of_gltf(std::string const& text) {
  auto const scene = nlohmann::json::parse(text, nullptr, false);
  try {
    std::size_t n = 0;
    auto const which = scene.value("scene", 0U);
    for (auto const& node : scene.at("scenes").at(which).at("nodes")) {
      auto const& mesh = scene.at("meshes").at(scene.at("nodes").at(node.get<unsigned>()).at("mesh").get<unsigned>());
      for (auto const& part : mesh.at("primitives")) {
        bool const indexed = part.contains("indices");
        auto const of = indexed ? part.at("indices") : part.at("attributes").at("POSITION");
        auto const count = scene.at("accessors").at(of.get<unsigned>()).at("count").get<std::size_t>();
        auto const mode = part.value("mode", 4U);
        n += mode == 4 ? count / 3 : mode == 5 || mode == 6 ? count - 2 : 0;
      }
    }
    return n;
  } catch (nlohmann::json::exception const&) {
    return 0;
  }
}

/// How many triangles a file has if it is one.
std::size_t triangles_of(std::string const& ending, std::string const& file) {
  if (ending == ".obj") return triangles_of_obj(file);
  if (ending == ".gltf") return triangles_of_gltf(file);
  if (ending == ".glb") {
    std::uint32_t length = 0;
    if (file.size() > 20) std::memcpy(&length, &file[12], 4);
    return file.size() < 20 ? 0 : triangles_of_gltf(file.substr(20, length));
  }
  return 12;
}

/// How many corners of the triangles are not where those of the cube are.
std::size_t corners_elsewhere(collide::mesh_data<float> const& mesh) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < mesh.corners.size(); ++i) {
    float const* const at = &mesh.vertices[3 * std::size_t{mesh.corners[i]}];
    int const v = corners[i / 3][i % 3];
    n += at[0] != coordinate(v, 0) || at[1] != coordinate(v, 1) || at[2] != coordinate(v, 2) ? 1 : 0;
  }
  return n;
}

struct test_file {
  std::string ending, content;
  std::size_t corners_elsewhere;  ///< at most, if it is read, where triangles are declared
};

/// A file that differs from a good one.
test_file changed(test_file file, std::mt19937& random) {
  auto const below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  std::string& all = file.content;
  auto const at = below(all.size());
  auto const length = 1 + below(std::min<std::size_t>(all.size() - at, 40));
  auto const kind = random() % 8;
  // a vertex is a corner of up to six triangles; a name that JSON does not know means nothing
  file.corners_elsewhere = kind < 3 ? 0 : kind < 5 || file.ending[1] == 'g' ? 36 : 6;
  if (kind < 2) {
    all.resize(at);
  } else if (kind == 2) {
    all.resize(all.size() - 1 - below(4));
  } else if (kind == 3) {
    all.erase(at, length);
  } else if (kind == 4) {
    all.insert(at, all.substr(at, length));
  } else {
    unsigned char const others[] = {static_cast<unsigned char>(random()),
                                    static_cast<unsigned char>(" \n-.019e"[random() % 8]),
                                    static_cast<unsigned char>(all[at] ^ (1 << random() % 8))};
    all[at] = static_cast<char>(others[kind - 5]);
  }
  return file;
}

enum result : char { none, taken, refused, wrong };

result read_file(std::string const& path, test_file const& file) {
  try {
    auto const mesh = collide::read_mesh<float>(path);
    auto const triangles = triangles_of(file.ending, file.content);
    if (mesh.size() != triangles) {
      std::fprintf(stderr, "%s: %zu triangles in place of %zu\n", path.c_str(), mesh.size(), triangles);
    } else if (mesh.size() != 12 || corners_elsewhere(mesh) <= file.corners_elsewhere) {
      return taken;
    } else {
      std::fprintf(stderr, "%s: %zu corners are elsewhere\n", path.c_str(), corners_elsewhere(mesh));
    }
  } catch (collide::error const& e) {
    std::string const what = e.what(), named = ": " + path + ": ";
    auto const at = what.find(named);
    bool const says_why = at < what.size() && at + named.size() < what.size();
    if (what.compare(0, 14, "collide: read_") == 0 && says_why && what.find('\n') == what.npos) return refused;
    std::fprintf(stderr, "%s: says '%s'\n", path.c_str(), what.c_str());
  } catch (std::exception const& e) {
    std::fprintf(stderr, "%s: throws '%s'\n", path.c_str(), e.what());
  }
  return wrong;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  std::filesystem::path const folder = argv[1];
  std::size_t const count = std::strtoul(argv[2], nullptr, 10);
  std::mt19937 random(static_cast<unsigned>(std::strtoul(argv[3], nullptr, 10)));
  std::vector<test_file> const good = {{".stl", ascii_stl(), 0},
                                       {".stl", binary_stl(), 0},
                                       {".ply", ply("ascii"), 0},
                                       {".ply", ply("binary_little_endian"), 0},
                                       {".ply", ply("binary_big_endian"), 0},
                                       {".off", off(), 0},
                                       {".obj", obj(), 0},
                                       {".gltf", gltf(false), 0},
                                       {".glb", gltf(true), 0}};
  std::vector<test_file> files = good;
  while (files.size() < count) files.push_back(changed(good[files.size() % good.size()], random));
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  auto const path_of = [&](std::size_t i) { return (folder / (std::to_string(i) + files[i].ending)).string(); };
  auto* const results =
      static_cast<result*>(mmap(nullptr, files.size(), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  if (results == MAP_FAILED) return 2;

  // a process reads until all are read, or it dies of one; the next goes on behind that
  for (std::size_t next = 0; next < files.size();) {
    pid_t const child = fork();
    if (child == 0) {
      for (; next < files.size(); ++next) {
        auto const path = path_of(next);
        std::ofstream(path, std::ios::binary) << files[next].content;
        alarm(5);
        results[next] = read_file(path, files[next]);
        if (results[next] != wrong) std::filesystem::remove(path);
      }
      _exit(0);
    }
    int status = 0;
    if (child < 0 || waitpid(child, &status, 0) != child) return 2;
    while (next < files.size() && results[next] != none) ++next;
    if (next == files.size()) break;
    char const* const death = WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "ends the program";
    std::fprintf(stderr, "%s: %s\n", path_of(next).c_str(), death);
    results[next++] = wrong;
  }

  bool failed = false;
  for (std::size_t g = 0; g < good.size(); ++g) {
    std::size_t of[4] = {};
    for (std::size_t i = g; i < files.size(); i += good.size()) ++of[static_cast<std::size_t>(results[i])];
    std::printf("%s: %zu read, %zu refused, %zu wrong\n", good[g].ending.c_str(), of[taken], of[refused], of[wrong]);
    failed = failed || of[wrong] > 0 || results[g] != taken;
  }
  return failed ? 1 : 0;
}
