/// make_seeds FOLDER HARNESS...: writes the inputs that the harnesses start from, in a folder each, most of them from
/// the hard cases of tests/data; and for each harness the list of its inputs, as libFuzzer reads it.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "../oracle/scene.hpp"

namespace {

std::string const data = TEST_DATA_DIR;

void write(std::filesystem::path const& folder, std::string const& name, std::string_view content) {
  std::filesystem::create_directories(folder);
  std::ofstream file(folder / name, std::ios::binary);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  if (!file.flush()) throw std::runtime_error((folder / name).string() + ": cannot write it");
}

template <class S>
std::string bytes(std::vector<double> const& numbers) {
  std::string content;
  for (double const x : numbers) {
    S const number = static_cast<S>(x);
    char of[sizeof(S)];
    std::memcpy(of, &number, sizeof(S));
    content.append(of, sizeof(S));
  }
  return content;
}

/// The hard cases of a file as bytes; see numbers.hpp.
template <class S>
void write_cases(std::filesystem::path const& folder, std::string const& file, bool floats, bool swept) {
  for (auto const& c : oracle::read_hard_cases(data + '/' + file, floats)) {
    std::vector<double> numbers;
    for (auto const& p : {c.shape.a, c.shape.b, c.shape.c, c.ball.centre})
      numbers.insert(numbers.end(), {p.x, p.y, p.z});
    if (swept) numbers.insert(numbers.end(), {c.move.x, c.move.y, c.move.z});
    numbers.push_back(c.ball.radius);
    write(folder, file + '.' + std::to_string(c.id) + (sizeof(S) == 4 ? ".float" : ".double"), bytes<S>(numbers));
  }
}

/// The header and some rows of a file, spread over it.
std::string some_rows(std::string const& file) {
  std::ifstream in(data + '/' + file);
  std::string rows, line;
  for (int i = 0; std::getline(in, line); ++i) {
    if (i % 400 == 0) rows += line + '\n';
  }
  return rows;
}

constexpr std::string_view meshes[] = {
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    "# blender\r\nmtllib a.mtl\r\no cube\r\nv 0 0 0 1\r\nv 1e0 0. .0\r\nv +1 -1 0x\r\n",
    "v 0 0 0 1 0.5 0.5 0.5\nvn 0 0 1\nvt 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng a b\nusemtl m\ns off\nf -4//1 -3//1 -2//1 "
    "-1//1\nf 1/1/1 2/1/1 3/1/1\n",
    "f 1 2 3 4 5\nv 0 0 0\nv 4 0 0\nv 4 4 0\nv 1 1 0\nv 0 4 0\n",
    "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 \\\n0.5 0\nv 0 2 0\nv 1 1 1\nf 1 2 3 4 5 6 \\\n 1\nl 1 2\np 1\nvp 1 2\n",
    "v 1e39 0 0\nv 1e-46 -1e-320 nan\nf 1 1 1\n",
};

constexpr std::string_view spheres[] = {
    "x,y,z\n0.2,0.2,0.1\n1e5,-2,.5\n",
    "\xef\xbb\xbfr, z ,name,x,y\r\n1,2,\"a \"\"b\"\"\",3,4\r\n\r\n0,1e-46,,+3.5,1e30\r\n",
    "# x,y,z,r\n1 , 2\t,3,1\n\"1\",\"2\",3,-1\n",
    "x,y,z,r\n1,2,3,inf\n1,2,3,nan\n1,2,3\n1,2,3,4,5\n",
};

constexpr std::string_view cases[] = {
    "id,family,ax,ay,az,bx,by,bz,cx,cy,cz,px,py,pz,R\n0,a,0,0,0,1,0,0,0,1,0,0,0,0x1p-1,.5\n",
    "id,family,hit,ax,ay,az,bx,by,bz,cx,cy,cz,px,py,pz,dx,dy,dz,R\n"
    "0,a,1,0,0,0,1,0,0,0,1,0,0,0,1,0,0,-1,.5\n1,b,0,0,0,0,1,0,0,0,1,0,0,0,1,,,,inf\n",
};

template <std::size_t N>
void write_texts(std::filesystem::path const& folder, std::string_view const (&texts)[N]) {
  for (std::size_t i = 0; i < N; ++i) write(folder, "text." + std::to_string(i), texts[i]);
}

/// The paths of all files of a folder, in an order that is always the same, with commas between them.
std::string list(std::filesystem::path const& folder) {
  std::vector<std::string> paths;
  for (auto const& entry : std::filesystem::directory_iterator(folder)) paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  std::string joined;
  for (auto const& path : paths) joined += (joined.empty() ? "" : ",") + path;
  return joined;
}

}  // namespace

int main(int argc, char** argv) {
  std::filesystem::path const folder = argv[1];
  std::filesystem::remove_all(folder);
  write_texts(folder / "read_obj", meshes);
  write_texts(folder / "read_csv", spheres);
  write_texts(folder / "read_cases", cases);
  for (char const* file : {"static_f32.csv", "static_f64.csv", "swept_f32.csv"}) {
    write(folder / "read_cases", file, some_rows(file));
  }
  write_cases<float>(folder / "static", "static_f32.csv", true, false);
  write_cases<double>(folder / "static", "static_f64.csv", false, false);
  write_cases<float>(folder / "swept", "swept_f32.csv", true, true);
  write_cases<double>(folder / "swept", "swept_f32.csv", true, true);
  for (int i = 2; i < argc; ++i) write(folder, std::string(argv[i]) + ".list", list(folder / argv[i]));
}
